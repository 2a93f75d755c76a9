//! Fuzzes textures: any bytes are a picture or are refused.

#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use marraztu_io::load_picture;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    tempfile::tempdir().expect("there is a place for temporary files").keep()
});

fuzz_target!(|data: &[u8]| {
    // A TGA is known by its name alone; all others by their beginning.
    let path = FOLDER.join("a.tga");
    std::fs::write(&path, data).expect("it can be written to");
    if let Ok(picture) = load_picture(&path) {
        let size = picture.size();
        assert!(size.area() > 0 && picture.pixels().len() == size.area());
    }
});
