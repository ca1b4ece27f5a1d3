//! Rigid obstacles of simple shape: plane, sphere (a circle in the plane) and cylinder, each full or a hole.

use crate::error::{Error, Result};
use crate::linalg::vector::first_non_finite;
use crate::surface::vector::{across, dot, length, minus, plus, times, turned, unit, Vector, ZERO};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigidShape {
    /// Point, outward normal.
    Plane,
    /// Centre, radius.
    Sphere,
    /// Point of the axis, direction of the axis, radius.
    Cylinder,
}

impl RigidShape {
    /// How many numbers describe the shape in `dim` dimensions.
    pub fn numbers(self, dim: usize) -> Result<usize> {
        if !(2..=3).contains(&dim) || (dim == 2 && self == Self::Cylinder) {
            let what = "a plane or a circle has 2 dimensions; a plane, a sphere or a cylinder 3";
            return Err(Error::argument("dim", what).value(dim as f64));
        }
        Ok(match self {
            Self::Plane => 2 * dim,
            Self::Sphere => dim + 1,
            Self::Cylinder => 2 * dim + 1,
        })
    }
}

/// An obstacle at its present place. With a negative radius the body is outside of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    pub dim: usize,
    pub shape: RigidShape,
    point: Vector,
    /// Unit normal of a plane, or axis of a cylinder.
    direction: Vector,
    radius: f64,
}

/// A point of the obstacle, its outward normal there, and the gap of a node: `x - y = g n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidFoot {
    pub y: Vector,
    pub normal: Vector,
    pub gap: f64,
}

impl Rigid {
    /// `data`: a point, then as [`RigidShape`] says.
    pub fn new(dim: usize, shape: RigidShape, data: &[f64]) -> Result<Self> {
        let numbers = shape.numbers(dim)?;
        if data.len() != numbers {
            let what = format!("this obstacle has {numbers} numbers, not {}", data.len());
            return Err(Error::argument("data", what).value(data.len() as f64).limit(numbers as f64));
        }
        if let Some(at) = first_non_finite(data) {
            return Err(Error::argument("data", "the entry is not a finite number").entry(at));
        }
        let vector = |from: usize| std::array::from_fn(|i| if i < dim { data[from + i] } else { 0.0 });
        let direction = match shape {
            RigidShape::Sphere => ZERO,
            _ => unit(vector(dim))
                .ok_or_else(|| Error::argument("data", "the direction has no length").entry(dim))?,
        };
        let radius = if shape == RigidShape::Plane { 0.0 } else { data[numbers - 1] };
        if shape != RigidShape::Plane && radius == 0.0 {
            return Err(Error::argument("data", "the radius is 0").entry(numbers - 1));
        }
        Ok(Self { dim, shape, point: vector(0), direction, radius })
    }

    /// The point nearest to x; none in the centre or on the axis.
    pub fn foot(&self, x: Vector) -> Option<RigidFoot> {
        let from = minus(x, self.point);
        let (normal, gap) = match self.shape {
            RigidShape::Plane => (self.direction, dot(self.direction, from)),
            _ => {
                let from =
                    if self.shape == RigidShape::Cylinder { across(from, self.direction) } else { from };
                let side = self.radius.signum();
                (times(side, unit(from)?), side * length(from) - self.radius)
            }
        };
        Some(RigidFoot { y: plus(x, -gap, normal), normal, gap })
    }

    /// A direction of the obstacle when the obstacle is at `other`: it turns without spin.
    pub fn direction_at(&self, other: &Self, v: Vector) -> Vector {
        match self.shape {
            RigidShape::Sphere => v,
            _ if self.direction == other.direction => v,
            _ => turned(v, self.direction, other.direction),
        }
    }

    /// A point of the obstacle when the obstacle is at `other`.
    pub fn point_at(&self, other: &Self, y: Vector) -> Vector {
        if self == other {
            return y;
        }
        plus(other.point, 1.0, self.direction_at(other, minus(y, self.point)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;

    #[test]
    fn gaps_are_open_outside_of_the_body_and_normals_point_there() {
        let of = |shape, data: &[f64]| Rigid::new(3, shape, data).unwrap();
        let x = [3.0, 4.0, 2.0];
        for (rigid, gap) in [
            (of(RigidShape::Plane, &[0.0, 0.0, 1.0, 0.0, 0.0, 2.0]), 1.0),
            (of(RigidShape::Sphere, &[3.0, 0.0, 2.0, 1.5]), 2.5),
            (of(RigidShape::Sphere, &[3.0, 0.0, 2.0, -6.0]), 2.0),
            (of(RigidShape::Cylinder, &[0.0, 0.0, 7.0, 0.0, 0.0, -3.0, 4.0]), 1.0),
            (of(RigidShape::Cylinder, &[0.0, 0.0, 7.0, 0.0, 0.0, -3.0, -4.0]), -1.0),
        ] {
            let foot = rigid.foot(x).unwrap();
            assert!((foot.gap - gap).abs() < 1e-15, "{rigid:?}: {foot:?}");
            assert!(length(minus(plus(foot.y, foot.gap, foot.normal), x)) < 1e-15);
            let further = rigid.foot(plus(x, 0.1, foot.normal)).unwrap();
            assert!((further.gap - gap - 0.1).abs() < 1e-15);
        }
        assert!(of(RigidShape::Sphere, &[3.0, 4.0, 2.0, 1.0]).foot(x).is_none());
    }

    #[test]
    fn data_without_meaning_are_refused_by_their_argument() {
        let refused = |dim, shape, data: &[f64]| Rigid::new(dim, shape, data).unwrap_err().kind;
        assert_eq!(refused(4, RigidShape::Sphere, &[0.0; 5]), Kind::Argument("dim"));
        assert_eq!(refused(2, RigidShape::Cylinder, &[0.0; 5]), Kind::Argument("dim"));
        for data in [&[0.0; 3][..], &[0.0; 5], &[0.0, 0.0, f64::NAN, 1.0], &[0.0; 4]] {
            assert_eq!(refused(3, RigidShape::Sphere, data), Kind::Argument("data"), "{data:?}");
        }
        assert_eq!(refused(3, RigidShape::Plane, &[0.0; 6]), Kind::Argument("data"));
    }

    #[test]
    fn material_points_follow_the_obstacle_back_to_where_it_was() {
        let now = Rigid::new(3, RigidShape::Plane, &[0.0, 0.0, 1.0, 0.0, 0.6, 0.8]).unwrap();
        let begin = Rigid::new(3, RigidShape::Plane, &[1.0, 2.0, 0.0, 0.0, 0.0, 1.0]).unwrap();
        let foot = now.foot([0.3, 0.7, 4.0]).unwrap();
        assert!(begin.foot(now.point_at(&begin, foot.y)).unwrap().gap.abs() < 1e-15);
        assert!(length(minus(now.direction_at(&begin, foot.normal), [0.0, 0.0, 1.0])) < 1e-15);
    }
}
