//! Khronos' validator accepts every exported glTF file.

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use super::{grey, put, put_picture, run};

/// The npm package of the validator, with its version.
const PACKAGE: &str = "gltf-validator@2.0.0-dev.3.10";

/// Whether skipping the test counts as a failure.
fn is_required() -> bool {
    std::env::var_os("MARRAZTU_REQUIRE_SHARED").is_some_and(|value| value == "1")
}

#[expect(clippy::print_stderr, reason = "who runs the tests has to see what is left out")]
fn left_out(reason: &str) {
    assert!(!is_required(), "{reason}");
    eprintln!("LEFT OUT: {reason}");
}

/// The folder of the validator; npm installs it on first use.
fn validator() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gltf-validator");
    let module = folder.join("node_modules/gltf-validator");
    if !module.is_dir() {
        std::fs::create_dir_all(&folder).unwrap();
        let install = ["install", "--silent", "--no-audit", "--no-fund", "--prefix", ".", PACKAGE];
        let done = Process::new("npm").current_dir(&folder).args(install).output();
        if !done.is_ok_and(|output| output.status.success()) || !module.is_dir() {
            left_out("npm cannot install gltf-validator");
            return None;
        }
    }
    Some(module)
}

/// All files below a folder with one of these endings.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else { return found };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if endings.iter().any(|ending| path.to_string_lossy().ends_with(ending)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Inputs that are easy to export wrongly: no faces, huge numbers, odd normals, odd names, every
/// kind of opacity.
fn odd(folder: &Path) {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let mapped = format!("{square}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n");
    let maps = "newmtl m\nKd .5 .25 1\nKe 2 3 0\nd .5\nmap_Kd soft.png\nmap_d -s 2 2 1 grey.png\n\
                map_Ke -o .5 0 0 soft.png\nnorm -s 3 3 1 soft.png\nPr 7\nPm -1\n\
                newmtl n\nmap_d grey.png\nnewmtl h\nmap_Kd hard.png\nnewmtl h\nmap_d hard.png\n";
    let cases = [
        ("points.obj", format!("o only points\n{square}")),
        ("huge.obj", "v 0 0 0\nv 3e38 0 0\nv 0 3e38 1e38\nf 1 2 3\n".into()),
        ("large.obj", "v 0 0 0\nv 5e30 0 0\nv 0 7e33 1e31\nf 1 2 3\n".into()),
        ("tiny.obj", "v 0 0 0\nv 1e-40 0 0\nv 0 1e-42 0\nf 1 2 3\n".into()),
        ("no-area.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\nf 1 1 1\n".into()),
        ("zero-normals.obj", format!("{square}vn 0 0 0\nvn 0 0 9\nf 1//1 2//2 3//1 4//1\n")),
        ("names.obj", format!("o \u{e9}\u{1}\u{7f}\ng \"q\"\\x\n{square}f 1 2 3\no\ng\nf 1 3 4\n")),
        ("some-uvs.obj", format!("mtllib m.mtl\n{mapped}usemtl m\nf 1/1 2/2 3/3\nf 1 3 4\n")),
        ("no-uvs.obj", format!("mtllib m.mtl\n{square}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n")),
        (
            "maps.obj",
            format!(
                "mtllib m.mtl\n{mapped}usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 3/3 4/4\n\
                 usemtl h\nf 1/1 4/4 2/2\nusemtl none\nf 2/2 3/3 4/4\n"
            ),
        ),
        ("colours.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 2 0\nv 1 1 0 0 0 1\nf 1 2 3\n".into()),
    ];
    for (name, text) in &cases {
        put(folder, &[(name, text)]);
    }
    put(folder, &[("m.mtl", maps)]);
    put_picture(folder, "soft.png", 8, |x, y| [255, 0, 0, u8::try_from(x * 30 + y).unwrap()]);
    put_picture(folder, "grey.png", 3, |x, _| grey(u8::try_from(x * 100).unwrap()));
    put_picture(folder, "hard.png", 5, |x, _| [9, 9, 9, if x < 2 { 0 } else { 255 }]);
}

#[test]
fn the_validator_finds_no_error_and_no_warning_in_any_export() {
    let Some(validator) = validator() else { return };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let beside = || root.join("../shared");
    let shared = std::env::var_os("MARRAZTU_SHARED").map_or_else(beside, PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    odd(folder.path());
    let mut inputs = files(folder.path(), &[".obj"]);
    inputs.extend(files(&root.join("assets"), &[".obj", ".marraztu"]));
    for name in ["models", "cases"] {
        let found = files(&shared.join(name), &[".obj", ".obj.gz", ".marraztu"]);
        if found.is_empty() {
            left_out(&format!("there are no {name} at {}", shared.display()));
        }
        inputs.extend(found);
    }

    // Two processes at a time, because most of the time is start-up and reading.
    let numbered: Vec<(usize, &PathBuf)> = inputs.iter().enumerate().collect();
    let export = |(i, input): &(usize, &PathBuf)| {
        let ending = if i.is_multiple_of(4) { "gltf" } else { "glb" };
        let stem = input.file_stem().unwrap().to_string_lossy();
        let out = folder.path().join(format!("{i} {stem}.{ending}"));
        let arguments = ["export", &input.to_string_lossy(), "--out", &out.to_string_lossy(), "-q"];
        let output = run(root, &arguments);
        // Some models are broken on purpose.
        output.status.success().then_some(out)
    };
    let half = numbered.len() / 2;
    let exported: Vec<PathBuf> = std::thread::scope(|scope| {
        let export = &export;
        let halves = numbered
            .chunks(half.max(1))
            .map(|chunk| scope.spawn(move || chunk.iter().filter_map(export).collect::<Vec<_>>()));
        let halves: Vec<_> = halves.collect();
        halves.into_iter().flat_map(|half| half.join().unwrap()).collect()
    });
    assert!(exported.len() + 15 > inputs.len(), "{} of {}", exported.len(), inputs.len());

    let script = root.join("tests/exports/validate.cjs");
    let output = Process::new("node").arg(script).arg(validator).args(&exported).output().unwrap();
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(report, format!("{} files\n", exported.len()), "{:?}", output.status);
}
