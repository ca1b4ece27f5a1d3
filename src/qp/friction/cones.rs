//! The admissible sets of forces: free rows, half lines, and nodes with a disc or a cone of friction, with their
//! projections.

use crate::error::{Error, Kind, Result};

/// One contact node. Without tangential rows it is a half line: contact without friction. Nodes may share a normal row, of which each
/// has the tangential forces that its own mu and bound allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Its normal row, n >= 0; none: only the bound limits the tangential force.
    pub normal: Option<usize>,
    tangents: [usize; 2],
    /// Number of tangential rows: 0, 1 or 2.
    count: usize,
    /// The normal row is that of the node before.
    pub follows: bool,
    /// Places from the coordinate of the normal row to the first tangential one.
    pub behind: usize,
    /// Coefficient and bound of friction in scaled units, `|t| <= bound + mu n`.
    pub mu: f64,
    pub bound: f64,
}

/// Forces of one node: n, 0 without a normal row, and t, 0 without a tangential row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    pub normal: f64,
    pub tangential: [f64; 2],
}

/// Where the orthogonal projection on a cone ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// The force is in the set and does not change.
    Inside,
    /// On the surface `|t| = bound + mu n`, n > 0: direction of t, and `ratio` of the new to the old length of t.
    Surface { along: [f64; 2], ratio: f64 },
    /// n = 0, |t| < bound, t unchanged.
    Open,
    /// n = 0, |t| = bound.
    Rim { along: [f64; 2], ratio: f64 },
}

impl Node {
    pub fn new(normal: Option<usize>, tangents: &[usize], mu: f64, bound: f64) -> Result<Self> {
        let wrong = |what: &str| Err(Error::new(Kind::Argument("nodes"), what));
        if tangents.len() > 2 {
            return wrong("a node of friction has at most two tangential rows");
        }
        if !((0.0..f64::INFINITY).contains(&mu) && bound >= 0.0) {
            return wrong("a coefficient or bound of friction is negative or not a number");
        }
        if mu > 0.0 && normal.is_none() && !tangents.is_empty() {
            return wrong("a coefficient of friction needs a normal row");
        }
        let mut rows = [0; 2];
        rows[..tangents.len()].copy_from_slice(tangents);
        Ok(Self { normal, tangents: rows, count: tangents.len(), follows: false, behind: 1, mu, bound })
    }

    pub fn tangents(&self) -> &[usize] {
        &self.tangents[..self.count]
    }

    /// Its normal row, unless the node before has it already.
    pub fn own_normal(&self) -> Option<usize> {
        self.normal.filter(|_| !self.follows)
    }

    pub fn of(&self, x: &[f64]) -> Force {
        let mut tangential = [0.0; 2];
        self.tangents().iter().zip(&mut tangential).for_each(|(&row, t)| *t = x[row]);
        Force { normal: self.normal.map_or(0.0, |row| x[row]), tangential }
    }

    pub fn put(&self, force: Force, x: &mut [f64]) {
        self.normal.into_iter().for_each(|row| x[row] = force.normal);
        self.tangents().iter().zip(force.tangential).for_each(|(&row, t)| x[row] = t);
    }

    /// `bound + mu n`
    pub fn limit(&self, normal: f64) -> f64 {
        if normal > 0.0 && self.normal.is_some() {
            self.bound + self.mu * normal
        } else {
            self.bound
        }
    }

    /// PI, the nearest point of the cone.
    pub fn nearest(&self, force: Force) -> (Force, Place) {
        self.beside(force, nearest_normal(&[*self], |_| force))
    }

    /// The nearest force with this normal part, and where it is.
    fn beside(&self, force: Force, normal: f64) -> (Force, Place) {
        let (tangential, limit) = (force.tangential, self.limit(normal));
        let length = length(tangential);
        if length <= limit {
            let place = if force.normal >= 0.0 || normal > 0.0 { Place::Inside } else { Place::Open };
            return (Force { normal, tangential }, place);
        }
        let (along, ratio) = (direction(tangential), limit / length);
        let place = if normal > 0.0 { Place::Surface { along, ratio } } else { Place::Rim { along, ratio } };
        (Force { normal, tangential: along.map(|u| limit * u) }, place)
    }

    /// NAT, the law of Coulomb: `(n+, min(|t|, b) t/|t|)`, `b = bound + mu n+`.
    pub fn natural(&self, trial: Force) -> Force {
        let (normal, length) = (trial.normal.max(0.0), length(trial.tangential));
        let limit = self.limit(normal);
        let by = if length > limit { limit / length } else { 1.0 };
        Force { normal, tangential: trial.tangential.map(|t| by * t) }
    }
}

/// The n >= 0 of least `(n - v_n)^2 + sum (|t_i| - bound_i - mu_i n)_+^2` over nodes that share it. Its derivative is concave:
/// Newton's steps from below do not pass the zero, and end once no further node comes within its limit.
fn nearest_normal(nodes: &[Node], v: impl Fn(&Node) -> Force) -> f64 {
    let given = v(&nodes[0]).normal;
    let mut normal = given.max(0.0);
    loop {
        let (mut top, mut bottom) = (given, 1.0);
        for node in nodes {
            let length = length(v(node).tangential);
            if length > node.limit(normal) {
                top += node.mu * (length - node.bound);
                bottom += node.mu * node.mu;
            }
        }
        let next = top / bottom;
        if !(next > normal) {
            return normal;
        }
        normal = next;
    }
}

pub fn length(tangential: [f64; 2]) -> f64 {
    tangential[0].hypot(tangential[1])
}

/// `t / |t|`; the first direction if t = 0.
pub fn direction(tangential: [f64; 2]) -> [f64; 2] {
    let length = length(tangential);
    if length > 0.0 {
        tangential.map(|t| t / length)
    } else {
        [1.0, 0.0]
    }
}

/// The sets of all m rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Cones {
    order: usize,
    nodes: Vec<Node>,
    /// Rows that belong to no node: free.
    free: Vec<usize>,
}

impl Cones {
    /// Nodes that share a normal row come one after the other.
    pub fn new(order: usize, mut nodes: Vec<Node>) -> Result<Self> {
        for k in 0..nodes.len() {
            let before = k.checked_sub(1).map(|before| nodes[before]);
            let shared = before.filter(|before| before.normal.is_some() && before.normal == nodes[k].normal);
            nodes[k].follows = shared.is_some();
            nodes[k].behind = shared.map_or(1, |before| before.behind + before.count);
        }
        let mut taken = vec![false; order];
        let rows =
            nodes.iter().flat_map(|node| node.own_normal().into_iter().chain(node.tangents().to_vec()));
        for row in rows {
            match taken.get_mut(row) {
                Some(taken) if !*taken => *taken = true,
                _ => {
                    let what = format!("row {row} of a node does not exist, or occurs more than once");
                    return Err(Error::new(Kind::Argument("nodes"), what));
                }
            }
        }
        let free = (0..order).filter(|&row| !taken[row]).collect();
        Ok(Self { order, nodes, free })
    }

    /// Half lines of these rows, without friction.
    pub fn half_lines(bounded: &[bool]) -> Result<Self> {
        let rows = (0..bounded.len()).filter(|&row| bounded[row]);
        Self::new(bounded.len(), rows.map(|row| Node::new(Some(row), &[], 0.0, 0.0)).collect::<Result<_>>()?)
    }

    /// No node has a tangential row.
    pub fn are_half_lines(&self) -> bool {
        self.nodes.iter().all(|node| node.count == 0)
    }

    /// m
    pub fn order(&self) -> usize {
        self.order
    }

    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// The nodes by their normal rows.
    pub fn groups(&self) -> impl Iterator<Item = &[Node]> {
        self.nodes.chunk_by(|_, next| next.follows)
    }

    /// PI, the nearest point of all cones, and where it is at each node.
    pub fn nearest(&self, v: &[f64]) -> (Vec<f64>, Vec<Place>) {
        let (mut point, mut places) = (v.to_vec(), Vec::with_capacity(self.nodes.len()));
        for nodes in self.groups() {
            let normal = nearest_normal(nodes, |node| node.of(v));
            for node in nodes {
                let (force, place) = node.beside(node.of(v), normal);
                node.put(force, &mut point);
                places.push(place);
            }
        }
        (point, places)
    }

    /// These sets with all coefficients multiplied by `by`.
    pub fn wider(&self, by: f64) -> Self {
        let nodes = self.nodes.iter().map(|node| Node { mu: by * node.mu, ..*node }).collect();
        Self { nodes, free: self.free.clone(), order: self.order }
    }

    /// `x - NAT(x - rho r)` on the nodes, `rho r` on free rows: zero exactly if the laws hold.
    pub fn law(&self, x: &[f64], r: &[f64], rho: f64) -> Vec<f64> {
        let trial: Vec<f64> = x.iter().zip(r).map(|(x, r)| x - rho * r).collect();
        let mut law: Vec<f64> = r.iter().map(|r| rho * r).collect();
        for node in &self.nodes {
            let (now, natural) = (node.of(x), node.natural(node.of(&trial)));
            let tangential = [0, 1].map(|k| now.tangential[k] - natural.tangential[k]);
            node.put(Force { normal: now.normal - natural.normal, tangential }, &mut law);
        }
        law
    }
}
