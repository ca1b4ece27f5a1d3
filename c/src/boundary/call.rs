//! Which exported function a host has called.

/// An exported function and the names of its arguments, in order.
#[derive(Debug, Clone, Copy)]
pub struct Call {
    pub function: &'static str,
    pub arguments: &'static [&'static str],
}

/// `call!(feti_body_load(p, body, n, f))`: the arguments must be names in scope.
macro_rules! call {
    ($function:ident($($argument:ident),*)) => {{
        $(let _ = &$argument;)*
        $crate::boundary::Call { function: stringify!($function), arguments: &[$(stringify!($argument)),*] }
    }};
}
pub(crate) use call;
