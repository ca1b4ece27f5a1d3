//! What holds where two surfaces meet.

use crate::error::Result;
use crate::model::pairs::WHAT;
use crate::numbers::surface::ANGLE;
use crate::platform::memory::filled;

/// Of every node with a row of the pair.
#[derive(Debug, Clone)]
pub struct Laws {
    /// Coefficient of friction, no unit.
    pub friction: Vec<f64>,
    /// Shear per area at pressure 0.
    pub cohesion: Vec<f64>,
    /// Subtracted from gaps, length.
    pub offset: Vec<f64>,
    /// Length per pressure.
    pub compliance: Vec<f64>,
    pub scalars: Scalars,
}

/// Of the whole pair.
#[derive(Debug, Clone, Copy)]
pub struct Scalars {
    /// Largest gap, or penetration, at which a node has a row, length.
    pub distance: f64,
    /// Deepest penetration that is believed, length.
    pub depth: f64,
    /// Gaps of the first find up to this size count as 0, length.
    pub adjust: f64,
    pub is_on: bool,
    /// Angle between outward normals, at least, degrees.
    pub angle: f64,
    /// Length; of axisymmetric problems the angle, 2 pi or 1.
    pub thickness: f64,
    pub axisymmetric: bool,
}

impl Laws {
    pub fn new(nodes: usize, distance: f64) -> Result<Self> {
        let zeros = || filled(nodes, 0.0, WHAT);
        let scalars = Scalars {
            distance,
            depth: distance,
            adjust: 0.0,
            is_on: true,
            angle: ANGLE,
            thickness: 1.0,
            axisymmetric: false,
        };
        let (friction, cohesion, offset, compliance) = (zeros()?, zeros()?, zeros()?, zeros()?);
        Ok(Self { friction, cohesion, offset, compliance, scalars })
    }
}
