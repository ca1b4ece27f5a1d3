//! The committed header and Fortran interfaces are what c/src gives.

use std::process::Command;

#[test]
fn the_committed_header_and_interfaces_match_the_sources() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let output = Command::new(env!("CARGO_BIN_EXE_feti-bindgen"))
        .args(["--check", "--root", root])
        .output()
        .expect("the generator runs");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "run `cargo run -p feti-bindgen` and commit: {text}");
}
