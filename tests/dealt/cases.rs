//! The reference cases and decks of other tests, dealt out.

use decks::rubbing::{self, Rubbing};
use decks::{masonry, Body, Csr, Cube, Deck, Moduli, Rows, Stack};

use super::{compare, Motions};
use crate::reference::{Case, Sparse, CASES};

fn csr(of: &Sparse, cols: usize) -> Csr {
    let mut all = Csr::empty(cols);
    for range in of.ptr.windows(2) {
        let row: Vec<_> = (range[0]..range[1]).map(|e| (of.col[e] as usize, of.val[e])).collect();
        all.push_row(&row);
    }
    all
}

/// Both triangles of a lower one.
fn full(lower: &Sparse) -> Csr {
    let n = lower.ptr.len() - 1;
    let mut rows = vec![Vec::new(); n];
    for i in 0..n {
        for e in lower.ptr[i]..lower.ptr[i + 1] {
            let (j, v) = (lower.col[e] as usize, lower.val[e]);
            rows[i].push((j, v));
            if i != j {
                rows[j].push((i, v));
            }
        }
    }
    let mut all = Csr::empty(n);
    rows.iter().for_each(|row| all.push_row(row));
    all
}

fn reference(name: &str) -> Deck {
    let case = Case::read(name);
    let mut first = 0;
    let bodies = case.bodies.iter().map(|(k, r)| {
        let n = k.ptr.len() - 1;
        let null_space = (!r.is_empty()).then(|| r.chunks(n).map(<[f64]>::to_vec).collect());
        first += n;
        let load = case.load[first - n..first].to_vec();
        Body {
            stiffness: full(k),
            null_space,
            load,
            coordinates: vec![[0.0; 3]; n],
            node: vec![1; n],
            direction: vec![1; n],
        }
    });
    let mut deck = Deck::new(name, bodies.collect());
    let rows = |(of, rhs): &(Sparse, Vec<f64>)| Rows {
        matrix: csr(of, case.load.len()),
        rhs: rhs.clone(),
        compliance: vec![0.0; rhs.len()],
    };
    (deck.contact, deck.equalities) = (rows(&case.contact), rows(&case.equalities));
    deck
}

#[test]
fn reference_cases_dealt_out_to_ranks_have_the_bits_of_one_rank() {
    for (k, name) in CASES.iter().enumerate() {
        let deck = reference(name);
        compare(name, k as u64, &deck, (Motions::Exact, ""));
        compare(name, 5 + k as u64, &deck, (Motions::Unsaid, ""));
    }
}

#[test]
fn decks_dealt_out_to_ranks_have_the_bits_of_one_rank() {
    let cube = |side: usize| Cube { subdomains: [side; 3], elements: 4, ..Cube::default() };
    let moduli = Moduli::Checkerboard(1e3);
    let pressure = 300.0 * Cube::default().pressure;
    let decks = [
        cube(2).build(),
        Cube { clamp: false, waves: 0.3, ..cube(2) }.build(),
        Cube { layer: 0.25, ..cube(2) }.build(),
        Cube { moduli, pressure, ..cube(3) }.build(),
        Cube { dimension: 2, elements: 8, ..cube(4) }.build(),
        Stack::default().build(),
        masonry::tower(6),
        masonry::heap(12, 5),
        rubbing::cube(&Cube { clamp: false, ..cube(2) }, 0.3, 0.8),
        rubbing::cube(&cube(2), 1.0, 1.5),
    ];
    let rubbing = Rubbing::floating_36();
    let decks = decks.into_iter().chain(rubbing.iter().step_by(9).map(Rubbing::build));
    for (k, deck) in decks.enumerate() {
        let name = deck.name.clone();
        compare(&name, k as u64, &deck, (Motions::Exact, ""));
    }
}
