//! An island with bodies that are cut, in terms of the host's bodies: its answers are certified with the bodies and rows of
//! the host. Parts of other bodies are judged each for itself, as in all islands.

mod null_space;

use std::ops::Range;
use std::sync::Arc;

use crate::body::{grounded, GeneralizedInverse, Kept, Local, Locals, Seen};
use crate::certificate::{certify, Candidate, Data, Judgement, Load, LoadOf, LoadOfWhole};
use crate::constraints::{RowKind, RowSet, Touched};
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::power_of_two_below;
use crate::linalg::{Csr, Matrix};
use crate::model::{Parts, SolvedModel};
use crate::platform::memory::{copied, reserved, zeros};
use crate::platform::threads;
use crate::setup::islands::{Island, Members, Nodes};
use null_space::null_space;

const WHAT: &str = "bodies that are cut";

/// The bodies of an island, each with all its pieces.
pub struct Whole {
    /// Bodies and rows with the numbers of the host, over the touched unknowns of the bodies that are cut and of the other parts.
    pub island: Island,
    bodies: Vec<WholeBody>,
    /// For every part of the cut island: its body in `island`.
    pub body_of: Vec<usize>,
    /// For every unknown of the pieces: its unknown in `island`, and its weight there.
    place: Vec<(usize, f64)>,
}

/// Data of a body for the certificate.
struct WholeBody {
    null_space: Basis,
    grounded: Arc<[u32]>,
    soft: bool,
    /// The part that it is, if it is not cut.
    part: Option<usize>,
}

enum Basis {
    /// K+ of a body that is not cut.
    Known(Arc<GeneralizedInverse>),
    Found(Matrix),
}

impl Basis {
    fn vectors(&self) -> Result<&Matrix> {
        match self {
            Self::Known(kplus) => kplus.null_space(),
            Self::Found(vectors) => Ok(vectors),
        }
    }
}

/// What has been made of parts.
pub struct OfParts<'a> {
    pub kplus: &'a (dyn Fn(usize) -> Result<&'a Arc<GeneralizedInverse>> + Sync),
    /// Grounded unknowns.
    pub grounded: &'a (dyn Fn(usize) -> Result<Arc<[u32]>> + Sync),
}

impl Whole {
    /// None for an island without pieces.
    pub fn of(model: &SolvedModel, cut: &Island, of_parts: &OfParts) -> Result<Option<Self>> {
        let Some(parts) = model.parts.as_ref() else { return Ok(None) };
        if !cut.bodies.iter().any(|&part| model.is_piece(part)) {
            return Ok(None);
        }
        let (mut bodies, mut ranges): (Vec<usize>, Vec<Range<usize>>) = Default::default();
        let (mut body_of, mut place) = (reserved(cut.bodies.len(), WHAT)?, reserved(cut.unknowns(), WHAT)?);
        let (mut part_of, mut end) = (Vec::new(), 0);
        for (&part, own) in cut.bodies.iter().zip(&*cut.ranges) {
            let (body, is_cut) = (parts.parts[part].body, model.is_piece(part));
            if !is_cut || bodies.last() != Some(&body) {
                let unknowns = if is_cut { parts.offsets[body + 1] - parts.offsets[body] } else { own.len() };
                bodies.push(body);
                part_of.push((!is_cut).then_some(part));
                ranges.push(end..end + unknowns);
                end += unknowns;
            }
            let start = ranges.last().map_or(0, |range| range.start);
            body_of.push(bodies.len() - 1);
            place.extend((0..own.len()).map(|i| {
                let (dof, share) = if is_cut { parts.place(part, i) } else { (i, 1.0) };
                (start + dof, share)
            }));
        }
        // unknowns of `island` where rows touch pieces
        let at = |j: usize| {
            let part = cut.touched.body_of(j);
            place[cut.ranges[part].start + cut.touched.dof(j)].0
        };
        let of_host = |kind: RowKind| {
            let is_of_host = move |number: &usize| kind != RowKind::Equality || *number < parts.judged();
            cut.members(kind).numbers.iter().take_while(move |number| is_of_host(number)).count()
        };
        let columns = RowKind::ALL.into_iter().flat_map(|kind| {
            let matrix = &cut.members(kind).rows.matrix;
            (0..of_host(kind)).flat_map(|i| matrix.row(i)).map(|(j, _)| at(j))
        });
        let touched = Arc::new(Touched::of(&ranges, columns));
        let column = |j: usize| {
            let unknown = at(j);
            let body = ranges.partition_point(|range: &Range<usize>| range.end <= unknown);
            touched.place(body, unknown - ranges[body].start).unwrap_or_default()
        };
        let of_host = |kind| members(cut.members(kind), of_host(kind), touched.len(), column);
        let (contact, equalities) = (of_host(RowKind::Inequality)?, of_host(RowKind::Equality)?);
        let stiffness = |(body, part): (&usize, &Option<usize>)| match (&parts.assembled[*body], part) {
            (Some(k), _) => k.largest_diagonal(),
            (None, part) => part.and_then(|p| model.bodies[p].body.k()).map_or(0.0, |k| k.largest_diagonal()),
        };
        let unit = power_of_two_below(bodies.iter().zip(&part_of).map(stiffness).fold(0.0, f64::max));
        let Nodes { numbers, nodes, .. } = &*cut.friction;
        let friction = Arc::new(Nodes {
            numbers: numbers.clone(),
            nodes: nodes.clone(),
            tangential: of_host(RowKind::Tangential)?,
        });
        let equalities = Arc::new(equalities);
        let (bodies, ranges) = (bodies.into(), Arc::new(ranges));
        let island = Island { bodies, ranges, touched, contact, equalities, friction, unit };
        let is_away = |part: usize| (of_parts.kplus)(part).is_ok_and(|kplus| kplus.on_caller());
        let on_caller = |k: usize| parts.of(island.bodies[k]).any(is_away);
        let bodies = threads::run_apart(model.threads(), island.bodies.len(), on_caller, |k| {
            let (body, part) = (island.bodies[k], part_of[k]);
            let made = whole_body(model, parts, (body, part), of_parts);
            made.map_err(|e| e.body(part.unwrap_or(parts.first[body])))
        })?;
        Ok(Some(Self { island, bodies, body_of, place }))
    }

    /// The judgement of an answer of the pieces by bodies and rows of the host; `data`: the pieces with their loads.
    pub fn judged(&self, model: &SolvedModel, data: &Data, answer: Candidate) -> Result<Judgement> {
        let (u, loads) = (self.mean(&data.bodies, answer.u)?, self.loads(data)?);
        let mu = &answer.mu[..self.island.equalities.numbers.len()];
        let data = self.data(model, loads)?;
        let at_rows = data.bodies.at_rows(&u);
        let u = Kept::of(u);
        certify(&data, Candidate { u: &u, at_rows: &at_rows, mu, ..answer })
    }

    /// The weighted mean of the copies of every unknown.
    fn mean(&self, pieces: &Locals, v: &Kept) -> Result<Vec<Vec<f64>>> {
        self.gathered(&pieces.bring(v)?, |share| share)
    }

    /// The sum of the loads of the copies of every unknown.
    fn loads(&self, data: &Data) -> Result<Vec<Vec<f64>>> {
        self.gathered(&data.bodies.ask(|_| LoadOf, &data.loads)?, |_| 1.0)
    }

    fn gathered<O: AsRef<[f64]>>(&self, of_pieces: &[O], weight: fn(f64) -> f64) -> Result<Vec<Vec<f64>>> {
        let mut all = zeros(self.island.unknowns(), WHAT)?;
        let of_pieces = of_pieces.iter().flat_map(|own| own.as_ref());
        self.place.iter().zip(of_pieces).for_each(|((j, share), v)| all[*j] += weight(*share) * v);
        self.island.ranges.iter().map(|range| copied(&all[range.clone()], WHAT)).collect()
    }

    /// The data of the island for the certificate.
    fn data<'a>(&'a self, model: &'a SolvedModel, loads: Vec<Vec<f64>>) -> Result<Data<'a>> {
        let missing = || Error::new(Kind::State, "a body has not been set up");
        let parts = model.parts.as_ref().ok_or_else(missing)?;
        let mut bodies = reserved(self.bodies.len(), WHAT)?;
        for (k, (&body, own)) in self.island.bodies.iter().zip(&self.bodies).enumerate() {
            let stiffness = match (&parts.assembled[body], own.part) {
                (Some(k), _) => Some(crate::body::Stiffness::Assembled(k)),
                (None, Some(part)) => model.bodies[part].body.k(),
                (None, None) => None,
            };
            let stiffness = stiffness.ok_or_else(missing)?;
            let largest = stiffness.largest_diagonal();
            bodies.push(Seen::Here(Local {
                stiffness,
                null_space: own.null_space.vectors()?,
                said: None,
                soft: own.soft,
                unit: if largest > 0.0 { power_of_two_below(largest) } else { self.island.unit },
                grounded: &own.grounded,
                touched: self.island.touched.on(k),
                dual: None,
            }));
        }
        let load = |own: Vec<f64>| Load { own: Some(own.into()), whole: LoadOfWhole::default() };
        Ok(Data {
            bodies: Locals::new(bodies, model.threads()),
            loads: Kept::of(loads.into_iter().map(load).collect()),
            touched: &self.island.touched,
            contact: &self.island.contact.rows,
            equalities: &self.island.equalities.rows,
            tangential: &self.island.friction.tangential.rows,
            nodes: &self.island.friction.nodes,
            limit: model.settings.certificate_tolerance,
            accuracy: model.settings.data_accuracy,
            unit: None,
        })
    }

    /// The null space of a body of the host, n x r.
    pub fn null_space(&self, body: usize) -> Option<&Matrix> {
        let at = self.island.bodies.binary_search(&body).ok()?;
        self.bodies[at].null_space.vectors().ok()
    }

    /// `alpha = R'D u / unit` of a body of the host, r: u is `R alpha` plus a motion normal to R.
    pub fn amplitudes(&self, model: &SolvedModel, body: usize, u: &[f64]) -> Vec<f64> {
        let (Some(vectors), Some(parts)) = (self.null_space(body), &model.parts) else { return Vec::new() };
        let Some(k) = &parts.assembled[body] else { return Vec::new() };
        let unit = power_of_two_below(k.largest_diagonal());
        let weighed: Vec<f64> = u.iter().enumerate().map(|(i, u)| k.metric(i, unit) / unit * u).collect();
        vectors.mul_transposed(&weighed)
    }
}

/// The first `count` rows, which are those of the host, over the touched unknowns of its bodies.
fn members(cut: &Members, count: usize, columns: usize, column: impl Fn(usize) -> usize) -> Result<Members> {
    let numbers = cut.numbers[..count].to_vec();
    let mut matrix = Csr::empty(columns);
    for i in 0..count {
        let mut entries: Vec<(usize, f64)> = cut.rows.matrix.row(i).map(|(j, v)| (column(j), v)).collect();
        entries.sort_unstable_by_key(|entry| entry.0);
        matrix.push_row(entries);
    }
    let rhs = copied(&cut.rows.rhs[..count], WHAT)?;
    let compliance = copied(&cut.rows.compliance[..count], WHAT)?.into();
    let rows = RowSet { matrix: Arc::new(matrix), rhs, compliance, taken: cut.rows.taken.clone() };
    Ok(Members { rows, numbers })
}

fn whole_body(
    model: &SolvedModel,
    parts: &Parts,
    (body, part): (usize, Option<usize>),
    of_parts: &OfParts,
) -> Result<WholeBody> {
    let missing = || Error::new(Kind::State, "a body has not been set up");
    let Some(k) = &parts.assembled[body] else {
        let part = part.ok_or_else(missing)?;
        let (kplus, grounded) = ((of_parts.kplus)(part)?, (of_parts.grounded)(part)?);
        let soft = kplus.is_soft();
        let null_space = match kplus.elsewhere() {
            None => Basis::Known(Arc::clone(kplus)),
            Some(_) => Basis::Found(kplus.bring_null_space()?.into_owned()),
        };
        return Ok(WholeBody { null_space, grounded, soft, part: Some(part) });
    };
    let mut soft = false;
    let mut bases = reserved(parts.of(body).len(), WHAT)?;
    for part in parts.of(body) {
        let kplus = (of_parts.kplus)(part)?;
        soft |= kplus.is_soft();
        bases.push(kplus.free_motions()?);
    }
    let vectors = null_space(model, parts, body, &bases)?;
    let grounded = grounded(crate::body::Stiffness::Assembled(k))?.into();
    Ok(WholeBody { null_space: Basis::Found(vectors), grounded, soft, part: None })
}
