//! Other output than pictures of scenes: turntables, transparent pictures, exports.
//!
//! Catches: a first frame that differs from the picture, a file left behind by a failure, an export
//! that other readers reject, positions that lose bits.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::path::Path;
use std::process::{Command as Process, Output};

use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::edit::items;
use marraztu_core::edit::turntable::{Turn, turned};
use marraztu_core::scene::{
    Command, LoadOptions, MaterialChoice, Mesh, Object, PolygonMode, Scene, Sides, View,
};
use marraztu_io::{self as io, ExportOptions, Progress, Sources};
use marraztu_render::{Renderer, plan_frame, without_ground};
use serde_json::Value;

const SIZE: Size = Size::new(160, 120);

fn drawn(scene: &Scene, view: &View) -> Picture {
    let shot = Shot::new(scene, view, &Settings::default(), SIZE);
    Renderer::default().render(&plan_frame(&shot)).clone()
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_marraztu");
    Process::new(program).current_dir(folder).args(arguments).output().unwrap()
}

#[track_caller]
fn runs(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}\n{told}");
    told
}

#[test]
fn a_whole_turn_comes_back_and_the_first_picture_is_the_picture() {
    let (scene, view) = io::default_scene();
    for turn in [Turn::Objects, Turn::Camera] {
        let at = |part| turned(&scene, &view, turn, part).unwrap();
        assert_eq!(at(0.0), scene);
        assert_eq!(at(1.0), scene);
        assert!(drawn(&at(0.25), &view) != drawn(&scene, &view), "{turn:?}");
        // Two half turns are a full turn, apart from rounding.
        let half = turned(&at(0.5), &view, turn, 0.5).unwrap();
        for ((_, a), (_, b)) in half.objects.iter().zip(scene.objects.iter()) {
            assert!(a.placement.now().abs_diff_eq(*b.placement.now(), 1e-9));
        }
    }
}

#[test]
fn objects_that_are_not_drawn_do_not_move_the_axis_of_a_turntable() {
    let (scene, view) = io::default_scene();
    let id = view.object.unwrap();
    let centre = |scene: &Scene| scene.objects.get(id).unwrap().bounding_sphere(0.0).unwrap().0;
    let alone = View { only_selected: true, ..view.clone() };
    let polygons = View { polygons: Some(PolygonMode::begin()), ..view.clone() };
    for (view, stays) in [(alone, true), (polygons, true), (view, false)] {
        let turned = turned(&scene, &view, Turn::Objects, 0.25).unwrap();
        let by = centre(&turned) - centre(&scene);
        assert_eq!(by.length() < 1e-9, stays, "{by}");
    }
}

#[test]
fn a_turntable_is_a_gif_an_animated_png_or_a_folder_of_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let turn = ["turntable", "--size", "40x30", "--frames", "3", "--out"];
    for name in ["turn.gif", "turn.png", "frames"] {
        runs(folder.path(), &[&turn[..], &[name]].concat());
    }
    runs(folder.path(), &["render", "--size", "40x30", "--out", "still.png"]);
    let still = io::load_picture(&path("still.png")).unwrap();
    assert!(io::load_picture(&path("frames/frame-001.png")).unwrap() == still);
    assert!(io::load_picture(&path("frames/frame-002.png")).unwrap() != still);
    assert!(io::load_picture(&path("turn.png")).unwrap() == still, "its first picture");
    assert!(std::fs::read(path("turn.gif")).unwrap().starts_with(b"GIF89a"));
    for wrong in [&["turntable", "--out", "a.mp4"][..], &["turntable", "--frames", "0"]] {
        assert_eq!(run(folder.path(), wrong).status.code(), Some(2), "{wrong:?}");
    }
    std::fs::write(path("poem.gif"), "Roses are red").unwrap();
    let refused = run(folder.path(), &[&turn[..], &["poem.gif"]].concat());
    assert_eq!(refused.status.code(), Some(1));
    assert_eq!(std::fs::read(path("poem.gif")).unwrap(), b"Roses are red");
}

#[test]
fn laid_over_its_own_ground_a_picture_without_is_the_one_with() {
    let (scene, view) = io::default_scene();
    let settings = Settings { samples: Samples::Sixteen, ..Settings::default() };
    let shot = Shot::new(&scene, &view, &settings, SIZE);
    let mut renderer = Renderer::default();
    let whole = renderer.render(&plan_frame(&shot)).clone();
    let cut = without_ground(&mut renderer, &shot);
    for (pixel, expected) in cut.pixels().iter().zip(whole.pixels()) {
        let share = f64::from(pixel[3]) / 255.0;
        for i in 0..3 {
            let ground = f64::from(scene.background.0[i]);
            let over = share * f64::from(pixel[i]) + (1.0 - share) * ground;
            assert!((over - f64::from(expected[i])).abs() <= 2.0, "{pixel:?} {expected:?}");
        }
    }
    assert!(cut.pixels().iter().any(|pixel| (1..255).contains(&pixel[3])), "edges");
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "--transparent", "--size", "160x120", "--samples", "16", "--out"];
    runs(folder.path(), &[&arguments[..], &["cut.png"]].concat());
    assert!(io::load_picture(&folder.path().join("cut.png")).unwrap() == cut);
}

/// The first scene without the spot of the selected object.
fn scene() -> (Scene, View) {
    let (mut scene, view) = io::default_scene();
    let spot = scene.lights.iter().find(|(_, light)| light.slot == 3).map(|(id, _)| id).unwrap();
    let id = marraztu_core::scene::ItemId::Light(spot);
    items::toggle_shown(&scene, id).unwrap().apply(&mut scene).unwrap();
    (scene, view)
}

/// The number of pixels that differ by more than 3 steps.
fn apart(a: &Picture, b: &Picture) -> usize {
    let differs = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).any(|i| a[i].abs_diff(b[i]) > 3);
    a.pixels().iter().zip(b.pixels()).filter(|pair| differs(*pair)).count()
}

#[test]
fn an_exported_obj_is_read_back_as_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("first.obj");
    let (before, view) = scene();
    let exported =
        io::export(&path, &before, &view, ExportOptions::SCENE, &Sources::default()).unwrap();
    assert_eq!(exported.files.last().unwrap(), &path);
    let loaded = io::load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
    assert_eq!(loaded.findings, [], "nothing had to be mended");
    let polygons = |mesh: &Mesh| mesh.polygon_count();
    let all: usize = before.objects.iter().map(|(_, it)| polygons(&it.model.mesh)).sum();
    assert_eq!(polygons(&loaded.model.mesh), all);
    let mut after = before.clone();
    let ids: Vec<_> = after.objects.ids().collect();
    for id in ids {
        Command::Remove(marraztu_core::scene::ItemId::Object(id)).apply(&mut after).unwrap();
    }
    let object = Object::new(Shared::new(loaded.model), MaterialChoice::File);
    let object = Object { sides: Sides::One, ..object };
    items::insert_object(&after, object).apply(&mut after).unwrap();
    let view = View { marks: false, ..view };
    let (one, other) = (drawn(&before, &view), drawn(&after, &view));
    assert!(apart(&one, &other) < 40, "{} pixels", apart(&one, &other));
}

#[test]
fn positions_of_unmoved_objects_keep_every_bit_in_obj() {
    let folder = tempfile::tempdir().unwrap();
    let odd = folder.path().join("odd.obj");
    std::fs::write(&odd, "v 0.1 1e-7 -3.4028e38\nv 1 0 0\nv 0.333333343 1 0\nf 1 2 3\n").unwrap();
    runs(folder.path(), &["export", "odd.obj", "--out", "again.obj", "--quiet"]);
    let load = |name: &str| {
        let path = folder.path().join(name);
        io::load(&path, &LoadOptions::default(), &Progress::new()).unwrap().model
    };
    assert_eq!(load("again.obj").mesh.positions(), load("odd.obj").mesh.positions());
    let replaced = run(folder.path(), &["export", "odd.obj", "--out", "odd.obj"]);
    assert_eq!(replaced.status.code(), Some(1), "what is read is not replaced");
}

/// Reads the JSON and the buffer of a glTF file.
fn gltf(path: &Path) -> (Value, Vec<u8>) {
    let bytes = std::fs::read(path).unwrap();
    if path.extension().unwrap() == "gltf" {
        let json: Value = serde_json::from_slice(&bytes).unwrap();
        let buffer = json["buffers"][0]["uri"].as_str().unwrap();
        return (json.clone(), std::fs::read(path.with_file_name(buffer)).unwrap());
    }
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
    let text = number(12);
    assert_eq!((&bytes[16..20], text % 4), (&b"JSON"[..], 0));
    let buffer = number(20 + text);
    assert_eq!((&bytes[24 + text..28 + text], buffer % 4), (&b"BIN\0"[..], 0));
    assert_eq!(28 + text + buffer, bytes.len());
    (serde_json::from_slice(&bytes[20..20 + text]).unwrap(), bytes[28 + text..].to_vec())
}

fn whole(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

/// Reads the numbers of an accessor, and checks its bounds.
fn numbers(json: &Value, buffer: &[u8], accessor: &Value) -> Vec<Vec<u32>> {
    let accessor = &json["accessors"][whole(accessor)];
    let view = &json["bufferViews"][whole(&accessor["bufferView"])];
    let width = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        other => panic!("{other}"),
    };
    let (start, length) = (whole(&view["byteOffset"]), whole(&view["byteLength"]));
    let count = whole(&accessor["count"]);
    assert!(count > 0 && count * width * 4 == length, "as long as it says");
    assert!(start.is_multiple_of(4) && start + length <= buffer.len(), "within the buffer");
    let words: Vec<u32> = buffer[start..start + length]
        .chunks(4)
        .map(|bytes| u32::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    words.chunks(width).map(<[u32]>::to_vec).collect()
}

#[test]
fn an_exported_gltf_is_sound_and_has_every_position_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, view) = scene();
    for name in ["first scene.gltf", "first.glb"] {
        let path = folder.path().join(name);
        let exported =
            io::export(&path, &scene, &view, ExportOptions::SCENE, &Sources::default()).unwrap();
        assert!(exported.notes.iter().any(|note| note.contains("ambient lights")));
        // The URI of the buffer is escaped; the file has the plain name.
        let (json, buffer) = if name.ends_with("gltf") {
            let bytes = std::fs::read(&path).unwrap();
            let json: Value = serde_json::from_slice(&bytes).unwrap();
            assert_eq!(json["buffers"][0]["uri"], "first%20scene.bin");
            (json, std::fs::read(folder.path().join("first scene.bin")).unwrap())
        } else {
            gltf(&path)
        };
        assert_eq!(json["asset"]["version"], "2.0");
        assert_eq!(whole(&json["buffers"][0]["byteLength"]), buffer.len());
        let objects: Vec<&Object> = scene.objects.iter().map(|(_, object)| object).collect();
        let roots = json["scenes"][0]["nodes"].as_array().unwrap();
        let nodes: Vec<&Value> = roots.iter().map(|root| &json["nodes"][whole(root)]).collect();
        assert_eq!(nodes.len(), objects.len() + 1 + 3, "objects, a camera, sun, bulb and a spot");
        assert_eq!(json["cameras"].as_array().unwrap().len(), 1);
        let lights = &json["extensions"]["KHR_lights_punctual"]["lights"];
        let kinds: Vec<&str> =
            lights.as_array().unwrap().iter().map(|it| it["type"].as_str().unwrap()).collect();
        assert_eq!(kinds, ["directional", "point", "spot"]);
        assert_eq!(json["extensionsUsed"], serde_json::json!(["KHR_lights_punctual"]));
        for (node, object) in nodes.into_iter().zip(objects) {
            assert_eq!(node["name"], object.name.as_str());
            holds_object(&json, &buffer, node, object);
        }
    }
}

/// The primitives of a node and its descendants, which must not have transforms.
fn primitives<'a>(json: &'a Value, node: &'a Value) -> Vec<&'a Value> {
    let own = node.get("mesh").map(|mesh| &json["meshes"][whole(mesh)]["primitives"]);
    let children = node["children"].as_array().into_iter().flatten();
    let below = children.flat_map(|child| {
        let child = &json["nodes"][whole(child)];
        assert!(child["matrix"].is_null());
        primitives(json, child)
    });
    own.into_iter().flat_map(|own| own.as_array().unwrap()).chain(below).collect()
}

/// Checks that a node is valid, and that its meshes have the positions and triangles of an object.
fn holds_object(json: &Value, buffer: &[u8], node: &Value, object: &Object) {
    let mesh = &object.model.mesh;
    let placement = object.placement.now().to_cols_array();
    for (told, expected) in node["matrix"].as_array().unwrap().iter().zip(placement) {
        assert!((told.as_f64().unwrap() - expected).abs() < 1e-4);
    }
    let mut found = std::collections::BTreeSet::new();
    let mut triangles = 0;
    // Every primitive is valid: indices in range, exact bounds, normals of length 1.
    for primitive in primitives(json, node) {
        assert!(whole(&primitive["material"]) < json["materials"].as_array().unwrap().len());
        let attributes = &primitive["attributes"];
        let positions = numbers(json, buffer, &attributes["POSITION"]);
        let normals = numbers(json, buffer, &attributes["NORMAL"]);
        assert_eq!(positions.len(), normals.len());
        let indices = numbers(json, buffer, &primitive["indices"]);
        assert!(indices.len().is_multiple_of(3));
        assert!(indices.iter().all(|index| (index[0] as usize) < positions.len()));
        triangles += indices.len() / 3;
        let told = &json["accessors"][whole(&attributes["POSITION"])];
        for i in 0..3 {
            let along = || positions.iter().map(|position| f32::from_bits(position[i]));
            let (min, max) = (along().reduce(f32::min), along().reduce(f32::max));
            let single = |number: &Value| number.to_string().parse::<f32>().ok();
            assert_eq!([single(&told["min"][i]), single(&told["max"][i])], [min, max]);
        }
        for normal in normals {
            let square: f32 = normal.iter().map(|x| f32::from_bits(*x).powi(2)).sum();
            assert!((square - 1.0).abs() < 1e-4);
        }
        found.extend(positions);
    }
    // Together they have all triangles, and every used position bit for bit.
    assert_eq!(triangles, mesh.triangle_count());
    let used = (0..).take(mesh.polygon_count()).flat_map(|polygon| mesh.polygon(polygon));
    let bits = |corner: &marraztu_core::scene::Corner| {
        mesh.positions()[corner.position as usize].map(f32::to_bits).to_vec()
    };
    assert_eq!(found, used.map(bits).collect());
}
