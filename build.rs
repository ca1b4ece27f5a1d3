//! Sets the cfg `avx512` where the compiler knows these instructions (Rust 1.89).

use std::env;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    println!("cargo:rustc-check-cfg=cfg(avx512)");
    if variable("CARGO_CFG_TARGET_ARCH") == "x86_64" && minor_version(&variable("RUSTC")) >= 89 {
        println!("cargo:rustc-cfg=avx512");
    }
}

/// 89 of `rustc 1.89.0 (...)`, 0 of what says no version.
fn minor_version(rustc: &str) -> u32 {
    let Ok(output) = Command::new(rustc).arg("--version").output() else { return 0 };
    let text = String::from_utf8_lossy(&output.stdout);
    text.split('.').nth(1).and_then(|minor| minor.parse().ok()).unwrap_or(0)
}
