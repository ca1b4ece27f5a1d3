//! Bodies: their null spaces, coordinates, loads, and functions instead of a matrix.

use std::sync::Arc;

use crate::body::{
    same_vectors, Body, Coordinates, HostFunctions, HostOperator, Modes, NullSpaceInput, OtherForm,
};
use crate::error::{Error, Kind, Result, INDEX};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Matrix;
use crate::mesh::Mesh;
use crate::model::contents::{Change, GivenBody};
use crate::model::host::HostModel;
use crate::platform::memory::copied;

impl Change {
    /// `change`, or `Nothing` if the input is unchanged.
    pub fn unless(unchanged: bool, change: Self) -> Self {
        if unchanged {
            Self::Nothing
        } else {
            change
        }
    }
}

impl HostModel {
    pub fn add_body(&mut self, n: usize) -> Result<usize> {
        if n == 0 {
            return Err(Error::argument("n", "a body has at least one unknown").value(0.0).limit(1.0));
        }
        self.check_no_table()?;
        let first = self.sizes().dofs;
        let most = i64::MAX as usize - first;
        if n > most {
            let what = "the unknowns of all bodies together exceed 64 bits";
            let error = Error::new(Kind::Overflow, what).body(self.bodies.len());
            return Err(error.value(n as f64).limit(most as f64));
        }
        self.revisions.rows += 1;
        self.offsets.push(first + n);
        self.bodies.push(GivenBody { body: Body { order: n, ..Body::default() }, ..GivenBody::default() });
        Ok(self.bodies.len() - 1)
    }

    pub fn set_null_space(
        &mut self,
        body: usize,
        n: usize,
        r: usize,
        basis: &[f64],
        ldr: usize,
        modes: Modes,
    ) -> Result<()> {
        self.check_length(body, "n", n)?;
        if r > n {
            let what = format!("{r} null vectors of {n} unknowns");
            return Err(Error::argument("r", what).body(body).value(r as f64).limit(n as f64));
        }
        if r > 0 {
            check_ld("ldr", ldr, n).map_err(|e| e.body(body))?;
        }
        let mut vectors = Matrix::zeros(n, r)?;
        for j in 0..r {
            let column = &basis[j * ldr..j * ldr + n];
            if let Some(dof) = first_non_finite(column) {
                let what = "the entry is not a finite number";
                return Err(Error::argument("basis", what).body(body).dof(dof).entry(j * ldr + dof));
            }
            vectors.col_mut(j).copy_from_slice(column);
        }
        let given = NullSpaceInput { vectors, modes };
        let old = self.given(body)?.body.null_space.as_ref();
        let unchanged = old.is_some_and(|old| same_vectors(old, &given));
        self.change(body, Change::unless(unchanged, Change::Motions))?.body.null_space =
            Some(Box::new(given));
        Ok(())
    }

    pub fn set_fixing(&mut self, body: usize, dofs: Option<&[usize]>) -> Result<()> {
        let order = self.order(body)?;
        let beyond = dofs.into_iter().flatten().enumerate().find(|(_, dof)| **dof >= order);
        if let Some((entry, &dof)) = beyond {
            let what = format!("unknown {INDEX} is outside the {order} unknowns of the body");
            let error = Error::argument("dof", what).body(body).entry(entry);
            return Err(error.index(dof as i64).limit(order as f64));
        }
        let unchanged = self.given(body)?.body.fixing.as_deref() == dofs;
        let given = self.change(body, Change::unless(unchanged, Change::Fixing))?;
        given.body.fixing = dofs.map(Box::from);
        Ok(())
    }

    pub fn set_coordinates(
        &mut self,
        body: usize,
        dim: usize,
        node: &[i32],
        dir: &[i32],
        xyz: &[f64],
        ld: usize,
    ) -> Result<()> {
        self.check_length(body, "n", node.len())?;
        if !(1..=3).contains(&dim) {
            let error = Error::argument("dim", "space has 1, 2 or 3 dimensions");
            return Err(error.body(body).value(dim as f64));
        }
        check_ld("ld", ld, dim).map_err(|e| e.body(body))?;
        let coordinates = Coordinates::new(dim, dir, xyz, ld).map_err(|e| e.body(body))?;
        let old = self.given(body)?.body.coordinates.as_ref();
        let unchanged = old.is_some_and(|old| old.same(&coordinates));
        self.change(body, Change::unless(unchanged, Change::Motions))?.body.coordinates =
            Some(Box::new(coordinates));
        Ok(())
    }

    pub fn set_coordinate_modes(&mut self, body: usize, modes: Modes) -> Result<()> {
        let unchanged = self.given(body)?.body.coordinate_modes == modes;
        self.change(body, Change::unless(unchanged, Change::Motions))?.body.coordinate_modes = modes;
        Ok(())
    }

    pub fn set_load(&mut self, body: usize, f: &[f64]) -> Result<()> {
        self.check_length(body, "n", f.len())?;
        if let Some(dof) = first_non_finite(f) {
            return Err(Error::argument("f", "the entry is not a finite number").body(body).entry(dof));
        }
        self.bodies[body].body.load = Some(copied(f, "a load")?.into());
        Ok(())
    }

    pub fn set_operator(&mut self, body: usize, diagonal: &[f64], functions: HostFunctions) -> Result<()> {
        self.check_length(body, "n", diagonal.len())?;
        if let Some(dof) = diagonal.iter().position(|d| !(d.is_finite() && *d >= 0.0)) {
            let what = "the diagonal entry of K is not a finite number >= 0";
            return Err(Error::argument("diag", what).body(body).dof(dof).entry(dof).value(diagonal[dof]));
        }
        let operator = HostOperator::new(body, copied(diagonal, "the diagonal of a body")?, functions);
        let slot = self.change(body, Change::Pattern)?;
        slot.body.other = Some(Box::new(OtherForm::Operator(Arc::new(operator))));
        (slot.body.stiffness, slot.mesh) = (None, None);
        slot.form = None;
        slot.spoiled = false;
        Ok(())
    }

    /// Checks that every body has the input that a setup needs.
    pub fn check_complete(&self) -> Result<()> {
        let refused = |p: usize, what: &str| Err(Error::new(Kind::State, what).body(p));
        if self.bodies.is_empty() {
            return Err(Error::new(Kind::State, "the problem has no body yet"));
        }
        for (p, given) in self.bodies.iter().enumerate() {
            let body = &given.body;
            if let Some(element) = given.mesh.as_deref().and_then(Mesh::first_missing) {
                let what = "the matrix of this element has not been given";
                return Err(Error::new(Kind::State, what).body(p).element(element));
            }
            if body.k().is_none() && body.given_there().is_none() {
                return refused(p, "the stiffness matrix has not been given");
            }
            if body.operator().is_some() && body.null_space.is_none() && body.coordinates.is_none() {
                let what = "the null space has not been given: it cannot be found from products with K";
                return refused(p, what);
            }
            if given.spoiled {
                return refused(p, SPOILED);
            }
        }
        Ok(())
    }
}

/// The host has changed borrowed values of a matrix in place, and these were refused.
pub const SPOILED: &str =
    "the values of the stiffness matrix were rewritten in place and refused: give valid values";

pub fn check_ld(name: &'static str, ld: usize, least: usize) -> Result<()> {
    if ld >= least {
        return Ok(());
    }
    Err(Error::argument(name, format!("the leading dimension {ld} is less than {least}"))
        .value(ld as f64)
        .limit(least as f64))
}
