//! Rigid-body modes from the coordinates of the dofs: candidates for the null space.

use std::ops::Range;

use crate::error::{Error, Result};
use crate::linalg::hash::hash;
use crate::linalg::vector::{first_non_finite, norm};
use crate::linalg::{Matrix, SpdSolver};
use crate::numbers::body::RIGID;
use crate::numbers::data::BINARY;
use crate::platform::memory::{copied, headroom, reserved};
use crate::ranks::wire_struct;

/// Direction and position of each dof.
#[derive(Debug, Clone)]
pub struct Coordinates {
    /// 1-3: displacement along axis x, y, z; 4-6: rotation about it.
    direction: Vec<i32>,
    /// Position, length; coordinates beyond the given dimension are 0.
    place: Vec<[f64; 3]>,
}

wire_struct!(Coordinates { direction, place });

/// Digits of coordinates that have been rounded: fewer may be exact, more are rounding of f64.
const DIGITS: Range<i32> = 5..13;
/// Number of points whose digits are counted.
const POINTS: usize = 256;

/// Bytes of the modes, per dof.
const PER_DOF: usize = 48;

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

    /// Hash key, continuing from the key `before`.
    pub fn key(&self, before: u64) -> u64 {
        let key = hash(before, self.direction.iter().map(|direction| *direction as u64));
        hash(key, self.place.as_flattened().iter().map(|x| x.to_bits()))
    }

    /// The rigid modes of a connected body, n x (up to 6), without modes that move nothing; none for a single spring to the
    /// ground.
    pub fn rigid_modes(&self, stiff: impl Fn(usize) -> bool) -> Result<Matrix> {
        let _room = headroom(self.len() * PER_DOF, "the rigid modes of a body")?;
        let mut modes = Matrix::zeros(self.len(), 0)?;
        if self.len() == 1 && stiff(0) {
            return Ok(modes);
        }
        modes.data = reserved(self.len() * 6, "the rigid modes of a body")?;
        let (centre, size) = self.extent();
        for mode in 0..6 {
            let motion = |i: usize| self.motion(i, mode, centre, size);
            if (0..self.len()).any(|i| motion(i) != 0.0) {
                modes.data.extend((0..self.len()).map(motion));
                modes.cols += 1;
            }
        }
        Ok(modes)
    }

    /// The largest edge of the box around all dofs.
    pub fn length(&self) -> f64 {
        (0..3).map(|k| self.along(k)).fold(0.0, f64::max)
    }

    fn along(&self, k: usize) -> f64 {
        let ends = self.place.iter().map(|place| place[k]);
        ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
    }

    /// Twice the unit of the last digit of coordinates that have been rounded to a few decimal digits, relative to the distance of
    /// neighbours; 0 if they have not.
    pub fn last_digit(&self) -> f64 {
        let places = &self.place;
        let some = places.iter().step_by(places.len().div_ceil(POINTS).max(1)).flatten();
        let decimal = |x: &f64| {
            let text = format!("{x:e}");
            let (digits, exponent) = text.split_once('e')?;
            Some((exponent.parse::<i32>().ok()?, digits.chars().filter(char::is_ascii_digit).count() as i32))
        };
        // multiples of 2^-20 are exact
        let all: Vec<_> = some.filter(|x| (*x * BINARY).fract() != 0.0).filter_map(decimal).collect();
        let most = all.iter().map(|number| number.1).max().unwrap_or(0);
        let long = all.iter().filter(|number| number.1 + 2 >= most).count();
        if !DIGITS.contains(&most) || 2 * long < all.len() {
            return 0.0;
        }
        let highest = all.iter().map(|number| number.0).max().unwrap_or(0);
        let dimension = (0..3).filter(|&k| self.along(k) > 0.0).count().max(1);
        let nodes = 1 + places.windows(2).filter(|pair| pair[0] != pair[1]).count();
        2.0 * 10f64.powi(highest - most + 1) * (nodes as f64).powf(1.0 / dimension as f64) / self.length()
    }

    /// The rigid motion of v, one entry per dof: velocity of the origin (length) and rotation about the axes, of least
    /// size if v does not determine it. `None` if v is not a rigid motion of the whole body.
    pub fn rigid_motion(&self, v: &[f64]) -> Option<[f64; 6]> {
        let (centre, size) = self.extent();
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
    fn extent(&self) -> ([f64; 3], f64) {
        let mut low = self.place[0];
        let mut high = low;
        for place in &self.place {
            for k in 0..3 {
                low[k] = low[k].min(place[k]);
                high[k] = high[k].max(place[k]);
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
    use crate::linalg::Symmetric;

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
        let k = Symmetric::new(ptr, col, val);
        let modes = coordinates.rigid_modes(|i| k.diagonal(i) > 0.0).unwrap();
        assert_eq!(modes.cols, 3);
        for j in 0..3 {
            let stretch: f64 = (0..4).map(|i| t[i] * modes.get(i, j)).sum();
            assert!(stretch.abs() < 1e-15);
        }
    }
}
