//! The programs that are run: this one again, CHOLMOD in C, faer's Cholesky, Clarabel and OSQP from Python.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::backing::BYTES;
use crate::compiler::compiler;
use crate::factors;
use crate::matrix;
use crate::problems::{Case, Model, PEERS};
use crate::programs::{output, Program};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const WORK: &str = env!("CARGO_TARGET_TMPDIR");

/// Programs in C that call CHOLMOD.
const BY_CHOLMOD: [&str; 2] = ["cholmod", "hostloop"];
/// Python packages of the peers.
const PACKAGES: [&str; 4] = ["numpy", "scipy", "clarabel", "osqp"];

pub struct Peers {
    folder: PathBuf,
    /// Python with the packages; none where it cannot be set up.
    python: Option<PathBuf>,
}

impl Peers {
    /// Compiles the programs in C, and sets up the Python packages once.
    pub fn set_up(packages: bool) -> Result<Self, String> {
        let folder = Path::new(WORK).join("bench");
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for name in BY_CHOLMOD {
            let mut gcc = compiler("gcc", &folder);
            gcc.args(["-std=c99", "-O2"])
                .arg(format!("benches/bench/{name}.c"))
                .arg("-o")
                .arg(folder.join(name));
            output(gcc.args(["-lcholmod", "-lm", "-ldl"]))?;
        }
        let python = if packages { python(&folder.join("python")) } else { None };
        Ok(Self { folder, python })
    }

    pub fn has_packages(&self) -> bool {
        self.python.is_some()
    }

    /// The files that the peers read for a deck; builds faer's program for those it is measured on.
    pub fn write(&self, case: &Case) -> Result<(), String> {
        let deck = case.model.build();
        let text = |error: std::io::Error| format!("{}: {error}", case.name);
        matrix::write(&deck, true, &self.matrix(case.name)).map_err(text)?;
        if case.name == PEERS {
            matrix::write(&deck, false, &self.problem(case.name)).map_err(text)?;
        }
        if let Model::Clamped(_) = case.model {
            self.build_faer()?;
            let order = factors::order(&deck).map_err(|error| error.to_string())?;
            let bytes: Vec<u8> = order.iter().flat_map(|dof| dof.to_ne_bytes()).collect();
            fs::write(self.order(case.name), bytes).map_err(text)?;
        }
        Ok(())
    }

    pub fn remove(&self, case: &Case) {
        for path in [self.matrix(case.name), self.problem(case.name), self.order(case.name)] {
            // What is not there need not be removed.
            let _ = fs::remove_file(path);
        }
    }

    fn matrix(&self, deck: &str) -> PathBuf {
        self.folder.join(format!("{deck}.matrix"))
    }

    fn problem(&self, deck: &str) -> PathBuf {
        self.folder.join(format!("{deck}.problem"))
    }

    /// The dofs in the order of elimination.
    fn order(&self, deck: &str) -> PathBuf {
        self.folder.join(format!("{deck}.order"))
    }

    /// Where faer's program is built.
    fn faer(&self) -> PathBuf {
        self.folder.join("faer")
    }

    fn build_faer(&self) -> Result<(), String> {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(["build", "--release", "--locked", "--quiet", "--manifest-path"]);
        cargo.arg(Path::new(ROOT).join("benches/faer/Cargo.toml"));
        output(cargo.arg("--target-dir").arg(self.faer())).map(|_| ())
    }

    /// The command of one run.
    pub fn command(&self, deck: &str, program: Program) -> Result<Command, String> {
        let own = |kind: &str, threads: usize| {
            let path = std::env::current_exe().map_err(|error| error.to_string())?;
            let mut command = Command::new(path);
            command.args(["child", kind, deck]).arg(threads.to_string());
            Ok(command)
        };
        match program {
            Program::Ours(threads) => own("ours", threads),
            Program::Few(threads) => own("few", threads),
            Program::Frictionless => own("frictionless", 1),
            Program::Cut(threads) => own("cut", threads),
            Program::Pieces(pieces) => own("pieces", pieces),
            Program::Later => own("later", 1),
            Program::Parts => own("parts", 1),
            Program::Bandwidth => own("bandwidth", 1),
            Program::Surfaces(threads) => own("surfaces", threads),
            Program::Factor(threads) => own("factor", threads),
            Program::Cholmod(_) => {
                let mut command = Command::new(self.folder.join("cholmod"));
                command.arg(self.matrix(deck)).arg(BYTES.to_string());
                Ok(command)
            }
            Program::HostLoop(digits) => {
                let mut command = Command::new(self.folder.join("hostloop"));
                command.arg(self.problem(deck)).arg(format!("1e-{digits}")).arg(BYTES.to_string());
                Ok(command)
            }
            Program::Faer(threads) => {
                let mut command = Command::new(self.faer().join("release/factorise-by-faer"));
                command.arg(self.matrix(deck)).arg(self.order(deck)).arg(threads.to_string());
                Ok(command)
            }
            Program::Clarabel | Program::Osqp => {
                let mut command = Command::new(self.python.as_deref().ok_or("no Python packages")?);
                let script = Path::new(ROOT).join("benches/bench/peers.py");
                command.arg(script).arg(program.name()).arg(self.problem(deck));
                Ok(command)
            }
        }
    }
}

/// A Python of its own with the packages, made when it is not there.
fn python(folder: &Path) -> Option<PathBuf> {
    let python = folder.join("bin/python");
    let works = || output(Command::new(&python).args(["-c", "import numpy, scipy, clarabel, osqp"])).is_ok();
    if !works() {
        let made = output(Command::new("python3").args(["-m", "venv"]).arg(folder));
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        let filled = made.and_then(|_| output(Command::new(&python).args(install).args(PACKAGES)));
        if let Err(why) = filled {
            println!("    no Clarabel and OSQP: {why}");
            return None;
        }
    }
    works().then_some(python)
}
