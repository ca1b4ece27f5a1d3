//! The sweeps of `make scaling`: what grows, on which decks, by which programs.

use std::thread::available_parallelism;

use crate::programs::Program;

/// Bytes of a megabyte.
pub const MEGABYTE: f64 = 1e6;

pub const OURS: Program = Program::Ours(1);
pub const UNIT: Program = Program::Cholmod(1);

/// Decks of which one quantity grows.
pub struct Sweep {
    /// The quantity, as the runs print it.
    pub name: &'static str,
    /// What the abscissa of the pictures is.
    pub label: &'static str,
    pub decks: &'static [&'static str],
}

/// `threads` is the one sweep whose decks are solved on 1, 2, 4, ... threads instead.
pub const THREADS: &str = "threads";
/// Bodies by their elements on two threads; no pictures.
pub const CUT: &str = "cut";

pub const SWEEPS: [Sweep; 5] = [
    Sweep { name: "dofs", label: "unknowns, two blocks", decks: &["2k", "4k", "13k", "40k", "92k", "144k"] },
    Sweep {
        name: "rows",
        label: "contact rows, two blocks of about 40 thousand unknowns together, flatter and flatter",
        decks: &["40k", "729_rows", "1296_rows", "1936_rows", "2704_rows", "4489_rows"],
    },
    Sweep {
        name: "bodies",
        label: "bodies that the same cube is cut into, glued",
        decks: &["cut_1", "cut_8", "cut_27", "cut_64"],
    },
    Sweep { name: THREADS, label: "threads", decks: &["144k", "one_body", "64_bodies"] },
    Sweep { name: CUT, label: "unknowns, two blocks", decks: &["144k_cut", "300k_cut", "989k_cut"] },
];

impl Sweep {
    pub fn programs(&self) -> Vec<Program> {
        match self.name {
            THREADS => thread_counts().into_iter().map(Program::Ours).collect(),
            CUT => vec![Program::Cut(2)],
            _ => vec![OURS, UNIT],
        }
    }
}

/// 1, 2, 4, ... and all threads of the machine.
fn thread_counts() -> Vec<usize> {
    let all = available_parallelism().map_or(1, |count| count.get());
    let powers = (0..).map(|power| 1 << power).take_while(|&count| count < all);
    powers.chain([all]).collect()
}
