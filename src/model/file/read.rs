//! A problem from a file: everything goes through the calls that a host would make.

use std::io::Read;

use crate::error::Result;
use crate::model::contents::Model;
use crate::model::file::format::{
    Tag, BODY, COORDINATES, FIXING, LOAD, NULL_SPACE, NUMBERING, OPTIONS, ROWS, STIFFNESS,
};
use crate::model::file::input::Input;
use crate::model::file::sections::{Offsets, SectionContent};

/// Reads a problem of `length` bytes.
pub fn read(source: impl Read, length: u64) -> Result<Model> {
    let mut input = Input::new(source, length)?;
    let mut model = Model::new();
    let mut offsets = Offsets::default();
    while !input.is_at_its_end() {
        let mut open = input.open()?;
        if !is_known(open.tag) {
            input.skip(&mut open)?;
            continue;
        }
        let part = SectionContent::read(&mut input, &mut open)?;
        input.close(&mut open)?;
        part.hand_over(&mut model, &mut offsets).map_err(|error| input.refused(error, &open))?;
    }
    Ok(model)
}

fn is_known(tag: Tag) -> bool {
    [OPTIONS, BODY, STIFFNESS, NULL_SPACE, COORDINATES, FIXING, LOAD, NUMBERING, ROWS].contains(&tag)
}
