//! Standard input and output, default names of pictures, and messages of the program.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use flate2::Compression;
use flate2::write::GzEncoder;
use marraztu_core::accuracy::Settings;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io as io;
use tempfile::TempDir;

/// A unit square far from the origin, with its corners counter-clockwise as seen from +Z.
const SQUARE: &str = "v 5 5 5\nv 6 5 5\nv 6 6 5\nv 5 6 5\nf 1 2 3 4\n";

/// Runs the program with some bytes as standard input.
fn run(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_marraztu"));
    command.current_dir(folder).args(arguments);
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A program that does not read its input closes the pipe, which is not an error here.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

/// Runs the program, checks its exit status, and returns standard output and standard error.
#[track_caller]
fn ends_with(status: i32, folder: &Path, arguments: &[&str], input: &[u8]) -> (Vec<u8>, String) {
    let output = run(folder, arguments, input);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}\n{err}");
    (output.stdout, err)
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("square.obj"), SQUARE).unwrap();
    folder
}

/// Returns the picture that `render` draws with these arguments at a small size.
#[track_caller]
fn drawn(folder: &Path, arguments: &[&str], input: &[u8]) -> Picture {
    let all = [&["render", "--out", "drawn.png", "--size", "96x64", "--samples", "1"], arguments]
        .concat();
    ends_with(0, folder, &all, input);
    io::load_picture(&folder.join("drawn.png")).unwrap()
}

fn packed(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_picture_is_named_after_its_file_and_lies_in_the_current_folder() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("models")).unwrap();
    std::fs::write(folder.path().join("models/pot.obj"), SQUARE).unwrap();
    let render = ["render", "--size", "32", "models/pot.obj"];
    let (_, err) = ends_with(0, folder.path(), &render, b"");
    assert_eq!(err, "note: the picture is in pot.png\n");
    let size = io::load_picture(&folder.path().join("pot.png")).unwrap().size();
    assert_eq!(size, Size::new(32, 32), "one number is a square");
    // An existing picture is replaced.
    ends_with(0, folder.path(), &render, b"");
    let (_, err) = ends_with(0, folder.path(), &[&render[..], &["--quiet"]].concat(), b"");
    assert_eq!(err, "");
    ends_with(0, folder.path(), &["render", "--size", "32"], b"");
    assert!(folder.path().join("scene.png").exists());
}

#[test]
fn a_picture_replaces_neither_a_file_of_another_kind_nor_its_own_source() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("poem.png"), "Roses are red").unwrap();
    for arguments in [&["square.obj", "--out", "poem.png"][..], &["poem.obj"]] {
        std::fs::write(at("poem.obj"), SQUARE).unwrap();
        let all = [&["render"], arguments].concat();
        let (_, err) = ends_with(1, folder.path(), &all, b"");
        assert!(err.contains("exists and is not a picture"), "{err}");
        assert_eq!(std::fs::read_to_string(at("poem.png")).unwrap(), "Roses are red");
    }
    // Neither the texture named by the material nor the texture option may be overwritten.
    let texture = Picture::filled(Size::new(2, 2), [255, 0, 0, 255]);
    io::save_picture(&at("wood.png"), &texture).unwrap();
    let text = SQUARE.replace("f 1 2 3 4", "vt 0 0\nusemtl wood\nf 1/1 2/1 3/1 4/1");
    std::fs::write(at("wood.obj"), format!("mtllib wood.mtl\n{text}")).unwrap();
    std::fs::write(at("wood.mtl"), "newmtl wood\nmap_Kd wood.png\n").unwrap();
    for arguments in
        [&["wood.obj"][..], &["square.obj", "--texture", "wood.png", "-o", "./wood.png"]]
    {
        let (_, err) = ends_with(1, folder.path(), &[&["render"], arguments].concat(), b"");
        assert!(err.contains("this file is an input"), "{err}");
        assert_eq!(io::load_picture(&at("wood.png")).unwrap(), texture);
    }
}

#[test]
fn a_model_or_a_scene_is_read_from_stdin_and_the_picture_written_to_stdout() {
    let folder = folder();
    let model = drawn(folder.path(), &["square.obj"], b"");
    assert!(drawn(folder.path(), &["-"], SQUARE.as_bytes()) == model);
    assert!(drawn(folder.path(), &["-"], &packed(SQUARE.as_bytes())) == model);

    let (scene, view) = io::default_scene();
    let path = folder.path().join("s.marraztu");
    io::save(&path, &scene, &view, &Settings::default()).unwrap();
    let text = std::fs::read(&path).unwrap();
    assert!(drawn(folder.path(), &["-"], &text) == drawn(folder.path(), &["s.marraztu"], b""));

    let (out, err) = ends_with(
        0,
        folder.path(),
        &["render", "-", "-o-", "--size", "96x64", "--samples", "1"],
        SQUARE.as_bytes(),
    );
    assert_eq!(err, "");
    std::fs::write(folder.path().join("out.png"), out).unwrap();
    assert!(io::load_picture(&folder.path().join("out.png")).unwrap() == model);

    let (out, _) = ends_with(0, folder.path(), &["info", "-"], SQUARE.as_bytes());
    assert!(String::from_utf8(out).unwrap().contains("vertices"));
    let (out, _) = ends_with(0, folder.path(), &["info", "-"], &text);
    assert!(String::from_utf8(out).unwrap().contains("r_falke"));
    let (_, err) = ends_with(1, folder.path(), &["render", "-"], b"v 1 2\n");
    assert!(err.starts_with("error: standard input:1: "), "{err}");
    let (_, err) = ends_with(2, folder.path(), &["render", "-", "-"], SQUARE.as_bytes());
    assert!(err.contains("can be read once"), "{err}");
}

#[test]
fn a_packed_model_equals_the_plain_one_and_finds_its_materials() {
    let folder = folder();
    let text = format!("mtllib m.mtl\nusemtl red\n{SQUARE}");
    std::fs::write(folder.path().join("m.mtl"), "newmtl red\nKd 1 0 0\nKs 0 0 0\n").unwrap();
    std::fs::write(folder.path().join("red.obj"), &text).unwrap();
    std::fs::write(folder.path().join("packed.obj.gz"), packed(text.as_bytes())).unwrap();
    let plain = drawn(folder.path(), &["red.obj"], b"");
    assert!(plain != drawn(folder.path(), &["square.obj"], b""), "the material shows");
    assert!(drawn(folder.path(), &["packed.obj.gz"], b"") == plain);
    let (out, _) = ends_with(0, folder.path(), &["info", "packed.obj.gz"], b"");
    assert!(String::from_utf8(out).unwrap().contains(" packed\n"), "without its endings");

    let mut half = packed(text.as_bytes());
    half.truncate(half.len() / 2);
    std::fs::write(folder.path().join("half.obj.gz"), half).unwrap();
    std::fs::write(folder.path().join("plain.obj.gz"), &text).unwrap();
    for name in ["half.obj.gz", "plain.obj.gz"] {
        let (_, err) = ends_with(1, folder.path(), &["render", name], b"");
        assert_eq!(err, format!("error: {name}: the gzip archive is damaged\n"));
    }
}

#[test]
fn a_picture_has_the_format_that_its_name_asks_for() {
    let folder = folder();
    let png = drawn(folder.path(), &["square.obj"], b"");
    for (name, signature) in
        [("a.jpg", &b"\xFF\xD8\xFF"[..]), ("a.webp", b"RIFF"), ("a.ppm", b"P6")]
    {
        let all = ["render", "square.obj", "--size", "96x64", "--samples", "1", "--out", name];
        ends_with(0, folder.path(), &all, b"");
        let path = folder.path().join(name);
        assert!(std::fs::read(&path).unwrap().starts_with(signature), "{name}");
        let read = io::load_picture(&path).unwrap();
        assert_eq!(read.size(), Size::new(96, 64));
        if name != "a.jpg" {
            assert!(read == png, "{name}");
        }
    }
}

#[test]
fn colours_of_the_background_threads_and_axes_that_point_up_are_taken_as_people_write_them() {
    let folder = folder();
    let corner =
        |color: &str| drawn(folder.path(), &["square.obj", "--background", color], b"").pixel(0, 0);
    assert_eq!(corner("#0a10FF"), [10, 16, 255, 255]);
    assert_eq!(corner("white"), [255; 4]);
    let plain = drawn(folder.path(), &[], b"");
    for threads in ["1", "2", "7"] {
        assert!(drawn(folder.path(), &["--threads", threads], b"") == plain, "{threads}");
    }
    ends_with(2, folder.path(), &["render", "--threads", "0"], b"");
    // The square faces +Z: with -Z up it lies face down.
    let seen = |up: &str, from: &str| {
        let all = ["square.obj", "--sides", "one", "--up", up, "--from", from];
        let picture = drawn(folder.path(), &all, b"");
        picture.pixel(48, 32) != picture.pixel(0, 0)
    };
    assert!(seen("y", "0,0") && seen("x", "0,0") && seen("-x", "0,0"));
    assert!(seen("z", "0,90") && seen("-z", "0,-90") && seen("-y", "180,0"));
    assert!(!seen("z", "0,-90") && !seen("-z", "0,90") && !seen("-y", "0,0"));
}

#[test]
fn progress_is_reported_in_per_cent_on_request() {
    let folder = folder();
    let render = ["render", "square.obj", "--size", "64", "--out", "a.png"];
    let (_, err) = ends_with(0, folder.path(), &render, b"");
    assert_eq!(err, "");
    let (_, err) = ends_with(0, folder.path(), &[&render[..], &["--progress"]].concat(), b"");
    let lines: Vec<&str> = err.lines().collect();
    for line in ["progress: reading square.obj: 100%", "progress: drawing: 100%"] {
        assert!(lines.contains(&line), "{err}");
    }
    ends_with(2, folder.path(), &[&render[..], &["--progress", "--quiet"]].concat(), b"");
}

#[test]
fn quiet_silences_notes_and_no_errors() {
    let folder = folder();
    let text = format!("{SQUARE}f 1 2 99\n");
    std::fs::write(folder.path().join("square.obj"), text).unwrap();
    let render = ["render", "square.obj", "--size", "64", "--out", "a.png"];
    let (_, err) = ends_with(0, folder.path(), &render, b"");
    assert!(err.starts_with("note: square.obj"), "{err}");
    let (_, err) = ends_with(0, folder.path(), &[&render[..], &["--quiet"]].concat(), b"");
    assert_eq!(err, "");
    let (_, err) = ends_with(1, folder.path(), &["render", "nosuch.obj", "--quiet"], b"");
    assert_eq!(err, "error: nosuch.obj: there is no such file\n");
}

#[test]
fn a_missing_file_is_reported_before_a_display_or_another_file_is_looked_for() {
    let folder = folder();
    let (_, err) = ends_with(1, folder.path(), &["nosuch.obj"], b"");
    assert_eq!(err, "error: nosuch.obj: there is no such file\n");
    for arguments in [&["rendr", "square.obj"][..], &["rendr", "square.obj", "--out", "a.png"]] {
        let (_, err) = ends_with(2, folder.path(), arguments, b"");
        let reason = "error: there is no file rendr; did you mean `marraztu render`?";
        assert!(err.starts_with(reason), "{err}");
    }
    let (_, err) = ends_with(2, folder.path(), &["-"], b"");
    assert!(err.contains("marraztu render -"), "{err}");
    std::fs::write(folder.path().join("bad.obj"), "v 1 2\n").unwrap();
    let (_, err) = ends_with(1, folder.path(), &["render", "bad.obj", "nosuch.obj"], b"");
    assert_eq!(err, "error: nosuch.obj: there is no such file\n");
}

#[test]
fn many_models_are_drawn_and_one_that_is_named_twice_is_read_once() {
    let folder = folder();
    // Each reading reports the fault in the file once.
    let text = format!("{SQUARE}f 1 2 99\n");
    std::fs::write(folder.path().join("square.obj"), text).unwrap();
    let mut all = vec!["render", "--size", "64", "--out", "a.png"];
    all.extend(["square.obj", "./square.obj"].iter().cycle().take(2_000));
    let (_, err) = ends_with(0, folder.path(), &all, b"");
    assert_eq!(err.matches("a face refers to a vertex").count(), 1, "{err}");
    // All but one are hidden. The notes summarise them in a few lines.
    assert!(err.lines().count() <= 3, "{err}");
}
