//! A problem from a file: everything goes through the calls that a host would make.

use std::io::Read;

use crate::error::Result;
use crate::solver::file::format::{
    Tag, BODY, COORDINATES, FIXING, LOAD, NULL_SPACE, NUMBERING, OPTIONS, ROWS, STIFFNESS,
};
use crate::solver::file::input::Input;
use crate::solver::file::sections::{Offsets, Part};
use crate::solver::problem::Problem;

/// Reads a problem of `length` bytes.
pub fn read(source: impl Read, length: u64) -> Result<Problem> {
    let mut input = Input::new(source, length)?;
    let mut problem = Problem::new();
    let mut offsets = Offsets::default();
    while !input.is_at_its_end() {
        let mut open = input.open()?;
        if !is_known(open.tag) {
            input.skip(&mut open)?;
            continue;
        }
        let part = Part::read(&mut input, &mut open)?;
        input.close(&mut open)?;
        part.hand_over(&mut problem, &mut offsets).map_err(|error| input.refused(error, &open))?;
    }
    Ok(problem)
}

fn is_known(tag: Tag) -> bool {
    [OPTIONS, BODY, STIFFNESS, NULL_SPACE, COORDINATES, FIXING, LOAD, NUMBERING, ROWS].contains(&tag)
}
