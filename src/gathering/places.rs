//! Where the unknowns of numbers are: their copies on all ranks, and the joints between these.

use std::collections::HashMap;

use crate::error::Result;
use crate::model::{HostModel, Joint};

/// A body, row or node by its rank and its number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct At {
    pub rank: usize,
    pub number: usize,
}

/// The unknowns that numbers have among all unknowns of all ranks, ascending.
#[derive(Default)]
pub struct Places {
    of: HashMap<usize, Vec<usize>>,
}

impl Places {
    /// The unknown `place` has this number.
    pub fn add(&mut self, number: usize, place: usize) {
        self.of.entry(number).or_default().push(place);
    }

    pub fn sort(&mut self) {
        self.of.values_mut().for_each(|places| places.sort_unstable());
    }

    /// The first unknown with this number.
    pub fn first(&self, number: usize) -> Option<usize> {
        self.of.get(&number)?.first().copied()
    }

    /// Each joins an unknown to the one before it with its number, in the order of the later ones.
    pub fn joints(&self) -> Vec<Joint> {
        let of = |(number, places): (&usize, &Vec<usize>)| {
            let number = *number;
            places.windows(2).map(move |ends| Joint { number, ends: [ends[0], ends[1]] }).collect::<Vec<_>>()
        };
        let mut joints: Vec<Joint> = self.of.iter().flat_map(of).collect();
        joints.sort_unstable_by_key(|joint| joint.ends[1]);
        joints
    }
}

/// Numbers, ascending, and the bodies and dofs of a rank that have each.
pub type Copies = (Vec<usize>, Vec<Vec<(usize, usize)>>);

/// The unknowns of a rank that have one of these numbers, or a number that several of them have.
pub fn copies(model: &HostModel, mut numbers: Vec<usize>) -> Result<Copies> {
    numbers.extend(model.joints()?.into_iter().map(|joint| joint.number));
    numbers.sort_unstable();
    numbers.dedup();
    let mut copies: Vec<Vec<(usize, usize)>> =
        numbers.iter().map(|number| model.unknowns.get(number).copied().into_iter().collect()).collect();
    if model.shares_numbers() {
        let at: HashMap<usize, usize> = numbers.iter().enumerate().map(|(k, number)| (*number, k)).collect();
        copies.iter_mut().for_each(Vec::clear);
        for (body, given) in model.bodies.iter().enumerate() {
            for (dof, number) in given.numbers.iter().flatten().enumerate() {
                at.get(number).into_iter().for_each(|k| copies[*k].push((body, dof)));
            }
        }
    }
    Ok((numbers, copies))
}
