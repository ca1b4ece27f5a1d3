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

/// `twins! { /// ... fn feti_x_i32, feti_x_i64(p: *mut feti_problem, list: *const I) |call| { ... } }`: a function that takes
/// indices `I` of 32 bits, and its twin for 64 bits; `call` is the call of each.
macro_rules! twins {
    ($(#[$doc:meta])* fn $narrow:ident, $wide:ident($($argument:tt)*) |$call:ident| $body:block) => {
        $crate::boundary::twins! { @ i32 [$(#[$doc])*] $narrow($($argument)*) |$call| $body }
        $crate::boundary::twins! { @ i64 [
            #[doc = concat!("As `", stringify!($narrow), "`, with 64-bit indices.")]
            #[doc = "\n# Safety\nThe arrays have the shapes that are given there."]
        ] $wide($($argument)*) |$call| $body }
    };
    (@ $index:ident [$($doc:tt)*] $name:ident($($argument:ident: $ty:ty),* $(,)?) |$call:ident| $body:block) => {
        mod $name {
            use super::*;
            type I = $index;

            $($doc)*
            #[no_mangle]
            pub unsafe extern "C" fn $name($($argument: $ty),*) -> i32 {
                let $call = $crate::boundary::call!($name($($argument),*));
                $body
            }
        }
        pub use $name::$name;
    };
}
pub(crate) use twins;
