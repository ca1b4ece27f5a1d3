//! Which bodies are lent to other ranks: the largest first, each to the rank with least work, rank 0 included.

use std::cmp::Reverse;

use crate::numbers::setup::SENT;

/// What a body costs.
pub struct Cost {
    /// Operations of its factorisation and of the assembly of its dual operator.
    pub work: f64,
    /// Bytes of its matrix.
    pub bytes: f64,
}

/// The rank of every body. `serve`: the ranks that may get bodies, rank 0 among them; `given`: those of bodies that have one; `costs`:
/// none for bodies that stay on rank 0. `all`: every body that may be lent is dealt out in turn, whatever it costs.
pub fn ranks_of(serve: &[bool], given: &[Option<usize>], costs: &[Option<Cost>], all: bool) -> Vec<usize> {
    let may: Vec<usize> = (0..serve.len()).filter(|rank| serve[*rank]).collect();
    let mut ranks: Vec<usize> = given.iter().map(|given| given.unwrap_or(0)).collect();
    let is_free = |p: &usize| given[*p].is_none();
    if all {
        let free = (0..ranks.len()).filter(is_free).filter(|p| costs[*p].is_some());
        free.collect::<Vec<_>>().into_iter().for_each(|p| ranks[p] = may[(p + 1) % may.len()]);
        return ranks;
    }
    let pays = |p: &usize| costs[*p].as_ref().is_some_and(|cost| cost.work > SENT * cost.bytes);
    let work = |p: usize| costs[p].as_ref().map_or(0.0, |cost| cost.work);
    let (mut lent, stay): (Vec<usize>, Vec<usize>) = (0..ranks.len()).partition(|p| is_free(p) && pays(p));
    lent.sort_by(|&p, &q| work(q).total_cmp(&work(p)));
    let mut loads = vec![0.0; serve.len()];
    stay.into_iter().for_each(|p| loads[ranks[p]] += work(p));
    for p in lent {
        // of equal ranks the last: rank 0 also leads
        let least = may
            .iter()
            .copied()
            .min_by(|&a, &b| loads[a].total_cmp(&loads[b]).then(Reverse(a).cmp(&Reverse(b))));
        ranks[p] = least.unwrap_or(0);
        loads[ranks[p]] += work(p);
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(work: &[f64]) -> Vec<Option<Cost>> {
        work.iter().map(|&work| Some(Cost { work, bytes: 1.0 })).collect()
    }

    #[test]
    fn the_largest_bodies_go_first_and_small_ones_stay() {
        let work = [3e6, 1.0, 5e6, 2e6, 4e6, 1e6];
        assert_eq!(ranks_of(&[true; 2], &[None; 6], &costs(&work), false), [0, 0, 1, 1, 0, 1]);
        assert_eq!(ranks_of(&[true], &[None; 6], &costs(&work), false), [0; 6]);
    }

    #[test]
    fn ranks_that_do_not_serve_get_nothing() {
        let (serve, work) = ([true, false, true], [3e6, 5e6, 4e6]);
        assert_eq!(ranks_of(&serve, &[None; 3], &costs(&work), false), [0, 2, 0]);
        assert_eq!(ranks_of(&serve, &[Some(1), None, None], &costs(&work), true), [1, 0, 2]);
    }

    #[test]
    fn bodies_that_have_a_rank_keep_it_and_others_fill_up() {
        let given = [Some(1), Some(1), None, None];
        assert_eq!(ranks_of(&[true; 2], &given, &costs(&[1e6; 4]), false), [1, 1, 0, 0]);
        let mut some = costs(&[1e6; 4]);
        some[3] = None;
        assert_eq!(
            ranks_of(&[true; 3], &[None; 4], &some, true),
            [1, 2, 0, 0],
            "a body of the host's functions stays"
        );
    }
}
