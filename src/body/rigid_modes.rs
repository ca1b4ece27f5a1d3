//! Rigid-body modes from the coordinates of the dofs: candidates for the null space.

use crate::error::{Error, Result};
use crate::linalg::graph::components;
use crate::linalg::vector::{first_non_finite, norm};
use crate::linalg::{Matrix, SpdSolver, Symmetric};
use crate::platform::memory::{copied, headroom, reserved, zeros};

/// Direction and position of each dof.
#[derive(Debug, Clone)]
pub struct Coordinates {
    /// 1-3: displacement along axis x, y, z; 4-6: rotation about it.
    direction: Vec<i32>,
    /// Position, length; coordinates beyond the given dimension are 0.
    place: Vec<[f64; 3]>,
}

/// Rigid modes of the parts of a body.
pub struct RigidModes {
    /// Modes j of all parts in column j.
    pub modes: Matrix,
    /// Dofs of every part, and the number of its modes.
    pub members: Vec<Vec<usize>>,
    pub counts: Vec<usize>,
}

impl RigidModes {
    /// Dofs of every part and the number of its modes.
    pub fn parts(&self) -> Vec<(&[usize], usize)> {
        self.members.iter().map(Vec::as_slice).zip(self.counts.iter().copied()).collect()
    }
}

/// Bound of the remainder after a rigid motion is decomposed.
const RIGID: f64 = 1e-6;

/// Bytes for the parts of a body and their members, per dof.
const PER_DOF: usize = 128;

impl Coordinates {
    /// `place(i, k)` is coordinate k of dof i at `xyz[k + ld i]`, k < dim.
    pub fn new(dim: usize, direction: &[i32], xyz: &[f64], ld: usize) -> Result<Self> {
        if let Some(at) = direction.iter().position(|d| !(1..=6).contains(d)) {
            let found = direction[at];
            return Err(Error::argument("dir", format!("direction {found} is not one of 1 to 6")).dof(at));
        }
        let mut place: Vec<[f64; 3]> = reserved(direction.len(), "the coordinates of a body")?;
        place.extend(
            (0..direction.len())
                .map(|i| std::array::from_fn(|k| if k < dim { xyz[k + ld * i] } else { 0.0 })),
        );
        if let Some(at) = place.iter().position(|p| first_non_finite(p).is_some()) {
            return Err(Error::argument("xyz", "a coordinate is not a finite number").dof(at));
        }
        Ok(Self { direction: copied(direction, "the coordinates of a body")?, place })
    }

    pub fn len(&self) -> usize {
        self.direction.len()
    }

    /// The coordinates of some dofs.
    pub fn of(&self, dofs: &[u32]) -> Result<Self> {
        let (mut direction, mut place) = (
            reserved(dofs.len(), "the coordinates of a body")?,
            reserved(dofs.len(), "the coordinates of a body")?,
        );
        direction.extend(dofs.iter().map(|&dof| self.direction[dof as usize]));
        place.extend(dofs.iter().map(|&dof| self.place[dof as usize]));
        Ok(Self { direction, place })
    }

    /// Per dof: 1-3 a displacement, 4-6 a rotation.
    pub fn directions(&self) -> &[i32] {
        &self.direction
    }

    /// Per dof: position, length.
    pub fn places(&self) -> &[[f64; 3]] {
        &self.place
    }

    /// Equal bit by bit.
    pub fn same(&self, other: &Self) -> bool {
        let bits = |places: &[[f64; 3]]| -> bool {
            places.iter().flatten().zip(other.place.iter().flatten()).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        self.direction == other.direction && bits(&self.place)
    }

    /// The six rigid modes of every connected part except single springs to the ground, without modes that move nothing:
    /// modes j of all parts in column j, n x (up to 6).
    pub fn rigid_modes(&self, stiffness: &Symmetric) -> Result<RigidModes> {
        let _room = headroom(self.len() * PER_DOF, "the rigid modes of a body")?;
        let (part_of, parts) = components(stiffness);
        let mut members = vec![Vec::new(); parts];
        part_of.iter().enumerate().for_each(|(dof, &part)| members[part].push(dof));
        self.motions(members, |dof| stiffness.diagonal(dof) > 0.0)
    }

    /// The rigid modes of a body whose parts are not known: it counts as one part.
    pub fn rigid_modes_of_one(&self, stiff: impl Fn(usize) -> bool) -> Result<Matrix> {
        let _room = headroom(self.len() * PER_DOF, "the rigid modes of a body")?;
        Ok(self.motions(vec![(0..self.len()).collect()], stiff)?.modes)
    }

    /// The rigid modes of all parts, except single dofs with stiffness.
    fn motions(&self, members: Vec<Vec<usize>>, stiff: impl Fn(usize) -> bool) -> Result<RigidModes> {
        let (mut modes, mut counts) = (Matrix::zeros(self.len(), 0)?, vec![0; members.len()]);
        modes.data = reserved(self.len() * 6, "the rigid modes of a body")?;
        let floats = |dofs: &[usize]| dofs.len() > 1 || !stiff(dofs[0]);
        let empty = zeros(self.len(), "the rigid modes of a body")?;
        for (dofs, count) in members.iter().zip(&mut counts).filter(|(dofs, _)| floats(dofs)) {
            let (centre, size) = self.extent(dofs);
            for mode in 0..6 {
                let motion = |i: usize| self.motion(i, mode, centre, size);
                if dofs.iter().all(|&i| motion(i) == 0.0) {
                    continue;
                }
                if modes.cols == *count {
                    modes.push_col(&empty);
                }
                dofs.iter().for_each(|&i| modes.set(i, *count, motion(i)));
                *count += 1;
            }
        }
        Ok(RigidModes { modes, members, counts })
    }

    /// The rigid motion of v, one entry per dof: velocity of the origin (length) and rotation about the axes, of least
    /// size if v does not determine it. `None` if v is not a rigid motion of the whole body.
    pub fn rigid_motion(&self, v: &[f64]) -> Option<[f64; 6]> {
        let all: Vec<usize> = (0..self.len()).collect();
        let (centre, size) = self.extent(&all);
        let modes = Matrix::from_fn(self.len(), 6, |i, mode| self.motion(i, mode, centre, size)).ok()?;
        let mut normal = Matrix::zeros(6, 6).ok()?;
        (0..6).for_each(|j| normal.col_mut(j).copy_from_slice(&modes.mul_transposed(modes.col(j))));
        let scale: [f64; 6] =
            std::array::from_fn(|j| Some(normal.get(j, j)).filter(|d| *d > 0.0).unwrap_or(1.0));
        let part = SpdSolver::new(&normal, &scale).ok()?.solve(&modes.mul_transposed(v));
        let mut left = v.to_vec();
        modes.mul_add(-1.0, &part, &mut left);
        let w = [part[3] / size, part[4] / size, part[5] / size];
        let arm = |a: usize, b: usize| w[a] * centre[b] - w[b] * centre[a];
        let origin = [part[0] - arm(1, 2), part[1] - arm(2, 0), part[2] - arm(0, 1)];
        (norm(&left) <= RIGID * norm(v)).then_some([origin[0], origin[1], origin[2], w[0], w[1], w[2]])
    }

    /// Centre and half the largest edge of the box around the dofs (1 for a point).
    fn extent(&self, dofs: &[usize]) -> ([f64; 3], f64) {
        let mut low = self.place[dofs[0]];
        let mut high = low;
        for &i in dofs {
            for k in 0..3 {
                low[k] = low[k].min(self.place[i][k]);
                high[k] = high[k].max(self.place[i][k]);
            }
        }
        let size = (0..3).map(|k| 0.5 * (high[k] - low[k])).fold(0.0, f64::max);
        (std::array::from_fn(|k| 0.5 * (low[k] + high[k])), if size > 0.0 { size } else { 1.0 })
    }

    /// Movement of dof `i` in mode 0-2 (translation along an axis) or 3-5 (rotation about it by `1 / size`, so that
    /// translations and rotations move points of the boundary equally far).
    fn motion(&self, i: usize, mode: usize, centre: [f64; 3], size: f64) -> f64 {
        let direction = self.direction[i] as usize - 1;
        if mode < 3 {
            return f64::from(u8::from(direction == mode));
        }
        let axis = mode - 3;
        if direction >= 3 {
            return if direction - 3 == axis { 1.0 / size } else { 0.0 };
        }
        // e_axis x (x - centre), component `direction`
        let arm = |k: usize| (self.place[i][k] - centre[k]) / size;
        if direction == (axis + 1) % 3 {
            -arm((axis + 2) % 3)
        } else if direction == (axis + 2) % 3 {
            arm((axis + 1) % 3)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_is_taken_apart_into_the_velocity_of_the_origin_and_a_rotation() {
        // four points in the plane, u = (1, 2) + 0.5 e_z x position
        let xyz = [3.0, 1.0, 3.0, 1.0, 5.0, 1.0, 5.0, 1.0, 3.0, 4.0, 3.0, 4.0];
        let coordinates = Coordinates::new(2, &[1, 2, 1, 2, 1, 2], &xyz, 2).unwrap();
        let v: Vec<f64> = (0..3).flat_map(|k| [1.0 - 0.5 * xyz[4 * k + 1], 2.0 + 0.5 * xyz[4 * k]]).collect();
        let motion = coordinates.rigid_motion(&v).unwrap();
        for (found, expected) in motion.iter().zip([1.0, 2.0, 0.0, 0.0, 0.0, 0.5]) {
            assert!((found - expected).abs() < 1e-13, "{motion:?}");
        }
        let mut bent = v;
        bent[0] += 0.1;
        assert_eq!(coordinates.rigid_motion(&bent), None);
    }

    #[test]
    fn the_modes_of_a_truss_bar_do_not_stretch_it() {
        // a bar from (0,0) to (3,4): K = t t' with t = (-.6, -.8, .6, .8)
        let t = [-0.6, -0.8, 0.6, 0.8];
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..4 {
            for j in 0..=i {
                col.push(j as u32);
                val.push(t[i] * t[j]);
            }
            ptr.push(col.len());
        }
        let xyz = [0.0, 0.0, 0.0, 0.0, 3.0, 4.0, 3.0, 4.0];
        let coordinates = Coordinates::new(2, &[1, 2, 1, 2], &xyz, 2).unwrap();
        let modes = coordinates.rigid_modes(&Symmetric::new(ptr, col, val)).unwrap().modes;
        assert_eq!(modes.cols, 3);
        for j in 0..3 {
            let stretch: f64 = (0..4).map(|i| t[i] * modes.get(i, j)).sum();
            assert!(stretch.abs() < 1e-15);
        }
    }
}
