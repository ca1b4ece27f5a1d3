//! Writes a problem file, section by section.

use std::io::{self, Write};

use crate::body::Modes;
use crate::constraints::{Friction, RowKind, RowSet};
use crate::error::{Error, Kind, Result};
use crate::mesh::{Mesh, Piece as MeshPiece};
use crate::model::contents::GivenBody;
use crate::model::file::format::{
    self, padding, section_length, Crc, Tag, BODY, COORDINATES, COORDINATES_FLAGS, FIXING, FORMAT, FRICTION,
    HEADER, LOAD, MAGIC, NULL_SPACE, NUMBERING, OPTIONS, PIECES, ROWS, STIFFNESS,
};
use crate::model::host::HostModel;
use crate::platform::memory::reserved;

/// Numbers defined by the format.
pub const EXACT: u64 = 0;
pub const CANDIDATES: u64 = 1;
pub const SOFT: u64 = 2;
pub const INEQUALITY: u64 = 1;
pub const EQUALITY: u64 = 2;

/// Bytes converted in one block.
const BLOCK: usize = 8192;

/// A part of a payload as stored in memory.
enum Piece<'a> {
    Number(u64),
    Numbers(&'a [usize]),
    /// Numbers of which some may be -1.
    Signed(Vec<i64>),
    /// The numbers with a constant added.
    Shifted(&'a [usize], usize),
    Columns(&'a [u32]),
    /// Unknowns, 8 bytes each.
    Dofs(&'a [u32]),
    Directions(&'a [i32]),
    Reals(&'a [f64]),
    /// Numbers collected for the file.
    Gathered(Vec<f64>),
    Text(String),
}

struct Section<'a> {
    tag: Tag,
    pieces: Vec<Piece<'a>>,
}

impl Piece<'_> {
    fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Number(_) => 8,
            Self::Numbers(numbers) => 8 * numbers.len(),
            Self::Signed(numbers) => 8 * numbers.len(),
            Self::Shifted(numbers, _) => 8 * numbers.len(),
            Self::Dofs(dofs) => 8 * dofs.len(),
            Self::Columns(columns) => 4 * columns.len(),
            Self::Directions(directions) => 4 * directions.len(),
            Self::Reals(reals) => 8 * reals.len(),
            Self::Gathered(reals) => 8 * reals.len(),
            Self::Text(text) => text.len(),
        };
        bytes as u64
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Number(number) => out.write_all(&number.to_le_bytes()),
            Self::Numbers(numbers) => blocks(numbers, |number| (*number as u64).to_le_bytes(), out),
            Self::Signed(numbers) => blocks(numbers, |number| number.to_le_bytes(), out),
            Self::Shifted(numbers, by) => blocks(numbers, |number| ((number + by) as u64).to_le_bytes(), out),
            Self::Dofs(dofs) => blocks(dofs, |dof| u64::from(*dof).to_le_bytes(), out),
            Self::Columns(columns) => blocks(columns, |column| column.to_le_bytes(), out),
            Self::Directions(directions) => blocks(directions, |direction| direction.to_le_bytes(), out),
            Self::Reals(reals) => blocks(reals, |real| real.to_le_bytes(), out),
            Self::Gathered(reals) => blocks(reals, |real| real.to_le_bytes(), out),
            Self::Text(text) => out.write_all(text.as_bytes()),
        }
    }
}

fn blocks<T, const N: usize>(
    values: &[T],
    bytes: impl Fn(&T) -> [u8; N],
    out: &mut impl Write,
) -> io::Result<()> {
    let mut block = [0; BLOCK];
    for values in values.chunks(BLOCK / N) {
        let used = &mut block[..values.len() * N];
        used.chunks_exact_mut(N).zip(values).for_each(|(to, value)| to.copy_from_slice(&bytes(value)));
        out.write_all(used)?;
    }
    Ok(())
}

impl Section<'_> {
    fn payload(&self) -> u64 {
        self.pieces.iter().map(Piece::bytes).sum()
    }

    /// With head and checksum.
    fn bytes(&self) -> u64 {
        section_length(self.payload()).unwrap_or(0)
    }

    fn write(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        let mut out = Summed { out, crc: Crc::new() };
        out.write_all(&self.tag)?;
        out.write_all(&0_u32.to_le_bytes())?;
        out.write_all(&self.payload().to_le_bytes())?;
        self.pieces.iter().try_for_each(|piece| piece.write(&mut out))?;
        out.write_all(&[0; 8][..padding(self.payload()) as usize])?;
        out.finish()
    }
}

/// A writer that also computes a checksum.
struct Summed<'a, W: ?Sized> {
    out: &'a mut W,
    crc: Crc,
}

impl<W: Write + ?Sized> Summed<'_, W> {
    fn finish(self) -> io::Result<()> {
        self.out.write_all(&self.crc.value().to_le_bytes())
    }
}

impl<W: Write + ?Sized> Write for Summed<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.crc.add(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The bodies of a file in their order: the bytes of each, and what writes them.
pub struct Bodies<'a> {
    pub bytes: Vec<u64>,
    pub write: &'a mut dyn FnMut(usize, &mut dyn Write) -> io::Result<()>,
}

/// Bytes of the whole file.
pub fn length(model: &HostModel, of_bodies: &[u64]) -> u64 {
    let others = std::iter::once(options(model)).chain(rows_and_nodes(model));
    HEADER + of_bodies.iter().sum::<u64>() + others.map(|section| section.bytes()).sum::<u64>()
}

/// Bytes of all sections of every body.
pub fn lengths(model: &HostModel) -> Vec<u64> {
    let of_body = |given| of_body(given).map(|section| section.bytes()).sum();
    model.bodies.iter().map(of_body).collect()
}

/// Section k of a body; nothing after the last.
pub fn section(given: &GivenBody, k: usize) -> Result<Vec<u8>> {
    let Some(section) = of_body(given).nth(k) else { return Ok(Vec::new()) };
    let mut bytes = reserved(usize::try_from(section.bytes()).unwrap_or(usize::MAX), "a problem file")?;
    section.write(&mut bytes).map_err(|e| Error::new(Kind::Io, e.to_string()))?;
    Ok(bytes)
}

/// All sections of a body.
pub fn body(given: &GivenBody, out: &mut dyn Write) -> io::Result<()> {
    of_body(given).try_for_each(|section| section.write(out))
}

/// Header and sections. The sections of a body follow its BODY section; then come rows, and finally nodes with friction.
pub fn write(model: &HostModel, bodies: Bodies, out: &mut impl Write) -> io::Result<()> {
    let mut header = Summed { out, crc: Crc::new() };
    header.write_all(&MAGIC)?;
    header.write_all(&FORMAT.to_le_bytes())?;
    header.write_all(&format::library().to_le_bytes())?;
    header.write_all(&length(model, &bodies.bytes).to_le_bytes())?;
    header.write_all(&0_u32.to_le_bytes())?;
    header.finish()?;
    options(model).write(out)?;
    (0..bodies.bytes.len()).try_for_each(|body| (bodies.write)(body, out))?;
    rows_and_nodes(model).try_for_each(|section| section.write(out))
}

fn options(model: &HostModel) -> Section<'_> {
    Section { tag: OPTIONS, pieces: vec![Piece::Text(model.settings.changes())] }
}

fn rows_and_nodes(model: &HostModel) -> impl Iterator<Item = Section<'_>> {
    let contact = rows(INEQUALITY, model.rows(RowKind::Inequality));
    let equalities = rows(EQUALITY, model.rows(RowKind::Equality));
    contact.into_iter().chain(equalities).chain(friction(&model.friction))
}

fn of_body(given: &GivenBody) -> impl Iterator<Item = Section<'_>> {
    use Piece::{Columns, Directions, Number, Numbers, Reals};
    let body = &given.body;
    let n = Number(body.order as u64);
    let order = Some(Section { tag: BODY, pieces: vec![n] });
    let count = |len: usize| Number(len as u64);
    let number = |modes: Modes| match modes {
        Modes::Exact => Number(EXACT),
        Modes::Candidates => Number(CANDIDATES),
        Modes::Soft => Number(SOFT),
    };
    let stiffness = body.stiffness.as_ref().map(|k| {
        let sizes = [count(k.order()), count(k.val.len())];
        let arrays = [Numbers(&k.ptr), Reals(&k.val), Columns(&k.col)];
        Section { tag: STIFFNESS, pieces: sizes.into_iter().chain(arrays).collect() }
    });
    let pieces = body.assembled().and(given.mesh.as_deref()).and_then(Mesh::pieces).map(of_pieces);
    let null_space = body.null_space.as_ref().map(|r| {
        let sizes = [count(r.vectors.rows), count(r.vectors.cols), number(r.modes)];
        Section { tag: NULL_SPACE, pieces: sizes.into_iter().chain([Reals(&r.vectors.data)]).collect() }
    });
    let coordinates = body.coordinates.as_ref().map(|given| {
        let places = Reals(given.places().as_flattened());
        let pieces = vec![count(given.len()), places, Directions(given.directions())];
        Section { tag: COORDINATES, pieces }
    });
    let flags = Some(body.coordinate_modes).filter(|modes| *modes != Modes::Candidates);
    let flags = flags.map(|modes| Section { tag: COORDINATES_FLAGS, pieces: vec![number(modes)] });
    let fixing = body.fixing.as_ref().map(|dofs| unknowns(FIXING, dofs));
    let load = body.load.as_ref().map(|f| Section { tag: LOAD, pieces: vec![count(f.len()), Reals(f)] });
    let numbering = given.numbers.as_ref().map(|numbers| unknowns(NUMBERING, numbers));
    [order, stiffness, pieces, null_space, coordinates, flags, fixing, load, numbering].into_iter().flatten()
}

/// Number of unknowns, pieces, total unknowns, total entries; first unknown of each piece; unknowns; rows; values;
/// columns.
fn of_pieces(of: &[MeshPiece]) -> Section<'_> {
    use Piece::{Columns, Dofs, Number, Reals, Shifted};
    let ends = |size: fn(&MeshPiece) -> usize| {
        of.iter().scan(0, move |end, piece| {
            *end += size(piece);
            Some(*end)
        })
    };
    let (rows, entries) = (|p: &MeshPiece| p.dofs.len(), |p: &MeshPiece| p.stiffness.val.len());
    let last = |size| ends(size).last().unwrap_or(0) as u64;
    let mut pieces = vec![Number(of.len() as u64), Number(last(rows)), Number(last(entries)), Number(0)];
    pieces.extend(ends(rows).map(|end| Number(end as u64)));
    pieces.extend(of.iter().map(|piece| Dofs(&piece.dofs)));
    pieces.push(Number(0));
    let begins = std::iter::once(0).chain(ends(entries));
    pieces.extend(of.iter().zip(begins).map(|(piece, begin)| Shifted(&piece.stiffness.ptr[1..], begin)));
    pieces.extend(of.iter().map(|piece| Reals(&piece.stiffness.val)));
    pieces.extend(of.iter().map(|piece| Columns(&piece.stiffness.col)));
    Section { tag: PIECES, pieces }
}

fn unknowns(tag: Tag, numbers: &[usize]) -> Section<'_> {
    Section { tag, pieces: vec![Piece::Number(numbers.len() as u64), Piece::Numbers(numbers)] }
}

fn friction(friction: &Friction) -> Option<Section<'_>> {
    use Piece::{Gathered, Number, Numbers, Reals, Signed};
    let (nodes, rows) = (&friction.nodes, &friction.rows);
    let matrix = &rows.matrix;
    let pieces = vec![
        Number(friction.dim as u64),
        Number(nodes.len() as u64),
        Number(matrix.val.len() as u64),
        Signed(nodes.iter().map(|node| node.normal.map_or(-1, |row| row as i64)).collect()),
        Numbers(&matrix.ptr),
        Numbers(&matrix.col),
        Reals(&matrix.val),
        Gathered(nodes.iter().map(|node| node.coefficient).collect()),
        Gathered(nodes.iter().map(|node| node.bound).collect()),
        Gathered(nodes.iter().map(|node| rows.compliance[node.first]).collect()),
        Reals(&rows.rhs),
    ];
    (!nodes.is_empty()).then_some(Section { tag: FRICTION, pieces })
}

fn rows(kind: u64, rows: &RowSet) -> Option<Section<'_>> {
    use Piece::{Number, Numbers, Reals};
    let matrix = &rows.matrix;
    let pieces = vec![
        Number(kind),
        Number(rows.len() as u64),
        Number(matrix.val.len() as u64),
        Numbers(&matrix.ptr),
        Numbers(&matrix.col),
        Reals(&matrix.val),
        Reals(&rows.rhs),
        Reals(&rows.compliance),
    ];
    (rows.len() > 0).then_some(Section { tag: ROWS, pieces })
}
