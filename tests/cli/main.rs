//! Runs the program as a user does: arguments, files and exit status.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod budget;
mod limits;
mod models;

use std::path::Path;
use std::process::{Command, Output, Stdio};

use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::math::Axis;
use marraztu_core::edit::{lights, motion};
use marraztu_core::scene::{Observer, Projection, Scene, View};
use marraztu_io as io;
use marraztu_lab::suite::SUITE;
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use tempfile::TempDir;

/// A unit square far from the origin, with its corners counter-clockwise as seen from +Z.
const SQUARE: &str = "v 5 5 5\nv 6 5 5\nv 6 6 5\nv 5 6 5\nf 1 2 3 4\n";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_marraztu"));
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.output().unwrap()
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

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("square.obj"), SQUARE).unwrap();
    folder
}

/// Returns the picture that `render` draws with these arguments at a small size.
#[track_caller]
fn drawn(folder: &Path, arguments: &[&str]) -> Picture {
    let mut all = vec!["render", "--out", "drawn.png", "--size", "160x120"];
    if !arguments.contains(&"--samples") {
        all.extend(["--samples", "1"]);
    }
    all.extend(arguments);
    let (out, _) = ends_with(0, folder, &all);
    assert_eq!(out, "");
    io::load_picture(&folder.join("drawn.png")).unwrap()
}

fn first_scene(settings: &Settings, size: Size) -> Picture {
    let (scene, view) = io::default_scene();
    Renderer::default().render(&plan_frame(&Shot::new(&scene, &view, settings, size))).clone()
}

#[test]
fn help_lists_the_commands_and_version_names_the_version() {
    let folder = folder();
    let (out, _) = ends_with(0, folder.path(), &["--help"]);
    for word in ["render", "info", "Examples:", "Exit status:", ".marraztu", "exact, ideal,"] {
        assert!(out.contains(word), "{word}");
    }
    let (out, _) = ends_with(0, folder.path(), &["lab", "--help"]);
    for scene in SUITE {
        assert!(out.contains(&format!(" {}", scene.word)), "{}", scene.word);
    }
    let (out, _) = ends_with(0, folder.path(), &["render", "--help"]);
    let options = [
        "out",
        "size",
        "material",
        "sides",
        "projection",
        "shading",
        "normals",
        "edges",
        "edges-over",
        "lights",
        "up",
        "scale",
        "flip-winding",
        "crease",
        "texture",
        "camera",
        "from",
        "time",
        "helpers",
        "arithmetic",
        "filter",
        "specular",
        "background",
        "surface",
        "back-faces",
        "face-normals",
        "vertex-normals",
        "no-file-normals",
    ];
    for option in options {
        assert!(out.contains(&format!("--{option} ")) || out.contains(&format!("--{option}\n")));
    }
    let (out, _) = ends_with(0, folder.path(), &["--version"]);
    assert_eq!(out, format!("marraztu {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn the_first_scene_is_drawn_as_the_renderer_draws_it_in_both_formats() {
    let folder = folder();
    let expected = first_scene(&Settings::default(), Size::new(160, 120));
    assert!(drawn(folder.path(), &[]) == expected);

    ends_with(
        0,
        folder.path(),
        &["render", "--out", "a.ppm", "--size", "160x120", "--samples", "1"],
    );
    let ppm = std::fs::read(folder.path().join("a.ppm")).unwrap();
    let pixels = expected.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
    assert!(ppm == b"P6\n160 120\n255\n".iter().copied().chain(pixels).collect::<Vec<u8>>());

    ends_with(0, folder.path(), &["render", "-o", "b.png", "--samples", "1"]);
    let size = io::load_picture(&folder.path().join("b.png")).unwrap().size();
    assert_eq!(size, Size::new(800, 800));
}

#[test]
fn every_option_of_the_view_changes_the_picture() {
    let folder = folder();
    let plain = drawn(folder.path(), &[]);
    let changes: &[&[&str]] = &[
        &["--material", "polished-gold"],
        &["--projection", "orthographic"],
        &["--shading", "face"],
        &["--shading", "vertex"],
        &["--normals", "face"],
        &["--edges"],
        &["--edges-over"],
        &["--lights", "0,2"],
        &["--lights", "none"],
        &["--helpers", "none"],
        &["--specular", "half-vector"],
        &["--background", "10,20,30"],
        &["--face-normals"],
        &["--vertex-normals"],
    ];
    for change in changes {
        // `assert_ne` would print both pictures as numbers.
        assert!(drawn(folder.path(), change) != plain, "{change:?} changes nothing");
    }
    let settings =
        Settings { arithmetic: marraztu_core::accuracy::Arithmetic::F64, ..Settings::default() };
    let exact = drawn(folder.path(), &["--arithmetic", "f64"]);
    assert!(exact == first_scene(&settings, Size::new(160, 120)));
}

#[test]
fn a_texture_given_as_an_option_covers_the_model_and_is_filtered_as_requested() {
    let folder = folder();
    let text = SQUARE.replace("f 1 2 3 4", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4");
    std::fs::write(folder.path().join("square.obj"), text).unwrap();
    let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    let texture = Picture::from_pixels(Size::new(2, 2), texels).unwrap();
    io::save_picture(&folder.path().join("t.png"), &texture).unwrap();
    let base = ["square.obj", "--texture", "t.png", "--surface", "texture", "--filter"];
    let nearest = drawn(folder.path(), &[&base[..], &["nearest"]].concat());
    let corners = [[70, 50], [90, 50], [70, 70], [90, 70]].map(|[x, y]| nearest.pixel(x, y));
    assert_eq!(corners.as_slice(), texture.pixels());
    assert!(drawn(folder.path(), &[&base[..], &["bilinear"]].concat()) != nearest);
}

#[test]
fn a_scene_is_drawn_as_it_was_saved_and_models_go_into_it() {
    let folder = folder();
    let (scene, mut view) = io::default_scene();
    view.projection = Projection::Orthographic;
    let settings =
        Settings { light: marraztu_core::accuracy::LightAt::Face, ..Settings::default() };
    io::save(&folder.path().join("s.marraztu"), &scene, &view, &settings).unwrap();
    let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(160, 120)));
    let expected = Renderer::default().render(&plan).clone();
    assert!(drawn(folder.path(), &["s.marraztu"]) == expected);
    let with_more = drawn(folder.path(), &["s.marraztu", "square.obj", "--scale", "20"]);
    assert!(with_more != expected);

    let (out, _) = ends_with(0, folder.path(), &["info", "s.marraztu"]);
    for line in ["* r_falke: ", "  x_wing: ", "* 1 sun: on, (255, 255, 255)", "lights"] {
        assert!(out.lines().any(|l| l.starts_with(line)), "{line}\n{out}");
    }
    let (_, err) = ends_with(2, folder.path(), &["render", "-oa.png", "s.marraztu", "s.marraztu"]);
    assert!(err.contains("only one scene"), "{err}");
}

#[test]
fn a_camera_that_is_asked_for_looks_even_if_an_object_is_the_observer() {
    let folder = folder();
    let (scene, view) = io::default_scene();
    let saved = |observer| {
        let view = View { observer, ..view.clone() };
        let path = folder.path().join("s.marraztu");
        io::save(&path, &scene, &view, &Settings::default()).unwrap();
    };
    saved(Observer::Camera);
    let expected = drawn(folder.path(), &["s.marraztu"]);
    saved(Observer::Object);
    assert!(drawn(folder.path(), &["s.marraztu"]) != expected);
    assert!(drawn(folder.path(), &["s.marraztu", "--camera", "1"]) == expected);
    let turn = ["turntable", "s.marraztu", "--turn", "camera", "--size", "8", "--frames", "2"];
    let turn = [&turn[..], &["--out", "frames"]].concat();
    let (_, err) = ends_with(1, folder.path(), &turn);
    assert!(err.contains("the observer is an object; choose a camera with --camera"), "{err}");
    assert!(!folder.path().join("frames").exists());
    ends_with(0, folder.path(), &[&turn[..], &["--camera", "1"]].concat());
}

#[test]
fn an_example_needs_no_file() {
    let folder = folder();
    let chess = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/examples/chess.marraztu");
    let own = drawn(folder.path(), &["example:/chess.marraztu"]);
    assert!(own == drawn(folder.path(), &[chess]));
    let (_, err) = ends_with(1, folder.path(), &["render", "-oa.png", "example:/no.marraztu"]);
    assert!(err.contains("there is no such file"), "{err}");
}

#[test]
fn the_named_lights_shine_and_no_others_whatever_the_scene_says() {
    let folder = folder();
    let (mut scene, view) = io::default_scene();
    let toggle = |scene: &mut Scene, slot| {
        lights::toggle_slot(scene, slot).unwrap().apply(scene).unwrap();
    };
    toggle(&mut scene, 1);
    io::save(&folder.path().join("s.marraztu"), &scene, &view, &Settings::default()).unwrap();
    for slot in [0, 1, 2, 4] {
        toggle(&mut scene, slot);
    }
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(160, 120)));
    let expected = Renderer::default().render(&plan).clone();
    assert!(drawn(folder.path(), &["s.marraztu", "--lights", "1, 3"]) == expected);
}

#[test]
fn spinning_objects_are_drawn_at_the_time_that_is_given() {
    let folder = folder();
    let (mut scene, view) = io::default_scene();
    let id = view.object.unwrap();
    let spin = motion::toggle_spin(&scene, id, Axis::Y, 0.0).unwrap();
    spin.apply(&mut scene).unwrap();
    io::save(&folder.path().join("s.marraztu"), &scene, &view, &Settings::default()).unwrap();
    let at = |time| drawn(folder.path(), &["s.marraztu", "--time", time]);
    assert!(at("3") != at("0"), "a quarter turn at 30 degrees a second");
    assert!(at("12") == at("0"), "a whole turn");
    assert!(at("-9") == at("3"), "the clock runs backwards too");
}

#[test]
fn info_describes_each_file_and_a_bad_one_does_not_keep_it_from_the_others() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.obj"), "v 1 2\nv 1 x 3\nf 1 2 3\n").unwrap();
    let (out, err) = ends_with(0, folder.path(), &["info", "square.obj"]);
    assert_eq!(err, "");
    assert!(out.contains("square") && out.contains("vertices"), "{out}");
    let (all, err) = ends_with(1, folder.path(), &["info", "bad.obj", "square.obj"]);
    assert!(all.contains("vertices"), "{all}");
    assert!(err.starts_with("error: bad.obj:1: "), "{err}");
    assert_eq!(err.lines().count(), 1, "one clear message");
}

#[test]
fn completions_of_every_shell_know_the_commands_and_their_options() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (script, _) = ends_with(0, folder.path(), &["completions", shell]);
        for word in ["compare", "completions", "junit", "dry-run"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
        // PowerShell and Elvish complete no values.
        assert!(script.contains("orthographic") || ["powershell", "elvish"].contains(&shell));
    }
    let (_, err) = ends_with(2, folder.path(), &["completions", "tcsh"]);
    assert!(err.contains("bash, elvish, fish, powershell, zsh"), "{err}");
}

#[test]
fn manual_pages_are_written_for_each_command_and_replace_no_other_file() {
    let folder = folder();
    for _ in 0..2 {
        ends_with(0, folder.path(), &["man", "share/man1"]);
    }
    let at = |name: &str| folder.path().join("share/man1").join(name);
    let page = std::fs::read_to_string(at("marraztu-batch.1")).unwrap();
    assert!(page.contains(".TH marraztu\\-batch 1 ") || page.contains(".TH marraztu-batch 1 "));
    assert!(page.contains(".SH EXAMPLES") && page.contains(".SH \"EXIT STATUS\""));
    assert!(at("marraztu.1").exists());
    std::fs::write(at("marraztu-render.1"), "Roses are red").unwrap();
    let (_, err) = ends_with(1, folder.path(), &["man", "share/man1"]);
    assert!(err.contains("marraztu-render.1: a file with this name exists"), "{err}");
    assert_eq!(std::fs::read_to_string(at("marraztu-render.1")).unwrap(), "Roses are red");
}

#[test]
fn info_as_json_has_an_object_for_each_file_also_for_one_that_cannot_be_read() {
    let folder = folder();
    let files = ["square.obj", "absent.obj", "example:/chess.marraztu"];
    let (out, err) = ends_with(1, folder.path(), &[&["info", "--json"], &files[..]].concat());
    assert_eq!(err, "error: absent.obj: there is no such file\n");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let found = json["files"].as_array().unwrap();
    assert!(found.iter().map(|file| &file["kind"]).eq(["model", "unreadable", "scene"]));
    assert!(found.iter().map(|file| &file["file"]).eq(files));
    assert_eq!(found[1]["error"], "absent.obj: there is no such file");
    assert_eq!(found[0]["bounds"]["min"], serde_json::json!([5.0, 5.0, 5.0]));
    assert_eq!(found[2]["objects"].as_array().unwrap().len(), 29);
}

#[test]
fn names_cannot_control_the_terminal() {
    let folder = folder();
    let square = std::fs::read_to_string(folder.path().join("square.obj")).unwrap();
    let text = format!("o \u{1b}]0;title\u{7}\n{square}");
    std::fs::write(folder.path().join("named.obj"), text).unwrap();
    let (out, _) = ends_with(0, folder.path(), &["info", "named.obj"]);
    assert!(out.contains("\u{fffd}]0;title\u{fffd}") && !out.contains('\u{1b}'), "{out:?}");
    let (_, err) = ends_with(1, folder.path(), &["info", "\u{1b}[2J.obj"]);
    assert!(err.contains("\u{fffd}[2J.obj") && !err.contains('\u{1b}'), "{err:?}");
}

#[test]
fn a_reader_that_closes_the_pipe_causes_no_error() {
    let folder = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_marraztu"))
        .args(["info", "square.obj"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stderr, b"");
}

#[test]
fn invalid_arguments_end_with_2_and_draw_nothing() {
    let folder = folder();
    let wrong: &[(&[&str], &str)] = &[
        (&["render", "-o", "a.gif"], "its name has to end in .png, .jpg, .webp, .ppm, .exr"),
        (&["render", "-o", "a.png", "--size", "0x5"], "800x600"),
        (&["render", "-o", "a.png", "--material", "cheese"], "brass, bronze"),
        (&["render", "-o", "a.png", "--shading", "gouraud"], "vertex"),
        (&["render", "-o", "a.png", "--background", "1,2,300"], "0 to 255"),
        (&["render", "-o", "a.png", "--time", "soon"], "finite number"),
        (&["render", "-o", "a.png", "--camera", "0"], "0 is not in"),
        (&["render", "-o", "a.png", "--lights", "x"], "numbers"),
        (&["render", "-o", "a.png", "--edges", "--edges-over"], "cannot be used with"),
        (&["render", "-o", "a.png", "--report", "--transparent"], "cannot be used with"),
        (&["render", "-o", "a.png", "--report", "--layers", "mask"], "--layers has no color"),
        (&["render", "-o", "a.png", "--up", "z"], "name one"),
        (&["render", "-o", "a.png", "--crease", "60"], "name one"),
        (&["render", "-o", "a.png", "square.obj", "--crease", "181"], "from 0 to 180"),
        (&["render", "-o", "a.png", "square.obj", "--crease", "NaN"], "from 0 to 180"),
        (&["render", "-o", "a.png", "--nonsense"], "--nonsense"),
        (&["info"], "<FILES>"),
        (&["--nonsense"], "--nonsense"),
    ];
    for (arguments, word) in wrong {
        let (out, err) = ends_with(2, folder.path(), arguments);
        assert!(err.starts_with("error: ") && err.contains(word), "{arguments:?}\n{err}");
        let own = if arguments[0].starts_with('-') { "" } else { arguments[0] };
        assert!(err.contains(&format!("\nUsage: marraztu {own}")), "{arguments:?}\n{err}");
        assert_eq!(out, "");
    }
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn a_failure_ends_with_1_and_says_why_in_one_sentence() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.obj"), "# nothing\nv 1 two 3\n").unwrap();
    std::fs::write(folder.path().join("bad.marraztu"), "what is this").unwrap();
    let wrong: &[(&[&str], &str)] = &[
        (&["absent.obj"], "absent.obj: there is no such file"),
        (&["bad.obj"], "bad.obj:2: "),
        (&["absent.marraztu"], "absent.marraztu: there is no such file"),
        (&["bad.marraztu"], "bad.marraztu"),
        (&["--texture", "absent.png"], "absent.png: there is no such file"),
        (&["--camera", "2"], "the scene has 1 camera: there is no camera 2"),
        (&["--lights", "0,7"], "the scene has no light in slot 7"),
    ];
    for (arguments, word) in wrong {
        let all = [&["render", "-o", "a.png"], *arguments].concat();
        let (out, err) = ends_with(1, folder.path(), &all);
        assert!(err.starts_with("error: ") && err.contains(word), "{arguments:?}\n{err}");
        assert_eq!((err.lines().count(), out.as_str()), (1, ""), "{err}");
    }
    assert!(!folder.path().join("a.png").exists());
    let (_, err) = ends_with(1, folder.path(), &["render", "-o", "absent/a.png"]);
    let reason = "error: absent/a.png could not be saved: the folder absent/ does not exist\n";
    assert_eq!(err, reason);
}

#[test]
fn mended_faults_are_reported_and_the_picture_is_drawn() {
    let folder = folder();
    let text = format!("{SQUARE}f 1 2 99\nmtllib absent.mtl\n");
    std::fs::write(folder.path().join("square.obj"), text).unwrap();
    let (_, err) = ends_with(0, folder.path(), &["render", "square.obj", "-o", "a.png"]);
    assert_eq!(err.lines().count(), 2, "{err}");
    assert!(err.lines().all(|line| line.starts_with("note: square.obj: ")), "{err}");
}

#[test]
fn without_a_display_the_editor_reports_it_and_names_alternatives() {
    let folder = folder();
    for arguments in [&[][..], &["square.obj"]] {
        let (_, err) = ends_with(1, folder.path(), arguments);
        assert!(err.starts_with("error: "), "{err}");
        assert!(err.contains("marraztu render"), "{err}");
        assert!(err.lines().count() <= 2, "{err}");
    }
}

#[test]
fn a_scene_without_its_files_is_drawn_described_and_exported_with_a_finding() {
    let folder = folder();
    let scene = r#"(version: 1, cameras: [(id: 3, name: "c", eye: (0.0, 0.0, 4.0))], objects: [
        (id: 1, name: "ship", model: File(path: "models/ship.obj")),
        (id: 2, name: "square", model: File(path: "square.obj"),
            texture: Some((path: "t.png")))])"#;
    std::fs::write(folder.path().join("a.marraztu"), scene).unwrap();
    let size = ["--size", "40x30"];
    let missing = "the model \"models/ship.obj\" was not found: a box is shown instead";
    let (_, err) = ends_with(
        0,
        folder.path(),
        &[&["render", "a.marraztu", "--out", "a.png"], &size[..]].concat(),
    );
    assert!(err.contains(missing) && err.contains("the texture \"t.png\" was not found"), "{err}");
    let picture = io::load_picture(&folder.path().join("a.png")).unwrap();
    assert_ne!(picture.pixel(20, 15), picture.pixel(0, 0), "the box is seen");
    let (out, _) = ends_with(0, folder.path(), &["info", "a.marraztu"]);
    assert!(
        out.contains("ship: a box in place of the missing file ") && out.contains(missing),
        "{out}"
    );
    let (out, err) = ends_with(0, folder.path(), &[&["plan", "a.marraztu"], &size[..]].concat());
    assert!(out.contains("ship") && err.contains(missing), "{out}{err}");
    for name in ["a.glb", "a.obj"] {
        let (_, err) = ends_with(0, folder.path(), &["export", "a.marraztu", "--out", name]);
        assert!(err.contains("ship is left out: its model"), "{err}");
        assert!(err.contains("square is exported without its texture"), "{err}");
        assert!(!err.contains("hidden objects"), "{err}");
    }
    let obj = std::fs::read_to_string(folder.path().join("a.obj")).unwrap();
    assert!(obj.contains("v 5 5 5") && !obj.contains("ship"), "{obj}");
}

#[test]
fn an_address_is_refused_in_one_sentence_and_creates_no_folder() {
    let folder = folder();
    std::fs::write(folder.path().join("a.obj"), SQUARE).unwrap();
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    for arguments in [
        &["render", "a.obj", "--out", "s3://pictures/a.png"][..],
        &["render", "a.obj", "--layers", "depth", "--out", "gs://pictures/{layer}.png"],
        &["batch", "a.obj", "--out", "s3://pictures/{stem}.png"],
        &["batch", "a.obj", "--out", "S3://pictures/{stem}.png", "--dry-run"],
        &["batch", "a.obj", "--dataset", "coco", "--out", "https://pictures/set"],
        &["batch", "a.obj", "--report", "s3://pictures/r.jsonl"],
        &["batch", "a.obj", "--times", "abfs+x://pictures/t.jsonl"],
        &["batch", "a.obj", "--sheet", "1x1", "--sheets", "s3://sheets"],
        &["turntable", "a.obj", "--out", "s3://pictures/a.gif"],
        &["turntable", "a.obj", "--out", "s3://pictures/a"],
        &["views", "a.obj", "--out", "s3://pictures/a.png"],
        &["thumbnail", "a.obj", "s3://pictures/a.png"],
        &["export", "a.obj", "--out", "s3://models/a.glb"],
        &["verify", "--out", "s3://pictures"],
        &["lab", "a.obj", "--out", "s3://results"],
    ] {
        let output = run(folder.path(), arguments);
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success(), "{arguments:?}");
        let sentence = err.lines().next().unwrap_or_default();
        assert!(sentence.contains("cannot be written to; choose a file"), "{arguments:?}\n{err}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before, "{arguments:?}");
    }
}
