//! How far the load of a body moves it, each unknown by itself.

use crate::body::{wire_struct, HostLoad, Local, Name, Question};
use crate::error::Result;

/// Asks for `sum_j |f_j| / D^_j`, a length.
pub struct Way {
    /// The load is more than rounding.
    pub counts: bool,
    /// D^ where rows touch the body, t, force / length, infinite without stiffness.
    pub held: Vec<f64>,
}

wire_struct!(Way { counts, held });

impl Question for Way {
    const NAME: Name = Name::Way;
    type Answer = f64;
    type Kept = ();
    type Given = (HostLoad,);

    fn answer(self, body: &Local, _: &mut (), HostLoad(load): &HostLoad) -> Result<f64> {
        let Some(load) = load.as_ref().filter(|_| self.counts) else { return Ok(0.0) };
        let mut at_rows = body.touched.iter().zip(&self.held).peekable();
        let held = |j: usize| match at_rows.next_if(|(dof, _)| **dof as usize == j) {
            Some((_, held)) => *held,
            None => body.stiffness.metric(j, f64::INFINITY),
        };
        Ok(load.iter().zip((0..body.order()).map(held)).map(|(f, held)| f.abs() / held).sum())
    }
}
