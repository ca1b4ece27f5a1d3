//! Calls that all ranks make which have a part of a problem.

use crate::ranks::wire_enum;

/// A call that all ranks make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Call {
    Setup,
    Solve,
    Check,
    SaveState,
    RestoreState,
    OpenMotion,
    Dependent,
    Write,
    Read,
}

impl Call {
    pub fn name(self) -> &'static str {
        match self {
            Self::Setup => "feti_setup",
            Self::Solve => "feti_solve",
            Self::Check => "feti_check",
            Self::SaveState => "feti_state_save",
            Self::RestoreState => "feti_state_restore",
            Self::OpenMotion => "feti_diagnosis_undetermined",
            Self::Dependent => "feti_diagnosis_dependent",
            Self::Write => "feti_problem_write",
            Self::Read => "feti_problem_read",
        }
    }
}

wire_enum!(Call { Setup, Solve, Check, SaveState, RestoreState, OpenMotion, Dependent, Write, Read });
