//! The dofs t that the search eliminates last in every connected part, and K with springs at them.

use crate::error::Result;
use crate::linalg::{Multiple, Symmetric};
use crate::platform::memory::{filled, reserved};

/// One dof from each of `count` intervals of equal length, at random with a fixed seed; all dofs if there are no more.
pub fn spread(dofs: &[usize], count: usize) -> Vec<usize> {
    let (n, mut state) = (dofs.len(), 0x9e37_79b9_7f4a_7c15_u64);
    if n <= count {
        return dofs.to_vec();
    }
    (0..count)
        .map(|k| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let (begin, end) = (k * n / count, (k + 1) * n / count);
            dofs[begin + (state >> 33) as usize % (end - begin)]
        })
        .collect()
}

/// Positions of the entries of K between different parts; all these entries are 0.
pub fn between_parts(k: &Symmetric, part_of: &[usize]) -> Result<Vec<usize>> {
    let row =
        |i: usize| (k.ptr[i]..k.ptr[i + 1]).filter(move |&at| part_of[k.col[at] as usize] != part_of[i]);
    let mut found = reserved((0..k.order()).flat_map(row).count(), "the connected parts of a body")?;
    found.extend((0..k.order()).flat_map(row));
    Ok(found)
}

/// `K + E D_tt E'` without the entries between parts; all dofs t of one part are coupled.
pub fn supported(k: &Multiple, last: &[Vec<usize>], between: &[usize]) -> Result<Symmetric> {
    const WHAT: &str = "a supported stiffness matrix";
    let mut mates = filled::<&[usize]>(k.order(), &[], WHAT)?;
    last.iter().for_each(|last| last.iter().for_each(|&dof| mates[dof] = last));
    let coupled: usize = last.iter().map(|last| last.len() * (last.len() + 1) / 2).sum();
    let mut sum = Symmetric::with_room(k.order(), k.matrix.col.len() + coupled, WHAT)?;
    let (mut row, mut left_out) = (Vec::new(), between.iter().copied().peekable());
    for i in 0..k.order() {
        row.clear();
        let kept = k.matrix.ptr[i]..k.matrix.ptr[i + 1];
        let kept = kept.filter(|at| left_out.next_if_eq(at).is_none());
        row.extend(kept.map(|at| (k.matrix.col[at] as usize, k.by * k.matrix.val[at])));
        let earlier = mates[i].iter().copied().take_while(|&j| j < i);
        if !mates[i].is_empty() {
            let found = row.len();
            for j in earlier {
                if row[..found].binary_search_by_key(&j, |entry| entry.0).is_err() {
                    row.push((j, 0.0));
                }
            }
            row.sort_unstable_by_key(|entry| entry.0);
            row.last_mut().into_iter().for_each(|diagonal| diagonal.1 += k.metric(i, 1.0));
        }
        sum.push_row(row.iter().copied());
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dofs_chosen_are_spread_and_never_the_same_twice() {
        let all: Vec<usize> = (0..1000).map(|i| 3 * i).collect();
        let chosen = spread(&all, 24);
        assert!(chosen.len() == 24 && chosen.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(spread(&all[..7], 24), all[..7]);
    }
}
