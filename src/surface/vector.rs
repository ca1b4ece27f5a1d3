//! Points and vectors of space; in the plane the third coordinate is 0.

/// Coordinates, length; or a direction, no unit.
pub type Vector = [f64; 3];

pub const ZERO: Vector = [0.0; 3];
/// Normal of the plane.
pub const E_Z: Vector = [0.0, 0.0, 1.0];

#[inline]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + s b`
#[inline]
pub fn plus(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

#[inline]
pub fn times(s: f64, a: Vector) -> Vector {
    [s * a[0], s * a[1], s * a[2]]
}

#[inline]
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Largest coordinate in size.
pub fn largest(a: Vector) -> f64 {
    a.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// `a / |a|`; none if |a| is 0 or not a normal number.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = length(a);
    length.is_normal().then(|| times(length.recip(), a))
}

/// The part of `a` across the unit vector `n`.
pub fn across(a: Vector, n: Vector) -> Vector {
    plus(a, -dot(a, n), n)
}

/// Angle between two vectors, radian.
pub fn angle(a: Vector, b: Vector) -> f64 {
    length(cross(a, b)).atan2(dot(a, b))
}

/// `v` turned as the unit vector `from` turns to `to`, without spin about them (Rodrigues); opposite vectors turn by half a turn about some
/// axis across them.
pub fn turned(v: Vector, from: Vector, to: Vector) -> Vector {
    let (axis, cosine) = (cross(from, to), dot(from, to));
    if 1.0 + cosine <= f64::EPSILON {
        let about = any_across(from);
        return plus(times(-1.0, v), 2.0 * dot(v, about), about);
    }
    let along = dot(axis, v) / (1.0 + cosine);
    plus(plus(times(cosine, v), 1.0, cross(axis, v)), along, axis)
}

/// A unit vector across the unit vector `n`, the same for equal n.
pub fn any_across(n: Vector) -> Vector {
    let least = (0..3).fold(0, |least, i| if n[i].abs() < n[least].abs() { i } else { least });
    let mut e = ZERO;
    e[least] = 1.0;
    unit(across(e, n)).unwrap_or(e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_turns_with_another_and_keeps_its_length() {
        let unit = |v: Vector| unit(v).unwrap();
        let (from, to, v) = (unit([1.0, 2.0, -0.5]), unit([-0.3, 0.4, 2.0]), [0.7, -1.0, 2.0]);
        assert!(length(minus(turned(from, from, to), to)) < 1e-15);
        assert!((length(turned(v, from, to)) - length(v)).abs() < 1e-15);
        assert!(length(minus(turned(turned(v, from, to), to, from), v)) < 1e-15);
        assert!(length(minus(turned(from, from, times(-1.0, from)), times(-1.0, from))) < 1e-15);
        assert!(dot(any_across(from), from).abs() < 1e-16);
    }
}
