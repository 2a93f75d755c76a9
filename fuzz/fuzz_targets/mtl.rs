//! Fuzzes MTL files: a model is read whatever the bytes of its MTL file, with the materials that
//! could be parsed.

#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use marraztu_io::{Progress, describe, load};
use marraztu_core::scene::LoadOptions;

/// A folder with a model and a texture, to which each run adds the materials.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("there is a place for temporary files").keep();
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    std::fs::write(folder.join("a.obj"), model).expect("it can be written to");
    let texture = b"P6 1 1 255\n\x01\x02\x03";
    std::fs::write(folder.join("T.ppm"), texture).expect("it can be written to");
    folder
});

fuzz_target!(|data: &[u8]| {
    std::fs::write(FOLDER.join("a.mtl"), data).expect("it can be written to");
    let loaded = load(&FOLDER.join("a.obj"), &LoadOptions::default(), &Progress::new());
    let loaded = loaded.expect("no MTL file is a reason to refuse a model");
    for material in &loaded.model.materials {
        let m = &material.material;
        let colors = [m.ambient, m.diffuse, m.specular].concat();
        assert!(colors.iter().all(|x| (0.0..=1.0).contains(x)), "{m:?}");
        assert!(m.exponent >= 1.0 && m.exponent.is_finite(), "{m:?}");
        assert!((0.0..=1.0).contains(&material.opacity), "{}", material.opacity);
    }
    assert!(describe(&loaded).starts_with("name"));
});
