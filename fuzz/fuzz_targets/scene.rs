//! Fuzzes scene files: any bytes are a scene or are refused, and a scene can be saved and gives the
//! same text each time.

#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use marraztu_io::{Progress, open, to_text};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    tempfile::tempdir().expect("there is a place for temporary files").keep()
});

fuzz_target!(|data: &[u8]| {
    let path = FOLDER.join("a.marraztu");
    std::fs::write(&path, data).expect("it can be written to");
    let text = || {
        let opened = open(&path, &Progress::new()).ok()?;
        let text = to_text(&path, &opened.scene, &opened.view, &opened.settings);
        Some(text.expect("a scene that was opened can be saved"))
    };
    let Some(first) = text() else { return };
    std::fs::write(&path, &first).expect("it can be written to");
    assert_eq!(text().as_ref(), Some(&first));
});
