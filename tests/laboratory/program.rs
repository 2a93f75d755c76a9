//! The command `marraztu lab` on the first scene at a small size.

use std::path::Path;
use std::process::{Command, Stdio};

use marraztu_core::accuracy::AXES;
use marraztu_io as io;

#[track_caller]
fn lab(status: i32, folder: &Path, arguments: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_marraztu"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(status), "{arguments:?}\n{out}\n{err}");
    assert!(!err.contains("panicked"), "{err}");
    (out, err)
}

#[test]
fn a_sweep_prints_its_table_and_leaves_everything_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "lab",
        "--quick",
        "--size",
        "48x36",
        "--out",
        "found",
        "--shading",
        "face",
        "--max-error",
        "255",
        "--budget-ms",
        "1e6",
    ];
    let (out, _) = lab(0, folder.path(), &arguments);
    for part in [
        "the first scene: 48 x 36 pixels",
        "presets",
        "At 48x36, 1 sample per pixel, on the first scene, ",
        "saves more than the noise",
        "are noise",
        "combinations",
        "Not measured here: ",
        "the fastest with RMSE in byte steps at most 255: ",
        "the most exact within",
        "equal results",
        "again: marraztu lab --quick --size 48x36 --out found --shading face",
    ] {
        assert!(out.contains(part), "{part}\n{out}");
    }
    // The current settings are marked, and share a row with the choice that equals them.
    assert!(out.lines().any(|line| line.contains('>') && line.contains("Flat")), "{out}");
    let found = folder.path().join("found");
    let read = |name: &str| std::fs::read_to_string(found.join(name)).unwrap();
    assert_eq!(read("table.txt"), out);
    assert!(read("table.csv").starts_with("group,name,"));
    assert!(read("report.json").contains("\"floor\""));
    for look in ["light", "dark"] {
        assert!(read(&format!("plots-{look}.svg")).contains("<svg"));
        assert!(io::load_picture(&found.join(format!("plots-{look}.png"))).is_ok());
    }
    let [ideal, x1, x256] = ["ideal", "error-x1", "error-x256"]
        .map(|name| io::load_picture(&found.join(format!("{name}.png"))).unwrap());
    assert_eq!((ideal.size().width, ideal.size().height), (48, 36));
    let sum = |picture: &marraztu_core::base::image::Picture| -> u64 {
        picture.pixels().iter().flat_map(|p| &p[..3]).map(|byte| u64::from(*byte)).sum()
    };
    assert!(0 < sum(&x1) && sum(&x1) < sum(&x256));
}

#[test]
fn axes_are_chosen_by_their_keys() {
    let folder = tempfile::tempdir().unwrap();
    let (out, _) =
        lab(0, folder.path(), &["lab", "--quick", "--size", "32x24", "--axes", "arithmetic"]);
    assert!(out.contains("Light arithmetic, --arithmetic"), "{out}");
    assert!(!out.contains("--shading"), "{out}");
    let (_, err) = lab(2, folder.path(), &["lab", "--axes", "beauty"]);
    assert!(AXES.iter().all(|axis| err.contains(axis.key)), "{err}");
}

#[test]
fn a_pixel_is_explained_and_one_outside_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["lab", "--size", "64x64", "--preset", "draft", "--shading", "face"];
    let (out, _) = lab(0, folder.path(), &[&arguments[..], &["--pixel", "0,0"]].concat());
    assert!(out.contains("shows  the background") && out.contains("0 byte steps off"), "{out}");
    assert!(!out.contains("nearer"), "{out}");
    let (out, _) = lab(0, folder.path(), &[&arguments[..], &["--pixel", "36,33"]].concat());
    assert!(out.contains("  full resolution: (0, 0, 179), 130 steps nearer"), "{out}");
    assert!(out.contains("  256 samples per pixel: "), "{out}");
    assert!(out.contains("other choices change nothing here"), "{out}");
    let (_, err) = lab(1, folder.path(), &[&arguments[..], &["--pixel", "64,0"]].concat());
    assert!(err.contains("there is no 64,0"), "{err}");
}

#[test]
fn single_axes_override_a_preset() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = |arguments: &[&str]| {
        let fixed = ["render", "--size", "64x64", "--samples", "1", "--out", "p.png"];
        lab(0, folder.path(), &[&fixed[..], arguments].concat());
        io::load_picture(&folder.path().join("p.png")).unwrap()
    };
    let draft = drawn(&["--preset", "draft"]);
    assert!(draft == drawn(&["--resolution", "half"]));
    assert!(draft != drawn(&[]));
    assert!(drawn(&["--preset", "draft", "--resolution", "full"]) == drawn(&[]));
    let fine = |arguments: &[&str]| {
        let fixed = ["render", "--size", "64x64", "--out", "p.png"];
        lab(0, folder.path(), &[&fixed[..], arguments].concat());
        io::load_picture(&folder.path().join("p.png")).unwrap()
    };
    let ideal = fine(&["--preset", "ideal"]);
    assert!(ideal == fine(&["--preset", "exact", "--samples", "256", "--threads", "1"]));
    assert!(ideal != fine(&["--preset", "exact"]));
}

#[test]
fn a_report_of_a_picture_has_its_time_and_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let render = |preset: &str| {
        let arguments =
            ["render", "--size", "96x64", "--out", "p.png", "--report", "--preset", preset];
        let (_, err) = lab(0, folder.path(), &arguments);
        let line = err.lines().find(|line| line.contains("against the ideal")).unwrap().to_owned();
        let error = line.split("error ").nth(1).unwrap().split(' ').next().unwrap();
        assert!(line.contains(" ms a picture with "), "{line}");
        error.parse::<f64>().unwrap()
    };
    let errors = ["draft", "default", "ideal"].map(render);
    assert!(errors[0] > errors[1] && errors[1] > 0.0 && errors[2] == 0.0, "{errors:?}");
}

#[test]
fn one_scene_of_the_suite_is_measured_by_its_word() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["lab", "--suite=depth", "--size", "48x27", "--out", "found"];
    let (out, _) = lab(0, folder.path(), &arguments);
    assert!(out.contains("At 48x27, 1 sample per pixel, on suite scene depth, "), "{out}");
    assert!(out.contains("again: marraztu lab --suite=depth --size 48x27\n"), "{out}");
    let found = folder.path().join("found");
    for name in ["page.md", "page.html", "table.csv", "report.json", "depth-depth-light.svg"] {
        assert!(found.join(name).exists(), "{name}");
    }
    lab(2, folder.path(), &["lab", "--suite=beauty"]);
    // The suite has its own scenes, settings and metric.
    for more in [
        &["--measure", "flip"][..],
        &["--inside"],
        &["--samples", "4"],
        &["--preset", "draft"],
        &["--material", "gold"],
        &["--up", "z"],
        &["--camera", "1"],
    ] {
        let (_, err) = lab(2, folder.path(), &[&["lab", "--suite=tiny"][..], more].concat());
        assert!(err.contains("cannot be used with") && err.contains(more[0]), "{err}");
    }
}
