//! CHOLMOD as an oracle, from the Rust harness: a C and a Fortran driver are compiled with the crate `cc` against
//! SuiteSparse and the library, and solve every reference case. What they check is in
//! `tests/abi/c/cholmod_oracle.c` and `tests/abi/fortran/cholmod_oracle.f90`.
#![cfg(all(unix, target_os = "linux"))]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use flate2::read::GzDecoder;

#[path = "../support/compiler.rs"]
mod compiler;

use compiler::compiler;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const WORK: &str = env!("CARGO_TARGET_TMPDIR");

/// What Rust's standard library needs from the system when the archive is linked.
const SYSTEM: [&str; 7] = ["-lcholmod", "-lgcc_s", "-lutil", "-lrt", "-lpthread", "-lm", "-ldl"];

/// The archive of the library. Cargo builds it for no test, because none can link it as a crate: the first that asks builds it, in
/// the target folder of this program.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--release", "--locked", "-p", "feti-contact-c", "--message-format=json"]);
        cargo.arg("--target-dir").arg(Path::new(WORK).with_file_name("")).current_dir(ROOT);
        let told = run(&mut cargo);
        let mut files = told.split('"').filter(|text| text.ends_with("libfeti_contact.a"));
        files.next().expect("cargo names the archive").into()
    })
}

/// The reference cases as plain text, unpacked once.
fn data() -> &'static Path {
    static DATA: OnceLock<PathBuf> = OnceLock::new();
    DATA.get_or_init(|| {
        let out = Path::new(WORK).join("cases");
        for case in entries(&Path::new(ROOT).join("tests/data")).iter().filter(|path| path.is_dir()) {
            let folder = out.join(case.file_name().expect("name of a case"));
            fs::create_dir_all(&folder).expect("folder of a case");
            for packed in entries(case).iter().filter(|path| path.extension().is_some_and(|e| e == "gz")) {
                let mut text = GzDecoder::new(fs::File::open(packed).expect("packed file"));
                let plain = folder.join(packed.file_stem().expect("name of a file"));
                std::io::copy(&mut text, &mut fs::File::create(plain).expect("plain file"))
                    .expect("whole file");
            }
        }
        out
    })
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let list = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = list.map(|entry| entry.expect("entry of a folder").path()).collect();
    paths.sort();
    paths
}

/// Runs a command to its end; it must succeed.
fn run(command: &mut Command) -> String {
    let what = format!("{command:?}");
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{what}: {error} (`make setup` installs what is missing)"));
    let text =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(output.status.success(), "{what}: {}\n{text}", output.status);
    text
}

/// The driver solves every case, finds no difference, and prints nothing.
fn agrees_with_cholmod(driver: &Path) {
    assert_eq!(run(Command::new(driver).arg(data())), "");
}

#[test]
fn cholmod_gives_the_same_dual_operator_to_a_c_program() {
    let out = Path::new(WORK).join("cholmod_c");
    let sources = ["cholmod_oracle", "cholmod_shim", "brute_force", "handover", "matrices"]
        .map(|f| format!("tests/abi/c/{f}.c"));
    let driver = out.join("driver");
    let mut command = compiler("gcc", &out);
    command.args(["-std=c99", "-Iinclude", "-Iexamples_c", "-Itests/abi/c", "examples_c/case_reader.c"]);
    command.args(sources).arg(library()).args(SYSTEM).arg("-o").arg(&driver);
    run(&mut command);
    agrees_with_cholmod(&driver);
}

#[test]
fn cholmod_gives_the_same_dual_operator_to_a_fortran_program() {
    let out = Path::new(WORK).join("cholmod_fortran");
    let shim = out.join("cholmod_shim.o");
    let driver = out.join("driver");
    run(compiler("gcc", &out).args(["-std=c99", "-c", "tests/abi/c/cholmod_shim.c", "-o"]).arg(&shim));
    let mut command = compiler("gfortran", &out);
    command.arg("-J").arg(&out).args(modules());
    command.args(["examples_fortran/case_reader.f90", "tests/abi/fortran/support/case_problem.f90"]);
    command
        .arg("tests/abi/fortran/cholmod_oracle.f90")
        .arg(&shim)
        .arg(library())
        .args(SYSTEM)
        .arg("-o")
        .arg(&driver);
    run(&mut command);
    agrees_with_cholmod(&driver);
}

/// The Fortran sources of the library, modules before their users: interfaces, base, the parts, the whole.
fn modules() -> Vec<PathBuf> {
    let rank = |path: &Path| match path.file_stem().and_then(|stem| stem.to_str()) {
        Some("feti_contact_c") => 0,
        Some("feti_contact_base") => 1,
        Some("feti_contact") => 3,
        _ => 2,
    };
    let mut files = entries(&Path::new(ROOT).join("include/fortran"));
    files.retain(|path| path.extension().is_some_and(|e| e == "f90"));
    files.sort_by_key(|path| rank(path));
    files
}
