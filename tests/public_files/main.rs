//! Files as users and programs write them, after public bug reports: nothing is lost or shown
//! wrong.
//!
//! Catches: an input replaced by an output, a whole file rejected for one odd word, a fault that is
//! visible in the picture but not among the findings, a picture with another format than its name.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use marraztu_core::base::image::{Picture, Size};
use marraztu_io as io;
use tempfile::TempDir;

mod appearance;
mod coordinates;
mod findings;
mod outputs;
mod spelling;
mod stl;

/// A unit square in the plane z = 0, with texture coordinates and the material `m`.
const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
                      vt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// A cube from -1 to 1 with counter-clockwise faces as seen from outside.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\n\
                    v 1 1 1\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

/// A temporary folder, the program's working directory.
struct Folder(TempDir);

impl Folder {
    fn with(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, text) in files {
            std::fs::write(folder.at(name), text).unwrap();
        }
        folder
    }

    fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.at(name)).unwrap()
    }

    /// Writes a square picture with texels computed from column and row.
    fn picture(&self, name: &str, side: usize, texel: impl Fn(usize, usize) -> [u8; 4]) {
        let texels = (0..side * side).map(|i| texel(i % side, i / side)).collect();
        let picture = Picture::from_pixels(Size::new(side, side), texels).unwrap();
        io::save_picture(&self.at(name), &picture).unwrap();
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_marraztu");
        Command::new(program).current_dir(self.path()).args(arguments).output().unwrap()
    }

    /// Runs the program, checks its exit status, and returns standard output and standard error.
    #[track_caller]
    fn ends(&self, status: i32, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let told = [output.stdout, output.stderr].concat();
        let told = String::from_utf8_lossy(&told).into_owned();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}\n{told}");
        told
    }

    /// Returns the output of `info` for a file.
    #[track_caller]
    fn info(&self, name: &str) -> String {
        self.ends(0, &["info", name])
    }

    /// Returns a small picture drawn by `render` with one sample per pixel.
    #[track_caller]
    fn drawn(&self, arguments: &[&str]) -> Picture {
        let render = ["render", "--size", "64", "--samples", "1", "--out", "drawn.png"];
        self.ends(0, &[&render, arguments].concat());
        io::load_picture(&self.at("drawn.png")).unwrap()
    }
}

/// The pixel at the centre of a picture.
fn middle(picture: &Picture) -> [u8; 4] {
    let Size { width, height } = picture.size();
    picture.pixel(width / 2, height / 2)
}
