//! The kinds of rows.

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RowKind {
    /// `B u <= c`, multipliers lambda >= 0.
    Inequality,
    /// `H u = h`, multipliers mu of any sign.
    Equality,
    /// Tangential rows T of nodes with friction, with the slip `s = T u - s_old - C_t lambda_t`.
    Tangential,
}

impl RowKind {
    pub const ALL: [Self; 3] = [Self::Inequality, Self::Equality, Self::Tangential];

    pub fn name(self) -> &'static str {
        match self {
            Self::Inequality => "contact row",
            Self::Equality => "equality row",
            Self::Tangential => "tangential row",
        }
    }
}
