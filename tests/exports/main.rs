//! Exports, read as other programs read them.
//!
//! Catches: glTF that Khronos' validator rejects, lost names and numbers, colours and opacity that
//! other programs display differently.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod again;
mod gltf;
mod kept;
mod validator;

use std::path::Path;
use std::process::{Command as Process, Output};

use marraztu_core::base::image::{Picture, Size};
use marraztu_io as io;
use serde_json::Value;

/// Runs the program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_marraztu");
    Process::new(program).current_dir(folder).args(arguments).output().unwrap()
}

/// Runs the program in a folder, checks that it succeeds, and returns its output.
#[track_caller]
fn runs(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}\n{text}");
    text
}

/// Writes text files into a folder.
fn put(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

/// Writes a square picture of `side` texels on a side.
fn put_picture(folder: &Path, name: &str, side: usize, texel: impl Fn(usize, usize) -> [u8; 4]) {
    let pixels = (0..side * side).map(|i| texel(i % side, i / side)).collect();
    let picture = Picture::from_pixels(Size::new(side, side), pixels).unwrap();
    io::save_picture(&folder.join(name), &picture).unwrap();
}

const fn grey(value: u8) -> [u8; 4] {
    [value, value, value, 255]
}

/// The JSON of a .gltf file.
fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The bytes of an image of a .gltf file, from its buffer view.
fn image_bytes(path: &Path, json: &Value, image: usize) -> Vec<u8> {
    let number = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let view = &json["bufferViews"][number(&json["images"][image]["bufferView"])];
    let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
    let buffer = std::fs::read(path.with_extension("bin")).unwrap();
    buffer[start..start + length].to_vec()
}

/// Decodes an image of a .gltf file.
fn image(path: &Path, json: &Value, image: usize) -> Picture {
    let file = path.with_extension("image.png");
    std::fs::write(&file, image_bytes(path, json, image)).unwrap();
    io::load_picture(&file).unwrap()
}

#[test]
fn hidden_objects_and_parts_are_counted_in_notes() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 1 3 2\n";
    let object = |id: u32, rest: &str| {
        format!("(id: {id}, name: \"t{id}\", model: File(path: \"t.obj\"), {rest}), ")
    };
    let objects = [object(1, "hidden_parts: \"0\""), object(2, "visible: false")].concat();
    let cameras = "(id: 90, name: \"c\", eye: (0.5, 0.8, 8.0))";
    let scene = format!("(version: 1, objects: [{objects}], cameras: [{cameras}])");
    put(folder.path(), &[("t.obj", obj), ("s.marraztu", &scene)]);
    for name in ["s.obj", "s.glb"] {
        let notes = runs(folder.path(), &["export", "s.marraztu", "--out", name]);
        for what in ["objects", "parts"] {
            assert!(notes.contains(&format!("hidden {what} are left out: 1")), "{name} {notes}");
        }
    }
}

#[test]
fn a_lens_that_gltf_lacks_is_named_in_a_note() {
    let folder = tempfile::tempdir().unwrap();
    for (lens, is_noted) in [("", false), ("shift: (0.1, 0.0)", true), ("pixel_aspect: 1.1", true)]
    {
        let cameras = format!("(id: 90, name: \"eye\", eye: (0.5, 0.8, 8.0), lens: ({lens}))");
        let scene = format!("(version: 1, cameras: [{cameras}])");
        put(folder.path(), &[("s.marraztu", &scene)]);
        let notes = runs(folder.path(), &["export", "s.marraztu", "--out", "s.glb"]);
        let is_there = notes.contains("eye has a centred lens with square pixels");
        assert_eq!(is_there, is_noted, "{lens}: {notes}");
    }
}
