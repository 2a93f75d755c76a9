//! The pictures of batches, and the commands that compare and arrange pictures.

use std::path::Path;

use marraztu_io as io;

use super::{SMALL, contents, ends_with, folder, report};

#[test]
fn a_batch_draws_the_pixels_of_render_from_each_view() {
    let folder = folder();
    let base = ["--size", "64x48", "--material", "gold"];
    let (_, err) = ends_with(
        0,
        folder.path(),
        &[&["batch", "models/cam.obj", "models/plate.obj", "--views", "front,iso"], &base[..]]
            .concat(),
    );
    assert!(err.starts_with("note: 4 drawn, 0 missing"), "{err}");
    for (i, from) in ["0,0", "45,35.264389682754654"].iter().enumerate() {
        let arguments = ["render", "models/cam.obj", "--out", "one.png", "--from", from];
        ends_with(0, folder.path(), &[&arguments[..], &base].concat());
        let load = |name: &str| io::load_picture(&folder.path().join(name)).unwrap();
        assert!(load("one.png") == load(&format!("cam-00{i}.png")), "{from}");
    }
    // Sheets hold the pictures with their labels.
    let sheet = ["batch", "models/cam.obj", "models/plate.obj", "--sheet", "2x1", "--sheets", "s"];
    ends_with(0, folder.path(), &[&sheet[..], &base].concat());
    let sheets = contents(&folder.path().join("s"));
    assert_eq!(sheets.keys().collect::<Vec<_>>(), [Path::new("sheet-000.png")]);
    // Without views, the camera of the options is used, and the name is the model's.
    ends_with(
        0,
        folder.path(),
        &[&["batch", "models/cam.obj", "--from", "0,0"], &base[..]].concat(),
    );
    let load = |name: &str| io::load_picture(&folder.path().join(name)).unwrap();
    assert!(load("cam.png") == load("cam-000.png"));
}

#[test]
fn a_large_picture_and_a_transparent_one_are_those_of_render() {
    let folder = folder();
    for options in
        [&["--size", "1100x1000", "--samples", "1"][..], &["--size", "64", "--transparent"]]
    {
        let file = ["models/plate.obj"];
        ends_with(
            0,
            folder.path(),
            &[&["batch", "--out", "a.png", "--threads", "2"], &file[..], options].concat(),
        );
        ends_with(0, folder.path(), &[&["render", "--out", "b.png"], &file[..], options].concat());
        let (out, _) = ends_with(0, folder.path(), &["compare", "a.png", "b.png"]);
        assert!(out.starts_with("largest difference  0\n"), "{out}");
    }
}

#[test]
fn a_picture_beyond_its_time_limit_is_reported_as_such() {
    let folder = folder();
    let arguments = [
        "batch",
        "models/x_wing.obj",
        "--size",
        "3000",
        "--samples",
        "16",
        "--timeout",
        "0.05",
        "--report",
        "r.jsonl",
    ];
    ends_with(1, folder.path(), &arguments);
    let line = &report(&folder.path().join("r.jsonl"))[0];
    assert_eq!(line["status"], "timeout");
    assert_eq!(line["error"], "models/x_wing.obj: the time limit was reached");
    assert!(!folder.path().join("x_wing.png").exists());
}

#[test]
fn an_output_never_replaces_an_input_or_a_file_that_is_no_picture() {
    let folder = folder();
    let at = |name: &str| folder.path().join("models").join(name);
    std::fs::write(at("cam.png"), "my notes").unwrap();
    let before = contents(folder.path());
    for (file, out) in
        [("models/square.obj", "models/square.ppm"), ("models/cam.obj", "models/cam.png")]
    {
        ends_with(1, folder.path(), &[&["batch", file, "--out", out], &SMALL[..]].concat());
    }
    assert!(contents(folder.path()) == before);
}

#[test]
fn a_batch_replaces_no_texture_of_another_model_in_its_list() {
    let folder = folder();
    let texture = folder.path().join("models/square.ppm");
    let before = std::fs::read(&texture).unwrap();
    std::fs::copy(folder.path().join("models/cam.obj"), folder.path().join("square.obj")).unwrap();
    let arguments =
        ["batch", "models/square.obj", "square.obj", "--out", "models/{stem}{index}.ppm"];
    std::fs::rename(&texture, folder.path().join("models/square1.ppm")).unwrap();
    let mtl = "newmtl a\nKd 1 1 1\nmap_Kd square1.ppm\n";
    std::fs::write(folder.path().join("models/square.mtl"), mtl).unwrap();
    let texture = folder.path().join("models/square1.ppm");
    let (_, err) = ends_with(1, folder.path(), &[&arguments[..], &SMALL].concat());
    assert!(err.contains("this file is an input"), "{err}");
    assert_eq!(std::fs::read(texture).unwrap(), before);
}

#[test]
fn an_angle_without_a_size_is_horizontal_in_pictures_of_any_shape() {
    let folder = folder();
    // At distance 2, half of the view is 2 tan(0.5) = 1.09 wide: the square has 200 / 2.18 pixels.
    let json = r#"{"camera_angle_x": 1.0, "frames": [
        {"transform_matrix": [[1,0,0,0.5],[0,1,0,0.5],[0,0,1,2]]}]}"#;
    std::fs::write(folder.path().join("cameras.json"), json).unwrap();
    let views = ["--views", "cameras.json", "--out", "a.png", "--samples", "1"];
    let arguments = ["batch", "models/square.obj", "--size", "200x100"];
    ends_with(0, folder.path(), &[&arguments[..], &views].concat());
    let picture = io::load_picture(&folder.path().join("a.png")).unwrap();
    let row = (0..200).filter(|x| picture.pixel(*x, 50) != picture.pixel(0, 50)).count();
    assert!((91..=92).contains(&row), "{row}");
}

#[test]
fn a_wide_lens_keeps_what_is_near_along_its_axis_and_far_to_the_side() {
    let folder = folder();
    // The square is 0.8 in front of the camera, and more than 2 to its right.
    let json = r#"{"camera_angle_x": 2.9, "frames": [
        {"transform_matrix": [[1,0,0,-2],[0,1,0,0.5],[0,0,1,0.8]]}]}"#;
    std::fs::write(folder.path().join("cameras.json"), json).unwrap();
    let views = ["--views", "cameras.json", "--out", "a.png", "--samples", "1"];
    let arguments = ["batch", "models/square.obj", "--size", "200"];
    ends_with(0, folder.path(), &[&arguments[..], &views].concat());
    let picture = io::load_picture(&folder.path().join("a.png")).unwrap();
    assert!(picture.pixels().iter().any(|pixel| *pixel != picture.pixel(0, 0)));
}

#[test]
fn a_batch_frames_what_turns_at_the_time_of_the_picture() {
    let folder = folder();
    // After two seconds, the square is a quarter of a turn further around the origin.
    let square = "v 50 0 0\nv 50 1 0\nv 50 1 1\nv 50 0 1\nf 1 2 3 4\n";
    std::fs::write(folder.path().join("far.obj"), square).unwrap();
    let scene = r#"(version: 1, next_id: 9, objects: [(id: 1, name: "a", sides: Two,
        model: File(path: "far.obj"), spin: (axes: (false, true, false), speed: 45.0),
        placement: ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0),
            (0.0, 0.0, 0.0, 1.0)))],
        cameras: [(id: 2, name: "c", eye: (0.0, 0.0, 1000.0))],
        lights: [(id: 3, name: "ambient", slot: 0, kind: Ambient)],
        view: (object: Some(1), camera: 2, light: Some(3), subject: Object, marks: false))"#;
    std::fs::write(folder.path().join("s.marraztu"), scene).unwrap();
    let arguments = ["batch", "s.marraztu", "--views", "front", "--time", "2", "--out", "a.png"];
    ends_with(0, folder.path(), &[&arguments[..], &SMALL].concat());
    let picture = io::load_picture(&folder.path().join("a.png")).unwrap();
    assert!(picture.pixels().iter().any(|pixel| *pixel != picture.pixel(0, 0)));
}

#[test]
fn cameras_of_a_file_place_the_camera_and_the_size() {
    let folder = folder();
    let json = r#"{"w": 48, "h": 32, "fl_x": 40, "frames": [
        {"file_path": "a.png", "transform_matrix": [[1,0,0,0.5],[0,1,0,0.5],[0,0,1,2]]},
        {"file_path": "b.png", "transform_matrix": [[1,0,0,0.5],[0,1,0,0.5],[0,0,1,900]]}]}"#;
    std::fs::write(folder.path().join("cameras.json"), json).unwrap();
    ends_with(
        0,
        folder.path(),
        &[
            "batch",
            "models/square.obj",
            "--views",
            "cameras.json",
            "--out",
            "{view_name}.png",
            "--samples",
            "1",
        ],
    );
    let [near, far] =
        ["a.png", "b.png"].map(|name| io::load_picture(&folder.path().join(name)).unwrap());
    assert_eq!((near.size().width, near.size().height), (48, 32));
    // At distance 2, the unit square is 40 / 2 = 20 pixels wide.
    let is_square = |x: usize| near.pixel(x, 16) != near.pixel(0, 0);
    let width = (0..48).filter(|x| is_square(*x)).count();
    assert_eq!((width, is_square(13), is_square(35)), (20, false, false));
    assert!((0..48).all(|x| far.pixel(x, 16) == far.pixel(0, 0)) || far != near);
}

#[test]
fn the_cameras_of_views_look_with_their_own_lens_whatever_the_scene_says() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let json = r#"{"w": 64, "h": 64, "frames": [
        {"file_path": "a", "fl_x": 100, "transform_matrix": [[1,0,0,0.5],[0,1,0,0.5],[0,0,1,3]]},
        {"file_path": "b", "projection": "perspective",
         "transform_matrix": [[1,0,0,0.5],[0,1,0,0.5],[0,0,1,3]]}]}"#;
    std::fs::write(at("cameras.json"), json).unwrap();
    let drawn = |view: &str| {
        let scene = format!(
            r#"(version: 1, next_id: 9, objects: [
                (id: 1, name: "a", sides: Two, model: File(path: "models/square.obj"))],
            cameras: [(id: 2, name: "c", eye: (0.0, 0.0, 9.0))],
            lights: [(id: 3, name: "ambient", slot: 0, kind: Ambient)],
            view: (object: Some(1), camera: 2, light: Some(3), subject: Object, marks: false,
                {view}))"#
        );
        std::fs::write(at("s.marraztu"), scene).unwrap();
        ["cameras.json", "front"].iter().for_each(|views| {
            let base = ["batch", "s.marraztu", "--views", views, "--out", "o/{view_name}.png"];
            ends_with(0, folder.path(), &[&base[..], &SMALL].concat());
        });
        ["a", "b", "front"].map(|name| io::load_picture(&at(&format!("o/{name}.png"))).unwrap())
    };
    let [angle, selected, front] = drawn("");
    assert!(angle != selected && selected != front);
    assert!(drawn("observer: Object") == [angle.clone(), selected.clone(), front.clone()]);
    let [parallel_angle, parallel_selected, parallel_front] = drawn("projection: Orthographic");
    assert!([parallel_angle, parallel_selected] == [angle, selected]);
    assert!(parallel_front != front, "a direction has no projection");
}

#[test]
fn pictures_are_compared_with_an_exit_status() {
    let folder = folder();
    let render = |name: &str, more: &[&str]| {
        let arguments = ["render", "models/cam.obj", "--samples", "1", "--out", name];
        ends_with(0, folder.path(), &[&arguments[..], more].concat());
    };
    render("a.png", &["--size", "64"]);
    render("b.png", &["--size", "64", "--background", "1,2,3"]);
    render("c.png", &["--size", "32"]);
    let compare = |status, arguments: &[&str]| {
        ends_with(status, folder.path(), &[&["compare"], arguments].concat())
    };
    assert!(compare(0, &["a.png", "a.png"]).0.contains("differing pixels    0 of 4096"));
    let (out, _) = compare(1, &["a.png", "b.png", "--out", "diff.png"]);
    assert!(out.contains("largest difference") && out.contains("FLIP"), "{out}");
    assert!(folder.path().join("diff.png").exists());
    let (out, _) = compare(1, &["a.png", "b.png", "--html", "page.html"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    let value = out.lines().last().and_then(|line| line.split_whitespace().last()).unwrap();
    assert!(page.contains(&format!("<td>FLIP</td><td>{value}</td>")), "{page}");
    assert_eq!(page.matches("data:image/png;base64,").count(), 3);
    compare(0, &["a.png", "a.png", "--html", "page.html"]);
    let (_, err) = compare(2, &["a.png", "b.png", "--html", "models/cam.obj"]);
    assert!(err.contains("is not a page"), "{err}");
    compare(0, &["a.png", "b.png", "--max", "255"]);
    compare(1, &["a.png", "b.png", "--max", "255", "--flip", "0.0001"]);
    let before = std::fs::read(folder.path().join("a.png")).unwrap();
    let (_, err) = compare(2, &["a.png", "b.png", "--out", "a.png"]);
    assert!(err.contains("this file is an input"), "{err}");
    assert_eq!(std::fs::read(folder.path().join("a.png")).unwrap(), before);
    for wrong in [["a.png", "c.png"], ["a.png", "absent.png"], ["a.png", "models/cam.obj"]] {
        let (_, err) = compare(2, &wrong);
        assert!(err.starts_with("error: ") && err.lines().count() == 1, "{err}");
    }
}

#[test]
fn views_and_thumbnails_show_a_model_whatever_its_name() {
    let folder = folder();
    let (out, _) =
        ends_with(0, folder.path(), &["views", "models/square.obj", "--size", "100", "--quiet"]);
    assert!(out.contains("vertices") && out.contains("findings"), "{out}");
    let sheet = io::load_picture(&folder.path().join("square-views.png")).unwrap();
    assert!(sheet.size().width > 200 && sheet.size().height > 240, "{:?}", sheet.size());
    let at = |name: &str| folder.path().join(name);
    std::fs::copy(at("models/x_wing.obj"), at("gnome-desktop-file-to-thumbnail")).unwrap();
    ends_with(
        0,
        folder.path(),
        &["thumbnail", "--size", "128", "gnome-desktop-file-to-thumbnail", "t"],
    );
    std::fs::rename(at("t"), at("t.png")).unwrap();
    let picture = io::load_picture(&at("t.png")).unwrap();
    assert_eq!((picture.size().width, picture.pixel(0, 0)), (128, [0; 4]));
    assert!(picture.pixels().iter().any(|pixel| pixel[3] == 255));
    std::fs::write(at("noise"), [0, 1, 2, 3]).unwrap();
    let (_, err) = ends_with(1, folder.path(), &["thumbnail", "noise", "n.png"]);
    assert!(err.starts_with("error: noise: "), "{err}");
    assert!(!at("n.png").exists());
}

#[test]
fn a_panorama_lights_every_picture_and_a_changed_one_draws_them_again() {
    let folder = folder();
    let sky = folder.path().join("sky.png");
    let fill = |color: [u8; 3]| {
        image::RgbImage::from_pixel(8, 4, image::Rgb(color)).save(&sky).unwrap();
    };
    fill([10, 120, 240]);
    let arguments = ["batch", "models/cam.obj", "--views", "front,iso", "--size", "64x48"];
    let arguments = [&arguments[..], &["--sky", "sky.png", "--resume"]].concat();
    let (_, err) = ends_with(0, folder.path(), &arguments);
    assert!(err.starts_with("note: 2 drawn"), "{err}");
    let corner = |name: &str| io::load_picture(&folder.path().join(name)).unwrap().pixel(0, 0);
    assert_eq!([corner("cam-000.png"), corner("cam-001.png")], [[10, 120, 240, 255]; 2]);
    let (_, err) = ends_with(0, folder.path(), &arguments);
    assert!(err.starts_with("note: 0 drawn"), "{err}");
    fill([200, 30, 0]);
    let (_, err) = ends_with(0, folder.path(), &arguments);
    assert!(err.starts_with("note: 2 drawn"), "{err}");
    assert_eq!(corner("cam-000.png"), [200, 30, 0, 255]);
    // With a background, it only lights. It is an input, which no output replaces.
    let plain = ["render", "models/cam.obj", "--size", "64x48", "--sky", "sky.png", "--out"];
    let behind = ["one.png", "--background", "white"];
    ends_with(0, folder.path(), &[&plain[..], &behind].concat());
    assert_eq!(corner("one.png"), [255; 4]);
    let own = ["views", "models/cam.obj", "--sky", "sky.png", "--out", "sky.png"];
    let (_, err) = ends_with(1, folder.path(), &own);
    assert!(err.contains("input"), "{err}");
    ends_with(1, folder.path(), &[&plain[..], &["sky.png"]].concat());
    assert_eq!(corner("sky.png"), [200, 30, 0, 255]);
    let (_, err) = ends_with(1, folder.path(), &["render", "models/cam.obj", "--sky", "none.hdr"]);
    assert_eq!(err.lines().count(), 1, "{err}");
}
