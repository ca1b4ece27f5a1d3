//! A problem as one file: all input of the host, so that any reader makes the same calls with the same bits. The file
//! contains no answers, start values, saved states or factors.

pub mod format;
mod input;
mod read;
pub mod write;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Error, Kind, Result};
use crate::mesh::Mesh;
use crate::model::bodies::SPOILED;
use crate::model::file::write::Bodies;
use crate::model::host::HostModel;
use crate::platform::files::{failed, regular};
use crate::platform::memory::reserved;

/// Bytes per write to the system.
const BUFFER: usize = 1 << 17;

impl HostModel {
    pub fn write_file(&self, path: &Path) -> Result<()> {
        self.check_kept()?;
        let write = &mut |p: usize, out: &mut dyn Write| write::body(&self.bodies[p], out);
        self.write_with(path, Bodies { bytes: write::lengths(self), write })
    }

    /// Options and rows are those of this model; the bodies may be elsewhere.
    pub fn write_with(&self, path: &Path, bodies: Bodies) -> Result<()> {
        regular(path)?;
        // if the path is a link, its target is replaced
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let (temporary, file) = create_beside(&target).map_err(|e| failed(path, "create", &e))?;
        let written = self.fill(bodies, file, &target).map_err(|e| {
            // of a body elsewhere
            let own = e.get_ref().and_then(|e| e.downcast_ref::<Error>()).cloned();
            own.unwrap_or_else(|| failed(path, "write", &e))
        });
        let renamed =
            written.and_then(|()| fs::rename(&temporary, &target).map_err(|e| failed(path, "rename", &e)));
        if renamed.is_err() {
            // a failure here needs no further action
            let _ = fs::remove_file(&temporary);
        }
        renamed
    }

    pub fn write_bytes(&self) -> Result<Vec<u8>> {
        self.check_kept()?;
        let lengths = write::lengths(self);
        let length = usize::try_from(write::length(self, &lengths)).unwrap_or(usize::MAX);
        let mut bytes = reserved(length, "a problem file")?;
        let write = &mut |p: usize, out: &mut dyn Write| write::body(&self.bodies[p], out);
        write::write(self, Bodies { bytes: lengths, write }, &mut bytes)
            .map_err(|e| Error::new(Kind::Io, e.to_string()))?;
        Ok(bytes)
    }

    pub fn read_file(&mut self, path: &Path) -> Result<()> {
        self.check_empty()?;
        regular(path)?;
        let file = File::open(path).map_err(|e| failed(path, "open", &e))?;
        let length = file.metadata().map_err(|e| failed(path, "open", &e))?.len();
        let read = read::read(BufReader::with_capacity(BUFFER, file), length);
        self.adopt(read.map_err(|error| at(path, error))?);
        Ok(())
    }

    pub fn read_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        self.check_empty()?;
        self.adopt(read::read(bytes, bytes.len() as u64)?);
        Ok(())
    }

    /// Takes over bodies with their numbers, rows and options of another model; those that belong to the host are unchanged.
    fn adopt(&mut self, mut other: Self) {
        other.settings.keep_of_host(&self.settings);
        other.revisions.rows += self.revisions.rows + 1;
        *self = other;
    }

    /// Checks that the library has all input: no functions in place of a matrix, no refused values, no incomplete first
    /// pass over elements.
    pub fn check_kept(&self) -> Result<()> {
        for (p, given) in self.bodies.iter().enumerate() {
            if given.body.operator().is_some() {
                let what =
                    "the body is given by functions of the host (feti_body_operator), which a file cannot contain";
                return Err(Error::new(Kind::Unsupported, what).body(p));
            }
            if let Some(element) = given.mesh.as_deref().and_then(Mesh::first_missing) {
                let what =
                    "the matrix of this element has not been given: a file cannot contain an incomplete body";
                return Err(Error::new(Kind::State, what).body(p).element(element));
            }
            if given.spoiled {
                return Err(Error::new(Kind::State, SPOILED).body(p));
            }
        }
        Ok(())
    }

    fn check_empty(&self) -> Result<()> {
        let counts = self.sizes();
        if counts.bodies + counts.rows + counts.equalities + counts.nodes == 0 {
            return Ok(());
        }
        let what = format!("a file is read into an empty problem; this one has {} bodies", counts.bodies);
        Err(Error::new(Kind::State, what))
    }

    fn fill(&self, bodies: Bodies, file: File, target: &Path) -> io::Result<()> {
        if let Ok(old) = fs::metadata(target) {
            file.set_permissions(old.permissions())?;
        }
        let mut out = BufWriter::with_capacity(BUFFER, file);
        write::write(self, bodies, &mut out)?;
        out.flush()?;
        out.get_ref().sync_all()
    }
}

/// Creates a new file in the folder of `target`.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    loop {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = target.with_file_name(format!("feti-{}-{number}.tmp", process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((path, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Adds the name of the file to an error.
fn at(path: &Path, mut error: Error) -> Error {
    error.what = format!("{}: {}", path.display(), error.what);
    error
}
