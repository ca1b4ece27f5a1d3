//! Unknowns of different bodies that move together because the host gave them one number (option `glue`).

use std::collections::HashMap;

use crate::error::{Error, Kind, Result};
use crate::model::host::HostModel;
use crate::model::parts::Joint;
use crate::platform::memory::{refusal, reserved};

const WHAT: &str = "unknowns with one number";

impl HostModel {
    /// Whether unknowns move together.
    pub fn has_joints(&self) -> bool {
        self.joined.as_ref().map_or_else(|| self.shares_numbers(), |joints| !joints.is_empty())
    }

    /// For every number one joint fewer than unknowns that have it: each joins the unknown to that of the previous body.
    pub fn joints(&self) -> Result<Vec<Joint>> {
        if let Some(joints) = &self.joined {
            return Ok(joints.clone());
        }
        let numbered = self.bodies.iter().filter_map(|given| given.numbers.as_deref());
        let count = numbered.map(<[usize]>::len).sum::<usize>() - self.unknowns.len();
        let (mut joints, mut last) = (reserved(count, WHAT)?, HashMap::new());
        let bytes = count * size_of::<(usize, usize)>();
        last.try_reserve(count).map_err(|_| refusal(bytes, WHAT))?;
        if count == 0 {
            return Ok(joints);
        }
        for (body, given) in self.bodies.iter().enumerate() {
            for (dof, &number) in given.numbers.iter().flatten().enumerate() {
                let place = self.offsets[body] + dof;
                let first = self.unknowns.get(&number).map_or(place, |(p, i)| self.offsets[*p] + i);
                if first < place {
                    let before = last.insert(number, place).unwrap_or(first);
                    joints.push(Joint { number, ends: [before, place] });
                }
            }
        }
        Ok(joints)
    }

    pub fn summed(&self, mut values: Vec<f64>) -> Result<Vec<f64>> {
        for Joint { ends: [before, place], .. } in self.joints()?.into_iter().rev() {
            values[before] += values[place];
        }
        Ok(values)
    }

    /// Refuses to change the option while unknowns of several bodies share a number.
    pub(super) fn check_glue(&self, argument: &'static str) -> Result<()> {
        if self.settings.glue == 1 || !self.shares_numbers() {
            return Ok(());
        }
        let what = "option \"glue\" stays 1 while unknowns of several bodies have the same number";
        Err(Error::new(Kind::Argument(argument), what))
    }
}
