//! Results that the host reads after a solve.

use crate::certificate::{Certificate, FrictionState};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Proof, Result};
use crate::platform::memory::zeros;
use crate::solve::{Answer, OfOthers, Report, RowState};
use crate::solver::findings::Findings;
use crate::solver::joints::add_glue;
use crate::solver::problem::Problem;

impl Problem {
    pub(super) fn answer(&self) -> Result<&Answer> {
        let what = "there is no answer yet: solve first (a change of bodies or rows drops the last one)";
        self.current().map(|current| &*current.answer).ok_or_else(|| Error::new(Kind::State, what))
    }

    /// Report of the last solve that gave an answer.
    pub fn report(&self) -> Option<&Report> {
        self.current().map(|current| &current.answer.report)
    }

    /// Which entry of the certificate of the last answer is the worst above its limit, and where.
    pub fn shortfall(&self) -> Option<Error> {
        let certificate = &self.report()?.certificate;
        let named = Certificate::NAMES.iter().zip(certificate.entries());
        let fails = named.filter(|(_, entry)| !(entry.ratio <= 1.0));
        let ((name, of), entry) = fails.max_by(|(_, a), (_, b)| a.ratio.total_cmp(&b.ratio))?;
        let kind = if of.ends_with("row") { format!(" of this {of}") } else { String::new() };
        let what = format!("{name}{kind} is {:.1e}, the limit {:.1e}", entry.figure, certificate.limit);
        let mut error = Error::new(Kind::State, what).value(entry.figure).limit(certificate.limit);
        error.place.rank = entry.place.map(|_| entry.rank).filter(|_| self.is_answered_together());
        let named = match (entry.place, *of) {
            (None, _) => error,
            (Some(body), "body") => error.body(body),
            (Some(node), "node") => error.node(node),
            (Some(row), _) => error.row(row),
        };
        if let Some((pair, node)) = self.worst_pair(certificate) {
            return Some(named.pair(pair).node(node));
        }
        Some(named)
    }

    /// As `answer`, for results of one body: its group of bodies must have an answer.
    fn answer_on(&self, body: usize) -> Result<&Answer> {
        self.model.given(body)?;
        let answer = self.answer()?;
        if answer.without[body] {
            let what = "the group of bodies that this one belongs to has no answer";
            return Err(Error::new(Kind::State, what).body(body));
        }
        Ok(answer)
    }

    /// u of one body, length.
    pub fn displacement(&self, body: usize) -> Result<&[f64]> {
        Ok(&self.answer_on(body)?.u[self.model.range(body)])
    }

    /// u of all bodies one after the other, length.
    pub fn displacements(&self) -> Result<&[f64]> {
        Ok(&self.answer()?.u)
    }

    /// Force of the rows on the body: `-B'lambda`, `-H'mu`, or both including the glue, so that `K u = f + r`. The forces
    /// on all bodies are kept for later calls.
    pub fn reaction(&mut self, kind: Option<RowKind>, body: usize, r: &mut [f64]) -> Result<()> {
        self.model.check_length(body, "n", r.len())?;
        self.answer_on(body)?;
        let kept = self.history.current.as_mut().and_then(|current| current.reactions.take());
        let kept = kept.filter(|(of, _)| *of == kind);
        let all = kept.map_or_else(|| self.reactions(kind), |(_, all)| Ok(all))?;
        r.copy_from_slice(&all[self.model.range(body)]);
        if let Some(current) = &mut self.history.current {
            current.reactions = Some((kind, all));
        }
        Ok(())
    }

    /// The forces of `reaction` on all bodies one after the other.
    pub fn reactions(&self, kind: Option<RowKind>) -> Result<Vec<f64>> {
        let answer = self.answer()?;
        let mut all = zeros(answer.u.len(), "a reaction")?;
        if let Some(OfOthers { of_rows, of_glue, .. }) = answer.of_others.as_deref() {
            let asked = RowKind::ALL.iter().filter(|of| kind.is_none_or(|kind| kind == **of));
            let of_rows = asked.flat_map(|of| &of_rows[*of as usize]);
            of_rows.chain(of_glue.iter().filter(|_| kind.is_none())).for_each(|(j, push)| all[*j] += push);
            return Ok(all);
        }
        for of in RowKind::ALL {
            if kind.is_none_or(|kind| kind == of) {
                let (rows, multipliers) = (self.model.rows(of), answer.forces(of));
                rows.matrix.mul_transposed_add(-1.0, &multipliers[..rows.len()], &mut all);
            }
        }
        if kind.is_none() {
            add_glue(&self.model, &answer.mu[self.model.equalities.len()..], &mut all)?;
        }
        Ok(all)
    }

    /// Passes the forces of `reaction` on all unknowns of the host, also those that the table eliminates, with their positions.
    pub fn spread_reaction(&self, kind: Option<RowKind>, to: impl FnMut(usize, f64)) -> Result<()> {
        let asked = RowKind::ALL.into_iter().filter(|of| kind.is_none_or(|kind| kind == *of));
        let multipliers = asked.map(|of| Ok((of, self.multipliers(of)?))).collect::<Result<Vec<_>>>()?;
        self.model.spread_reaction(self.reactions(kind)?, &multipliers, to)
    }

    /// Amplitudes alpha of the null space of one body, in the basis `null_space` gives.
    pub fn amplitudes(&self, body: usize) -> Result<&[f64]> {
        Ok(&self.answer_on(body)?.alpha[body])
    }

    /// lambda >= 0 or mu, force.
    pub fn multipliers(&self, kind: RowKind) -> Result<&[f64]> {
        let answer = self.answer()?;
        Ok(match kind {
            RowKind::Inequality => &answer.lambda,
            RowKind::Equality => &answer.mu[..self.model.equalities.len()],
            RowKind::Tangential => &answer.tangential,
        })
    }

    /// Open gaps c + C lambda - B u, length.
    pub fn gaps(&self) -> Result<&[f64]> {
        Ok(&self.answer()?.gaps)
    }

    /// Slips `T u - s_old - C_t lambda_t` of all nodes with friction, length, (dim, nodes).
    pub fn slips(&self) -> Result<&[f64]> {
        Ok(&self.answer()?.slips)
    }

    pub fn friction_states(&self) -> Result<&[FrictionState]> {
        Ok(&self.answer()?.friction)
    }

    pub fn active(&self) -> Result<&[RowState]> {
        Ok(&self.answer()?.states)
    }

    pub fn findings(&self) -> Result<&Findings> {
        self.findings.as_ref().ok_or_else(|| Error::new(Kind::State, "nothing has been solved yet"))
    }

    /// The rigid motion of one body that no contact force can hold, largest entry of all bodies 1.
    pub fn escaping_motion(&self, body: usize) -> Result<&[f64]> {
        self.model.given(body)?;
        match &self.findings()?.proof {
            Some(Proof::Motion { v, .. }) => v.get(self.model.range(body)),
            _ => None,
        }
        .ok_or_else(|| {
            Error::new(
                Kind::State,
                "the last solve has found neither a load that nothing holds nor a motion with negative stiffness",
            )
        })
    }
}
