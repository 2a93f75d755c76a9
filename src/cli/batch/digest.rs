//! Stamps: hashes of everything that a picture depends on.
//!
//! A picture is up to date if its file carries the stamp of its job. The stamp covers the bytes of
//! the model and of all files that it refers to, the options, the camera, the format and the
//! program. The checksums of the test pictures stand for the renderer: they change if any picture
//! changes, even if the version does not.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use marraztu_io::{self as io, Progress, Sources};
use marraztu_lab::pictures;
use sha2::{Digest as _, Sha256};

use super::jobs::Job;
use crate::cli::stage::is_scene;

/// The version of the stamp's content.
const VERSION: u32 = 2;

/// The hashes of a model.
#[derive(Clone, Debug)]
pub(super) struct ModelHash {
    /// The SHA-256 of the file alone.
    pub(super) file: String,
    /// The hash of the file and all files that it refers to.
    all: String,
}

/// A value that several threads may need, computed by the first.
type Slot<T> = Arc<Mutex<Option<T>>>;

/// Computes stamps. Each file is hashed once.
#[derive(Debug)]
pub(super) struct Stamper {
    /// The program's version and its renderer.
    program: String,
    models: Mutex<BTreeMap<PathBuf, Slot<Option<ModelHash>>>>,
    files: Mutex<BTreeMap<PathBuf, Slot<Option<String>>>>,
}

impl Stamper {
    pub(super) fn new() -> Self {
        let mut program = format!("marraztu {}\n", env!("CARGO_PKG_VERSION"));
        for (name, sum) in pictures::listed() {
            // Writing to a string cannot fail.
            let _ = writeln!(program, "{sum:016x} {name}");
        }
        let program = hex(&Sha256::digest(program));
        Self { program, models: Mutex::default(), files: Mutex::default() }
    }

    /// Returns the stamp of a job. `None` if its model cannot be read.
    pub(super) fn stamp(&self, job: &Job) -> Option<String> {
        let model = self.model(&job.row.file)?;
        let (camera, size) = (job.camera(), job.size());
        let texture = job.row.parsed.options.scene.surfaces.texture.as_deref();
        let texture = texture.map(|path| self.file(path).unwrap_or_default());
        let text = format!(
            "{VERSION}\n{}\n{}\n{}{:?}\n{}x{}\n{}\n{texture:?}\n",
            self.program,
            model.all,
            job.row.parsed.text,
            camera.aim,
            size.width,
            size.height,
            job.encodings(),
        );
        Some(hex(&Sha256::digest(text)))
    }

    /// Returns the hashes of a model or scene. `None` if it cannot be read.
    pub(super) fn model(&self, path: &Path) -> Option<ModelHash> {
        once(&self.models, path, || {
            let file = self.file(path)?;
            let mut all = format!("{file}\n");
            for (name, path) in companions(path)? {
                let hash = path.map_or_else(
                    || Some("missing".to_owned()),
                    |path| Some(self.file(&path).unwrap_or_else(|| "unreadable".to_owned())),
                );
                let _ = writeln!(all, "{name:?} {}", hash.unwrap_or_default());
            }
            Some(ModelHash { file, all: hex(&Sha256::digest(all)) })
        })
    }

    /// Returns the SHA-256 of a file.
    fn file(&self, path: &Path) -> Option<String> {
        once(&self.files, path, || hash_of_file(path).ok())
    }
}

/// Returns the names and files that a model or scene refers to. `None` if it cannot be read.
pub(super) fn companions(path: &Path) -> Option<Vec<(String, Option<PathBuf>)>> {
    if !is_scene(path) {
        let companions = io::companions(path).ok()?;
        return Some(companions.into_iter().map(|it| (it.name, it.path)).collect());
    }
    let opened = io::open(path, &Progress::new()).ok()?;
    let sources = Sources::of(&opened.scene);
    // Folders differ between machines, so the names are left out.
    let mut files: Vec<_> =
        sources.files().map(|path| (String::new(), Some(path.to_owned()))).collect();
    files.sort();
    Some(files)
}

/// Returns the value of a path, computed at most once at a time.
fn once<T: Clone>(
    map: &Mutex<BTreeMap<PathBuf, Slot<T>>>,
    path: &Path,
    compute: impl FnOnce() -> T,
) -> T {
    let slot = {
        let mut map = map.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(map.entry(path.to_owned()).or_default())
    };
    let mut value = slot.lock().unwrap_or_else(PoisonError::into_inner);
    value.get_or_insert_with(compute).clone()
}

/// Returns the SHA-256 of a file in hexadecimal digits. Fails if it cannot be read.
pub(super) fn hash_of_file(path: &Path) -> std::io::Result<String> {
    io::check_file(path).map_err(std::io::Error::other)?;
    let mut file = File::open(path)?;
    let mut hash = Sha256::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(hex(&hash.finalize())),
            count => hash.update(&piece[..count]),
        }
    }
}

/// Returns the SHA-256 of bytes in hexadecimal digits.
pub(super) fn hash_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_the_one_of_sha256sum() {
        // FIPS 180-2, appendix B.1.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hash_of(b"abc"), abc);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        assert_eq!(hash_of_file(&path).unwrap(), abc);
        assert!(hash_of_file(folder.path()).is_err());
    }

    #[test]
    fn a_model_has_another_hash_after_each_change_of_a_file_that_it_refers_to() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let hash = || Stamper::new().model(&at("a.obj")).unwrap();
        std::fs::write(at("a.obj"), "mtllib a.mtl\nv 0 0 0\n").unwrap();
        let mut all = vec![hash().all];
        for (name, text) in [
            ("a.mtl", "newmtl a\nmap_Kd a.png\n"),
            ("a.png", "1"),
            ("a.png", "2"),
            ("a.mtl", "newmtl b\nmap_Kd a.png\n"),
        ] {
            std::fs::write(at(name), text).unwrap();
            all.push(hash().all);
        }
        let file = hash().file;
        std::fs::write(at("a.obj"), "mtllib a.mtl\nv 0 0 1\n").unwrap();
        all.push(hash().all);
        assert_ne!(hash().file, file);
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 6, "every change shows");
        assert!(Stamper::new().model(&at("absent.obj")).is_none());
    }
}
