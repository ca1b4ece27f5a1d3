//! Numbers of a pair by their names, for all slave nodes or for each.

use std::f64::consts::PI;

use crate::constraints::{FrictionInput, RowKind, RowsInput};
use crate::error::{Error, Kind, Result};
use crate::model::host::HostModel;
use crate::model::pairs::{copied, Geometry, WHAT};
use crate::platform::memory::filled;

/// Names of the numbers that nodes may have each, and of those of the pair.
const BY_NODE: [&str; 4] = ["friction", "cohesion", "offset", "compliance"];
const OF_PAIR: [&str; 6] = ["adjust", "on", "angle", "depth", "thickness", "axisymmetric"];

impl HostModel {
    /// `value`: one number, or one for each node of the slave surface.
    pub fn pair_set(&mut self, pair: usize, name: &str, value: &[f64]) -> Result<()> {
        self.check_pair_number(pair, name, value.len())?;
        let is_by_node = BY_NODE.contains(&name);
        let is_allowed = |v: f64| match name {
            "offset" => v.is_finite(),
            "on" | "axisymmetric" => v == 0.0 || v == 1.0,
            "angle" => (0.0..=PI.to_degrees()).contains(&v),
            "thickness" => v.is_finite() && v > 0.0,
            _ => v.is_finite() && v >= 0.0,
        };
        if let Some(at) = value.iter().position(|v| !is_allowed(*v)) {
            let what = format!("{name} cannot be {}", value[at]);
            let error = Error::argument("value", what).pair(pair).entry(at).value(value[at]);
            return Err(if value.len() > 1 { error.node(at) } else { error });
        }
        if is_by_node {
            return self.set_by_node(pair, name, value);
        }
        let scalars = &mut self.pairs.pairs[pair].laws.scalars;
        match name {
            "adjust" => scalars.adjust = value[0],
            "on" => scalars.is_on = value[0] == 1.0,
            "angle" => scalars.angle = value[0],
            "depth" => scalars.depth = value[0],
            "thickness" => scalars.thickness = value[0],
            _ => scalars.axisymmetric = value[0] == 1.0,
        }
        Ok(())
    }

    /// Checks that pairs have this number, and that it may be given as `n` numbers.
    pub fn check_pair_number(&self, pair: usize, name: &str, n: usize) -> Result<()> {
        let of = self.pairs.pair(pair)?;
        let nodes = self.pairs.surfaces[of.slave].len();
        let (is_by_node, known) = (BY_NODE.contains(&name), OF_PAIR.contains(&name));
        if !is_by_node && !known {
            let what =
                format!("a pair has no number {name}: it has {}, {}", BY_NODE.join(", "), OF_PAIR.join(", "));
            return Err(Error::argument("name", what).pair(pair));
        }
        if n == 1 || is_by_node && n == nodes {
            return Ok(());
        }
        let each =
            if is_by_node { format!(", or {nodes}, one for each node of the slave") } else { String::new() };
        let error = Error::argument("n", format!("{name} is one number{each}, not {n}")).pair(pair);
        Err(error.value(n as f64).limit(1.0))
    }

    fn set_by_node(&mut self, pair: usize, name: &str, value: &[f64]) -> Result<()> {
        let of = &self.pairs.pairs[pair];
        let each =
            of.nodes.iter().map(|&node| if value.len() == 1 { value[0] } else { value[node as usize] });
        let values = copied(each)?;
        let some = values.iter().any(|v| *v > 0.0);
        let is_cloud =
            matches!(&self.pairs.surfaces[of.slave], Geometry::Nodes { faces, .. } if faces.len() == 0);
        if some && is_cloud && ["cohesion", "compliance"].contains(&name) {
            let what = format!("{name} belongs to areas, and nodes without faces have none");
            return Err(Error::new(Kind::Unsupported, what).pair(pair));
        }
        if some && of.is_tied && ["friction", "cohesion"].contains(&name) {
            return Err(Error::new(Kind::Unsupported, format!("a tie has no {name}")).pair(pair));
        }
        if some && of.friction.is_none() && ["friction", "cohesion"].contains(&name) {
            self.begin_friction(pair)?;
        }
        let laws = &mut self.pairs.pairs[pair].laws;
        match name {
            "friction" => laws.friction = values,
            "cohesion" => laws.cohesion = values,
            "offset" => laws.offset = values,
            _ => laws.compliance = values,
        }
        Ok(())
    }

    /// Nodes with friction for all rows of the pair; their tangential rows come with the next find.
    fn begin_friction(&mut self, pair: usize) -> Result<()> {
        let (of, own) = (&self.pairs.pairs[pair], self.rows_of_pairs(RowKind::Tangential));
        if self.friction.len() > own {
            let what = "nodes with friction of pairs come before those of the host";
            return Err(Error::new(Kind::State, what).pair(pair));
        }
        let dim = self.pairs.dim(of) - 1;
        let normal = copied(of.nodes.iter().enumerate().map(|(k, _)| (of.first + k) as i64))?;
        let ptr = filled(dim * normal.len() + 1, 0, WHAT)?;
        let rows = RowsInput { ptr: &ptr, body: None, dof: &[], val: &[], rhs: None };
        let first =
            self.add_friction(FrictionInput { dim, normal: &normal, rows, coefficient: None, bound: None })?;
        self.pairs.pairs[pair].friction = Some(first);
        Ok(())
    }
}
