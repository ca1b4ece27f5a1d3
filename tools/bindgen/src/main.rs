//! Writes `include/feti_contact.h` and `include/fortran/feti_contact_c.f90` from one parse of `src/ffi/*.rs`.
//!
//! `feti-bindgen [--check] [--source DIR] [--root DIR]`; `--check` writes nothing and fails on the first line that
//! differs from the committed files. `--root` is the folder of the library's Cargo.toml, `--source` defaults to its src/ffi.
//!
//! Every exported function carries a table `| argument | in/out | shape | rule |` in its documentation ([`doc`]).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod c_header;
mod check;
mod doc;
mod fortran;
mod model;
mod parse;
#[cfg(test)]
mod tests;

const HEADER: &str = "include/feti_contact.h";
const FORTRAN: &str = "include/fortran/feti_contact_c.f90";

struct Options {
    check: bool,
    root: PathBuf,
    source: PathBuf,
}

fn main() -> ExitCode {
    let outcome = options(std::env::args().skip(1)).and_then(|options| run(&options));
    if let Err(message) = outcome {
        eprintln!("feti-bindgen: {message}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn options(mut arguments: impl Iterator<Item = String>) -> Result<Options, String> {
    let mut check = false;
    let mut root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut source = None;
    while let Some(argument) = arguments.next() {
        let mut folder = || arguments.next().map(PathBuf::from).ok_or(format!("{argument} needs a folder"));
        match argument.as_str() {
            "--check" => check = true,
            "--root" => root = folder()?,
            "--source" => source = Some(folder()?),
            _ => return Err(format!("unknown option {argument}; known: --check, --source DIR, --root DIR")),
        }
    }
    let source = source.unwrap_or_else(|| root.join("src/ffi"));
    Ok(Options { check, root, source })
}

fn run(options: &Options) -> Result<(), String> {
    let manifest = options.root.join("Cargo.toml");
    let version = package_version(&read(&manifest)?).ok_or(format!("{}: no version", manifest.display()))?;
    let generated = generate(&sources(&options.source)?, version)?;
    let mut drift = Vec::new();
    for (name, text) in [HEADER, FORTRAN].iter().zip(generated) {
        let path = options.root.join(name);
        if options.check {
            let committed = fs::read_to_string(&path).unwrap_or_default();
            drift.extend(check::first_difference(name, &committed, &text));
        } else {
            fs::create_dir_all(path.parent().expect("the file is in a folder")).map_err(|e| e.to_string())?;
            fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    if drift.is_empty() {
        Ok(())
    } else {
        Err(format!("run `cargo run -p feti-bindgen`:\n{}", drift.join("\n")))
    }
}

/// Header and Fortran module of the given (file name, text) pairs.
fn generate(sources: &[(String, String)], version: [u32; 3]) -> Result<[String; 2], String> {
    let api = parse::parse(sources, version)?;
    check::check(&api)?;
    Ok([c_header::print(&api)?, fortran::print(&api)])
}

/// The Rust files of `folder`, by name: the order must not depend on the file system.
fn sources(folder: &Path) -> Result<Vec<(String, String)>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
    paths.sort();
    paths.iter().map(|path| Ok((path.display().to_string(), read(path)?))).collect()
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// `version = "major.minor.patch"` of the section [package].
fn package_version(manifest: &str) -> Option<[u32; 3]> {
    let package = manifest.lines().skip_while(|line| line.trim() != "[package]").skip(1);
    let mut lines = package.take_while(|line| !line.starts_with('['));
    let value = lines.find_map(|line| line.strip_prefix("version")?.trim().strip_prefix('='))?;
    let numbers = value.trim().trim_matches('"').split('-').next()?.split('.').map(str::parse);
    numbers.collect::<Result<Vec<u32>, _>>().ok()?.try_into().ok()
}
