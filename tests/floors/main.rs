//! The floors of the crate and the rooms of a floor: which may use which.

mod arrows;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use arrows::{Sources, cycles};

/// Each floor with the floors under it that it may use. Standing on oneself is always allowed.
const FLOORS: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("scene", &["base"]),
    ("accuracy", &["base", "scene"]),
    ("io", &["base", "scene", "accuracy"]),
    ("edit", &["base", "scene", "accuracy"]),
    ("render", &["base", "scene", "accuracy"]),
    ("lab", &["base", "scene", "accuracy", "io", "edit", "render"]),
    ("app", &["base", "scene", "accuracy", "io", "edit", "render", "lab"]),
    // The command line opens the window, and lists its keys.
    ("cli", &["base", "scene", "accuracy", "io", "edit", "render", "lab", "app"]),
];

/// The rooms of a folder, files or folders, lowest first: a room may use those named before it. The
/// folder's own `mod.rs` stands above them all; that of a room may be a room by itself.
const ROOMS: &[(&str, &[&str])] = &[
    (
        "base",
        &[
            "once",
            "lists",
            "shared",
            "color",
            "byte_bounds",
            "image",
            "math",
            "rng",
            "cancellation",
            "work_stealing",
        ],
    ),
    (
        "render",
        &[
            "timings",
            "simd",
            "lights",
            "frame",
            "texture",
            "screen",
            "plan",
            "reference",
            "raster",
            "shadow",
            "shading",
            "tile_layers",
            "count",
            "damage",
            "renderer",
            "unseen",
            "without_ground",
            "exposure",
        ],
    ),
    (
        "lab",
        &[
            "hash",
            "timing",
            "statistics",
            "front",
            "flip",
            "error",
            "picture_source",
            "pixel",
            "attribution",
            "pairs",
            "candidates",
            "cost",
            "kernels",
            "instructions",
            "pictures",
            "sweep",
            "report",
            "suite",
        ],
    ),
    (
        "edit",
        &[
            "refusal",
            "gesture",
            "names",
            "set_transform",
            "items",
            "lights",
            "motion",
            "framing",
            "turntable",
            "lighting",
            "steps",
            "arrange",
            "shapes",
            "angles",
            "transform",
            "navigation",
            "placement",
            "aiming",
            "gizmo",
            "selection",
            "several",
            "copies",
            "selected",
            "presenting",
            "history",
        ],
    ),
    (
        "app",
        &[
            "theme",
            "fonts",
            "tasks",
            "painter",
            "shell",
            "widgets",
            "drawing",
            "chord",
            "panels/mod",
            "state",
            "actions",
            "input",
            "documents",
            "panels",
            "viewport",
            "editor",
            "start",
        ],
    ),
];

/// Crates that only one floor may use.
const GUESTS: &[(&str, &str)] = &[
    ("egui", "app"),
    ("eframe", "app"),
    ("egui_winit", "app"),
    ("winit", "app"),
    ("softbuffer", "app"),
    ("egui_material_icons", "app"),
    ("nucleo_matcher", "app"),
    ("rfd", "app"),
    ("fontdb", "app"),
    ("ttf_parser", "app"),
    ("png", "io"),
    ("gltf_json", "io"),
    ("tobj", "io"),
    ("image", "io"),
    ("ron", "io"),
    ("egui_plot", "app"),
    ("plotters", "lab"),
    ("serde_json", "lab"),
    ("clap", "cli"),
    ("indicatif", "cli"),
];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the floor has a folder") {
        let path = entry.expect("the folder can be read").path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// The names with which the paths begin that a source mentions, `{...}` of a `use` opened: for
/// `use crate::{base::math, scene}` these are `crate::base` and `crate::scene`. Comments are left
/// out, since they may name anything.
fn first_names(text: &str) -> Vec<String> {
    let code: String = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""))
        .collect::<Vec<_>>()
        .join(" ");
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut names = Vec::new();
    for (at, _) in code.match_indices("::") {
        let before = code[..at].trim_end();
        let start = before.rfind(|c| !is_name(c)).map_or(0, |i| i + 1);
        // In `a::b::c` only a is the beginning.
        if before[..start].ends_with("::") {
            continue;
        }
        match &before[start..] {
            own @ ("crate" | "marraztu") => {
                for name in after(&code[at + 2..]) {
                    names.push(format!("{own}::{name}"));
                }
            }
            name => names.push(name.to_owned()),
        }
    }
    names
}

/// The first names behind `crate::`, one or, in braces, many.
fn after(rest: &str) -> Vec<&str> {
    let name = |text: &'_ str| text.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    let first = |text: &str| name(text).unwrap_or(text.len());
    if !rest.starts_with('{') {
        return vec![&rest[..first(rest)]];
    }
    let (mut depth, mut begin, mut found) = (0, true, Vec::new());
    for (i, c) in rest.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => break,
            '}' => depth -= 1,
            ',' => begin = depth == 1,
            c if c.is_whitespace() => {}
            _ if begin && depth == 1 => {
                found.push(&rest[i..i + first(&rest[i..])]);
                begin = false;
            }
            _ => {}
        }
    }
    found
}

/// The faults of a source on `floor`.
fn faults(floor: &str, text: &str) -> Vec<String> {
    let under = FLOORS.iter().find(|(name, _)| *name == floor).map_or(&[][..], |(_, under)| under);
    let mut faults = Vec::new();
    for name in first_names(text) {
        let own = name.strip_prefix("crate::").or_else(|| name.strip_prefix("marraztu::"));
        match own {
            Some(other) => {
                let is_floor = FLOORS.iter().any(|(name, _)| *name == other);
                if is_floor && other != floor && !under.contains(&other) {
                    faults.push(format!("uses the floor {other}"));
                }
            }
            None => {
                let home = GUESTS.iter().find(|(guest, _)| *guest == name);
                // `image` is also the name of a module of ours: `use super::image` begins with
                // super.
                if home.is_some_and(|(_, home)| *home != floor) {
                    faults.push(format!("uses the crate {name}"));
                }
            }
        }
    }
    faults
}

#[test]
fn no_floor_uses_one_above_it_or_beside_it_and_no_guest_leaves_its_floor() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    let mut read = 0;
    for (floor, _) in FLOORS {
        for file in rust_files(&src.join(floor)) {
            let text = std::fs::read_to_string(&file).unwrap();
            read += 1;
            let name = file.strip_prefix(&src).unwrap().display().to_string();
            wrong.extend(faults(floor, &text).into_iter().map(|fault| format!("{name} {fault}")));
        }
    }
    assert!(read > 30, "the sources are elsewhere");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_folder_is_a_floor() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let root = std::fs::read_to_string(src.join("lib.rs")).unwrap();
    for line in root.lines().filter_map(|line| line.strip_prefix("pub mod ")) {
        let name = line.trim_end_matches(';');
        assert!(FLOORS.iter().any(|(floor, _)| *floor == name), "{name} is on no floor");
    }
}

#[test]
fn a_use_of_a_wrong_floor_is_seen_however_it_is_written() {
    let wrong = [
        ("edit", "use crate::render::FramePlan;"),
        ("edit", "use crate::{base::math, render::{FramePlan, Hit}};"),
        ("render", "fn f() { crate::io::load(); }"),
        ("scene", "use crate::{\n    base,\n    app,\n};"),
        ("base", "use crate::scene;"),
        ("render", "use egui::Ui;"),
        ("edit", "fn f(p: &image::RgbaImage) {}"),
        ("app", "let models = tobj::load_obj(path);"),
    ];
    for (floor, text) in wrong {
        assert_eq!(faults(floor, text).len(), 1, "{floor}: {text}");
    }
    let right = [
        ("edit", "use crate::{base::math, scene::{Scene, View}};"),
        ("edit", "// crate::render draws it, egui::Ui shows it"),
        ("base", "use super::image::Size; use crate::base::image::Picture;"),
        ("app", "use crate::render::FramePlan; use egui::Ui;"),
        ("io", "use image::ImageReader;"),
    ];
    for (floor, text) in right {
        assert_eq!(faults(floor, text), Vec::<String>::new(), "{floor}: {text}");
    }
}

/// The faults of the rooms of a folder.
fn room_faults(sources: &Sources, folder: &str, rooms: &[&str]) -> Vec<String> {
    let names: Vec<&str> = folder.split('/').collect();
    let arrows = sources.arrows(&names);
    let room = |module: &[String]| {
        let name = module.get(names.len())?;
        let alone = format!("{name}/mod");
        let is_alone = module.len() == names.len() + 1 && rooms.contains(&alone.as_str());
        Some(if is_alone { alone } else { name.clone() })
    };
    let floor = |room: &Option<String>| match room {
        Some(room) => rooms.iter().position(|name| name == room),
        None => Some(rooms.len()),
    };
    let mut faults = BTreeSet::new();
    for (module, used) in &arrows {
        let own = room(module);
        let Some(here) = floor(&own) else {
            faults.insert(format!("{folder}: {} is no room of the table", own.unwrap_or_default()));
            continue;
        };
        for other in used.iter().filter(|other| floor(&room(other)).is_some_and(|at| at > here)) {
            faults.insert(format!("{} uses {} above it", module.join("/"), other.join("/")));
        }
    }
    for name in rooms {
        if !arrows.keys().any(|module| room(module).as_deref() == Some(*name)) {
            faults.insert(format!("{folder}: there is no room {name}"));
        }
    }
    let cycles = cycles(&arrows).into_iter().map(|cycle| {
        let files: Vec<String> = cycle.iter().map(|module| module.join("/")).collect();
        format!("a cycle of {} files: {}", files.len(), files.join(", "))
    });
    faults.into_iter().chain(cycles).collect()
}

#[test]
fn no_room_uses_one_above_it_and_no_cycle_of_files_is_longer_than_a_file_and_its_parts() {
    let sources = Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let wrong: Vec<String> =
        ROOMS.iter().flat_map(|(folder, rooms)| room_faults(&sources, folder, rooms)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn no_cycle_of_files_is_longer_than_a_file_and_its_parts_anywhere() {
    let sources = Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let cycles: Vec<Vec<String>> = cycles(&sources.arrows(&[]))
        .into_iter()
        .map(|cycle| cycle.iter().map(|module| module.join("/")).collect())
        .collect();
    assert_eq!(cycles, [[""; 0]; 0]);
}

#[test]
fn an_arrow_between_rooms_is_seen_however_it_is_written() {
    let shop = |low: &str, high: &str, door: &str| {
        let files = [("a/mod.rs", door), ("a/low.rs", low), ("a/high.rs", high)];
        let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
        room_faults(&Sources::of(files), "a", &["low", "high"])
    };
    let door =
        "mod low; mod high; pub use high::Tall; pub use high::*; use high::Renamed as Other;";
    let high = "pub struct Tall; pub fn build() {}";
    for low in [
        "use super::high;",
        "use super::high::Tall;",
        "use crate::a::high::{Tall, build};",
        "use crate::{a::{high::{self as up}}};",
        "use super::Tall;",
        "use super::build;",
        "use super::Other;",
        "use super::*; fn f(tall: Tall) {}",
        "fn f() { super::high::build::<u8>() }",
        "mod inner { use super::super::high; }",
        "mod inner { fn f() { crate::a::Tall; } }",
    ] {
        assert!(!shop(low, high, door).is_empty(), "{low}");
    }
    for low in [
        "// use super::high;",
        "mod inner { use super::high; }",
        "#[cfg(test)] mod tests { use super::super::high; }",
        "use std::high::Tall;",
    ] {
        assert_eq!(shop(low, high, door), Vec::<String>::new(), "{low}");
    }
    let up_and_down = shop("use super::high;", "use super::low;", door);
    assert_eq!(up_and_down.len(), 2, "{up_and_down:#?}");
}

#[test]
fn a_file_and_its_own_parts_are_no_cycle_but_its_parts_among_each_other_are() {
    let whole = |first: &str, second: &str| {
        let files = [
            ("a/mod.rs", "mod whole;"),
            ("a/whole/mod.rs", "mod first; mod second; pub fn f() { first::g(); second::h(); }"),
            ("a/whole/first.rs", first),
            ("a/whole/second.rs", second),
        ];
        let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
        room_faults(&Sources::of(files), "a", &["whole"])
    };
    assert_eq!(whole("use super::f;", "use super::f;"), Vec::<String>::new());
    assert_eq!(whole("use super::second;", "use super::f;"), Vec::<String>::new());
    assert_eq!(whole("use super::second;", "use super::first;").len(), 1);
}
