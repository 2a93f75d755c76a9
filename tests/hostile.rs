//! Files that once broke the program, or were made to break it. Each is read or rejected quickly,
//! with a short message, and a scene that is read can be drawn. Fuzzing adds files; see
//! `fuzz/README.md`.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod common;

use std::path::{Path, PathBuf};

use glam::DMat4;
use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::LoadOptions;
use marraztu_io::{Loaded, Progress, describe, load, load_picture, open, to_text};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// The paths of the hostile files of a kind, sorted.
fn files(kind: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile").join(kind);
    let mut files: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty(), "there are none of {kind}");
    files
}

/// Checks that a message has a length that users can read.
fn check(path: &Path, message: &str) {
    assert!((1..600).contains(&message.len()), "{}: {message}", path.display());
}

fn draw(loaded: Loaded) {
    for finding in &loaded.findings {
        assert!((1..600).contains(&finding.text.len()), "{}", finding.text);
    }
    assert!(describe(&loaded).starts_with("name"));
    let (scene, view) = common::scene(&[(Shared::new(loaded.model), DMat4::IDENTITY)]);
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(16, 16)));
    assert_eq!(Renderer::default().render(&plan).pixels().len(), 256);
}

#[test]
fn models_are_read_or_refused() {
    for path in files("obj") {
        match load(&path, &LoadOptions::default(), &Progress::new()) {
            Ok(loaded) => draw(loaded),
            Err(error) => check(&path, &error.to_string()),
        }
    }
}

#[test]
fn no_material_is_a_reason_to_refuse_a_model() {
    let folder = tempfile::tempdir().unwrap();
    for path in files("mtl") {
        let name = path.file_name().unwrap();
        std::fs::copy(&path, folder.path().join(name)).unwrap();
        let model =
            format!("mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", name.display());
        let obj = folder.path().join("a.obj");
        std::fs::write(&obj, model).unwrap();
        draw(load(&obj, &LoadOptions::default(), &Progress::new()).unwrap());
    }
}

#[test]
fn textures_are_read_or_refused() {
    for path in files("texture") {
        match load_picture(&path) {
            Ok(picture) => assert!(picture.size().area() < 1 << 24, "{}", path.display()),
            Err(error) => check(&path, &error.to_string()),
        }
    }
}

#[test]
fn scenes_are_read_or_refused_and_saved_as_they_are() {
    for path in files("scene") {
        let opened = match open(&path, &Progress::new()) {
            Ok(opened) => opened,
            Err(error) => {
                check(&path, &error.to_string());
                continue;
            }
        };
        let text = to_text(&path, &opened.scene, &opened.view, &opened.settings).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("a.marraztu");
        std::fs::write(&copy, &text).unwrap();
        let again = open(&copy, &Progress::new()).unwrap();
        assert_eq!(again.scene, opened.scene, "{}", path.display());
    }
}
