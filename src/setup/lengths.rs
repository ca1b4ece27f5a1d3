//! How far loads move their bodies: a length of which right-hand sides may be differences.

use std::cell::OnceCell;
use std::sync::Arc;

use crate::body::{Local, Locals, Seen};
use crate::certificate::{led, Couple, Coupled, Trace, Way};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::Matrix;
use crate::model::{Lengths, SolvedModel};
use crate::setup::islands::Island;
use crate::setup::prepared::Prepared;

/// An island and its bodies.
type OfIsland<'b> = (&'b Island, Locals<'b>);

/// `of`: each of `count` islands.
fn lengths<'a, 'b>(
    model: &'a SolvedModel,
    count: usize,
    of: &dyn Fn(usize) -> Result<OfIsland<'b>>,
) -> Result<Lengths<'a>> {
    let (loads, mut all) = (model.loads_that_count(), vec![0.0; model.bodies.len()]);
    // what is little is so beside all bodies: a pilot may be an island
    let others = if count > 1 { 0..count } else { 0..0 };
    let (mut stiffest, strongest) = (0.0f64, OnceCell::new());
    for k in others.clone() {
        stiffest = of(k)?.1.iter().map(Seen::stiffest).fold(stiffest, f64::max);
    }
    let find_strongest = || {
        others.clone().try_fold(0.0, |most: f64, k| {
            Ok(of(k)?.1.ask(|_| Couple, ())?.iter().map(Coupled::strongest).fold(most, f64::max))
        })
    };
    for k in 0..count {
        let (island, bodies) = of(k)?;
        let coupled = || {
            let most = strongest.get().map_or_else(find_strongest, |known| Ok(*known))?;
            strongest.set(most).ok();
            Ok(bodies.ask(|_| Couple, ())?.into_iter().map(|own| own.beside(most)).collect())
        };
        let of = |body: &Seen| {
            let stiffest = if count > 1 { stiffest } else { body.stiffest() };
            (body.diagonal().into_owned(), stiffest, f64::INFINITY)
        };
        let trace = Trace::new(bodies.iter().map(of), &coupled);
        let held = led(&trace, RowKind::ALL.map(|kind| &island.members(kind).rows), &|_, _| true, 1.0)?;
        let way = |at: usize| Way {
            load: loads(island.bodies[at]).map(Arc::from),
            held: held[island.touched.range(at)].to_vec(),
        };
        island.bodies.iter().zip(bodies.ask(way, ())?).for_each(|(&p, way)| all[p] = way);
    }
    model.lengths(&all)
}

/// The lengths of a model that is not set up, whose bodies have their matrices here.
pub(super) fn first_lengths<'a>(model: &'a SolvedModel, islands: &[Island]) -> Result<Lengths<'a>> {
    let (none, missing) =
        (Matrix::zeros(0, 0)?, || Error::new(Kind::Internal, "a body without stiffness is set up"));
    let of = |k: usize| {
        let island = &islands[k];
        let local = |(at, p): (usize, &usize)| {
            let body = &model.bodies[*p].body;
            Ok(Seen::Here(Local {
                stiffness: body.k().ok_or_else(missing)?,
                null_space: &none,
                soft: false,
                unit: body.without(island.unit),
                grounded: &[],
                touched: island.touched.on(at),
                dual: None,
            }))
        };
        let bodies: Vec<_> = island.bodies.iter().enumerate().map(local).collect::<Result<_>>()?;
        Ok((island, Locals::new(bodies, 1)))
    };
    lengths(model, islands.len(), &of)
}

impl Prepared {
    /// The lengths of a model that is set up.
    pub fn lengths<'a>(&self, model: &'a SolvedModel) -> Result<Lengths<'a>> {
        let islands = &self.done(model)?.islands;
        lengths(model, islands.len(), &|k| Ok((&*islands[k].island, self.locals(model, &islands[k])?)))
    }
}
