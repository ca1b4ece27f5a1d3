//! The problem as the host gives it. What the methods of the host do is said where it calls them, in `solver/input.rs`.

use std::collections::HashMap;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use crate::constraints::Table;
use crate::error::Result;
use crate::model::contents::SolvedModel;
use crate::model::pairs::Pairs;
use crate::model::parts::Joint;
use crate::model::settings::Settings;

/// All input of the host. Every call checks its input first and stores all of it or nothing; what is stored changes by these
/// calls alone, so that the revisions tell what is out of date.
pub struct HostModel {
    pub(crate) contents: SolvedModel,
    /// Body and dof of every unknown number of the host.
    pub unknowns: HashMap<usize, (usize, usize)>,
    /// The joints of bodies on several ranks, whose numbers are there.
    pub joined: Option<Vec<Joint>>,
    /// Other ranks may have the unknowns that rows name by numbers.
    pub has_others: bool,
    /// Bodies given by elements are not cut unless the host says so.
    pub stays_whole: bool,
    /// Surfaces, and which of them may meet.
    pub pairs: Pairs,
    /// Increased if the numbers of a body change.
    pub numberings: u64,
    /// The host's table of unknowns, if it has given one.
    pub table: Option<Arc<Table>>,
}

/// Without parts it is the model that is solved.
impl Deref for HostModel {
    type Target = SolvedModel;

    fn deref(&self) -> &SolvedModel {
        &self.contents
    }
}

impl DerefMut for HostModel {
    fn deref_mut(&mut self) -> &mut SolvedModel {
        &mut self.contents
    }
}

impl HostModel {
    pub fn new() -> Self {
        Self {
            contents: SolvedModel::new(),
            unknowns: HashMap::new(),
            joined: None,
            has_others: false,
            stays_whole: false,
            pairs: Pairs::default(),
            numberings: 0,
            table: None,
        }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    pub fn set_f64(&mut self, name: &str, value: f64) -> Result<()> {
        self.settings.set_f64(name, value)
    }

    pub fn set_i64(&mut self, name: &str, value: i64) -> Result<()> {
        let before = self.settings.glue;
        self.settings.set_i64(name, value)?;
        self.check_glue("value").inspect_err(|_| self.settings.glue = before)
    }

    pub fn set_str(&mut self, name: &str, value: &str) -> Result<()> {
        self.settings.set_str(name, value)
    }

    pub fn set_text(&mut self, text: &str) -> Result<()> {
        let before = self.settings.clone();
        self.settings.set_text(text)?;
        self.check_glue("text").inspect_err(|_| self.settings = before)
    }

    pub fn get_f64(&self, name: &str) -> Result<f64> {
        self.settings.get_f64(name)
    }

    pub fn get_i64(&self, name: &str) -> Result<i64> {
        self.settings.get_i64(name)
    }

    pub fn get_str(&self, name: &str) -> Result<String> {
        self.settings.get_str(name)
    }
}

impl Default for HostModel {
    fn default() -> Self {
        Self::new()
    }
}
