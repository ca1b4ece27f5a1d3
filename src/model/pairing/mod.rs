//! What the host says of surfaces and pairs. Rows are written here; a find of the solver computes them.

mod laws;
mod rows;
mod surfaces;

use crate::constraints::{RowKind, RowsInput};
use crate::error::{Error, Kind, Result};
use crate::model::host::HostModel;
use crate::model::pairs::{Laws, Pair, PairMethod, WHAT};
use crate::platform::memory::{filled, refusal, reserved};
use crate::surface::NONE;

impl HostModel {
    /// Rows of one kind that belong to pairs; of tangential rows the nodes.
    pub fn rows_of_pairs(&self, kind: RowKind) -> usize {
        self.pairs.rows(kind, |pair| self.pairs.dim(pair))
    }

    pub fn pair_add(
        &mut self,
        slave: usize,
        master: usize,
        method: PairMethod,
        is_tied: bool,
        distance: f64,
    ) -> Result<(usize, usize)> {
        let (of_slave, of_master) =
            (self.pairs.surface(slave, "slave")?, self.pairs.surface(master, "master")?);
        if slave == master {
            let what = "a surface cannot meet itself: give its sides as two surfaces";
            return Err(Error::new(Kind::Unsupported, what).index(slave as i64));
        }
        let dim = of_slave.dim();
        if of_master.dim() != dim {
            let what = format!("the slave has {dim} dimensions, the master {}", of_master.dim());
            return Err(Error::argument("master", what).value(of_master.dim() as f64));
        }
        let (by_slave, by_master) = (of_slave.unknowns(), of_master.unknowns());
        if by_slave.zip(by_master).is_some_and(|(a, b)| a.is_tabled != b.is_tabled) {
            let what = "one of the surfaces names unknowns of the table, the other does not: add both after feti_dof_table, with FETI_ALL";
            return Err(Error::argument("master", what).index(master as i64));
        }
        if !(distance.is_finite() && distance > 0.0) {
            let what = "the distance up to which nodes meet the master is a finite number above 0";
            return Err(Error::argument("distance", what).value(distance));
        }
        if !of_master.has_points() {
            return Err(Error::argument("master", "this surface has no faces").index(master as i64));
        }
        let nodes = of_slave.slave_nodes()?;
        if method == PairMethod::Mortar && !of_slave.has_points() {
            let what = "nodes without faces have no areas for mortar: they meet by node-to-face";
            return Err(Error::new(Kind::Unsupported, what).index(slave as i64));
        }
        let kind = if is_tied { RowKind::Equality } else { RowKind::Inequality };
        let own = self.rows_of_pairs(kind);
        if self.rows(kind).len() > own {
            let what = format!("pairs come before rows: there is a {} of the host", kind.name());
            return Err(Error::new(Kind::State, what).row(own));
        }
        let rows = if is_tied { dim * nodes.len() } else { nodes.len() };
        let rhs = filled(rows, if is_tied { 0.0 } else { f64::INFINITY }, WHAT)?;
        let ptr = filled(rows + 1, 0, WHAT)?;
        let mut pair = Pair {
            slave,
            master,
            method,
            is_tied,
            first: own,
            friction: None,
            laws: Laws::new(nodes.len(), distance)?,
            kept: filled(nodes.len(), NONE, WHAT)?,
            met: filled(nodes.len(), None, WHAT)?,
            adjusted: None,
            tied: None,
            areas: filled(nodes.len(), 0.0, WHAT)?,
            held: (0, 0.0),
            nodes: Vec::new(),
        };
        pair.nodes = nodes;
        let begin = [of_slave.positions()?, of_master.positions()?];
        self.pairs.pairs.try_reserve(1).map_err(|_| refusal(size_of::<Pair>(), WHAT))?;
        let input = RowsInput { ptr: &ptr, body: None, dof: &[], val: &[], rhs: Some(&rhs) };
        self.add_rows(kind, input)?;
        for (surface, positions) in [slave, master].into_iter().zip(begin) {
            let is_of = |pair: &Pair| pair.slave == surface || pair.master == surface;
            if !self.pairs.pairs.iter().any(is_of) {
                self.pairs.surfaces[surface].begin_at(positions);
            }
        }
        self.pairs.pairs.push(pair);
        Ok((self.pairs.pairs.len() - 1, own))
    }

    pub fn pairs_commit(&mut self) -> Result<()> {
        let mut all = reserved(self.pairs.surfaces.len(), WHAT)?;
        for surface in &self.pairs.surfaces {
            all.push(surface.positions()?);
        }
        self.pairs.surfaces.iter_mut().zip(all).for_each(|(surface, positions)| surface.begin_at(positions));
        self.pairs.pairs.iter_mut().for_each(|pair| pair.kept.fill(NONE));
        Ok(())
    }
}
