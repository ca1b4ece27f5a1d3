//! Loads that no forces of the rows hold: how large their share is, on which bodies they act, and whether this is proved.

use crate::body::Kept;
use crate::certificate::Data;
use crate::constraints::{FrictionNode, RowKind};
use crate::error::{self, Error, Kind, Result};
use crate::linalg::graph::joined;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{self, norm_max, ratio, weighted_norm};
use crate::model::Accuracy;
use crate::numbers::solve::{BEYOND, LOAD_RANGE};
use crate::platform::memory::zeros;
use crate::qp::friction::unheld;
use crate::qp::Restricted;
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::friction::cones;
use crate::solve::local::{self, Left, Proof, Sizes, SizesLeft};
use crate::solve::scaled::Scaled;

/// The part of a load that the nearest forces of the rows do not hold. Bodies with such a part that are joined by
/// equality rows or by rows with a force move together: a cluster. Shares are relative to the cluster's load, |f|_{D^-1}
/// without grounded unknowns; to that of the host's body if the load of a part of it is rounding of that.
pub struct Unheld {
    /// D R c, in units of 2^p: the part not held, as a load; and R c, the motion that this part causes.
    left: Kept<local::Unheld>,
    /// c over the modes of the dual.
    pub amplitudes: Vec<f64>,
    /// The forces of the dual that leave this part.
    pub x: Vec<f64>,
    /// The largest |D R c|_{D^-1} / |f|_{D^-1} of a cluster.
    pub share: f64,
    /// The largest ratio of this kind of a single body with a load.
    pub of_body: f64,
    /// |D R c| / |D R R'f| of this cluster.
    margin: f64,
    /// Per body: its cluster, |f|_{D^-1} of the body, and the share of its cluster, 0 for a body without a part not held.
    cluster: Vec<usize>,
    loads: Vec<f64>,
    shares: Vec<f64>,
    /// Place in the island of the body with the largest part not held, in the cluster with the largest share.
    body: usize,
    /// Up to its `data` a share is rounding, and the answer without it is complete; up to `marginal` that answer is
    /// marginal; above it there is no answer, if that is proved.
    accuracy: Accuracy,
}

impl Unheld {
    /// For the forces that leave the least of the load, |D R c|_{D^-1}; the forces of rows marked in `far` are 0 (empty:
    /// no far rows).
    pub fn least(case: Case, scaled: &Scaled, far: &[bool]) -> Result<Self> {
        Self::nearest(case, scaled, far, &case.ready.dual.sizes_of_modes())
    }

    /// For the forces that leave the smallest part of each body's own load, so that rounding of a large load does not act
    /// on a body with a small one; `None` without loads.
    pub fn relative(case: Case, scaled: &Scaled, far: &[bool]) -> Result<Option<Self>> {
        let (ready, bodies) = (case.ready, case.locals()?);
        let sizes = |p: usize| Sizes { push: vec![0.0; ready.island.touched.range(p).len()] };
        let sizes = bodies.ask(sizes, &scaled.load.of)?;
        let sizes = ready.dual.of_modes(sizes.iter().map(|body| body.free));
        let most = norm_max(&sizes);
        let weights: Vec<f64> = sizes.iter().map(|size| most / size.max(LOAD_RANGE * most)).collect();
        (most > 0.0).then(|| Self::nearest(case, scaled, far, &weights)).transpose()
    }

    /// For the forces that leave the least of the resultants, each multiplied by its weight.
    fn nearest(case: Case, scaled: &Scaled, far: &[bool], weights: &[f64]) -> Result<Self> {
        let ready = case.ready;
        let qp = scaled.qp(ready, &*ready.dual);
        let is_far = |i: &usize| far.get(*i).copied().unwrap_or(false);
        let rows: Vec<usize> = (0..qp.b.len()).filter(|i| !is_far(i)).collect();
        let near = Restricted::new(qp, &rows);
        let (x, rest) = unheld(&near.qp(), &cones(ready, &scaled.gaps, &rows)?, weights)?;
        Self::of(&case.data(scaled.loads.clone())?, ready, scaled, near.spread(&x), &rest)
    }

    /// For the forces x of the dual, which leave `rest` = e - G x.
    fn of(data: &Data, ready: &Ready, scaled: &Scaled, x: Vec<f64>, rest: &[f64]) -> Result<Self> {
        let sizes_of_modes = ready.dual.sizes_of_modes();
        let amplitudes = rest.iter().zip(sizes_of_modes).map(|(e, size)| size * size * e).collect();
        let of_body = |p: usize| {
            let own = |all: &[f64]| all[ready.dual.modes_of(p)].to_vec();
            Left { rest: own(rest), resultants: own(&scaled.resultants) }
        };
        let (sizes, kept) = data.bodies.make(of_body, (&scaled.load.of, &data.loads))?;
        let of = |of: fn(&SizesLeft) -> f64| sizes.iter().map(of).collect::<Vec<f64>>();
        let (left, resultants, loads) =
            (of(|body| body.left), of(|body| body.resultants), of(|body| body.load));
        let (cluster, count) = clusters(ready, &x, &left);
        let of_cluster = |k: usize, sizes: &[f64]| {
            let own = (0..sizes.len()).filter(|&p| cluster[p] == k && left[p] > 0.0).map(|p| sizes[p]);
            weighted_norm(&own.collect::<Vec<_>>(), |_| 1.0)
        };
        let told = of(|body| body.told);
        let of_clusters: Vec<f64> =
            (0..count).map(|k| ratio(of_cluster(k, &left), of_cluster(k, &told))).collect();
        let share_of = |p: usize| if left[p] > 0.0 { of_clusters[cluster[p]] } else { 0.0 };
        let shares: Vec<f64> = (0..left.len()).map(share_of).collect();
        let worse = |best: usize, p: usize| {
            let (p_is, best_is) = ((shares[p], left[p]), (shares[best], left[best]));
            if p_is > best_is {
                p
            } else {
                best
            }
        };
        let body = (0..left.len()).fold(0, worse);
        let worst = cluster.get(body).copied().unwrap_or(0);
        let margin = ratio(of_cluster(worst, &left), of_cluster(worst, &resultants)).min(1.0);
        let share = shares.get(body).copied().unwrap_or(0.0);
        let loaded = (0..left.len()).filter(|&p| loads[p] > 0.0);
        let of_body = loaded.map(|p| left[p] / loads[p]).fold(0.0, f64::max);
        Ok(Self {
            left: kept,
            amplitudes,
            x,
            share,
            of_body,
            margin,
            cluster,
            loads,
            shares,
            body,
            accuracy: Accuracy { data: data.accuracy },
        })
    }

    /// The load to subtract from the loads; none if neither `share` nor the share of a single body exceeds rounding:
    /// then only the resultants change.
    pub fn load_to_take(&self, share: f64) -> Option<&Kept<local::Unheld>> {
        (share.max(self.of_body) > self.accuracy.data).then_some(&self.left)
    }

    /// Small enough to be rounding or marginal.
    pub fn is_little(&self) -> bool {
        self.share <= self.accuracy.marginal()
    }

    /// The error with a motion v = R c which proves that nothing holds the load: by the data of the host K does not
    /// strain by v, and f'v is more than the work of forces `BEYOND` times the load against the rows that resist. v moves
    /// the cluster with the largest share, or all bodies with more than a small share, or all: loads of other bodies do
    /// not count. Rows marked in `far` have no forces.
    pub fn proof(&self, case: Case, scaled: &Scaled, far: &[bool]) -> Result<Option<Error>> {
        if self.is_little() {
            return Ok(None);
        }
        let (ready, island, bodies) = (case.ready, case.island(), case.locals()?);
        let worst = self.cluster[self.body];
        let moves: [&(dyn Fn(usize) -> bool + Sync); 3] =
            [&|p| self.cluster[p] == worst, &|p| self.shares[p] > self.accuracy.marginal(), &|p| {
                self.shares[p] > 0.0
            }];
        for moves in moves {
            let prove = |p: usize| Proof { moves: moves(p) };
            let (answers, own) = bodies.make(prove, (&scaled.load.of, &self.left))?;
            let loads: Vec<f64> =
                (0..self.loads.len()).filter(|&p| moves(p)).map(|p| self.loads[p]).collect();
            let size = weighted_norm(&loads, |_| 1.0);
            let mut work = Twofold::default();
            answers.iter().for_each(|body| work.add_twofold(body.work));
            let at: Vec<f64> = answers.iter().flat_map(|body| &body.at_rows).copied().collect();
            let strains: Vec<f64> = answers.iter().map(|body| body.strain).collect();
            let strain = weighted_norm(&strains, |_| 1.0) / island.unit;
            let resisted = BEYOND * (resistance(ready, &at) + strain);
            if work.value() - bounded(ready, &at) > size * resisted {
                let mut v = zeros(case.model.sizes().dofs, "a motion")?;
                island.scatter(case.model, bodies.bring(&own)?, &mut v);
                let moved: Vec<bool> = answers.iter().map(|body| body.moved).collect();
                let why = self.why(case, (scaled, far), (&moved, &at));
                return Ok(Some(self.named(case, v, answers[self.body].is_stiff, &why)));
            }
        }
        Ok(None)
    }

    /// What the rows on the bodies that have `moved` by v do about it, v `at` the rows.
    fn why(&self, case: Case, (scaled, far): (&Scaled, &[bool]), (moved, at): (&[bool], &[f64])) -> String {
        let (ready, island) = (case.ready, case.island());
        let touching: Vec<usize> = (0..ready.rows.tangential)
            .filter(|&i| {
                let (rows, k) = island.row(i);
                rows.matrix.row(k).any(|(j, b)| b != 0.0 && moved[island.touched.body_of(j)])
            })
            .collect();
        let rubs = |node: &&FrictionNode| node.has_friction() && slip(ready, node, at) > 0.0;
        let rubbing = island.friction.nodes.iter().filter(rubs).count();
        let opened =
            touching.iter().filter(|&&i| i < ready.rows.contact && along(ready, i, at) < 0.0).count();
        if rubbing > 0 {
            // what interrupts this must not take the proof with it
            let held = 100.0 * self.held_by_friction(case, scaled, far).unwrap_or(f64::NAN);
            let told = format!("{held:.3}");
            return match told.as_str() {
                "0.000" => format!("; nothing presses the {rubbing} nodes with friction that would resist"),
                _ if held < 100.0 => format!(
                    "; the friction of {rubbing} nodes gives way: it can hold {told} % of the load along the slide"
                ),
                _ => format!("; the friction of {rubbing} nodes gives way"),
            };
        }
        match touching.len() {
            0 => "; no row with a finite gap touches what moves".to_owned(),
            rows if rows == opened => format!(
                "; the motion opens every contact row that touches what moves ({rows}): if the load is to press there, \
                 the signs of these rows (their normals) are the wrong way round"
            ),
            _ => String::new(),
        }
    }

    /// The part of the load along the slide that friction can hold, NaN if nothing slides: v of the proof also lifts, which would leave
    /// Coulomb's friction without pressure. The slide is the motion that the load drives without friction, and the pressure that of the
    /// forces which then hold the rest of the load.
    fn held_by_friction(&self, case: Case, scaled: &Scaled, far: &[bool]) -> Result<f64> {
        let (ready, bodies) = (case.ready, case.locals()?);
        let is_far = |group: usize| far.get(group).copied().unwrap_or(false);
        let leaders = ready.rows.scaling.grouping.leaders.iter().enumerate();
        let smooth: Vec<bool> =
            leaders.map(|(group, &row)| row >= ready.rows.tangential || is_far(group)).collect();
        let slide = Self::least(case, scaled, &smooth)?;
        let moves = |p: usize| slide.cluster[p] == slide.cluster[self.body] && slide.shares[p] > 0.0;
        let (answers, _) =
            bodies.make(|p: usize| Proof { moves: moves(p) }, (&scaled.load.of, &slide.left))?;
        let at: Vec<f64> = answers.iter().flat_map(|body| &body.at_rows).copied().collect();
        let mut work = Twofold::default();
        answers.iter().for_each(|body| work.add_twofold(body.work));
        let held = |node: &FrictionNode| {
            let pressed =
                node.normal.map_or(0.0, |row| node.coefficient * pressure(ready, scaled, (&slide.x, row)));
            (node.bound + pressed) * slip(ready, node, &at)
        };
        let held: f64 = ready.island.friction.nodes.iter().map(held).sum();
        Ok(held / ready.island.unit / work.value())
    }

    /// `stiff`: K resists the unknown of the body that moves fastest.
    fn named(&self, case: Case, mut v: Vec<f64>, stiff: bool, why: &str) -> Error {
        let body = case.island().bodies[self.body];
        let range = case.model.range(body);
        let fastest = range.start + vector::fastest(&v[range.clone()]);
        let sense = if v[fastest] > 0.0 { "positive" } else { "negative" };
        let what = format!(
            "the load moves the body and no contact force can hold it (|resultant| / |load| = {:.1e} of the bodies that move \
             together); the motion is fastest at this dof, in the {sense} direction{why}{}",
            self.share,
            if stiff { "" } else { "; this unknown has no stiffness: no element resists it" }
        );
        let largest = norm_max(&v);
        v.iter_mut().for_each(|v| *v /= largest);
        let dof = fastest - range.start;
        let limit = self.accuracy.marginal();
        let refusal = Error::new(Kind::LoadNotHeld, what).body(body).dof(dof).value(self.share).limit(limit);
        refusal.proved_by(error::Proof::Motion { margin: self.margin, v })
    }
}

/// Cluster of each body, and the number of clusters.
fn clusters(ready: &Ready, x: &[f64], left: &[f64]) -> (Vec<usize>, usize) {
    let (rows, island) = (&ready.rows, &ready.island);
    let forces = rows.scaling.decoupling.solve_transposed(x.to_vec());
    let joins = (0..forces.len()).filter(|&i| forces[i] != 0.0 || rows.kind(i) == RowKind::Equality);
    let bodies = joins.map(|i| {
        let touched = rows.scaled.row(i).map(|(j, _)| island.touched.body_of(j));
        touched.filter(|&p| left[p] > 0.0)
    });
    joined(left.len(), bodies)
}

/// `|(S (B v + mu |T v|))_+, S_H H v|` by the rows of the host, v where rows touch: forces within their cones do no more work.
pub fn resistance(ready: &Ready, v: &[f64]) -> f64 {
    let rows = &ready.rows;
    let mut all: Vec<f64> = (0..rows.tangential).map(|i| along(ready, i, v)).collect();
    for node in &ready.island.friction.nodes {
        node.normal.iter().for_each(|&row| all[row] += node.coefficient * slip(ready, node, v));
    }
    all[..rows.contact].iter_mut().for_each(|resists| *resists = resists.max(0.0));
    all.iter_mut().zip(&rows.scaling.scale).for_each(|(resists, s)| *resists *= s);
    weighted_norm(&all, |_| 1.0)
}

/// `sum bound |T v|` in units of 2^p: the largest work of the friction bounds.
fn bounded(ready: &Ready, v: &[f64]) -> f64 {
    let nodes = ready.island.friction.nodes.iter();
    let work = nodes.map(|node| if node.bound > 0.0 { node.bound * slip(ready, node, v) } else { 0.0 });
    work.sum::<f64>() / ready.island.unit
}

/// Force of a contact row, its share of that of its group in x; 0 if it carries none.
fn pressure(ready: &Ready, scaled: &Scaled, (x, row): (&[f64], usize)) -> f64 {
    let (scaling, gaps) = (&ready.rows.scaling, &scaled.gaps);
    let group = scaling.grouping.member[row].map(|(group, _)| group).filter(|&group| gaps.bounded[group]);
    group.map_or(0.0, |group| x[group] * scaling.force_of(group, row) * gaps.share[row])
}

/// `|T v|` of a node.
fn slip(ready: &Ready, node: &FrictionNode, v: &[f64]) -> f64 {
    let slips: Vec<f64> = node.rows().map(|row| along(ready, ready.rows.tangential + row, v)).collect();
    weighted_norm(&slips, |_| 1.0)
}

/// `b v` of a row of the stack.
fn along(ready: &Ready, i: usize, v: &[f64]) -> f64 {
    let ((rows, k), mut sum) = (ready.island.row(i), Twofold::default());
    rows.matrix.row(k).for_each(|(j, b)| sum.add_product(b, v[j]));
    sum.value()
}
