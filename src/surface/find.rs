//! The partner of every slave node: the nearest foot that may be believed.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::numbers::surface::EQUAL;
use crate::platform::interrupt::check;
use crate::platform::threads::run;
use crate::surface::faces::NONE;
use crate::surface::foot::{Foot, Node, Placed};
use crate::surface::rigid::{Rigid, RigidFoot};
use crate::surface::tree::Tree;
use crate::surface::vector::{dot, largest, Vector};

/// Which feet are believed.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// Largest |g|, length.
    pub distance: f64,
    /// Largest penetration -g, length.
    pub depth: f64,
    /// Largest cosine between the outward normals of slave and master.
    pub cosine: f64,
}

/// What slave nodes may meet.
pub enum Master<'a> {
    Faces(Placed<'a>, Tree),
    Rigid(&'a Rigid),
}

/// What a slave node has met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Partner {
    Face(Foot),
    Rigid(RigidFoot),
}

impl Partner {
    pub fn gap(&self) -> f64 {
        match self {
            Self::Face(Foot { gap, .. }) | Self::Rigid(RigidFoot { gap, .. }) => *gap,
        }
    }

    /// The master's outward normal.
    pub fn normal(&self) -> Vector {
        match self {
            Self::Face(Foot { normal, .. }) | Self::Rigid(RigidFoot { normal, .. }) => *normal,
        }
    }

    /// The line from foot to node is not the normal: the node is at the foot on an edge.
    pub fn is_askew(&self) -> bool {
        matches!(self, Self::Face(foot) if foot.distance != foot.gap.abs())
    }
}

/// Nodes of one task.
const TOGETHER: usize = 512;

/// The partners of the slave nodes at `x`, in their order. `normals`: outward unit normals, 0 for nodes that have none, as those of clouds.
/// `kept`: the faces that nodes keep, `NONE` for none; those that they keep from now on.
pub fn find(
    threads: usize,
    master: &Master,
    rule: &Rule,
    nodes: &[(Vector, Vector)],
    kept: &mut [u32],
) -> Result<Vec<Option<Partner>>> {
    let of_task = run(threads, nodes.len().div_ceil(TOGETHER), |task| {
        check()?;
        let own = TOGETHER * task..nodes.len().min(TOGETHER * (task + 1));
        Ok(own.map(|k| master.partner(rule, nodes[k], kept[k])).collect::<Vec<_>>())
    })?;
    let found: Vec<_> = of_task.concat();
    for (kept, partner) in kept.iter_mut().zip(&found) {
        *kept = match partner {
            Some(Partner::Face(foot)) if foot.is_inside => foot.face as u32,
            _ => NONE,
        };
    }
    Ok(found)
}

impl Master<'_> {
    fn partner(&self, rule: &Rule, (x, normal): (Vector, Vector), kept: u32) -> Option<Partner> {
        let node = Node { x, normal, cosine: rule.cosine };
        match self {
            Self::Faces(placed, tree) => {
                let may = |foot: &Foot| rule.allows(foot.gap, foot.distance) && node.faces(foot.normal);
                let kept =
                    (kept != NONE).then(|| placed.kept_foot(kept as usize, &node)).flatten().filter(may);
                kept.or_else(|| nearest(placed, tree, &node, rule.distance, may)).map(Partner::Face)
            }
            Self::Rigid(rigid) => {
                let foot = rigid.foot(x)?;
                let may = rule.allows(foot.gap, foot.gap.abs()) && node.faces(foot.normal);
                may.then_some(Partner::Rigid(foot))
            }
        }
    }
}

/// Which of the nodes could have another partner, whose direction differs by more than 45 degrees from that of their own: two walls of one
/// surface need two surfaces.
pub fn between_walls(
    threads: usize,
    placed: &Placed,
    tree: &Tree,
    rule: &Rule,
    nodes: &[(Vector, Vector)],
    partners: &[Option<Partner>],
) -> Result<Vec<bool>> {
    let has_other = |k: usize| {
        let ((x, normal), Some(own)) = (nodes[k], &partners[k]) else { return false };
        let node = Node { x, normal, cosine: rule.cosine };
        let is_other = |foot: &Foot| {
            let may = rule.allows(foot.gap, foot.distance) && node.faces(foot.normal);
            may && dot(foot.normal, own.normal()) < FRAC_1_SQRT_2
        };
        let near = tree.near(x).take_while(|(_, square)| square.sqrt() <= rule.distance);
        near.filter_map(|(face, _)| placed.foot(face, &node)).any(|foot| is_other(&foot))
    };
    let of_task = run(threads, nodes.len().div_ceil(TOGETHER), |task| {
        check()?;
        Ok((TOGETHER * task..nodes.len().min(TOGETHER * (task + 1))).map(has_other).collect::<Vec<_>>())
    })?;
    Ok(of_task.concat())
}

impl Rule {
    fn allows(&self, gap: f64, distance: f64) -> bool {
        distance <= self.distance && gap >= -self.depth
    }
}

/// The nearest foot that `may` be; of equal distances that of the lowest face.
fn nearest(
    placed: &Placed,
    tree: &Tree,
    node: &Node,
    distance: f64,
    may: impl Fn(&Foot) -> bool,
) -> Option<Foot> {
    let (mut found, mut least): (Vec<Foot>, f64) = (Vec::new(), distance);
    let rounding = NOISE * largest(node.x);
    let equal = |least: f64| least + EQUAL * least + rounding;
    for (face, square) in tree.near(node.x) {
        if square.sqrt() > equal(least) {
            break;
        }
        if let Some(foot) = placed.foot(face, node).filter(&may) {
            least = least.min(foot.distance);
            found.push(foot);
        }
    }
    found.into_iter().filter(|foot| foot.distance <= equal(least)).min_by_key(|foot| foot.face)
}
