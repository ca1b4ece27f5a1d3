//! Factorisations on several ranks in rounds: after each the host hears of it, and may end the call.

use std::collections::BTreeMap;

/// Bodies of one round: on other ranks, with these; and here.
#[derive(Debug)]
pub struct Round<L, O> {
    pub lent: Vec<(usize, usize, L)>,
    pub own: Vec<(usize, O)>,
}

impl<L, O> Default for Round<L, O> {
    fn default() -> Self {
        Self { lent: Vec::new(), own: Vec::new() }
    }
}

/// Rounds of so many operations on every rank, and of a body for each of so many threads at least. With no body on another rank all in one.
pub fn rounds<L, O>(
    all: Round<L, O>,
    work: &dyn Fn(usize) -> f64,
    (threads, operations): (usize, f64),
) -> Vec<Round<L, O>> {
    let of_lent = all.lent.iter().map(|(p, rank, _)| (*rank, *p));
    let mut ranks: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    for (rank, p) in of_lent.chain(all.own.iter().map(|(p, _)| (0, *p))) {
        let (bodies, sum) = ranks.entry(rank).or_default();
        *bodies += 1;
        *sum += work(p);
    }
    let of_rank =
        |(bodies, sum): &(usize, f64)| bodies.div_ceil(threads).min((sum / operations).ceil() as usize);
    let count = if all.lent.is_empty() { 1 } else { ranks.values().map(of_rank).fold(1, usize::max) };
    let mut so_far: BTreeMap<usize, f64> = BTreeMap::new();
    let mut round_of = |rank: usize, p: usize| {
        let (done, own) = (so_far.entry(rank).or_default(), work(p));
        let middle = *done + own / 2.0;
        *done += own;
        ((count as f64 * middle / ranks[&rank].1) as usize).min(count - 1)
    };
    let mut rounds: Vec<Round<L, O>> = (0..count).map(|_| Round::default()).collect();
    for (p, rank, of) in all.lent {
        rounds[round_of(rank, p)].lent.push((p, rank, of));
    }
    for (p, of) in all.own {
        rounds[round_of(0, p)].own.push((p, of));
    }
    rounds
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies 0 to 9 of 6 operations, every second on rank 1.
    fn all() -> Round<(), ()> {
        let of = |rank: usize| (0..10).filter(move |p| p % 2 == rank);
        Round { lent: of(1).map(|p| (p, 1, ())).collect(), own: of(0).map(|p| (p, ())).collect() }
    }

    fn bodies(rounds: &[Round<(), ()>]) -> Vec<(Vec<usize>, Vec<usize>)> {
        let of = |round: &Round<(), ()>| {
            (round.lent.iter().map(|of| of.0).collect(), round.own.iter().map(|of| of.0).collect())
        };
        rounds.iter().map(of).collect()
    }

    #[test]
    fn every_round_has_its_share_of_the_work_of_every_rank() {
        let made = rounds(all(), &|_| 6.0, (1, 10.0));
        let expected = [(vec![1, 3], vec![0, 2]), (vec![5], vec![4]), (vec![7, 9], vec![6, 8])];
        assert_eq!(bodies(&made), expected);
        assert_eq!(rounds(all(), &|_| 6.0, (4, 10.0)).len(), 2, "a body for each thread");
        assert_eq!(rounds(all(), &|_| 6.0, (1, 30.0)).len(), 1, "little work");
        assert_eq!(rounds(all(), &|_| 0.0, (1, 10.0)).len(), 1, "no work");
        let both =
            Round { lent: vec![(0, 1, ()), (1, 1, ()), (2, 1, ())], own: vec![(2, ()), (3, ()), (4, ())] };
        let expected = [(vec![0], vec![2]), (vec![1], vec![3]), (vec![2], vec![4])];
        assert_eq!(bodies(&rounds(both, &|_| 6.0, (1, 6.0))), expected, "here and there, too");
        let here = Round::<(), ()> { lent: Vec::new(), own: all().own };
        assert_eq!(rounds(here, &|_| 6.0, (1, 1.0)).len(), 1, "no other rank");
    }
}
