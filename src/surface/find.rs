//! The partner of every slave node: the nearest foot that may be believed.

use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::numbers::surface::EQUAL;
use crate::platform::interrupt::check;
use crate::platform::threads::run;
use crate::surface::faces::NONE;
use crate::surface::foot::{Foot, Node, Placed};
use crate::surface::rigid::{Rigid, RigidFoot};
use crate::surface::tree::Tree;
use crate::surface::vector::{largest, Vector};

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
