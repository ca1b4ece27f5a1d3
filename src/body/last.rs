//! The dofs t that the search eliminates last, and K with springs at them.

use crate::error::Result;
use crate::linalg::{Multiple, Symmetric};

/// One of n dofs from each of `count` intervals of equal length, at random with a fixed seed; all dofs if there are no
/// more.
pub fn spread(n: usize, count: usize) -> Vec<usize> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    if n <= count {
        return (0..n).collect();
    }
    (0..count)
        .map(|k| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let (begin, end) = (k * n / count, (k + 1) * n / count);
            begin + (state >> 33) as usize % (end - begin)
        })
        .collect()
}

/// `K + E D_tt E'`; all dofs t, ascending, are coupled.
pub fn supported(k: &Multiple, last: &[usize]) -> Result<Symmetric> {
    const WHAT: &str = "a supported stiffness matrix";
    let coupled = last.len() * (last.len() + 1) / 2;
    let mut sum = Symmetric::with_room(k.order(), k.matrix.col.len() + coupled, WHAT)?;
    let (mut row, mut next) = (Vec::new(), 0);
    for i in 0..k.order() {
        row.clear();
        row.extend(k.matrix.lower_row(i).map(|(j, v)| (j, k.by * v)));
        if last.get(next) == Some(&i) {
            let found = row.len();
            for &j in &last[..next] {
                if row[..found].binary_search_by_key(&j, |entry| entry.0).is_err() {
                    row.push((j, 0.0));
                }
            }
            row.sort_unstable_by_key(|entry| entry.0);
            row.last_mut().into_iter().for_each(|diagonal| diagonal.1 += k.metric(i, 1.0));
            next += 1;
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
        let chosen = spread(1000, 24);
        assert!(chosen.len() == 24 && chosen.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(spread(7, 24), [0, 1, 2, 3, 4, 5, 6]);
    }
}
