//! The elimination tree of a sparse Cholesky factorisation and its postorder.

/// No parent: a root of the forest.
pub const NONE: usize = usize::MAX;

/// Parent of every column; `neighbours(j)` gives the rows i < j of column j, and possibly other rows (Liu's algorithm
/// with path compression).
pub fn elimination_tree<'a, I>(n: usize, neighbours: impl Fn(usize) -> I) -> Vec<usize>
where
    I: Iterator<Item = &'a u32>,
{
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for j in 0..n {
        for &i in neighbours(j) {
            let mut i = i as usize;
            while i != NONE && i < j {
                let next = ancestor[i];
                ancestor[i] = j;
                if next == NONE {
                    parent[i] = j;
                }
                i = next;
            }
        }
    }
    parent
}

/// Columns in an order in which every subtree is contiguous and children precede parents.
pub fn postorder(parent: &[usize]) -> Vec<usize> {
    let n = parent.len();
    let (mut head, mut next) = (vec![NONE; n], vec![NONE; n]);
    for j in (0..n).rev().filter(|&j| parent[j] != NONE) {
        next[j] = head[parent[j]];
        head[parent[j]] = j;
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for root in (0..n).filter(|&j| parent[j] == NONE) {
        stack.push(root);
        while let Some(&j) = stack.last() {
            match head[j] {
                NONE => {
                    order.push(j);
                    stack.pop();
                }
                child => {
                    head[j] = next[child];
                    stack.push(child);
                }
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_of_an_arrow_matrix_is_a_star_and_children_precede_parents() {
        // columns 0, 1, 2 are coupled only to column 3
        let columns: [&[u32]; 4] = [&[3], &[3], &[3], &[0, 1, 2]];
        let parent = elimination_tree(4, |j| columns[j].iter());
        assert_eq!(parent, [3, 3, 3, NONE]);
        assert_eq!(postorder(&parent), [0, 1, 2, 3]);
    }

    #[test]
    fn subtrees_are_contiguous_in_the_postorder() {
        // 0 -> 2, 1 -> 3, 2 -> 4, 3 -> 4
        assert_eq!(postorder(&[2, 3, 4, 4, NONE]), [0, 2, 1, 3, 4]);
    }
}
