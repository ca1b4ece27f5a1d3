//! Names the shared library for the loader and marks it for safe use from a host that loads and unloads it.
//!
//! soname libfeti_contact.so.0.MINOR before 1.0 (every minor version may change the interface), libfeti_contact.so.MAJOR
//! from then on. `nodelete`: threads of the pool outlive a dlclose. `noexecstack`: the stack stays non-executable.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // cargo-c sets this variable, and the soname itself.
    println!("cargo:rerun-if-env-changed=CARGO_FEATURE_CAPI");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    if env::var_os("CARGO_FEATURE_CAPI").is_some() || variable("CARGO_CFG_TARGET_OS") != "linux" {
        return;
    }
    let major = variable("CARGO_PKG_VERSION_MAJOR");
    let version = if major == "0" { format!("0.{}", variable("CARGO_PKG_VERSION_MINOR")) } else { major };
    for option in [&format!("-soname,libfeti_contact.so.{version}"), "-z,nodelete", "-z,noexecstack"] {
        println!("cargo:rustc-cdylib-link-arg=-Wl,{option}");
    }
}
