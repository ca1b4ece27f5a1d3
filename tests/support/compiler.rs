//! Compilers for the programs in other languages that tests and benchmarks build.

use std::fs;
use std::path::Path;
use std::process::Command;

/// A compiler call as the crate `cc` makes it, outside a build script: everything it would take from cargo is given.
pub fn compiler(name: &str, out: &Path) -> Command {
    fs::create_dir_all(out).expect("folder for objects");
    let triple = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let mut build = cc::Build::new();
    build
        .compiler(name)
        .target(&triple)
        .host(&triple)
        .opt_level(2)
        .debug(false)
        .out_dir(out)
        .cargo_metadata(false);
    let mut command = build.get_compiler().to_command();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}
