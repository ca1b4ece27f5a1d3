//! Names the shared library for the loader and marks it for safe use from a host that loads and unloads it, and whose malloc
//! may fail (src/reserve.rs).
//!
//! soname libfeti_contact.so.0.MINOR before 1.0 (every minor version may change the interface), libfeti_contact.so.MAJOR
//! from then on. `nodelete`: threads of the pool outlive a dlclose. `noexecstack`: the stack stays non-executable.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    if variable("CARGO_CFG_TARGET_OS") != "linux" {
        return;
    }
    for option in ["-z,nodelete", "-z,noexecstack"] {
        println!("cargo:rustc-cdylib-link-arg=-Wl,{option}");
    }
    if ["x86_64", "aarch64"].contains(&&*variable("CARGO_CFG_TARGET_ARCH")) {
        for name in ["malloc", "calloc", "realloc", "posix_memalign", "free", "__cxa_thread_atexit_impl"] {
            println!("cargo:rustc-cdylib-link-arg=-Wl,--wrap={name}");
        }
    }
    // cargo-c sets this variable, and the soname itself.
    println!("cargo:rerun-if-env-changed=CARGO_FEATURE_CAPI");
    if env::var_os("CARGO_FEATURE_CAPI").is_some() {
        return;
    }
    let major = variable("CARGO_PKG_VERSION_MAJOR");
    let version = if major == "0" { format!("0.{}", variable("CARGO_PKG_VERSION_MINOR")) } else { major };
    println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libfeti_contact.so.{version}");
}
