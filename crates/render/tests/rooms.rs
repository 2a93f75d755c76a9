//! The rooms of this crate, lowest first: code uses its own room and those before it.

use std::path::{Path, PathBuf};

const ROOMS: &[&str] = &[
    "cancellation",
    "work_stealing",
    "timings",
    "accel",
    "simd",
    "lights",
    "frame",
    "texture",
    "screen",
    "plan",
    "ancestors",
    "raster",
    "rays",
    "shadow",
    "shading",
    "tile_layers",
    "picture_camera",
    "layers",
    "count",
    "damage",
    "renderer",
    "unseen",
    "without_ground",
    "bands",
    "exposure",
];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries
        .flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// The names that follow `start` outside comments: the first part of a path.
fn names_after<'a>(text: &'a str, start: &'a str) -> impl Iterator<Item = &'a str> {
    let code = text.lines().filter_map(|line| line.split("//").next());
    code.flat_map(move |line| {
        line.split(start).skip(1).filter_map(|rest| rest.split(|c: char| !is_name(c)).next())
    })
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Rooms above `room` that a file uses. A path into another room starts with `crate::`, or with
/// `super::` in a file beside `lib.rs`.
fn faults(room: &str, beside_lib: bool, text: &str) -> Vec<String> {
    let Some(own) = ROOMS.iter().position(|name| *name == room) else {
        return vec!["is in no room of the table".to_owned()];
    };
    // A unit test may draw whole pictures.
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
    let by_super = names_after(text, "super::").filter(|_| beside_lib);
    names_after(text, "crate::")
        .chain(by_super)
        .filter(|name| ROOMS.iter().position(|room| room == name).is_some_and(|at| at > own))
        .map(|name| format!("uses the room {name}, which is above {room}"))
        .collect()
}

#[test]
fn no_room_uses_one_above_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    for file in rust_files(&src).iter().filter(|file| !file.ends_with("lib.rs")) {
        let name = file.strip_prefix(&src).unwrap();
        let first = name.components().next().unwrap().as_os_str().to_str().unwrap();
        let (room, beside_lib) = (first.trim_end_matches(".rs"), first.ends_with(".rs"));
        let text = std::fs::read_to_string(file).unwrap();
        let faults = faults(room, beside_lib, &text);
        wrong.extend(faults.into_iter().map(|fault| format!("{} {fault}", name.display())));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_use_of_a_room_above_is_seen() {
    assert_eq!(faults("raster", false, "use crate::shading::Lists;").len(), 1);
    assert_eq!(faults("count", true, "use super::damage::Damage;").len(), 1);
    assert_eq!(faults("renderer", true, "use super::damage::Damage;").len(), 0);
    assert_eq!(faults("raster", false, "// crate::shading\nuse crate::screen::Tile;").len(), 0);
    assert_eq!(faults("kitchen", false, "").len(), 1);
}
