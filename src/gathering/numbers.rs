//! Numbers of unknowns that several ranks have, found from sorted sections: no list of all numbers is anywhere.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::error::Result;

/// Numbers of a section.
pub const SECTION: usize = 1 << 16;

/// The numbers that several lists have, ascending, each with these lists. A list is ascending and comes in sections: of each the first, and
/// `next` of its number until one is empty.
pub fn shared(
    firsts: Vec<Vec<usize>>,
    mut next: impl FnMut(usize) -> Result<Vec<usize>>,
) -> Result<Vec<(usize, Vec<usize>)>> {
    let (mut sections, mut heads) = (Vec::new(), BinaryHeap::new());
    for (list, section) in firsts.into_iter().enumerate() {
        heads.extend(section.first().map(|number| Reverse((*number, list))));
        sections.push((section, 1));
    }
    let (mut shared, mut last) = (Vec::<(usize, Vec<usize>)>::new(), None);
    while let Some(Reverse((number, list))) = heads.pop() {
        if let Some((_, before)) = last.filter(|(of, _)| *of == number) {
            match shared.last_mut().filter(|(of, _)| *of == number) {
                Some((_, lists)) => lists.push(list),
                None => shared.push((number, vec![before, list])),
            }
        }
        last = Some((number, list));
        let (section, at) = &mut sections[list];
        if *at == section.len() {
            (*section, *at) = (next(list)?, 0);
        }
        heads.extend(section.get(*at).map(|number| Reverse((*number, list))));
        *at += 1;
    }
    Ok(shared)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_several_lists_are_found_across_the_ends_of_sections() {
        let lists = [vec![1, 4, 5, 9, 10], vec![2, 4, 10, 11], vec![4, 9, 1 << 59], vec![]];
        for section in 1..6 {
            let mut at = [0; 4];
            let mut next = |list: usize| {
                let end = (at[list] + section).min(lists[list].len());
                let own = lists[list][at[list]..end].to_vec();
                at[list] = end;
                Ok(own)
            };
            let expected = [(4, vec![0, 1, 2]), (9, vec![0, 2]), (10, vec![0, 1])];
            let firsts = (0..4).map(|list| next(list).unwrap()).collect();
            assert_eq!(shared(firsts, next).unwrap(), expected, "{section}");
        }
    }
}
