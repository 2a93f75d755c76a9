//! Runs `marraztu batch` and its companions as a user or a cluster does: lists, shards, signals.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod budget;
mod compare;
mod datasets;
mod layers;
mod pictures;
mod streams;
mod tars;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use marraztu_io as io;
use tempfile::TempDir;

/// The options of small and quick pictures.
const SMALL: [&str; 4] = ["--size", "64", "--samples", "1"];

/// A folder with models of different sizes.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    std::fs::create_dir(folder.path().join("models")).unwrap();
    for name in ["cam.obj", "x_wing.obj", "lessons/plate.obj", "lessons/wheel.obj"] {
        let to = Path::new(name).file_name().unwrap();
        std::fs::copy(assets.join(name), folder.path().join("models").join(to)).unwrap();
    }
    let textured = "mtllib square.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\nf 1 2 99\n";
    let at = |name: &str| folder.path().join("models").join(name);
    std::fs::write(at("square.obj"), textured).unwrap();
    std::fs::write(at("square.mtl"), "newmtl a\nKd 1 1 1\nmap_Kd square.ppm\n").unwrap();
    std::fs::write(at("square.ppm"), b"P6\n1 1\n255\n\xFF\x80\x00").unwrap();
    folder
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_marraztu"));
    command.current_dir(folder).args(arguments);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    for [index, count] in [
        ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT"],
        ["JOB_COMPLETION_INDEX", "JOB_COMPLETIONS"],
    ] {
        command.env_remove(index).env_remove(count);
    }
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Runs the program, checks its exit status, and returns standard output and standard error.
#[track_caller]
fn ends_with(status: i32, folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = run(folder, arguments);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(status), "{arguments:?}\n{out}\n{err}");
    assert!(!err.contains("panicked"), "{err}");
    (out, err)
}

/// Returns the files below a folder with their contents, by relative path.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in std::fs::read_dir(at).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                files.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    files
}

/// The arguments that draw all models from several views.
fn all_models<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let base = ["batch", "models/*.obj", "--views", "3", "--out", "out/{stem}-{view:02}.png"];
    [&base[..], &SMALL, more].concat()
}

/// Returns the lines of a report by their fields.
fn report(path: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Returns the numbers of pictures that were drawn, and of those that were left as they were.
fn drawn_and_unchanged(times: &Path) -> (usize, usize) {
    let lines = report(times);
    let unchanged = lines.iter().filter(|line| line["unchanged"] == true).count();
    (lines.len() - unchanged, unchanged)
}

#[test]
fn the_shards_of_any_number_draw_the_same_files_and_merge_to_the_same_report() {
    let whole = folder();
    ends_with(0, whole.path(), &all_models(&["--report", "report.jsonl", "--threads", "1"]));
    let expected = contents(&whole.path().join("out"));
    let report = std::fs::read(whole.path().join("report.jsonl")).unwrap();
    assert_eq!(expected.len(), 15);
    for count in 1..=8 {
        let parts = folder();
        let mut merge = vec!["merge".to_owned(), "--out".to_owned(), "report.jsonl".to_owned()];
        for index in 0..count {
            let (shard, name) = (format!("{index}/{count}"), format!("r{index}.jsonl"));
            let part = ["--shard", &shard, "--report", &name, "--memory", "1K"];
            ends_with(0, parts.path(), &all_models(&part));
            merge.push(name);
        }
        ends_with(0, parts.path(), &merge.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(contents(&parts.path().join("out")) == expected, "{count} shards");
        assert!(std::fs::read(parts.path().join("report.jsonl")).unwrap() == report, "{count}");
    }
    // An earlier joined report is not a part, and the page shows each picture.
    let merge = ["merge", "r*.jsonl", "--out", "report.jsonl", "--sheet", "pages/page.html"];
    let parts = folder();
    for shard in ["0/2", "1/2"] {
        let name = format!("new/folder/r{}.jsonl", &shard[..1]);
        ends_with(0, parts.path(), &all_models(&["--shard", shard, "--report", &name]));
        std::fs::copy(parts.path().join(&name), parts.path().join(format!("r{shard:.1}.jsonl")))
            .unwrap();
    }
    std::fs::copy(parts.path().join("r0.jsonl"), parts.path().join("report.jsonl")).unwrap();
    std::fs::create_dir(parts.path().join("pages")).unwrap();
    let (_, err) = ends_with(0, parts.path(), &merge);
    assert!(err.contains("report.jsonl is the output, so it is not read"), "{err}");
    assert!(std::fs::read(parts.path().join("report.jsonl")).unwrap() == report);
    let page = std::fs::read_to_string(parts.path().join("pages/page.html")).unwrap();
    let pictures = expected.keys().map(|name| format!("src=\"../out/{}\"", name.display()));
    assert!(pictures.into_iter().all(|picture| page.contains(&picture)), "{page}");
    assert!(!page.contains("Missing"), "{page}");
    // A report that is left out is noticed.
    ends_with(0, whole.path(), &all_models(&["--shard", "0/2", "--report", "half.jsonl"]));
    let merge = ["merge", "half.jsonl", "--out", "merged.jsonl", "--sheet", "half.html"];
    let (out, _) = ends_with(1, whole.path(), &merge);
    assert!(out.lines().count() > 0 && out.lines().all(|line| line.ends_with("\tabsent")), "{out}");
    let page = std::fs::read_to_string(whole.path().join("half.html")).unwrap();
    let runs = page.matches("<td>absent</td>").count();
    assert!((1..out.lines().count()).contains(&runs), "{page}");
}

#[test]
fn a_batch_that_is_killed_and_resumed_ends_with_the_same_files() {
    let (whole, killed) = (folder(), folder());
    ends_with(0, whole.path(), &all_models(&["--report", "report.jsonl"]));
    let arguments = all_models(&["--report", "report.jsonl", "--resume"]);
    let begin = Instant::now();
    for milliseconds in [20, 60, 110, 170, 240, 320] {
        let mut child = command(killed.path(), &arguments).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    ends_with(0, killed.path(), &arguments);
    assert!(contents(killed.path()) == contents(whole.path()), "after {:?}", begin.elapsed());
}

#[test]
fn two_processes_that_draw_the_same_pictures_do_not_disturb_each_other() {
    let (whole, shared) = (folder(), folder());
    ends_with(0, whole.path(), &all_models(&["--report", "report.jsonl"]));
    let arguments = all_models(&["--report", "report.jsonl"]);
    let mut children: Vec<Child> =
        (0..2).map(|_| command(shared.path(), &arguments).spawn().unwrap()).collect();
    for child in &mut children {
        assert!(child.wait().unwrap().success());
    }
    assert!(contents(shared.path()) == contents(whole.path()));
}

#[test]
fn a_second_run_draws_only_pictures_whose_files_or_options_have_changed() {
    let folder = folder();
    let run = |more: &[&str]| {
        let resume = ["--resume", "--times", "times.jsonl"];
        ends_with(0, folder.path(), &all_models(&[&resume, more].concat()));
        drawn_and_unchanged(&folder.path().join("times.jsonl"))
    };
    let at = |name: &str| folder.path().join(name);
    assert_eq!(run(&[]), (15, 0));
    assert_eq!(run(&[]), (0, 15));
    assert_eq!(run(&["--report", "first.jsonl"]), (0, 15));
    std::fs::write(at("models/square.ppm"), b"P6\n1 1\n255\n\x00\x80\x00").unwrap();
    assert_eq!(run(&[]), (3, 12));
    std::fs::remove_file(at("models/square.ppm")).unwrap();
    assert_eq!(run(&[]), (3, 12));
    std::fs::remove_file(at("out/cam-00.png")).unwrap();
    let half = std::fs::read(at("out/cam-01.png")).unwrap();
    std::fs::write(at("out/cam-01.png"), &half[..half.len() / 2]).unwrap();
    assert_eq!(run(&[]), (2, 13));
    assert_eq!(run(&["--edges"]), (15, 0));
    // A report of unchanged pictures is the one of drawn ones.
    assert_eq!(run(&["--edges", "--report", "second.jsonl"]), (0, 15));
    ends_with(0, folder.path(), &all_models(&["--edges", "--report", "third.jsonl"]));
    assert!(
        std::fs::read(at("second.jsonl")).unwrap() == std::fs::read(at("third.jsonl")).unwrap()
    );
    let findings = report(&at("third.jsonl"))
        .iter()
        .filter(|line| line["findings"] != serde_json::json!([]))
        .count();
    // The summary has no findings, and counts as a line with others.
    assert_eq!(findings, 3 + 1);
}

#[test]
fn pictures_of_every_format_are_resumed() {
    let folder = folder();
    for format in ["png", "jpg", "webp", "ppm"] {
        let arguments = ["batch", "models/cam.obj", "--format", format, "--resume", "--times", "t"];
        for expected in [(1, 0), (0, 1)] {
            ends_with(0, folder.path(), &[&arguments[..], &SMALL].concat());
            assert_eq!(drawn_and_unchanged(&folder.path().join("t")), expected, "{format}");
        }
        io::load_picture(&folder.path().join(format!("cam.{format}"))).unwrap();
    }
}

#[test]
fn broken_files_of_a_list_are_reported_and_the_others_are_drawn() {
    let folder = folder();
    std::fs::write(folder.path().join("models/bad.obj"), "v 1 two 3\n").unwrap();
    let list = "models/cam.obj\nmodels/bad.obj\nabsent.obj\nmodels\nmodels/plate.obj\n";
    std::fs::write(folder.path().join("list.txt"), list).unwrap();
    let base = ["batch", "--list", "list.txt", "--out", "{index}.png", "--report", "r.jsonl"];
    let run = |status, more: &[&str]| {
        ends_with(status, folder.path(), &[&base[..], &SMALL, more].concat())
    };
    let (_, err) = run(1, &[]);
    assert!(
        err.contains("error: models/bad.obj:1: ")
            && err.contains("error: absent.obj: there is no such file"),
        "{err}"
    );
    assert!(err.ends_with("pictures a second\n") && err.contains("2 drawn, 3 missing"), "{err}");
    let statuses: Vec<String> = report(&folder.path().join("r.jsonl"))
        .iter()
        .map(|line| line["status"].as_str().unwrap_or("summary").to_owned())
        .collect();
    assert_eq!(statuses, ["done", "invalid", "invalid", "invalid", "done", "summary"]);
    assert!(["0.png", "4.png"].iter().all(|name| folder.path().join(name).exists()));
    run(4, &["--strict-exit"]);
    // The first failure ends the batch; the report is complete.
    run(1, &["--stop", "--threads", "1"]);
    assert_eq!(report(&folder.path().join("r.jsonl")).len(), 6);
    let (out, _) = ends_with(1, folder.path(), &["merge", "r.jsonl", "--out", "m.jsonl"]);
    assert!(out.contains("1\tmodels/bad.obj\t0\tinvalid\n"), "{out}");
    // An output that cannot be written is not the fault of the input.
    let nowhere = ["batch", "models/cam.obj", "--out", "list.txt/{stem}.png", "--strict-exit"];
    let (_, err) = ends_with(1, folder.path(), &[&nowhere[..], &SMALL].concat());
    assert!(err.contains("cannot be created"), "{err}");
}

#[test]
#[cfg(unix)]
fn a_folder_without_permission_is_an_error_of_each_picture() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::set_permissions(&out, std::fs::Permissions::from_mode(0o555)).unwrap();
    // The administrator may write everywhere.
    if std::fs::write(out.join("probe"), "").is_ok() {
        return;
    }
    let (_, err) = ends_with(1, folder.path(), &all_models(&["--strict-exit"]));
    assert!(err.contains("permission denied"), "{err}");
}

#[test]
fn mistakes_in_a_list_are_found_before_the_first_picture() {
    let folder = folder();
    for (csv, reason) in [
        ("file,colour\nmodels/cam.obj,red\n", "list.csv:1: column colour: there is no such option"),
        ("file,size\nmodels/cam.obj,64\nmodels/cam.obj,0x5\n", "list.csv:3: column size: "),
        ("file,edges\nmodels/cam.obj,perhaps\n", "list.csv:2: column edges: "),
        ("file,views\nmodels/cam.obj,inside\n", "list.csv:2: column views: "),
        ("file,out\nmodels/cam.obj,a.gif\n", "list.csv:2: a.gif: its name has to end in"),
        ("file,out\nmodels/cam.obj,{shape}.png\n", "list.csv:2: column out: "),
        ("file,size\nmodels/cam.obj\n", "list.csv:2: the row has 1 columns"),
        (
            "file\nmodels/cam.obj\nmodels/cam.obj\n",
            "two pictures would be written to cam.png: list.csv:2",
        ),
        (
            "file,out\nmodels/cam.obj,new/a.png\nmodels/cam.obj,./new/../new/a.png\n",
            "two pictures would be written to ./new/../new/a.png: list.csv:2",
        ),
        ("name\nmodels/cam.obj\n", "no column \"file\""),
        ("file\n", "the list has no rows"),
    ] {
        std::fs::write(folder.path().join("list.csv"), csv).unwrap();
        let (out, err) = ends_with(2, folder.path(), &["batch", "--list", "list.csv"]);
        assert!(err.starts_with("error: ") && err.contains(reason), "{csv}\n{err}");
        assert!(err.contains("Usage: marraztu batch"), "{err}");
        assert_eq!(out, "");
    }
    for (arguments, reason) in [
        (&["batch"][..], "<FILES>"),
        (&["batch", "models/*.stl"], "no file matches models/*.stl"),
        (&["batch", "a.obj", "--shard", "2/2"], "counted from 0"),
        (&["batch", "a.obj", "--shard", "auto"], "SLURM_ARRAY_TASK_ID"),
        (&["batch", "a.obj", "--memory", "much"], "500M"),
        (&["batch", "a.obj", "--size", "-5"], "from 1 to 16384"),
        (
            &["batch", "models/cam.obj", "--report", "a.jsonl", "--times", "a.jsonl"],
            "--report and --times name the same file",
        ),
        (
            &["batch", "models/cam.obj", "--report", "a.jsonl", "--times", "b/.././a.jsonl"],
            "--report and --times name the same file",
        ),
        (&["batch", "--list", "models"], "models: this is a folder, not a file"),
        (&["merge", "models", "--out", "a.jsonl"], "models: this is a folder, not a file"),
        (&["batch", "a.obj", "--views", "0"], "1 to 100000 views"),
        (&["batch", "a.obj", "--views", "4", "--from", "0,0"], "--camera and --from"),
        (&["batch", "a.obj", "--transparent", "--format", "jpg"], "no transparent pixels"),
        (&["batch", "a.obj", "--out", "{x}.png"], "there is no field {x}"),
    ] {
        let (_, err) = ends_with(2, folder.path(), arguments);
        assert!(err.starts_with("error: ") && err.contains(reason), "{arguments:?}\n{err}");
    }
    assert!(
        contents(folder.path())
            .keys()
            .all(|name| name.starts_with("models") || name == Path::new("list.csv"))
    );
}

#[test]
fn rows_override_the_options_of_the_command_line() {
    let folder = folder();
    let list = "{\"file\": \"models/cam.obj\", \"size\": 32, \"out\": \"{stem}-small.jpg\"}\n\
                {\"file\": \"models/cam.obj\", \"views\": \"2\"}\n";
    std::fs::write(folder.path().join("list.jsonl"), list).unwrap();
    let base = ["batch", "--list", "list.jsonl", "--size", "64x48"];
    let (out, _) = ends_with(0, folder.path(), &[&base[..], &["--dry-run"]].concat());
    let rows = [
        "0\tmodels/cam.obj\t0\tcam-small.jpg",
        "1\tmodels/cam.obj\t0\tcam-000.png",
        "2\tmodels/cam.obj\t1\tcam-001.png",
    ];
    assert_eq!(out.lines().collect::<Vec<_>>(), rows);
    assert!(!folder.path().join("cam-000.png").exists(), "nothing is drawn");
    ends_with(0, folder.path(), &base);
    let size = |name: &str| {
        let size = io::load_picture(&folder.path().join(name)).unwrap().size();
        [size.width, size.height]
    };
    assert_eq!([size("cam-small.jpg"), size("cam-001.png")], [[32, 32], [64, 48]]);
}

#[test]
fn a_list_comes_from_standard_input_and_a_shard_from_the_environment() {
    use std::io::Write as _;
    let folder = folder();
    let mut shards = Vec::new();
    for task in ["1", "2"] {
        let mut command =
            command(folder.path(), &["batch", "--list", "-", "--shard", "auto", "--dry-run"]);
        command
            .env("SLURM_ARRAY_TASK_ID", task)
            .env("SLURM_ARRAY_TASK_COUNT", "2")
            .env("SLURM_ARRAY_TASK_MIN", "1");
        let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(b"file,edges\na.obj,true\nb.obj,\nc.obj,\n").unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        shards.extend(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned));
    }
    shards.sort();
    assert_eq!(shards, ["0\ta.obj\t0\ta.png", "1\tb.obj\t0\tb.png", "2\tc.obj\t0\tc.png"]);
}

/// Sends a signal to a batch that takes long, and returns its exit status and report.
#[cfg(unix)]
fn signalled(folder: &Path, signal: &str) -> (Option<i32>, Vec<serde_json::Value>) {
    let arguments = [
        "batch",
        "models/x_wing.obj",
        "--views",
        "300",
        "--out",
        "out/{view}.png",
        "--size",
        "400",
        "--report",
        "r.jsonl",
    ];
    let mut child = command(folder, &arguments).stderr(Stdio::null()).spawn().unwrap();
    // Wait until the first picture is there.
    let begin = Instant::now();
    let is_there = || {
        let mut names = std::fs::read_dir(folder.join("out")).into_iter().flatten().flatten();
        names.any(|it| it.file_name().to_str().is_some_and(|it| it.ends_with(".png")))
    };
    while !is_there() && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    let begin = Instant::now();
    let status = child.wait().unwrap();
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?}", begin.elapsed());
    (status.code(), report(&folder.join("r.jsonl")))
}

#[test]
#[cfg(unix)]
fn a_signal_ends_a_batch_with_a_complete_report_and_no_half_files() {
    for (signal, status) in [("-TERM", 143), ("-INT", 130)] {
        let folder = folder();
        let (code, lines) = signalled(folder.path(), signal);
        assert_eq!(code, Some(status));
        assert_eq!(lines.len(), 301);
        let done = lines.iter().filter(|line| line["status"] == "done").count();
        let cancelled = lines.iter().filter(|line| line["status"] == "cancelled").count();
        assert!(done > 0 && cancelled > 0 && done + cancelled == 300, "{done} {cancelled}");
        let files = contents(&folder.path().join("out"));
        assert_eq!(files.len(), done);
        assert!(
            files
                .keys()
                .all(|name| io::load_picture(&folder.path().join("out").join(name)).is_ok())
        );
    }
}

#[test]
fn no_output_replaces_a_file_that_was_read_or_that_is_something_else() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("list.csv"), "file\nmodels/cam.obj\n").unwrap();
    std::fs::write(at("poem.txt"), "Roses are red").unwrap();
    std::fs::create_dir(at("s")).unwrap();
    let picture = ["render", "models/plate.obj", "--size", "16", "--out", "s/sheet-000.png"];
    ends_with(0, folder.path(), &picture);
    let frame = "[[1,0,0,0],[0,1,0,0],[0,0,1,400],[0,0,0,1]]";
    let cameras = format!("{{\"frames\": [{{\"transform_matrix\": {frame}}}]}}");
    std::fs::create_dir(at("v")).unwrap();
    std::fs::write(at("v/cameras.json"), cameras).unwrap();
    let draw = ["batch", "--list", "list.csv", "--size", "16", "--out", "a.png"];
    ends_with(0, folder.path(), &[&draw[..], &["--report", "r.jsonl"]].concat());
    let before = contents(folder.path());
    for (arguments, reason) in [
        (&["--report", "list.csv"][..], "list.csv could not be saved: this file is an input"),
        (&["--times", "models/cam.obj"], "this file is an input"),
        (&["--report", "poem.txt"], "poem.txt: a file with this name exists and is not a report"),
        (&["--times", "poem.txt"], "is not a report"),
        (&["--report", "a.png"], "a.png is the name of a picture"),
        (&["--report", "./v/../a.png"], "a.png is the name of a picture"),
        (&["--sheet", "1x1", "--sheets", "s"], "sheet-000.png: a file with this name exists"),
        (&["--sheet", "1x1", "--sheets", "t", "--out", "t/sheet-000.png"], "the name of a picture"),
        (&["--sheet", "1x1", "--out", "b.npy", "--layers", "depth"], "b.npy is none"),
        (
            &["--views", "v/cameras.json", "--layers", "depth", "--out", "v/{view}-{layer}.png"],
            "v/cameras.json could not be saved: this file is an input",
        ),
    ] {
        let whole: Vec<&str> = match arguments.contains(&"--out") {
            true => [&draw[..5], arguments].concat(),
            false => [&draw[..], arguments].concat(),
        };
        let output = run(folder.path(), &whole);
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && err.contains(reason), "{whole:?}\n{err}");
        assert!(contents(folder.path()) == before, "{whole:?}");
    }
    for (arguments, reason) in [
        (&["merge", "r.jsonl", "--out", "list.csv", "--expect", "list.csv"][..], "is an input"),
        (&["merge", "r.jsonl", "--out", "poem.txt"], "is not a report"),
        (&["thumbnail", "models/cam.obj", "models/cam.obj"], "this file is an input"),
        (&["thumbnail", "models/cam.obj", "poem.txt"], "is not a picture"),
    ] {
        let output = run(folder.path(), arguments);
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && err.contains(reason), "{arguments:?}\n{err}");
        assert!(contents(folder.path()) == before, "{arguments:?}");
    }
    // Reports, times and sheets of earlier runs are replaced.
    for _ in 0..2 {
        let more = ["--report", "r.jsonl", "--times", "t.jsonl", "--sheet", "1x1", "--sheets", "u"];
        ends_with(0, folder.path(), &[&draw[..], &more].concat());
    }
}

#[test]
fn pictures_of_16_bits_are_compared_whole() {
    let folder = folder();
    let draw = ["render", "models/cam.obj", "--size", "32", "--layers", "depth", "--out"];
    let near = |scale: &str, out: &str| {
        ends_with(0, folder.path(), &[&draw[..], &[out, "--depth-scale", scale]].concat());
    };
    near("10", "a-{layer}.png");
    near("10.02", "b-{layer}.png");
    let (out, _) = ends_with(1, folder.path(), &["compare", "a-depth.png", "b-depth.png"]);
    let largest: u32 =
        out.lines().next().unwrap().split_whitespace().last().unwrap().parse().unwrap();
    assert!((1..256).contains(&largest), "less than a step of 8 bits: {out}");
    let most = largest.to_string();
    let limit = ["compare", "a-depth.png", "b-depth.png", "--max", &most];
    ends_with(0, folder.path(), &limit);
    ends_with(0, folder.path(), &["compare", "a-depth.png", "a-depth.png"]);
}
