//! Reads a problem from a file: the content of its sections, which replace the calls of a host.

use std::io::Read;

use crate::body::{Modes, SparseInput, Storage};
use crate::constraints::{FrictionInput, RowKind, RowsInput};
use crate::error::{Error, Kind, Result};
use crate::model::file::format::{
    Tag, BODY, COORDINATES, COORDINATES_FLAGS, FIXING, FRICTION, LOAD, NULL_SPACE, NUMBERING, OPTIONS,
    PIECES, ROWS, STIFFNESS,
};
use crate::model::file::input::{saturated, Input, OpenSection};
use crate::model::file::write::{CANDIDATES, EQUALITY, EXACT, INEQUALITY, SOFT};
use crate::model::host::HostModel;
use crate::model::pieces::PiecesInput;
use crate::platform::memory::reserved;

/// Reads a problem of `length` bytes.
pub fn read(source: impl Read, length: u64) -> Result<HostModel> {
    let mut input = Input::new(source, length)?;
    let mut model = HostModel::new();
    let mut offsets = Offsets::default();
    while !input.is_at_its_end() {
        let mut open = input.open()?;
        let Some(content) = SectionContent::read(&mut input, &mut open)? else {
            input.skip(&mut open)?;
            continue;
        };
        input.close(&mut open)?;
        let handed_over = content.hand_over(open.tag, &mut model, &mut offsets);
        handed_over.map_err(|error| input.refused(error, &open))?;
    }
    Ok(model)
}

/// The content of a section.
enum SectionContent {
    Options(String),
    Body { n: usize },
    Stiffness { ptr: Vec<usize>, col: Vec<i64>, val: Vec<f64> },
    Pieces(PiecesInput),
    NullSpace { n: usize, r: usize, modes: Modes, basis: Vec<f64> },
    Coordinates { places: Vec<f64>, directions: Vec<i32> },
    CoordinatesFlags(Modes),
    Fixing(Vec<usize>),
    Load(Vec<f64>),
    Numbering(Vec<i64>),
    Rows { kind: RowKind, ptr: Vec<usize>, unknown: Vec<u64>, val: Vec<f64>, rhs: Vec<f64>, inv_k: Vec<f64> },
    Friction(Nodes),
}

/// The nodes with friction of a section.
struct Nodes {
    dim: usize,
    normal: Vec<i64>,
    ptr: Vec<usize>,
    unknown: Vec<u64>,
    val: Vec<f64>,
    coefficient: Vec<f64>,
    bound: Vec<f64>,
    inv_kt: Vec<f64>,
    s_old: Vec<f64>,
}

/// First unknown of every body among all unknowns, their end, and the sections of the last body read so far.
#[derive(Default)]
struct Offsets {
    ends: Vec<u64>,
    seen: Vec<Tag>,
    rows: [bool; 2],
    friction: bool,
    options: bool,
}

impl SectionContent {
    /// None for a section that this library does not know.
    fn read<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Option<Self>> {
        Ok(Some(match open.tag {
            OPTIONS => Self::Options(input.text(open)?),
            BODY => Self::Body { n: input.size(open)? },
            STIFFNESS => Self::stiffness(input, open)?,
            PIECES => Self::pieces(input, open)?,
            NULL_SPACE => Self::null_space(input, open)?,
            COORDINATES => {
                let n = input.size(open)?;
                let places = input.reals(open, 3 * n)?;
                Self::Coordinates { places, directions: input.array(open, n, i32::from_le_bytes)? }
            }
            COORDINATES_FLAGS => Self::CoordinatesFlags(modes(input, open, "rigid motions")?),
            FIXING => Self::Fixing(input.counted(open, saturated)?),
            LOAD => Self::Load(input.counted(open, f64::from_le_bytes)?),
            NUMBERING => Self::Numbering(input.counted(open, i64::from_le_bytes)?),
            ROWS => Self::rows(input, open)?,
            FRICTION => Self::friction(input, open)?,
            _ => return Ok(None),
        }))
    }

    fn stiffness<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Self> {
        let (n, entries) = (input.size(open)?, input.size(open)?);
        let ptr = input.pointers(open, n, entries)?;
        let val = input.reals(open, entries)?;
        let col = input.array(open, entries, |bytes| i64::from(u32::from_le_bytes(bytes)))?;
        Ok(Self::Stiffness { ptr, col, val })
    }

    fn pieces<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Self> {
        let (pieces, rows, entries) = (input.size(open)?, input.size(open)?, input.size(open)?);
        if pieces == 0 {
            return Err(input.wrong(open, "a body has at least one piece"));
        }
        let first = input.pointers(open, pieces, rows)?;
        let dof = input.array(open, rows, i64::from_le_bytes)?;
        let ptr = input.pointers(open, rows, entries)?;
        let val = input.reals(open, entries)?;
        let col = input.array(open, entries, u32::from_le_bytes)?;
        Ok(Self::Pieces(PiecesInput { first, dof, ptr, col, val }))
    }

    fn null_space<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Self> {
        let (n, r) = (input.size(open)?, input.size(open)?);
        let modes = modes(input, open, "null space")?;
        let basis = input.reals(open, n.saturating_mul(r))?;
        Ok(Self::NullSpace { n, r, modes, basis })
    }

    fn rows<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Self> {
        let kind = match input.number(open)? {
            INEQUALITY => RowKind::Inequality,
            EQUALITY => RowKind::Equality,
            number => return Err(input.wrong(open, &format!("{number} is no kind of rows"))),
        };
        let (rows, entries) = (input.size(open)?, input.size(open)?);
        let ptr = input.pointers(open, rows, entries)?;
        let unknown = input.array(open, entries, u64::from_le_bytes)?;
        let (val, rhs) = (input.reals(open, entries)?, input.reals(open, rows)?);
        Ok(Self::Rows { kind, ptr, unknown, val, rhs, inv_k: input.reals(open, rows)? })
    }

    fn friction<R: Read>(input: &mut Input<R>, open: &mut OpenSection) -> Result<Self> {
        let dim = match input.size(open)? {
            dim @ 1..=2 => dim,
            dim => return Err(input.wrong(open, &format!("{dim} is no number of tangential rows of a node"))),
        };
        let (nodes, entries) = (input.size(open)?, input.size(open)?);
        Ok(Self::Friction(Nodes {
            dim,
            normal: input.array(open, nodes, i64::from_le_bytes)?,
            ptr: input.pointers(open, dim * nodes, entries)?,
            unknown: input.array(open, entries, u64::from_le_bytes)?,
            val: input.reals(open, entries)?,
            coefficient: input.reals(open, nodes)?,
            bound: input.reals(open, nodes)?,
            inv_kt: input.reals(open, nodes)?,
            s_old: input.reals(open, dim * nodes)?,
        }))
    }

    /// Makes the call of a host for this section.
    fn hand_over(self, tag: Tag, model: &mut HostModel, known: &mut Offsets) -> Result<()> {
        if ![OPTIONS, BODY, ROWS, FRICTION].contains(&tag) {
            known.once(tag)?;
        }
        let body = known.ends.len().wrapping_sub(1);
        match self {
            Self::Options(text) => {
                once(&mut known.options)?;
                model.set_text(&text)
            }
            Self::Body { n } => {
                known.add_body(n)?;
                model.add_body(n).map(drop)
            }
            Self::Stiffness { ptr, col, val } => {
                known.not_with(PIECES)?;
                let lower = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
                model.set_stiffness(body, lower)
            }
            Self::Pieces(given) => {
                known.not_with(STIFFNESS)?;
                model.set_pieces(body, &given)
            }
            Self::NullSpace { n, r, modes, basis } => model.set_null_space(body, n, r, &basis, n, modes),
            // labels of the nodes are not kept
            Self::Coordinates { places, directions } => {
                model.set_coordinates(body, 3, &directions, &directions, &places, 3)
            }
            Self::CoordinatesFlags(modes) => model.set_coordinate_modes(body, modes),
            Self::Fixing(dofs) => model.set_fixing(body, Some(&dofs)),
            Self::Load(f) => model.set_load(body, &f),
            Self::Numbering(numbers) => model.set_numbering(body, &numbers),
            Self::Rows { kind, ptr, unknown, val, rhs, inv_k } => {
                once(&mut known.rows[kind as usize])?;
                if known.friction {
                    return Err(Error::new(Kind::Io, "rows after the nodes with friction"));
                }
                let (body, dof) = known.places(&unknown)?;
                let _room = model.headroom_for_rows(rhs.len(), val.len())?;
                let rows = RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: Some(&rhs) };
                model.add_rows(kind, rows)?;
                model.set_compliance(kind, 0, &inv_k)
            }
            Self::Friction(nodes) => {
                once(&mut known.friction)?;
                nodes.hand_over(model, known)
            }
        }
    }
}

impl Nodes {
    fn hand_over(&self, model: &mut HostModel, known: &Offsets) -> Result<()> {
        let (body, dof) = known.places(&self.unknown)?;
        let _room = model.headroom_for_rows(self.s_old.len(), self.val.len())?;
        let rows = RowsInput { ptr: &self.ptr, body: Some(&body), dof: &dof, val: &self.val, rhs: None };
        let (coefficient, bound) = (Some(&self.coefficient[..]), Some(&self.bound[..]));
        model.add_friction_of_file(FrictionInput {
            dim: self.dim,
            normal: &self.normal,
            rows,
            coefficient,
            bound,
        })?;
        model.set_friction_compliance(0, &self.inv_kt)?;
        model.set_friction_reference(0, self.normal.len(), self.dim, &self.s_old)
    }
}

fn once(seen: &mut bool) -> Result<()> {
    if std::mem::replace(seen, true) {
        return Err(Error::new(Kind::Io, "this section occurs twice"));
    }
    Ok(())
}

impl Offsets {
    /// Notes a section of the last body, which must not occur twice.
    fn once(&mut self, tag: Tag) -> Result<()> {
        if self.ends.is_empty() {
            return Err(Error::new(Kind::Io, "there is no body before it"));
        }
        if self.seen.contains(&tag) {
            return Err(Error::new(Kind::Io, "this section occurs twice").body(self.ends.len() - 1));
        }
        self.seen.push(tag);
        Ok(())
    }

    /// Refuses a body with K in two forms.
    fn not_with(&self, other: Tag) -> Result<()> {
        if self.seen.contains(&other) {
            return Err(
                Error::new(Kind::Io, "the body has both a matrix and pieces").body(self.ends.len() - 1)
            );
        }
        Ok(())
    }

    fn add_body(&mut self, n: usize) -> Result<()> {
        if self.rows != [false; 2] || self.friction {
            return Err(Error::new(Kind::Io, "a body after the rows"));
        }
        let end = self.ends.last().copied().unwrap_or(0).saturating_add(n as u64);
        if end > isize::MAX as u64 / 8 {
            return Err(Error::new(Kind::Io, "the bodies have more unknowns than an array can have entries"));
        }
        self.ends.push(end);
        self.seen.clear();
        Ok(())
    }

    /// Body and dof of unknowns counted through all bodies; the call refuses an unknown beyond the last body.
    fn places(&self, unknown: &[u64]) -> Result<(Vec<i64>, Vec<i64>)> {
        let what = "the rows of a problem file";
        let (mut body, mut dof) = (reserved(unknown.len(), what)?, reserved(unknown.len(), what)?);
        for &number in unknown {
            let p = self.ends.partition_point(|end| *end <= number);
            let first = p.checked_sub(1).map_or(0, |before| self.ends[before]);
            body.push(p as i64);
            dof.push(i64::try_from(number - first).unwrap_or(i64::MAX));
        }
        Ok((body, dof))
    }
}

/// The meaning of motions, `of` in words.
fn modes<R: Read>(input: &mut Input<R>, open: &mut OpenSection, of: &str) -> Result<Modes> {
    Ok(match input.number(open)? {
        EXACT => Modes::Exact,
        CANDIDATES => Modes::Candidates,
        SOFT => Modes::Soft,
        number => return Err(input.wrong(open, &format!("{number} is no kind of {of}"))),
    })
}
