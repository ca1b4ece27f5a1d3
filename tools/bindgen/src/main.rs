//! Writes `include/feti_contact.h` and most of `include/fortran` from one parse of `c/src`: the interfaces of the C functions
//! ([`fortran`]), the typed modules ([`typed`]) and the FORTRAN 77 interface ([`f77`]); the Python modules ([`python`], [`python_methods`]).
//!
//! `feti-bindgen [--check] [--calls FILE] [--trace FILE] [--pages DIR] [--source DIR] [--root DIR]`; `--check` writes nothing and fails on the first line
//! that differs from the committed files. `--calls FILE` writes a C program for the tests instead ([`calls`]), as does `--trace` ([`trace`]);
//! `--pages DIR` writes reference pages there ([`pages`]) and manual pages below DIR/man ([`man`]).
//! `--root` is the folder of the library's Cargo.toml, `--source` defaults to its c/src.
//!
//! All of them have the order of the job ([`order`]).
//!
//! Every exported function carries a table `| argument | in/out | shape | rule |` in its documentation ([`doc`]).

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod c_header;
mod c_types;
mod calls;
mod check;
mod dictionary;
mod doc;
mod f77;
mod f77_constants;
mod faults;
mod fortran;
mod man;
mod model;
mod order;
mod overview;
mod pages;
mod parse;
mod procedure;
mod python;
mod python_methods;
mod rules;
mod statuses;
#[cfg(test)]
mod tests;
mod trace;
mod typed;
mod typed_table;

const HEADER: &str = "include/feti_contact.h";
const FORTRAN: &str = "include/fortran/feti_contact_c.f90";
const INCLUDE77: &str = "include/fortran/feti_contact_f77.inc";
const PYTHON: &str = "python/feti_contact/_raw.py";
const METHODS: &str = "python/feti_contact/_methods.py";
const FORTRAN77: &str = "include/fortran/feti_contact_f77_calls.f90";

struct Options {
    check: bool,
    calls: Option<PathBuf>,
    trace: Option<PathBuf>,
    pages: Option<PathBuf>,
    root: PathBuf,
    source: PathBuf,
}

fn main() -> ExitCode {
    let outcome = options(std::env::args().skip(1)).and_then(|options| run(&options, &order::SECTIONS));
    if let Err(message) = outcome {
        eprintln!("feti-bindgen: {message}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn options(mut arguments: impl Iterator<Item = String>) -> Result<Options, String> {
    let (mut check, mut calls, mut trace, mut pages) = (false, None, None, None);
    let mut root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut source = None;
    while let Some(argument) = arguments.next() {
        let mut path = || arguments.next().map(PathBuf::from).ok_or(format!("{argument} needs a path"));
        match argument.as_str() {
            "--check" => check = true,
            "--calls" => calls = Some(path()?),
            "--trace" => trace = Some(path()?),
            "--pages" => pages = Some(path()?),
            "--root" => root = path()?,
            "--source" => source = Some(path()?),
            _ => {
                return Err(format!(
                    "unknown option {argument}; known: --check, --calls FILE, --trace FILE, --pages DIR, --source DIR, --root DIR"
                ))
            }
        }
    }
    let source = source.unwrap_or_else(|| root.join("c/src"));
    Ok(Options { check, calls, trace, pages, root, source })
}

/// `sections` have to list what the sources export.
fn run(options: &Options, sections: &[order::Section]) -> Result<(), String> {
    let manifest = options.root.join("Cargo.toml");
    let version = package_version(&read(&manifest)?).ok_or(format!("{}: no version", manifest.display()))?;
    let sources = sources(&options.source)?;
    order::check(&checked(&sources, version)?, sections)?;
    if let Some(path) = &options.calls {
        return write(path, &calls::print(&checked(&sources, version)?)?);
    }
    if let Some(path) = &options.trace {
        return write(path, &trace::print(&checked(&sources, version)?));
    }
    if let Some(folder) = &options.pages {
        return write_pages(folder, &options.root, &checked(&sources, version)?);
    }
    let generated = generate(&sources, version)?;
    let mut drift = Vec::new();
    for (name, text) in &generated {
        let path = options.root.join(name);
        if options.check {
            let committed = fs::read_to_string(&path).unwrap_or_default();
            drift.extend(check::first_difference(name, &committed, text));
        } else {
            write(&path, text)?;
        }
    }
    if drift.is_empty() {
        Ok(())
    } else {
        Err(format!("run `cargo run -p feti-bindgen`:\n{}", drift.join("\n")))
    }
}

/// (path, text) of what the given (file name, text) pairs make, the header and the module of its interfaces first.
fn generate(sources: &[(String, String)], version: [u32; 3]) -> Result<Vec<(String, String)>, String> {
    let api = checked(sources, version)?;
    let texts = [
        (HEADER, c_header::print(&api)),
        (FORTRAN, fortran::print(&api)),
        (FORTRAN77, f77::print(&api)),
        (INCLUDE77, f77_constants::print(&api)),
        (PYTHON, python::print(&api)),
        (METHODS, python_methods::print(&api)),
    ];
    let texts = texts.map(|(path, text)| (path.to_string(), text));
    Ok(texts.into_iter().chain(typed::print(&api)).collect())
}

fn checked(sources: &[(String, String)], version: [u32; 3]) -> Result<model::Api, String> {
    let api = parse::parse(sources, version)?;
    check::check(&api)?;
    Ok(api)
}

fn write_pages(folder: &Path, root: &Path, api: &model::Api) -> Result<(), String> {
    let faces = pages::Faces { typed: typed::signatures(api, root), f77: f77::calls() };
    for (name, text) in pages::print(api, &faces) {
        write(&folder.join(name), &text)?;
    }
    man::print(api, &faces).iter().try_for_each(|(name, text)| write(&folder.join("man").join(name), text))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// The Rust files of `folder` and the folders in it by their paths from there, ordered by name alone: neither the file system
/// nor a move to another folder may change the order.
fn sources(folder: &Path) -> Result<Vec<(String, String)>, String> {
    let mut paths = files(folder, "rs")?;
    for inner in entries(folder)?.iter().filter(|path| path.is_dir()) {
        paths.extend(files(inner, "rs")?);
    }
    paths.sort_by(|a, b| a.file_name().cmp(&b.file_name()));
    let named = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).display().to_string();
    paths.iter().map(|path| Ok((named(path), read(path)?))).collect()
}

/// The files of a folder that end so, by name.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, String> {
    let mut paths = entries(folder)?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == ending));
    Ok(paths)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// `version = "major.minor.patch"` of the section [workspace.package].
fn package_version(manifest: &str) -> Option<[u32; 3]> {
    let package = manifest.lines().skip_while(|line| line.trim() != "[workspace.package]").skip(1);
    let mut lines = package.take_while(|line| !line.starts_with('['));
    let value = lines.find_map(|line| line.strip_prefix("version")?.trim().strip_prefix('='))?;
    let numbers = value.trim().trim_matches('"').split('-').next()?.split('.').map(str::parse);
    numbers.collect::<Result<Vec<u32>, _>>().ok()?.try_into().ok()
}
