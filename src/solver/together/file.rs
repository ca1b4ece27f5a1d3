//! A problem file of several ranks: rank 0 writes it, with the options and rows of all; the others bring the sections of their bodies, one
//! at a time.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{Error, Kind, Result};
use crate::gathering::At;
use crate::model::file::write::{body, lengths, section, Bodies};
use crate::model::HostModel;
use crate::ranks::value;
use crate::solver::call::Call;
use crate::solver::problem::Problem;
use crate::solver::together::leader::Leading;
use crate::solver::together::messages::{Begun, Finish, LENGTHS, SECTION_OF_FILE};
use crate::solver::together::Brought;

impl Problem {
    /// As `write_file`, by all ranks; false if rank 0 is alone with its problem.
    pub(in crate::solver) fn write_together(&mut self, path: &Path) -> Result<bool> {
        let brought = Brought { path: Some(path), ..Brought::default() };
        Ok(self.together(Call::Write, 0, brought)?.is_some())
    }

    /// Only rank 0 alone can read a problem.
    pub(in crate::solver) fn check_read_together(&mut self) -> Result<()> {
        self.together(Call::Read, 0, Brought::default()).map(drop)
    }
}

impl Leading<'_> {
    pub(super) fn written(&mut self, begun: Vec<(usize, Begun)>, path: Option<&Path>) -> Result<Vec<Finish>> {
        let lost = || Error::new(Kind::Internal, "rank 0 has no path of a file");
        let path = path.ok_or_else(lost)?;
        self.own.model.check_kept().map_err(|e| e.rank(0))?;
        self.gather(begun)?;
        let mut of_rank: Vec<Vec<u64>> = vec![Vec::new(); self.ranks.size];
        of_rank[0] = lengths(&self.own.model);
        for (rank, answer) in self.ask(LENGTHS, |_| ())? {
            of_rank[rank] = value(&answer)?;
        }
        let bodies = &self.leader.order.bodies;
        let bytes = bodies.iter().map(|At { rank, number }| of_rank[*rank][*number]).collect();
        let write = &mut |p: usize, out: &mut dyn Write| match bodies[p] {
            At { rank: 0, number } => body(&self.own.model.bodies[number], out),
            At { rank, number } => self.bring(rank, number, out),
        };
        self.all.model.write_with(path, Bodies { bytes, write })?;
        Ok(self.each(|_| Finish::default()))
    }

    /// Writes the sections of a body of another rank.
    fn bring(&self, rank: usize, number: usize, out: &mut dyn Write) -> io::Result<()> {
        for k in 0_usize.. {
            let bytes: Vec<u8> =
                self.ask_one(rank, SECTION_OF_FILE, (number, k)).map_err(io::Error::other)?;
            if bytes.is_empty() {
                break;
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }
}

/// Section k of a body of this rank; nothing after its last.
pub fn section_of(model: &HostModel, (number, k): (usize, usize)) -> Result<Vec<u8>> {
    section(model.given(number)?, k)
}
