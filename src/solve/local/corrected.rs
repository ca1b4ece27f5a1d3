//! A point of the finish on one body, u = v + w in two doubles, and its corrections.

use crate::body::{wire_struct, wire_unit, Local, Name, Question};
use crate::certificate::NOISE;
use crate::error::Result;
use crate::linalg::twofold::{Twofold, TwofoldVector};
use crate::linalg::vector::axpy;
use crate::platform::memory::{copied, filled, zeros};
use crate::solve::local::displaced::{displaced, of_load, turn};
use crate::solve::local::motions::{amplitudes, length};
use crate::solve::local::OfLoad;

const WHAT: &str = "a correction";

wire_unit!(Strained, PointAtRows, Displacement);
wire_struct!(Begin { at_rest });
wire_struct!(Shift { a, apart });
wire_struct!(Residual { at_rows });
wire_struct!(Correct { at_rows, a, apart });
wire_struct!(Corrected { apart, at_rows, length });
wire_struct!(Added { by });
wire_struct!(Turned { a, at_rows, length });
wire_struct!(Deformation { beta });

/// w are motions that K does not resist; in a sum with large w, v would lose its digits.
#[derive(Debug, Clone, Default)]
pub struct Point {
    v: TwofoldVector,
    w: TwofoldVector,
}

/// Keeps a point with w = 0; `at_rest`: v = 0.
pub struct Begin {
    pub at_rest: bool,
}

impl Question for Begin {
    const NAME: Name = Name::Begin;
    type Answer = ();
    type Kept = Point;
    type Given = (Vec<f64>,);

    fn answer(self, _: &Local, point: &mut Point, v: &Vec<f64>) -> Result<()> {
        let zero = zeros(v.len(), WHAT)?;
        point.v = if self.at_rest { zero.clone() } else { copied(v, WHAT)? }.into();
        point.w = zero.into();
        Ok(())
    }
}

/// Adds R a: to w where it is `apart` times as large as v and K resists it by rounding alone, otherwise to v. Asks whether it is apart.
pub struct Shift {
    pub a: Vec<f64>,
    pub apart: f64,
}

impl Question for Shift {
    const NAME: Name = Name::Shift;
    type Answer = bool;
    type Kept = Point;
    type Given = ();

    fn answer(self, body: &Local, point: &mut Point, _: ()) -> Result<bool> {
        Ok(point.shift(body, &self.a, self.apart)?.0)
    }
}

/// Keeps `f - K v`, in units of 2^p; asks for it, in two doubles, where rows touch: the forces of rows are still to be taken away there.
pub struct Strained;

impl Question for Strained {
    const NAME: Name = Name::Strained;
    type Answer = Vec<Twofold>;
    type Kept = Vec<f64>;
    type Given = (Vec<f64>, Point);

    fn answer(
        self,
        body: &Local,
        left: &mut Vec<f64>,
        (load, point): (&Vec<f64>, &Point),
    ) -> Result<Vec<Twofold>> {
        let mut all = filled(load.len(), Twofold::default(), WHAT)?;
        all.iter_mut().zip(load).for_each(|(left, f)| *left = Twofold::from(*f));
        for v in point.v.parts() {
            body.stiffness.add_twofold(-1.0 / body.dual()?.island, v, &mut all)?;
        }
        let at_rows = body.at_rows(&all);
        *left = all.into_iter().map(Twofold::value).collect();
        Ok(at_rows)
    }
}

/// Completes a residual by its values where rows touch; asks what the dual takes from it.
pub struct Residual {
    pub at_rows: Vec<f64>,
}

impl Question for Residual {
    const NAME: Name = Name::Residual;
    type Answer = OfLoad;
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(self, body: &Local, left: &mut Vec<f64>, _: ()) -> Result<OfLoad> {
        body.set_at_rows(&self.at_rows, left);
        of_load(body, left)
    }
}

/// Adds `K+ r + R a` for a residual r with these values where rows touch; `apart`: as for `Shift`.
pub struct Correct {
    pub at_rows: Vec<f64>,
    pub a: Vec<f64>,
    pub apart: f64,
}

/// A correction.
pub struct Corrected {
    /// The motion by R is apart.
    pub apart: bool,
    /// The correction where rows touch.
    pub at_rows: Vec<f64>,
    /// `|.|_D`
    pub length: f64,
}

impl Question for Correct {
    const NAME: Name = Name::Correct;
    type Answer = Corrected;
    type Kept = Point;
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, point: &mut Point, left: &Vec<f64>) -> Result<Corrected> {
        let mut moved = displaced(body, copied(left, WHAT)?, &self.at_rows)?;
        point.v.add_all(&moved);
        let (apart, motion) = point.shift(body, &self.a, self.apart)?;
        axpy(1.0, &motion, &mut moved);
        Ok(Corrected { apart, at_rows: body.at_rows(&moved), length: length(body, &moved)? })
    }
}

/// Adds a vector to v.
pub struct Added {
    pub by: Vec<f64>,
}

/// A correction and its amplitudes.
pub struct Turned {
    pub a: Vec<f64>,
    pub at_rows: Vec<f64>,
    pub length: f64,
}

impl Question for Added {
    const NAME: Name = Name::Added;
    type Answer = Turned;
    type Kept = Point;
    type Given = ();

    fn answer(self, body: &Local, point: &mut Point, _: ()) -> Result<Turned> {
        point.v.add_all(&self.by);
        let (a, length) = (amplitudes(body, &self.by)?, length(body, &self.by)?);
        Ok(Turned { a, at_rows: body.at_rows(&self.by), length })
    }
}

/// Asks for v and w where rows touch, each in two doubles.
pub struct PointAtRows;

impl Question for PointAtRows {
    const NAME: Name = Name::PointAtRows;
    type Answer = Vec<Vec<f64>>;
    type Kept = ();
    type Given = (Point,);

    fn answer(self, body: &Local, _: &mut (), point: &Point) -> Result<Vec<Vec<f64>>> {
        let parts = point.v.parts().into_iter().chain(point.w.parts());
        Ok(parts.map(|part| body.at_rows(part)).collect())
    }
}

/// Keeps u = v + w; asks for it where rows touch.
pub struct Displacement;

impl Question for Displacement {
    const NAME: Name = Name::Displacement;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Point,);

    fn answer(self, body: &Local, u: &mut Vec<f64>, point: &Point) -> Result<Vec<f64>> {
        *u = point.w.values();
        axpy(1.0, &point.v.values(), u);
        Ok(body.at_rows(u))
    }
}

/// Keeps `v - R beta`; asks for it where rows touch.
pub struct Deformation {
    pub beta: Vec<f64>,
}

impl Question for Deformation {
    const NAME: Name = Name::Deformation;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Point,);

    fn answer(self, body: &Local, deformed: &mut Vec<f64>, point: &Point) -> Result<Vec<f64>> {
        *deformed = point.v.values();
        axpy(-1.0, &turn(body, &self.beta)?, deformed);
        Ok(body.at_rows(deformed))
    }
}

impl Point {
    /// Whether R a is apart, and R a.
    fn shift(&mut self, body: &Local, a: &[f64], apart: f64) -> Result<(bool, Vec<f64>)> {
        let motion = turn(body, a)?;
        let apart =
            length(body, &motion)? > apart * length(body, &self.v.values())? && is_unresisted(body, &motion)?;
        let to = if apart { &mut self.w } else { &mut self.v };
        to.add_all(&motion);
        Ok((apart, motion))
    }
}

/// `|K w|_j <= 64 eps (|K||w|)_j`
fn is_unresisted(body: &Local, w: &[f64]) -> Result<bool> {
    let (image, terms) = body.products(w, "a motion")?;
    Ok(image.iter().zip(&terms).all(|(image, terms)| image.abs() <= NOISE * terms))
}
