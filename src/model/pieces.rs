//! A body that is cut, given by its pieces, as stored in a problem file.

use std::sync::Arc;

use crate::body::Form;
use crate::error::{Error, Kind, Result, INDEX};
use crate::linalg::Symmetric;
use crate::mesh::{Connectivity, Mesh, Piece};
use crate::model::contents::Change;
use crate::model::host::HostModel;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the pieces of a body";

/// The pieces one after the other.
pub struct PiecesInput {
    /// First unknown of every piece in `dof`, and the end.
    pub first: Vec<usize>,
    /// Unknowns of each piece, ascending, from 0.
    pub dof: Vec<i64>,
    /// First entry of every row of the lower triangles, piece after piece, and the end.
    pub ptr: Vec<usize>,
    /// Columns from 0 within the piece, ascending; the last entry of every row is the diagonal.
    pub col: Vec<u32>,
    /// force / length
    pub val: Vec<f64>,
}

impl HostModel {
    /// Sets the pieces of a body, which must cover all its unknowns.
    pub fn set_pieces(&mut self, body: usize, given: &PiecesInput) -> Result<()> {
        let order = self.order(body)?;
        given.check(order).map_err(|error| error.body(body))?;
        let connectivity = Connectivity::new(order, &given.first, &given.dof)?;
        let mut pieces = reserved(given.first.len() - 1, WHAT)?;
        for range in given.first.windows(2) {
            pieces.push(given.piece(range[0], range[1])?);
        }
        let mesh = Mesh::of_pieces(connectivity, pieces)?;
        let slot = self.change(body, Change::Pattern)?;
        slot.without_matrix();
        slot.form = Some(Box::new(Form::Elements(given.val.len())));
        slot.spoiled = false;
        slot.mesh = Some(Box::new(mesh));
        let room = slot.room_for_matrix()?;
        slot.assemble(room);
        Ok(())
    }
}

impl PiecesInput {
    /// Checks that unknowns ascend and cover the body, rows are lower triangles with a diagonal, and entries are finite.
    fn check(&self, order: usize) -> Result<()> {
        // a larger body has an unknown up to this number that no piece has
        let mut met = filled(order.min(self.dof.len() + 1), false, WHAT)?;
        for range in self.first.windows(2) {
            let dofs = &self.dof[range[0]..range[1]];
            if dofs.is_empty() || dofs.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(Error::new(Kind::Io, "the unknowns of a piece do not ascend"));
            }
            for &dof in dofs {
                let outside = || {
                    let what = format!("unknown {INDEX} is outside the {order} unknowns of the body");
                    Error::new(Kind::Io, what).index(dof)
                };
                let unknown = usize::try_from(dof).ok().filter(|dof| *dof < order).ok_or_else(outside)?;
                if let Some(met) = met.get_mut(unknown) {
                    *met = true;
                }
            }
            for row in 0..dofs.len() {
                self.check_row(range[0] + row, row)?;
            }
        }
        match met.iter().position(|met| !met) {
            Some(dof) => Err(Error::new(Kind::Io, "no piece has the unknown").dof(dof)),
            None => Ok(()),
        }
    }

    /// Checks row `at` of all rows, which is row `row` of its piece.
    fn check_row(&self, at: usize, row: usize) -> Result<()> {
        let entries = self.ptr[at]..self.ptr[at + 1];
        let col = &self.col[entries.clone()];
        let ascending = col.windows(2).all(|pair| pair[0] < pair[1]);
        if !ascending || col.last().is_none_or(|last| *last as usize != row) {
            let what = "the columns of a row do not ascend to its diagonal entry";
            return Err(Error::new(Kind::Io, what).row(at));
        }
        match self.val[entries.clone()].iter().position(|value| !value.is_finite()) {
            Some(entry) => {
                let what = "the entry is not a finite number";
                Err(Error::new(Kind::Io, what).row(at).entry(entries.start + entry))
            }
            None => Ok(()),
        }
    }

    /// The piece with the rows `from` to `to` - 1 of all rows.
    fn piece(&self, from: usize, to: usize) -> Result<Piece> {
        let (begin, end) = (self.ptr[from], self.ptr[to]);
        let mut dofs = reserved(to - from, WHAT)?;
        dofs.extend(self.dof[from..to].iter().map(|dof| *dof as u32));
        let (mut ptr, mut col) = (reserved(to - from + 1, WHAT)?, reserved(end - begin, WHAT)?);
        ptr.extend(self.ptr[from..=to].iter().map(|at| at - begin));
        col.extend_from_slice(&self.col[begin..end]);
        let mut val = reserved(end - begin, WHAT)?;
        val.extend_from_slice(&self.val[begin..end]);
        Ok(Piece { dofs: Arc::from(dofs), stiffness: Arc::new(Symmetric::new(ptr, col, val)) })
    }
}
