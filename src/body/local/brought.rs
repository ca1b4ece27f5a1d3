//! What is brought to where the decisions are, or kept with the bodies: vectors over their unknowns, and K.

use crate::body::elsewhere::Name;
use crate::body::given::Stiffness;
use crate::body::local::{Local, Question};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::platform::memory::copied;
use crate::ranks::{damaged, wire_struct, wire_unit};

/// Keeps a vector.
pub struct Put {
    pub v: Vec<f64>,
}

wire_struct!(Put { v });

impl Question for Put {
    const NAME: Name = Name::Put;
    type Answer = ();
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(self, _: &Local, v: &mut Vec<f64>, _: ()) -> Result<()> {
        *v = self.v;
        Ok(())
    }
}

/// Asks for a vector, or for its values at these unknowns.
pub struct Bring {
    pub at: Option<Vec<u32>>,
}

wire_struct!(Bring { at });

impl Question for Bring {
    const NAME: Name = Name::Bring;
    type Answer = Vec<f64>;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, _: &Local, _: &mut (), v: &Vec<f64>) -> Result<Vec<f64>> {
        let value = |dof: &u32| v.get(*dof as usize).copied().ok_or_else(damaged);
        match self.at {
            Some(at) => at.iter().map(value).collect(),
            None => copied(v, "a vector over the unknowns of a body"),
        }
    }
}

/// Asks for K, n x n, with the metric of its unknowns: for what needs those of an island in one place. None if its entries are not known.
pub struct Section;

wire_unit!(Section);

impl Question for Section {
    const NAME: Name = Name::Section;
    type Answer = Option<(Symmetric, Vec<f64>)>;
    type Kept = ();
    type Given = ();

    fn answer(self, body: &Local, _: &mut (), _: ()) -> Result<Self::Answer> {
        let Stiffness::Matrix(k) = body.stiffness else { return Ok(None) };
        Ok(Some((k.clone(), copied(body.dual()?.metric, "the metric of a body")?)))
    }
}
