//! How far the load of a body moves it, each unknown by itself.

use std::sync::Arc;

use crate::body::{wire_struct, Local, Name, Question};
use crate::error::Result;

/// Asks for `sum_j |f_j| / D^_j`, a length.
pub struct Way {
    /// f_p, force; none if it is only rounding.
    pub load: Option<Arc<[f64]>>,
    /// D^ where rows touch the body, t, force / length, infinite without stiffness.
    pub held: Vec<f64>,
}

wire_struct!(Way { load, held });

impl Question for Way {
    const NAME: Name = Name::Way;
    type Answer = f64;
    type Kept = ();
    type Given = ();

    fn answer(self, body: &Local, _: &mut (), _: ()) -> Result<f64> {
        let Some(load) = &self.load else { return Ok(0.0) };
        let mut at_rows = body.touched.iter().zip(&self.held).peekable();
        let held = |j: usize| match at_rows.next_if(|(dof, _)| **dof as usize == j) {
            Some((_, held)) => *held,
            None => body.stiffness.metric(j, f64::INFINITY),
        };
        Ok(load.iter().zip((0..body.order()).map(held)).map(|(f, held)| f.abs() / held).sum())
    }
}
