//! The problems as files of numbers, for `tests/mpi/deals.c`.

use std::path::Path;

use decks::{Body, Deck, Rows};

use super::{dimension, drawn, equal_rows, firsts, Motions, Said};
use crate::support::asked;

/// Words of 8 bytes, as this machine has them.
#[derive(Default)]
struct Words(Vec<u8>);

impl Words {
    fn bytes(&mut self, bytes: impl IntoIterator<Item = u8>) {
        self.0.extend(bytes);
        self.0.resize(self.0.len().next_multiple_of(8), 0);
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = i64>) {
        self.bytes(numbers.into_iter().flat_map(i64::to_ne_bytes));
    }

    fn counts<'a>(&mut self, counts: impl IntoIterator<Item = &'a usize>) {
        self.numbers(counts.into_iter().map(|count| *count as i64));
    }

    fn reals<'a>(&mut self, reals: impl IntoIterator<Item = &'a f64>) {
        self.bytes(reals.into_iter().flat_map(|real| real.to_ne_bytes()));
    }

    /// The key of a row is the first row that is the same.
    fn rows(&mut self, rows: &Rows) {
        let equal = equal_rows(rows);
        let first = |i: usize| equal.iter().find(|pair| pair.0 == i).map_or(i, |pair| pair.1);
        let keys: Vec<usize> = (0..rows.len()).map(first).collect();
        self.counts([&rows.len()].into_iter().chain(&keys).chain(&rows.matrix.ptr).chain(&rows.matrix.col));
        self.reals(rows.matrix.val.iter().chain(&rows.rhs).chain(&rows.compliance));
    }

    /// The null space as the C library takes it: -1 columns if it is not given, dimension 0 without coordinates.
    fn body(&mut self, first: usize, body: &Body, motions: Motions) {
        let (modes, flag, dimension) = match motions {
            Motions::Exact => (body.modes().len() as i64, 0, 0),
            Motions::Soft => (body.modes().len() as i64, 2, 0),
            Motions::Placed => (-1, 0, dimension(body) as i64),
            Motions::Unsaid => (-1, 0, 0),
        };
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..body.dofs() {
            for (j, v) in body.stiffness.row(i).filter(|(j, _)| *j <= i) {
                col.push(j);
                val.push(v);
            }
            ptr.push(col.len());
        }
        self.numbers([body.dofs() as i64, modes, flag, dimension]);
        self.numbers((first..first + body.dofs()).map(|number| number as i64));
        self.counts(ptr.iter().chain(&col));
        self.reals(val.iter().chain(&body.load));
        if modes > 0 {
            self.reals(body.modes().iter().flatten());
        }
        if dimension > 0 {
            self.bytes(body.node.iter().flat_map(|label| label.to_ne_bytes()));
            self.bytes(body.direction.iter().flat_map(|axis| axis.to_ne_bytes()));
            self.reals(body.coordinates.iter().flatten());
        }
    }

    fn deck(&mut self, deck: &Deck, (motions, options): Said) {
        let friction = &deck.friction;
        self.counts([&deck.bodies.len(), &friction.dim, &friction.normal.len()]);
        self.bytes(options.bytes().chain(std::iter::repeat(0)).take(32));
        firsts(deck).into_iter().zip(&deck.bodies).for_each(|(first, body)| self.body(first, body, motions));
        [&deck.contact, &deck.equalities, &friction.rows].into_iter().for_each(|rows| self.rows(rows));
        self.numbers(friction.normal.iter().map(|row| row.map_or(-1, |row| row as i64)));
        self.reals(friction.coefficient.iter().chain(&friction.bound));
    }
}

/// `make mpi`: the problems of so many seeds (DEALS), below folder PROBLEMS.
#[test]
#[ignore]
fn problems_to_deal_out() {
    let folder = std::env::var("PROBLEMS").expect("PROBLEMS: a folder");
    for seed in 0..asked::asked("DEALS").expect("DEALS: a number of seeds") {
        for (name, deck, said) in drawn(seed) {
            let mut words = Words::default();
            words.deck(&deck, said);
            let name = format!("{}{seed}.deal", name.replace(' ', "_"));
            std::fs::write(Path::new(&folder).join(name), words.0).unwrap();
        }
    }
}
