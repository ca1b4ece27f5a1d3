//! The time and the memory of the phases of a call.

use std::ffi::CStr;
use std::time::{Duration, Instant};

/// The phases of a setup and a solve, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Rows,
    NullSpaces,
    Analysis,
    Factorisation,
    DualOperators,
    Preconditioner,
    DualSolve,
    Recovery,
}

const NAMES: [&CStr; 8] = [
    c"rows",
    c"null spaces",
    c"analysis",
    c"factorisation",
    c"dual operators",
    c"preconditioner",
    c"dual solve",
    c"recovery",
];

/// One phase as reported to the host.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseReport {
    pub name: &'static CStr,
    /// Wall time in the last setup or solve that had work in this phase.
    pub seconds: f64,
    /// Bytes that the phase has made and keeps; 0 if not counted.
    pub bytes: usize,
}

impl PhaseReport {
    /// Its place in the order of the phases.
    pub fn place(&self) -> usize {
        NAMES.iter().position(|name| *name == self.name).unwrap_or(NAMES.len())
    }

    /// The phase at a place.
    pub fn at(place: usize, seconds: f64, bytes: usize) -> Option<Self> {
        NAMES.get(place).map(|name| Self { name, seconds, bytes })
    }
}

/// Wall time and bytes of every phase.
#[derive(Debug, Clone, Copy, Default)]
pub struct Phases {
    spent: [Duration; NAMES.len()],
    bytes: [usize; NAMES.len()],
}

impl Phases {
    /// Notes that the phase ends now; returns the time.
    pub fn ended(&mut self, phase: Phase, begun: Instant) -> Instant {
        let now = Instant::now();
        self.add(phase, now - begun);
        now
    }

    pub fn add(&mut self, phase: Phase, time: Duration) {
        self.spent[phase as usize] += time;
    }

    /// Moves time from one phase to another whose work was done within it.
    pub fn move_time(&mut self, from: Phase, to: Phase, time: Duration) {
        let time = time.min(self.spent[from as usize]);
        self.spent[from as usize] -= time;
        self.add(to, time);
    }

    pub fn keeps(&mut self, phase: Phase, bytes: usize) {
        self.bytes[phase as usize] = bytes;
    }

    /// Time and bytes of each, in their order.
    pub fn report(&self) -> Vec<PhaseReport> {
        let phase = |k: usize| PhaseReport {
            name: NAMES[k],
            seconds: self.spent[k].as_secs_f64(),
            bytes: self.bytes[k],
        };
        (0..NAMES.len()).map(phase).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_moves_between_phases_but_is_never_made() {
        let mut phases = Phases::default();
        phases.add(Phase::DualSolve, Duration::from_secs(3));
        phases.move_time(Phase::DualSolve, Phase::Recovery, Duration::from_secs(1));
        phases.move_time(Phase::DualSolve, Phase::Recovery, Duration::from_secs(5));
        let seconds: Vec<f64> = phases.report().iter().map(|phase| phase.seconds).collect();
        assert_eq!(seconds, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0]);
        phases.keeps(Phase::DualOperators, 80);
        assert_eq!((phases.report()[4].name, phases.report()[4].bytes), (c"dual operators", 80));
    }
}
