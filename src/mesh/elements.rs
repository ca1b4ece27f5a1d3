//! Element matrices: each is given once per pass, checked, added to its piece, and not stored.

use crate::error::{Error, Kind, Result};
use crate::mesh::connectivity::{Connectivity, Place};
use crate::mesh::held::HeldRows;
use crate::mesh::piece::{pieces, Piece};
use crate::platform::memory::{filled, reserved};

/// How the host stores the matrices of several elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementStorage {
    /// n x n column-major, n^2 numbers each.
    Full,
    /// The lower triangle column by column, n (n + 1) / 2 numbers each; equal to the upper triangle row by row.
    Lower,
    /// The upper triangle column by column, n (n + 1) / 2 numbers each.
    Upper,
}

impl ElementStorage {
    /// Number of values of an element with n unknowns.
    pub fn len(self, n: usize) -> usize {
        match self {
            Self::Full => n * n,
            Self::Lower | Self::Upper => n * (n + 1) / 2,
        }
    }

    /// Position of entry (i, j).
    fn at(self, n: usize, i: usize, j: usize) -> usize {
        match self {
            Self::Full => i + n * j,
            Self::Lower => {
                let (i, j) = (i.max(j), i.min(j));
                i + j * (2 * n - j - 1) / 2
            }
            Self::Upper => {
                let (i, j) = (i.min(j), i.max(j));
                i + j * (j + 1) / 2
            }
        }
    }
}

/// The matrix of one element, n x n.
#[derive(Clone, Copy)]
pub struct ElementMatrix<'a> {
    pub values: &'a [f64],
    pub n: usize,
    /// Leading dimension of a full matrix.
    pub ld: usize,
    pub storage: ElementStorage,
}

impl ElementMatrix<'_> {
    fn position(&self, i: usize, j: usize) -> usize {
        match self.storage {
            ElementStorage::Full => i + self.ld * j,
            packed => packed.at(self.n, i, j),
        }
    }

    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.values[self.position(i, j)]
    }

    /// Checks that entries are finite and `|k_ij - k_ji| <= tolerance max((|k_ii| |k_jj|)^1/2, |k_ij|, |k_ji|)`.
    fn check(&self, tolerance: f64) -> Result<()> {
        for j in 0..self.n {
            for i in j..self.n {
                let (one, other) = (self.get(i, j), self.get(j, i));
                if !(one.is_finite() && other.is_finite()) {
                    let (i, j) = if one.is_finite() { (j, i) } else { (i, j) };
                    let error = Error::argument("ke", "the entry is not a finite number");
                    return Err(error.row(i).entry(self.position(i, j)));
                }
                if one != other {
                    let size = self.get(i, i).abs().sqrt() * self.get(j, j).abs().sqrt();
                    let limit = tolerance * size.max(one.abs()).max(other.abs());
                    let apart = (one - other).abs();
                    if apart > limit {
                        let what = format!(
                            "|ke_ij - ke_ji| = {apart:.1e} exceeds {limit:.1e}: the matrix is not symmetric"
                        );
                        return Err(Error::argument("ke", what)
                            .row(i)
                            .entry(self.position(i, j))
                            .value(apart)
                            .limit(limit));
                    }
                }
            }
        }
        Ok(())
    }
}

/// A body given by elements.
#[derive(Debug, Default)]
pub struct Mesh {
    connectivity: Connectivity,
    /// The pieces, after the first matrix.
    cut: Option<Cut>,
    /// The elements of the host are known; false for a body read from a file.
    elements_known: bool,
}

/// The pieces and the elements added to them.
#[derive(Debug)]
struct Cut {
    wanted: i64,
    piece_of: Vec<u32>,
    pieces: Vec<Piece>,
    held: HeldRows,
    /// Elements given in this pass.
    given: Vec<bool>,
    missing: usize,
}

impl Mesh {
    pub fn new(connectivity: Connectivity) -> Self {
        Self { connectivity, cut: None, elements_known: true }
    }

    /// A body of which only the pieces are known; the connectivity has one element per piece.
    pub fn of_pieces(connectivity: Connectivity, pieces: Vec<Piece>) -> Result<Self> {
        const WHAT: &str = "the pieces of a body";
        let mut piece_of = reserved(pieces.len(), WHAT)?;
        piece_of.extend(0..pieces.len() as u32);
        let given = filled(pieces.len(), true, WHAT)?;
        let cut = Cut { wanted: 0, piece_of, pieces, held: HeldRows::default(), given, missing: 0 };
        Ok(Self { connectivity, cut: Some(cut), elements_known: false })
    }

    /// False if only the pieces are known: then no element can be added.
    pub fn has_elements(&self) -> bool {
        self.elements_known
    }

    pub fn connectivity(&self) -> &Connectivity {
        &self.connectivity
    }

    /// The number of pieces requested when the body was cut; none before the first matrix.
    pub fn wanted(&self) -> Option<i64> {
        self.cut.as_ref().map(|cut| cut.wanted)
    }

    /// Sets the piece of every element; `wanted`: the option `pieces` at this time.
    pub fn cut(&mut self, piece_of: Vec<u32>, wanted: i64) -> Result<()> {
        let pieces = pieces(&self.connectivity, &piece_of)?;
        let elements = self.connectivity.elements();
        let (held, given) =
            (HeldRows::new(&self.connectivity)?, filled(elements, false, "the elements of a body")?);
        self.cut = Some(Cut { wanted, piece_of, pieces, held, given, missing: elements });
        Ok(())
    }

    /// Begins another pass: all matrices must be given again.
    pub fn begin(&mut self) -> Result<()> {
        self.cut.as_mut().map_or(Ok(()), Cut::begin)
    }

    /// The pieces, if every element has been given.
    pub fn pieces(&self) -> Option<&[Piece]> {
        self.cut.as_ref().filter(|cut| cut.missing == 0).map(|cut| &cut.pieces[..])
    }

    /// Whether this number of further elements completes the pass; after a complete pass they begin the next.
    pub fn is_complete_with(&self, elements: usize) -> bool {
        let left = |cut: &Cut| if cut.missing == 0 { cut.given.len() } else { cut.missing };
        self.cut.as_ref().is_some_and(|cut| left(cut) == elements)
    }

    /// The first element of a piece; none if only the pieces are known.
    pub fn first_of(&self, piece: usize) -> Option<usize> {
        let cut = self.cut.as_ref().filter(|_| self.elements_known)?;
        cut.piece_of.iter().position(|of| *of as usize == piece)
    }

    /// Whether the body is cut into several pieces.
    pub fn is_cut(&self) -> bool {
        self.cut.as_ref().is_some_and(|cut| cut.pieces.len() > 1)
    }

    /// The first element that is missing in this pass.
    pub fn first_missing(&self) -> Option<usize> {
        match &self.cut {
            None => (self.connectivity.elements() > 0).then_some(0),
            Some(cut) => cut.given.iter().position(|given| !given),
        }
    }

    /// Adds the matrices of the elements from `first` on: all, or none if one is refused. The first element after a
    /// complete pass begins the next pass.
    pub fn add<'a>(
        &mut self,
        first: usize,
        matrices: impl Iterator<Item = ElementMatrix<'a>> + Clone,
        tolerance: f64,
    ) -> Result<()> {
        let missing = || Error::new(Kind::Internal, "elements came before the body was cut");
        let cut = self.cut.as_mut().ok_or_else(missing)?;
        let again = cut.missing == 0;
        for (e, ke) in matrices.clone().enumerate().map(|(k, ke)| (first + k, ke)) {
            let elements = self.connectivity.elements();
            if e >= elements {
                let what = format!("the body has {elements} elements");
                return Err(Error::argument("e", what).element(e).index(e as i64).limit(elements as f64));
            }
            let size = self.connectivity.size(e);
            if ke.n != size {
                let what = format!("the element joins {size} unknowns, but its matrix has {} rows", ke.n);
                return Err(Error::argument("n", what).element(e).value(ke.n as f64).limit(size as f64));
            }
            if cut.given[e] && !again {
                return Err(Error::new(Kind::State, "the element has already been given").element(e));
            }
            ke.check(tolerance).map_err(|error| error.element(e))?;
        }
        if again {
            cut.begin().map_err(|error| error.element(first))?;
        }
        for (e, ke) in matrices.enumerate().map(|(k, ke)| (first + k, ke)) {
            let places: Vec<Place> = self.connectivity.places(e).collect();
            cut.add(e, &places, |i, j| ke.get(i, j));
        }
        Ok(())
    }

    /// One more than the largest number of a held unknown.
    pub fn held_numbers(&self) -> usize {
        self.connectivity
            .held()
            .last()
            .map_or(0, |last| usize::try_from(*last).unwrap_or(usize::MAX).saturating_add(1))
    }

    /// Sets the entries of the held unknowns 0, 1, ... that have elements to `K_hf u`, force.
    pub fn held_forces(&self, u: &[f64], forces: &mut [f64]) {
        let Some(cut) = &self.cut else { return };
        for (k, number) in self.connectivity.held().iter().enumerate() {
            if let Some(force) = usize::try_from(*number).ok().and_then(|number| forces.get_mut(number)) {
                *force = cut.held.force(k, u);
            }
        }
    }
}

impl Cut {
    /// Begins another pass; without memory for it, nothing changes.
    fn begin(&mut self) -> Result<()> {
        let mut cleared = reserved(self.pieces.len(), "the pieces of a body")?;
        for piece in &self.pieces {
            cleared.push(piece.cleared()?);
        }
        self.pieces.iter_mut().zip(cleared).for_each(|(piece, cleared)| piece.stiffness = cleared);
        self.given.fill(false);
        self.missing = self.given.len();
        self.held.clear();
        Ok(())
    }

    fn add(&mut self, e: usize, places: &[Place], ke: impl Fn(usize, usize) -> f64) {
        self.pieces[self.piece_of[e] as usize].add(places, &ke);
        self.held.add(places, &ke);
        self.given[e] = true;
        self.missing -= 1;
    }
}
