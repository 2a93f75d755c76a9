//! Stamps: hashes of everything that a picture depends on.
//!
//! A picture is up to date if its file carries the stamp of its job. The stamp covers the bytes of
//! the model and of all files that it refers to, the options, the camera, the format and the
//! program. The checksums of the test pictures stand for the renderer: they change if any picture
//! changes, even if the version does not.
//!
//! Files are hashed before they are loaded. If a model is edited while its picture is drawn, the
//! picture has the stamp of the old model, so a later run draws it again.

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
use super::rows::Row;
use crate::cli::stage::is_scene;

/// The version of the stamp's content.
const VERSION: u32 = 2;

/// The most hashes of a kind that are remembered.
const MOST_KNOWN: usize = 10_000;

/// The hashes of the files that a row is drawn from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SourceHash {
    /// The SHA-256 of the model or scene alone.
    pub(super) file: String,
    /// The hash of the file and all files that it refers to.
    all: String,
    /// The SHA-256 of the texture and the panorama of the options, empty if one cannot be read.
    pictures: [Option<String>; 2],
}

impl SourceHash {
    /// Hashes the files of a row as they are now. `None` if the model cannot be read.
    pub(super) fn of(row: &Row) -> Option<Self> {
        Self::by(row, &|path| hash_of_file(path).ok())
    }

    fn by(row: &Row, hash: &dyn Fn(&Path) -> Option<String>) -> Option<Self> {
        let file = hash(&row.file)?;
        let mut all = format!("{file}\n");
        for (name, path) in companions(&row.file)? {
            let hash = path.map_or_else(
                || "missing".to_owned(),
                |path| hash(&path).unwrap_or_else(|| "unreadable".to_owned()),
            );
            // Writing to a string cannot fail.
            let _ = writeln!(all, "{name:?} {hash}");
        }
        let pictures = [row.texture(), row.sky()].map(|path| Some(hash(path?).unwrap_or_default()));
        Some(Self { file, all: hex(&Sha256::digest(all)), pictures })
    }
}

/// A value that several threads may need, computed by the first.
type Slot<T> = Arc<Mutex<Option<T>>>;

/// Values by file, remembered in part.
type Memory<K, T> = Mutex<BTreeMap<K, Slot<Option<T>>>>;

/// Computes stamps.
#[derive(Debug)]
pub(super) struct Stamper {
    /// The program's version and its renderer.
    program: String,
    /// The hashes by model, texture and panorama, and by file.
    sources: Memory<[Option<PathBuf>; 3], SourceHash>,
    files: Memory<PathBuf, String>,
}

impl Stamper {
    /// Creates a stamper for pictures with lights that stay in all views, or that follow the view.
    pub(super) fn new(has_fixed_lights: bool) -> Self {
        let mut program = format!("marraztu {}\n", env!("CARGO_PKG_VERSION"));
        if has_fixed_lights {
            program.push_str("fixed lights\n");
        }
        for (name, sum) in pictures::listed() {
            let _ = writeln!(program, "{sum:016x} {name}");
        }
        let program = hex(&Sha256::digest(program));
        Self { program, sources: Mutex::default(), files: Mutex::default() }
    }

    /// Returns the stamp of a picture that is drawn from files with these hashes.
    pub(super) fn stamp(&self, job: &Job, source: &SourceHash) -> String {
        let (camera, size) = (job.camera(), job.size());
        let [texture, sky] = &source.pictures;
        let text = format!(
            "{VERSION}\n{}\n{}\n{}{:?}\n{}x{}\n{}\n{texture:?}\n{}",
            self.program,
            source.all,
            job.row.kind.parsed.text,
            camera.aim,
            size.width,
            size.height,
            job.encodings(),
            // Pictures without a panorama keep their stamps.
            sky.as_ref().map_or_else(String::new, |sky| format!("{sky}\n")),
        );
        hex(&Sha256::digest(text))
    }

    /// Returns the hashes of the files of a row, as they were at the first call. `None` if the
    /// model cannot be read. Pictures are compared with these hashes; a picture that is drawn has
    /// the hashes of its loaded files ([`SourceHash::of`]).
    pub(super) fn known(&self, row: &Row) -> Option<SourceHash> {
        let key = [Some(&*row.file), row.texture(), row.sky()].map(|path| path.map(Path::to_owned));
        let file = |path: &Path| once(&self.files, path.to_owned(), || hash_of_file(path).ok());
        once(&self.sources, key, || SourceHash::by(row, &file))
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

/// Returns the value of a key, computed at most once at a time.
fn once<K: Ord, T: Clone>(
    memory: &Memory<K, T>,
    key: K,
    compute: impl FnOnce() -> Option<T>,
) -> Option<T> {
    let slot = {
        let mut map = memory.lock().unwrap_or_else(PoisonError::into_inner);
        if map.len() >= MOST_KNOWN {
            map.clear();
        }
        Arc::clone(map.entry(key).or_default())
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
    use super::super::tests::jobs_of;
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
        let row = |name: &str| {
            let jobs = jobs_of(&[at(name).to_str().unwrap()]).unwrap();
            Arc::clone(&jobs[0].row)
        };
        let hash = || Stamper::new(false).known(&row("a.obj")).unwrap();
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
        assert!(Stamper::new(false).known(&row("absent.obj")).is_none());
    }
}
