//! Rendering a model without a scene: its framing, and the options that apply.

use std::path::Path;

use marraztu_core::scene::Scene;

use super::{SQUARE, drawn, ends_with, folder};

#[test]
fn models_without_a_scene_are_seen_whole_and_in_the_middle() {
    let folder = folder();
    let behind = Scene::NEUTRAL.opaque();
    for how in
        [&["square.obj"][..], &["square.obj", "--scale", "1000"], &["square.obj", "square.obj"]]
    {
        let picture = drawn(folder.path(), how);
        assert_ne!(picture.pixel(80, 60), behind, "{how:?}");
        for x in 0..160 {
            assert_eq!([picture.pixel(x, 0), picture.pixel(x, 119)], [behind, behind], "{how:?}");
        }
    }
    let through_the_camera = drawn(folder.path(), &["square.obj", "--camera", "1"]);
    assert_eq!(through_the_camera.pixel(80, 60), behind, "the square is at (5, 5), and small");
    let marks = ["square.obj", "--camera", "1", "--helpers", "all"];
    assert_eq!(drawn(folder.path(), &marks).pixel(80, 60), [255, 255, 0, 255], "the bulb");
    let one = ["square.obj", "--flip-winding", "--sides", "one"];
    assert_eq!(drawn(folder.path(), &one).pixel(80, 60), behind, "its back is not drawn");
    let red = drawn(folder.path(), &[&one[..], &["--back-faces"]].concat());
    assert_eq!(red.pixel(80, 60), [255, 0, 0, 255]);
    let upright = drawn(folder.path(), &["square.obj", "--up", "z", "--from", "0,0"]);
    assert_eq!(upright.pixel(80, 60), behind, "it lies, and is seen from its edge");
    let upright = drawn(folder.path(), &["square.obj", "--up", "z"]);
    assert_ne!(upright.pixel(80, 60), behind, "from above it is seen");
}

#[test]
fn an_up_axis_that_the_file_states_is_used_unless_another_is_given() {
    let folder = folder();
    let square = "v 0 0 0\nv 2 0 0\nv 2 0 1\nv 0 0 1\nf 1 2 3 4\n";
    std::fs::write(folder.path().join("plain.obj"), square).unwrap();
    std::fs::write(folder.path().join("stated.obj"), format!("# Z-up\n{square}")).unwrap();
    let turned = drawn(folder.path(), &["plain.obj", "--up", "z"]);
    assert!(drawn(folder.path(), &["stated.obj"]) == turned);
    let plain = drawn(folder.path(), &["plain.obj"]);
    assert!(plain != turned);
    assert!(drawn(folder.path(), &["stated.obj", "--up", "y"]) == plain);
    let (said, _) = ends_with(0, folder.path(), &["info", "stated.obj"]);
    assert!(said.contains("Z is up"), "{said}");
}

#[test]
fn models_without_a_scene_are_seen_from_the_right_and_above() {
    let folder = folder();
    let picture = drawn(folder.path(), &["square.obj"]);
    assert!(picture == drawn(folder.path(), &["square.obj", "--from", "30,20"]));
    assert!(picture != drawn(folder.path(), &["square.obj", "--from", "0,0"]));
}

#[test]
fn both_sides_of_an_open_surface_are_drawn_and_the_front_of_a_closed_one() {
    let folder = folder();
    let back = |sides| {
        let all = ["square.obj", "--from", "180,0", "--lights", "0", "--sides", sides];
        drawn(folder.path(), &all)
    };
    let behind = Scene::NEUTRAL.opaque();
    assert_eq!(back("one").pixel(80, 60), behind);
    assert_ne!(back("two").pixel(80, 60), behind);
    assert!(back("auto") == back("two"));
    assert!(
        drawn(folder.path(), &["square.obj", "--from", "180,0", "--lights", "0"]) == back("two")
    );
    // A closed surface that is inside out: with one side drawn it shows the inside of its far wall,
    // with two sides its outside.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
    std::fs::write(folder.path().join("inside_out.obj"), text).unwrap();
    let closed = |sides| drawn(folder.path(), &["inside_out.obj", "--sides", sides]);
    assert!(closed("auto") == closed("one"));
    assert!(closed("two") != closed("one"));
}

/// Returns the notes that `render` prints on standard error.
fn notes(folder: &Path, arguments: &[&str]) -> String {
    let all =
        [&["render", "--out", "x.png", "--size", "160x120", "--samples", "1"], arguments].concat();
    ends_with(0, folder, &all).1
}

#[test]
fn a_picture_that_shows_nothing_of_an_object_says_why() {
    let folder = folder();
    let path = folder.path();
    assert_eq!(notes(path, &["square.obj"]), "");
    assert_eq!(notes(path, &[]), "", "all of the first scene is seen");
    let err = notes(path, &["square.obj", "--from", "180,0", "--sides", "one"]);
    assert!(
        err.contains("nothing of square is visible: its only face is turned away: --sides two"),
        "{err}"
    );
    let err = notes(path, &["square.obj", "--from", "90,0"]);
    assert!(
        err.contains("nothing of square is visible: it is smaller than a pixel, or seen edge-on"),
        "{err}"
    );
    let err = notes(path, &["square.obj", "--camera", "1", "--scale", "1e9"]);
    assert!(err.contains("nothing of square is visible: outside the view"), "{err}");

    std::fs::write(path.join("two.obj"), format!("{SQUARE}f 2 3 4\n").replace(" 5\n", " 4\n"))
        .unwrap();
    let err = notes(path, &["square.obj", "two.obj", "--from", "180,0", "--sides", "one"]);
    assert!(
        err.contains("square is visible: its only face")
            && err.contains("two is visible: all of its faces"),
        "{err}"
    );
    let err = notes(path, &["square.obj", "two.obj", "--from", "180,0"]);
    assert!(err.contains("nothing of square is visible: it is behind other objects"), "{err}");
    let err = notes(path, &["square.obj", "square.obj", "--from", "180,0", "--sides", "one"]);
    assert!(err.contains("and 1 other object is visible:"), "{err}");

    // In files of other programs, a material that hides the whole model is taken as opaque.
    let mtl = "# exported by Marraztu\nnewmtl clear\nKd 1 1 1\nd 0\n";
    std::fs::write(path.join("clear.mtl"), mtl).unwrap();
    let clear = format!("mtllib clear.mtl\n{}", SQUARE.replace("f 1", "usemtl clear\nf 1"));
    std::fs::write(path.join("clear.obj"), clear).unwrap();
    let err = notes(path, &["clear.obj"]);
    assert!(err.contains("nothing of clear is visible: it is wholly transparent"), "{err}");
}

#[test]
fn a_transparent_part_shows_no_edges_of_opaque_faces_that_are_turned_away() {
    let folder = folder();
    let [left, right] = ["v -3 0 0\nv -1 0 0\nv -2 2 0\n", "v 1 0 0\nv 3 0 0\nv 2 2 0\n"];
    let faces = "usemtl solid\nf 1 3 2\nusemtl glass\nf 4 5 6\n";
    let text = format!("mtllib two.mtl\n{left}{right}{faces}");
    std::fs::write(folder.path().join("two.obj"), text).unwrap();
    let materials = "newmtl solid\nKd 1 0 0\nnewmtl glass\nKd 0 1 0\nd 0.5\n";
    std::fs::write(folder.path().join("two.mtl"), materials).unwrap();
    let picture = drawn(folder.path(), &["two.obj", "--sides", "one", "--edges-over"]);
    let behind = Scene::NEUTRAL.opaque();
    let shown = |columns: std::ops::Range<usize>| {
        let pixels = columns.flat_map(|x| (0..120).map(move |y| (x, y)));
        pixels.filter(|(x, y)| picture.pixel(*x, *y) != behind).count()
    };
    assert_eq!(shown(0..80), 0, "the back of the left triangle");
    assert!(shown(80..160) > 200);
}

#[test]
fn normals_of_the_file_can_be_ignored() {
    let folder = folder();
    let text = SQUARE.replace("f 1 2 3 4", "vn 1 0 1\nf 1//1 2//1 3//1 4//1");
    std::fs::write(folder.path().join("square.obj"), text).unwrap();
    let plain = drawn(folder.path(), &["square.obj"]);
    assert!(drawn(folder.path(), &["square.obj", "--no-file-normals"]) != plain);
}

/// Two squares that meet at an angle of 45 degrees.
const ROOF: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 4 0 -2\nv 4 2 -2\nf 1 2 3 4\nf 2 5 6 3\n";

#[test]
fn edges_sharper_than_the_given_crease_angle_are_sharp() {
    let folder = folder();
    std::fs::write(folder.path().join("roof.obj"), ROOF).unwrap();
    let drawn = |crease: &[&str]| drawn(folder.path(), &[&["roof.obj"], crease].concat());
    let smooth = drawn(&["--crease", "180"]);
    let flat = drawn(&["--crease", "0"]);
    assert!(flat != smooth);
    assert!(drawn(&[]) == smooth, "60 degrees are more than 45");
    assert!(drawn(&["--crease", "46"]) == smooth && drawn(&["--crease", "45"]) == flat);
    assert!(drawn(&["--normals", "face"]) == flat);
    for command in
        [&["info", "--crease", "44.5"][..], &["plan", "--size", "8x8", "--crease", "44.5"]]
    {
        let (out, _) = ends_with(0, folder.path(), &[command, &["roof.obj"]].concat());
        assert_eq!(
            command[0] == "info",
            out.contains("smoothing       crease 44.5 degrees"),
            "{out}"
        );
    }
}

#[test]
fn models_without_a_scene_are_seen_from_the_side_that_is_asked_for() {
    let folder = folder();
    // A square that faces +Z, in a bounding box so deep that the camera is far from its plane.
    let seen = |from: &str| {
        let picture = drawn(
            folder.path(),
            &["square.obj", "--lights", "0", "--sides", "one", "--from", from],
        );
        let behind = picture.pixel(0, 0);
        picture.pixels().iter().filter(|pixel| **pixel != behind).count()
    };
    let front = seen("0,0");
    assert!(front > 1000, "{front}");
    for side in ["60,0", "-60,0", "0,60", "0,-60"] {
        let part = seen(side);
        assert!(part > front / 3 && part < front * 2 / 3, "{side}: {part} of {front}");
    }
    for behind in ["120,0", "180,0", "180,45"] {
        assert_eq!(seen(behind), 0, "{behind}: the square faces away");
    }
    let above = ["render", "--out", "x.png", "--from", "0,91", "square.obj"];
    ends_with(2, folder.path(), &above);
    let (_, err) = ends_with(2, folder.path(), &["render", "--out", "x.png", "--from", "0,9"]);
    assert!(err.contains("only for models without a scene"), "{err}");
}
