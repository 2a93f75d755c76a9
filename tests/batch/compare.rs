//! `marraztu compare` as a check in continuous integration: folders, masks, limits and reports.

use std::path::Path;

use marraztu_core::base::image::{Picture, Size};
use marraztu_io as io;
use serde_json::Value;
use tempfile::TempDir;

use super::{ends_with, folder};

const SIDE: usize = 16;

/// Saves a grey picture in which the first pixels of the first row are brighter.
fn save(folder: &Path, name: &str, changed: usize, steps: u8) {
    let mut picture = vec![[100, 100, 100, 255]; SIDE * SIDE];
    picture[..changed].fill([100 + steps, 100, 100, 255]);
    let picture = Picture::from_pixels(Size::new(SIDE, SIDE), picture).unwrap();
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    io::save_picture(&path, &picture).unwrap();
}

/// Two folders: one pair is equal, one differs, and one picture is in each folder alone.
fn folders() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, changed) in
        [("a/same.png", 0), ("b/same.png", 0), ("a/deep/x.png", 0), ("b/deep/x.png", 2)]
    {
        save(folder.path(), name, changed, 3);
    }
    save(folder.path(), "a/old.png", 0, 0);
    save(folder.path(), "b/new.webp", 0, 0);
    std::fs::write(folder.path().join("a/notes.txt"), "not a picture").unwrap();
    folder
}

fn compare(status: i32, folder: &Path, arguments: &[&str]) -> (String, String) {
    ends_with(status, folder, &[&["compare"], arguments].concat())
}

fn compare_json(status: i32, folder: &Path, arguments: &[&str]) -> Value {
    let (out, _) = compare(status, folder, &[arguments, &["--json"]].concat());
    serde_json::from_str(&out).unwrap()
}

#[test]
fn folders_are_compared_by_path_and_pictures_of_one_alone_are_reported() {
    let folder = folders();
    let (out, err) = compare(1, folder.path(), &["a", "b", "--out", "d", "--junit", "r/r.xml"]);
    assert_eq!(err, "");
    let lines: Vec<&str> = out.lines().collect();
    let x = "differs  deep/x.png: 2 of 256 pixels differ by up to 3, RMSE ";
    assert!(lines[0].starts_with(x) && lines[0].ends_with("(beyond --max)"), "{out}");
    assert_eq!(lines[1..3], ["extra    new.webp: not in a", "missing  old.png: not in b"]);
    assert_eq!(lines[3..], ["1 same, 1 different, 1 missing, 1 extra, 0 not comparable"]);
    let difference = io::load_picture(&folder.path().join("d/deep/x.png")).unwrap();
    assert_eq!([0, 2].map(|x| difference.pixel(x, 0)), [[48, 0, 0, 255], [0, 0, 0, 255]]);
    assert!(!folder.path().join("d/same.png").exists());
    let junit = std::fs::read_to_string(folder.path().join("r/r.xml")).unwrap();
    assert!(junit.contains("tests=\"4\" failures=\"3\" errors=\"0\""), "{junit}");
    assert!(junit.contains("<testcase classname=\"deep\" name=\"x.png\">"), "{junit}");
    compare(1, folder.path(), &["a", "b", "--junit", "r/r.xml"]);

    let json = compare_json(1, folder.path(), &["a", "b"]);
    let summary = serde_json::json!(
        {"pairs": 4, "same": 1, "differs": 1, "missing": 1, "extra": 1, "errors": 0}
    );
    assert_eq!((&json["same"], &json["summary"]), (&Value::Bool(false), &summary));
    let statuses = json["pairs"].as_array().unwrap().iter().map(|pair| pair["status"].clone());
    assert!(statuses.eq(["differs", "extra", "missing", "same"]), "{json}");
    for name in ["old.png", "new.webp"] {
        let own = if name == "old.png" { "a" } else { "b" };
        std::fs::remove_file(folder.path().join(own).join(name)).unwrap();
    }
    let json = compare_json(0, folder.path(), &["a", "b", "--max", "3"]);
    assert_eq!(json["same"], true);
}

#[test]
fn a_share_of_pixels_and_the_mean_error_have_limits_of_their_own() {
    let folder = folders();
    let pair = ["a/deep/x.png", "b/deep/x.png"];
    let limits =
        |status, more: &[&str]| compare_json(status, folder.path(), &[&pair, more].concat());
    // Two of 256 pixels are 0.78%, and the RMSE is 3 sqrt(2 / (3 * 256)).
    assert_eq!(limits(0, &["--pixels", "0.8%"])["pairs"][0]["measures"]["beyond"], 2);
    assert_eq!(limits(1, &["--pixels", "0.007"])["pairs"][0]["exceeded"][0], "pixels");
    let json = limits(0, &["--max", "3", "--rmse", "0.154"]);
    let rmse = json["pairs"][0]["measures"]["rmse"].as_f64().unwrap();
    assert!((rmse - 0.153_093_108_923_948_6).abs() < 1e-12, "{rmse}");
    assert_eq!(limits(1, &["--max", "3", "--rmse", "0.153"])["pairs"][0]["exceeded"][0], "rmse");
    let (out, _) = compare(0, folder.path(), &[&pair[..], &["--pixels", "1%"]].concat());
    assert!(out.contains("beyond --max        2 (0.7812%)\n"), "{out}");
}

#[test]
fn a_mask_selects_the_pixels_that_count_for_one_pair_or_by_name() {
    let folder = folders();
    let black = Picture::filled(Size::new(SIDE, SIDE), [0, 0, 0, 255]);
    let mut lower = black.pixels().to_vec();
    lower[SIDE..].fill([255; 4]);
    let lower = Picture::from_pixels(black.size(), lower).unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("masks/deep")).unwrap();
    for (name, picture) in [("black.png", &black), ("lower.png", &lower)] {
        io::save_picture(&at(name), picture).unwrap();
    }
    let pair = ["a/deep/x.png", "b/deep/x.png", "--mask"];
    let json = compare_json(0, folder.path(), &[&pair[..], &["lower.png"]].concat());
    assert_eq!(json["pairs"][0]["measures"]["pixels"], SIDE * (SIDE - 1));
    let (_, err) = compare(2, folder.path(), &[&pair[..], &["black.png"]].concat());
    assert_eq!(err, "error: the mask black.png selects no pixel\n");

    std::fs::copy(at("lower.png"), at("masks/deep/x.png")).unwrap();
    let json = compare_json(2, folder.path(), &["a", "b", "--mask", "masks"]);
    let status = |name: &str| {
        let pairs = json["pairs"].as_array().unwrap();
        pairs.iter().find(|pair| pair["name"] == name).unwrap()["status"].clone()
    };
    assert_eq!((status("deep/x.png"), status("same.png")), ("same".into(), "error".into()));
}

#[test]
fn numbers_of_layers_are_compared_in_their_own_unit() {
    let folder = folder();
    let draw = |out: &str, scale: &str| {
        let arguments = ["render", "models/cam.obj", "--size", "32", "--layers", "depth,object"];
        let more = ["--scale", scale, "--out", out];
        ends_with(0, folder.path(), &[&arguments[..], &more].concat());
    };
    draw("a-{layer}.npy", "1");
    draw("b-{layer}.npy", "1.001");
    draw("a.exr", "1");
    draw("b.exr", "1.001");
    let depths = ["a-depth.npy", "b-depth.npy", "--max"];
    let json = compare_json(1, folder.path(), &[&depths[..], &["0"]].concat());
    let measures = &json["pairs"][0]["measures"];
    let largest = measures["largest"].as_f64().unwrap();
    assert!(largest > 0.0 && largest < 0.2, "{json}");
    assert_eq!((&measures["unit"], &measures["flip"]), (&"1".into(), &Value::Null));
    compare(0, folder.path(), &[&depths[..], &["0.2"]].concat());
    let exr = compare_json(1, folder.path(), &["a.exr", "b.exr"]);
    assert_eq!(exr["pairs"][0]["measures"]["largest"].as_f64(), Some(largest));
    for (arguments, reason) in [
        (&["a-depth.npy", "a.exr"][..], "a-depth.npy has the channels 0, but a.exr has Z, id"),
        (&["a-depth.npy", "b-depth.npy", "--out", "d.png"], "--out and --html show colours"),
        (&["a-depth.npy", "b-depth.npy", "--flip", "1"], "--flip: a-depth.npy has numbers"),
    ] {
        let (_, err) = compare(2, folder.path(), arguments);
        assert!(err.contains(reason), "{err}");
    }
}

#[test]
fn reports_never_replace_other_files_and_a_damaged_picture_is_an_error() {
    let folder = folders();
    std::fs::write(folder.path().join("poem.xml"), "Roses are red").unwrap();
    let (_, err) = compare(2, folder.path(), &["a", "b", "--junit", "poem.xml"]);
    assert!(err.contains("is not a JUnit report"), "{err}");
    let (_, err) = compare(2, folder.path(), &["a", "b", "--html", "page.html"]);
    assert!(err.contains("for folders, use --out"), "{err}");
    let before = std::fs::read(folder.path().join("a/deep/x.png")).unwrap();
    for out in ["a", "b/differences"] {
        let (_, err) = compare(2, folder.path(), &["a", "b", "--out", out]);
        assert!(err.contains("--out lies in a folder that is compared"), "{err}");
    }
    assert_eq!(std::fs::read(folder.path().join("a/deep/x.png")).unwrap(), before);
    std::fs::write(folder.path().join("b/same.png"), "\u{89}PNG").unwrap();
    let (out, _) = compare(2, folder.path(), &["a", "b"]);
    assert!(out.contains("error    same.png: b/same.png: "), "{out}");
}
