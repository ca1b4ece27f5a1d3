//! Loads and the displacements that they cause, (17): `u = K+ (f - B'x) + R alpha`.

use crate::body::{wire_struct, wire_unit, Local, LocalDual, Name, Question};
use crate::certificate::Load;
use crate::error::Result;
use crate::linalg::vector::{axpy, dot, norm_max};
use crate::platform::memory::{copied, zeros};

const WHAT: &str = "a displacement";

wire_unit!(Scale, FromLoad, Loaded);
wire_struct!(OfLoad { moved, resultants });
wire_struct!(Displace { at_rows });
wire_struct!(Turn { a });
wire_struct!(Slide { at_rows, a });

/// What the dual takes from a load f.
pub struct OfLoad {
    /// `B_p K_p+ f_p` over the rows that touch the body.
    pub moved: Vec<f64>,
    /// `R_p'f_p`, the right-hand side e of `G lambda = e` in (12); 0 if it is rounding of a self-equilibrated load.
    pub resultants: Vec<f64>,
}

/// Keeps `f / 2^p`; asks for it where rows touch.
pub struct Scale;

impl Question for Scale {
    const NAME: Name = Name::Scale;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Load,);

    fn answer(self, body: &Local, scaled: &mut Vec<f64>, load: &Load) -> Result<Vec<f64>> {
        *scaled = load.everywhere(body.order())?;
        let unit = body.dual()?.island;
        scaled.iter_mut().for_each(|f| *f /= unit);
        Ok(body.at_rows(scaled))
    }
}

/// Asks what the dual takes from a scaled load.
pub struct FromLoad;

impl Question for FromLoad {
    const NAME: Name = Name::FromLoad;
    type Answer = OfLoad;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, _: &mut (), load: &Vec<f64>) -> Result<OfLoad> {
        of_load(body, load)
    }
}

/// Keeps a scaled load as one in the units of the host, in place of that of the host.
pub struct Loaded;

impl Question for Loaded {
    const NAME: Name = Name::Loaded;
    type Answer = ();
    type Kept = Load;
    type Given = (Vec<f64>, Load);

    fn answer(self, body: &Local, load: &mut Load, (scaled, of_host): (&Vec<f64>, &Load)) -> Result<()> {
        let unit = body.dual()?.island;
        let own = scaled.iter().map(|f| f * unit).collect();
        *load = Load { own: Some(own), whole: of_host.whole };
        Ok(())
    }
}

/// Keeps `K+ f`, f being a load with these values where rows touch; asks for it there.
pub struct Displace {
    pub at_rows: Vec<f64>,
}

impl Question for Displace {
    const NAME: Name = Name::Displace;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, moved: &mut Vec<f64>, load: &Vec<f64>) -> Result<Vec<f64>> {
        *moved = displaced(body, copied(load, WHAT)?, &self.at_rows)?;
        Ok(body.at_rows(moved))
    }
}

/// Keeps `v + R a`; asks for it where rows touch.
pub struct Turn {
    pub a: Vec<f64>,
}

impl Question for Turn {
    const NAME: Name = Name::Turn;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, turned: &mut Vec<f64>, v: &Vec<f64>) -> Result<Vec<f64>> {
        *turned = turn(body, &self.a)?;
        axpy(1.0, v, turned);
        Ok(body.at_rows(turned))
    }
}

/// Keeps `K+ f + R a`, f being 0 but where rows touch; asks for it there.
pub struct Slide {
    pub at_rows: Vec<f64>,
    pub a: Vec<f64>,
}

impl Question for Slide {
    const NAME: Name = Name::Slide;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(self, body: &Local, v: &mut Vec<f64>, _: ()) -> Result<Vec<f64>> {
        *v = displaced(body, zeros(body.order(), WHAT)?, &self.at_rows)?;
        axpy(1.0, &turn(body, &self.a)?, v);
        Ok(body.at_rows(v))
    }
}

pub(super) fn of_load(body: &Local, f: &[f64]) -> Result<OfLoad> {
    let LocalDual { kplus, rows, by, .. } = body.dual()?;
    let mut u = zeros(f.len(), WHAT)?;
    kplus.apply(f, &mut u)?;
    let moved = (0..rows.rows()).map(|k| by * rows.row_dot(k, &u)).collect();
    Ok(OfLoad { moved, resultants: resultants(body, f)? })
}

/// The right-hand side of `G lambda = e` in (12), `e = R'f`, in the scaling of the dual; 0 if it is rounding.
pub(super) fn resultants(body: &Local, f: &[f64]) -> Result<Vec<f64>> {
    let LocalDual { kplus, size, .. } = body.dual()?;
    let resultant = |k: usize| {
        let motion = body.null_space.col(k);
        let terms = norm_max(motion) * f.iter().map(|f| f.abs()).sum::<f64>();
        let resultant = Some(dot(motion, f)).filter(|e| e.abs() > kplus.rounding * terms);
        resultant.unwrap_or(0.0) / size
    };
    Ok((0..body.null_space.cols).map(resultant).collect())
}

/// `K+ f` for a load with these values where rows touch the body: (17) without its rigid motion; (16) if the body is held, K+ = K^-1.
pub(super) fn displaced(body: &Local, mut load: Vec<f64>, at_rows: &[f64]) -> Result<Vec<f64>> {
    let dual = body.dual()?;
    body.set_at_rows(at_rows, &mut load);
    let mut moved = zeros(load.len(), WHAT)?;
    dual.kplus.apply(&load, &mut moved)?;
    moved.iter_mut().for_each(|u| *u *= dual.by);
    Ok(moved)
}

/// `R a`, the rigid motion of (17).
pub(super) fn turn(body: &Local, a: &[f64]) -> Result<Vec<f64>> {
    let mut turned = zeros(body.order(), WHAT)?;
    body.null_space.mul_add(1.0 / body.dual()?.size, a, &mut turned);
    Ok(turned)
}
