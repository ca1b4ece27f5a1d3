//! How far loads move their bodies: a length of which right-hand sides may be differences.

use std::cell::OnceCell;

use crate::body::{Locals, Seen};
use crate::certificate::{led, Beside, Couple, Coupled, Trace, Way};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::model::{Lengths, SolvedModel};
use crate::setup::given::{away_of, AwayOf};
use crate::setup::islands::Island;
use crate::setup::prepared::Prepared;

/// An island and its bodies.
type OfIsland<'b> = (&'b Island, Locals<'b>);

/// `of`: each of `count` islands.
fn lengths<'a, 'b>(
    prepared: &Prepared,
    model: &'a SolvedModel,
    count: usize,
    of: &dyn Fn(usize) -> Result<OfIsland<'b>>,
) -> Result<Lengths<'a>> {
    let (loads, mut all) = (model.loads_that_count(), vec![0.0; model.bodies.len()]);
    // what is little is so beside all bodies: a pilot may be an island
    let (mut stiffest, known) = (0.0f64, OnceCell::new());
    for k in (0..count).filter(|_| count > 1) {
        stiffest = of(k)?.1.iter().map(Seen::stiffest).fold(stiffest, f64::max);
    }
    let find = || {
        (0..count).try_fold(0.0, |most: f64, k| {
            Ok(of(k)?.1.ask(|_| Couple, ())?.iter().map(Coupled::strongest).fold(most, f64::max))
        })
    };
    let strongest = || {
        let most = known.get().map_or_else(find, |known| Ok(*known))?;
        Ok(*known.get_or_init(|| most))
    };
    let beside = (count > 1).then_some(Beside { stiffest, strongest: &strongest });
    for k in 0..count {
        let (island, bodies) = of(k)?;
        let without = |_: &Seen| f64::INFINITY;
        let trace = match beside {
            Some(all) => Trace::beside(all, &bodies, without),
            None => Trace::of(&bodies, without),
        };
        let held = led(&trace, RowKind::ALL.map(|kind| &island.members(kind).rows), &|_, _| true, 1.0)?;
        let way = |at: usize| Way {
            counts: loads(island.bodies[at]),
            held: held[island.touched.range(at)].to_vec(),
        };
        let given = prepared.loads(model, (&island.bodies, &bodies))?;
        island.bodies.iter().zip(bodies.ask(way, &given)?).for_each(|(&p, way)| all[p] = way);
    }
    model.lengths(&all)
}

impl Prepared {
    /// The lengths of a model that is not set up.
    pub(super) fn first_lengths<'a>(
        &self,
        model: &'a SolvedModel,
        islands: &[Island],
        away: &[AwayOf],
    ) -> Result<Lengths<'a>> {
        let of = |k: usize| Ok((&islands[k], islands[k].matrices(model, away_of(away, k))));
        lengths(self, model, islands.len(), &of)
    }

    /// The lengths of a model that is set up; 0 if nothing depends on them.
    pub fn lengths<'a>(&self, model: &'a SolvedModel) -> Result<Lengths<'a>> {
        let islands = &self.done(model)?.islands;
        if !model.may_contradict() && !islands.iter().any(|ready| ready.rows.some_are_parallel()) {
            return model.lengths(&vec![0.0; model.bodies.len()]);
        }
        lengths(self, model, islands.len(), &|k| Ok((&*islands[k].island, self.locals(model, &islands[k])?)))
    }
}
