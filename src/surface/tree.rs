//! The faces of a surface in boxes: nearest boxes first.

use rstar::{PointDistance, RTree, RTreeObject, AABB};

use crate::error::Result;
use crate::numbers::surface::RIM;
use crate::platform::memory::{headroom, reserved};
use crate::surface::faces::Faces;
use crate::surface::vector::Vector;

/// Bytes of a face in the tree while it is made.
const PER_FACE: usize = 128;

/// The box that contains a face, with its continuation beyond a rim.
struct FaceBox {
    low: Vector,
    high: Vector,
    face: u32,
}

impl RTreeObject for FaceBox {
    type Envelope = AABB<Vector>;

    fn envelope(&self) -> AABB<Vector> {
        AABB::from_corners(self.low, self.high)
    }
}

impl PointDistance for FaceBox {
    fn distance_2(&self, point: &Vector) -> f64 {
        let outside = |i: usize| (self.low[i] - point[i]).max(point[i] - self.high[i]).max(0.0);
        (0..3).map(|i| outside(i) * outside(i)).sum()
    }
}

pub struct Tree(RTree<FaceBox>);

impl Tree {
    pub fn new(faces: &Faces, x: &[Vector]) -> Result<Self> {
        let _room = headroom(faces.len().saturating_mul(PER_FACE), "the faces of a surface")?;
        let mut boxes = reserved(faces.len(), "the faces of a surface")?;
        boxes.extend((0..faces.len()).map(|face| face_box(faces, face, x)));
        Ok(Self(RTree::bulk_load(boxes)))
    }

    /// Faces and the squares of the distances of their boxes from x, ascending.
    pub fn near(&self, x: Vector) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.0.nearest_neighbor_iter_with_distance_2(x).map(|(found, square)| (found.face as usize, square))
    }

    /// Faces with boxes that meet this one, in no order.
    pub fn within(&self, low: Vector, high: Vector) -> impl Iterator<Item = usize> + '_ {
        self.0.locate_in_envelope_intersecting(AABB::from_corners(low, high)).map(|found| found.face as usize)
    }
}

/// Corners and sagitta; a face at a rim may extend further by the part `RIM` in each of two directions, of its corners and of its sagitta.
fn face_box(faces: &Faces, face: usize, x: &[Vector]) -> FaceBox {
    let patch = faces.patch(face, x);
    let corners = &patch.nodes()[..patch.shape.corners().len()];
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in corners {
        (0..3).for_each(|i| (low[i], high[i]) = (low[i].min(corner[i]), high[i].max(corner[i])));
    }
    let continued = (1.0 + 2.0 * RIM) * (1.0 + 2.0 * RIM) - 1.0;
    let at_rim = (0..corners.len()).any(|edge| faces.beyond(face, edge).is_none());
    let bulge = patch.sagitta();
    for i in 0..3 {
        let more = if at_rim { bulge[i] + continued * (high[i] - low[i] + bulge[i]) } else { bulge[i] };
        (low[i], high[i]) = (low[i] - more, high[i] + more);
    }
    FaceBox { low, high, face: face as u32 }
}
