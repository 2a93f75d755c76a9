//! Archives for WebDataset: `--out "shards/{shard:06}.tar"`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use marraztu_io as io;
use serde_json::Value;

use super::{SMALL, command, contents, drawn_and_unchanged, ends_with, folder, report};

/// The arguments that draw 15 pictures into archives of four.
fn to_tars<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let base = ["batch", "models/*.obj", "--views", "3", "--out", "t/{shard:03}.tar"];
    [&base[..], &["--per-tar", "4"], &SMALL, more].concat()
}

/// Returns the members of an archive, in their order.
fn members(path: &Path) -> Vec<(String, Vec<u8>)> {
    let mut archive = tar::Archive::new(File::open(path).unwrap());
    let member = |entry: std::io::Result<tar::Entry<'_, File>>| {
        let mut entry = entry.unwrap();
        let header = entry.header();
        assert_eq!((header.mtime().unwrap(), header.mode().unwrap()), (0, 0o644));
        let name = entry.path().unwrap().to_str().unwrap().to_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        (name, content)
    };
    archive.entries().unwrap().map(member).collect()
}

/// Draws into archives in a new folder, and returns them by name.
fn tars(runs: &[&[&str]]) -> BTreeMap<PathBuf, Vec<u8>> {
    let folder = folder();
    runs.iter().for_each(|more| _ = ends_with(0, folder.path(), &to_tars(more)));
    contents(&folder.path().join("t"))
}

#[test]
fn archives_are_the_same_bytes_for_any_number_of_threads_and_shards() {
    let expected = tars(&[&["--threads", "1"]]);
    let names: Vec<&str> = expected.keys().map(|path| path.to_str().unwrap()).collect();
    assert_eq!(names, ["000.tar", "001.tar", "002.tar", "003.tar"]);
    assert!(tars(&[&["--threads", "3"]]) == expected);
    for count in 2..=6 {
        let shards: Vec<String> = (0..count).map(|index| format!("{index}/{count}")).collect();
        let runs: Vec<[&str; 2]> = shards.iter().map(|shard| ["--shard", &**shard]).collect();
        let runs: Vec<&[&str]> = runs.iter().rev().map(|run| &run[..]).collect();
        assert!(tars(&runs) == expected, "{count}");
    }
}

#[test]
fn an_archive_has_the_pictures_of_files_and_a_description_of_each() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let layers = ["--layers", "color,depth", "--format", "npy"];
    ends_with(0, folder.path(), &to_tars(&layers));
    let single = ["batch", "models/*.obj", "--views", "3", "--out", "o/{index}-{layer}.{ext}"];
    ends_with(0, folder.path(), &[&single[..], &SMALL, &layers].concat());
    let members = members(&at("t/001.tar"));
    let names: Vec<&str> = members.iter().take(4).map(|(name, _)| &**name).collect();
    let first = ["000000004.color.npy", "000000004.depth.npy", "000000004.json"];
    assert_eq!(names, [&first[..], &["000000005.color.npy"]].concat());
    assert!(members[1].1 == std::fs::read(at("o/4-depth.npy")).unwrap());
    let camera: Value = serde_json::from_slice(&members[2].1).unwrap();
    assert_eq!((&camera["scene"], &camera["view"]), (&"models/plate.obj".into(), &"1".into()));
    assert_eq!(camera["layers"]["depth"], "000000004.depth.npy");
    let cameras: Value =
        serde_json::from_slice(&std::fs::read(at("o/cameras.json")).unwrap()).unwrap();
    let same = |frame: &&Value| frame["layers"]["depth"] == "4-depth.npy";
    let frame = cameras["frames"].as_array().unwrap().iter().find(same).unwrap();
    assert_eq!(frame["K"], camera["K"]);
    assert_eq!(frame["transform_matrix"], camera["transform_matrix"]);
}

#[test]
fn resuming_draws_only_what_has_changed_and_gives_the_bytes_of_a_fresh_run() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let resume = |drawn: usize, unchanged: usize| {
        let more = ["--resume", "--times", "times.jsonl", "--report", "report.jsonl"];
        ends_with(0, folder.path(), &to_tars(&more));
        assert_eq!(drawn_and_unchanged(&at("times.jsonl")), (drawn, unchanged));
        contents(&at("t"))
    };
    let first = resume(15, 0);
    let times = |name: &str| std::fs::metadata(at(name)).unwrap().modified().unwrap();
    let before = times("t/000.tar");
    let report_of_first = std::fs::read(at("report.jsonl")).unwrap();
    assert!(resume(0, 15) == first);
    assert_eq!(times("t/000.tar"), before, "an archive without changes is not written again");
    assert!(std::fs::read(at("report.jsonl")).unwrap() == report_of_first);
    // A damaged archive keeps the pictures before its end; the third one is cut off here.
    let path = at("t/002.tar");
    let damaged = std::fs::read(&path).unwrap();
    std::fs::write(&path, &damaged[..damaged.len() / 2]).unwrap();
    let (_, err) = ends_with(0, folder.path(), &to_tars(&["--resume"]));
    assert!(!err.contains("15 unchanged") && err.contains("unchanged"), "{err}");
    assert!(contents(&at("t")) == first);
    // The pictures of a changed model are drawn, the others of the same archives are kept.
    std::fs::copy(at("models/wheel.obj"), at("models/plate.obj")).unwrap();
    let changed = resume(3, 12);
    assert!(changed != first);
    std::fs::remove_dir_all(at("t")).unwrap();
    assert!(resume(15, 0) == changed);
}

#[test]
fn pictures_that_cannot_be_drawn_are_missing_until_a_later_run_adds_them() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let model = std::fs::read(at("models/plate.obj")).unwrap();
    std::fs::write(at("models/plate.obj"), "f 1 2 3\n").unwrap();
    ends_with(1, folder.path(), &to_tars(&["--report", "r.jsonl"]));
    assert_eq!(members(&at("t/000.tar")).len(), 2 * 3);
    let lines = report(&at("r.jsonl"));
    assert_eq!((&lines[2]["status"], &lines[3]["status"]), (&"done".into(), &"invalid".into()));
    assert_eq!(lines[2]["out"], "t/000.tar/000000002.png");
    std::fs::write(at("models/plate.obj"), model).unwrap();
    ends_with(0, folder.path(), &to_tars(&["--resume"]));
    assert!(contents(&at("t")) == tars(&[&[]]));
    // Nothing of a model that is broken again stays.
    std::fs::write(at("models/plate.obj"), "f 1 2 3\n").unwrap();
    ends_with(1, folder.path(), &to_tars(&["--resume"]));
    assert_eq!(members(&at("t/000.tar")).len(), 2 * 3);
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_archives_with_the_finished_pictures_and_resuming_completes_them() {
    let (whole, ended) = (folder(), folder());
    let more = ["--size", "300", "--views", "300", "--per-tar", "60"];
    let draw = ["batch", "models/x_wing.obj", "--out", "t/{shard}.tar", "--report", "r.jsonl"];
    let draw = [&draw[..], &more].concat();
    ends_with(0, whole.path(), &draw);
    let mut child = command(ended.path(), &draw).stderr(Stdio::null()).spawn().unwrap();
    let begin = Instant::now();
    while !ended.path().join("t/0.tar").exists() && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(143));
    let lines = report(&ended.path().join("r.jsonl"));
    let done = lines.iter().filter(|line| line["status"] == "done").count();
    let files = contents(&ended.path().join("t")).into_keys();
    let found: usize = files.map(|name| members(&ended.path().join("t").join(name)).len()).sum();
    assert!(done >= 60 && found == 2 * done, "{done} {found}");
    ends_with(0, ended.path(), &[&draw[..], &["--resume"]].concat());
    assert!(contents(&ended.path().join("t")) == contents(&whole.path().join("t")));
}

#[test]
fn wrong_names_of_archives_are_rejected_before_anything_is_drawn() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("list.csv"), "file,out\nmodels/cam.obj,a.png\n").unwrap();
    std::fs::create_dir(at("t")).unwrap();
    std::fs::write(at("t/002.tar"), "Roses are red").unwrap();
    for (arguments, reason) in [
        (&["models/cam.obj", "--out", "a.tar"][..], "--out: the name of an archive has the field"),
        (&["models/cam.obj", "--out", "{stem}-{shard}.tar"], "the field {shard} once"),
        (&["models/cam.obj", "--out", "{shard}.tar", "--per-tar", "0"], "from 1 to 1000000"),
        (&["models/cam.obj", "--out", "{shard}.tar", "--sheet", "2x2"], "--sheet shows files"),
        (&["--list", "list.csv", "--out", "{shard}.tar"], "list.csv:2: column out: --out names"),
        (&to_tars(&[])[1..], "t/002.tar: a file with this name exists and is not an archive"),
    ] {
        let (_, err) = ends_with(2, folder.path(), &[&["batch"], arguments].concat());
        assert!(err.contains(reason), "{arguments:?}\n{err}");
    }
    assert_eq!(contents(&at("t")).len(), 1);
    assert!(io::load_picture(&at("0.tar")).is_err());
}
