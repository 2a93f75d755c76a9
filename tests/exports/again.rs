//! OBJ exports are read again and compared with the original.

use std::collections::BTreeMap;
use std::path::Path;

use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::edit::{framing, items};
use marraztu_core::scene::{
    FileMaterial, LoadOptions, MaterialChoice, Model, Object, PartNames, PresetId,
};
use marraztu_io::{self as io, ExportOptions, Loaded, Progress, Sources};
use marraztu_render::{Renderer, plan_frame};

use super::{put, put_picture, runs};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

fn load(folder: &Path, name: &str) -> Loaded {
    io::load(&folder.join(name), &LoadOptions::default(), &Progress::new()).unwrap()
}

/// Draws a model alone under the first scene's lights, framed.
fn picture(model: Model) -> Picture {
    let (mut scene, view) = io::default_scene();
    let ids: Vec<_> = scene.objects.ids().collect();
    for id in ids {
        let remove =
            marraztu_core::scene::Command::Remove(marraztu_core::scene::ItemId::Object(id));
        remove.apply(&mut scene).unwrap();
    }
    let object = Object::new(Shared::new(model), MaterialChoice::File);
    items::insert_object(&scene, object).apply(&mut scene).unwrap();
    framing::all(&scene, &view).unwrap().apply(&mut scene).unwrap();
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(96, 96));
    Renderer::default().render(&plan_frame(&shot)).clone()
}

/// Names of object, group and material per polygon.
fn called(model: &Model) -> Vec<&PartNames> {
    model.mesh.polygon_parts().iter().map(|part| model.mesh.part_names(*part)).collect()
}

/// Checks that a file with materials keeps names, numbers and picture through export and import.
#[track_caller]
fn comes_back(folder: &Path, obj: &str, mtl: &str) {
    put(folder, &[("a.obj", obj), ("a.mtl", mtl)]);
    // An export does not replace the files of an earlier row.
    for left in ["b.obj", "b.mtl", "b-texture-1.png", "b-texture-2.png"] {
        let _absent = std::fs::remove_file(folder.join(left));
    }
    runs(folder, &["export", "a.obj", "--out", "b.obj"]);
    let text = std::fs::read_to_string(folder.join("b.obj")).unwrap();
    let [a, b] = ["a.obj", "b.obj"].map(|name| load(folder, name).model);
    assert_eq!(called(&a), called(&b), "{obj}\n{text}");
    let names = |model: &Model| -> Vec<String> {
        model.mesh.parts().iter().map(|part| part.name.clone()).collect()
    };
    assert_eq!(names(&a), names(&b), "{obj}\n{text}");
    let numbers =
        |FileMaterial { name, material, opacity, unlit, undrawn, maps, .. }: &FileMaterial| {
            let maps: Vec<_> = maps.iter().map(|(kind, map)| (*kind, map.gain)).collect();
            (name.clone(), (*material, *opacity, *unlit, undrawn.clone(), maps))
        };
    let materials =
        |model: &Model| -> BTreeMap<_, _> { model.materials.iter().map(numbers).collect() };
    let (before, after) = (materials(&a), materials(&b));
    for (name, numbers) in &before {
        assert_eq!(after.get(name), Some(numbers), "{name}: {obj}\n{text}");
    }
    assert!(picture(a) == picture(b), "{obj}\n{text}");
}

#[test]
fn objects_groups_and_materials_come_back_under_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let mtl = "newmtl Paint Red\nKd 1 0 0\nKs 0 0 0\nnewmtl Material #25\nKd 1 0 0\nKs 0 0 0\n\
               newmtl unused\nKd 0 0 1\nNi 1.5\nnewmtl \u{5c71}\nKd 0 1 0\nnewmtl\nKd .5 .5 0\n";
    let rows = [
        "f 1 2 3\nf 1 3 4\n",
        "usemtl Paint Red\nf 1 2 3\nusemtl Material #25\nf 1 3 4\n",
        "f 1 2 3\nusemtl \u{5c71}\nf 1 3 4\n",
        "usemtl missing\nf 1 2 3\nusemtl\nf 1 3 4\n",
        "g\nf 1 2 3\no\nf 1 3 4\n",
        "g two groups\nf 1 2 3\ng #2\nf 1 3 4\n",
        "o Body\nf 1 2 3\ng left  door\nusemtl Paint Red\nf 1 3 4\no Body\nf 2 3 4\n",
        "o Body\ng g\nf 1 2 3\no Wheels\ng g\nf 1 3 4\no Body\ng g\nf 2 3 4\n",
        "f 1 2 3\no a\nf 1 3 4\no part 1\nf 2 3 4\n",
        "o only\nf 1 2 3\nf 1 3 4\n",
    ];
    for faces in rows {
        comes_back(folder.path(), &format!("mtllib a.mtl\n{SQUARE}{faces}"), mtl);
    }
}

#[test]
fn numbers_and_maps_of_materials_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let faces = "usemtl m\nf 1/1 2/2 3/3 4/4\n";
    put_picture(folder.path(), "t.png", 4, |x, y| {
        [128, u8::try_from(x * 60).unwrap(), u8::try_from(y * 60).unwrap(), 255]
    });
    put_picture(folder.path(), "n.png", 4, |x, y| {
        let tilt = |i: usize| u8::try_from(128 + 20 * (i % 2)).unwrap();
        [tilt(x), tilt(y), 250, 255]
    });
    let rows = [
        "Kd .5 .25 1\nKs .5 .5 .5\nNs 40\nNi 1.45\nTf 1 .5 .25\nPr .25\nPm .5\nPs .1\nPc .2\n\
         Pcr .3\naniso .4\nanisor .5\nillum 7\nd .75",
        "Kd .5 .25 1\nKs 0 0 0\nillum 0\nmap_Kd t.png",
        "Kd 1 1 1\nKs 1 1 1\nNs 9\nmap_Kd -o .25 .5 0 -s 2 3 1 t.png\nmap_Ks -clamp on t.png\n\
         bump -bm 2 t.png\nmap_d n.png\nmap_Ke t.png",
        "Kd 1 1 1\nKs 1 1 1\nNs 9\nnorm n.png",
        "Kd 1 1 1\nKs 1 1 1\nNs 9\nbump t.png\nnorm n.png",
        "Kd .5 .25 1\nKs 0 0 0\nKe 0 0 0\nmap_Ke t.png",
        "bsdf pbr\nKd .5 .25 1\nKs 0 .5 1",
    ];
    for statements in rows {
        let obj = format!("mtllib a.mtl\n{SQUARE}{faces}");
        comes_back(folder.path(), &obj, &format!("newmtl m\nKa 0 0 0\n{statements}\n"));
    }
    // Programs that do not know `norm` read `map_Bump`.
    put(folder.path(), &[("a.mtl", "newmtl m\nKd 1 1 1\nnorm n.png\n")]);
    runs(folder.path(), &["export", "a.obj", "--out", "c.obj"]);
    let mtl = std::fs::read_to_string(folder.path().join("c.mtl")).unwrap();
    let of = |statement: &str| {
        let line = mtl.lines().find(|line| line.starts_with(statement));
        line.and_then(|line| line.split(' ').next_back()).map(str::to_owned)
    };
    assert_eq!(of("norm "), Some("c-texture-1.png".to_owned()), "{mtl}");
    assert_eq!(of("norm "), of("map_Bump "), "{mtl}");
}

#[test]
fn duplicate_names_in_a_scene_are_made_unique() {
    let folder = tempfile::tempdir().unwrap();
    let obj =
        format!("mtllib a.mtl\n{SQUARE}o Body\ng door\nusemtl p\nf 1 2 3\no Wheel\nf 1 3 4\n");
    put(folder.path(), &[("a.obj", &obj), ("a.mtl", "newmtl p\nKd 1 0 0\nKs 0 0 0\n")]);
    let blue = "newmtl p\nKd 0 0 1\nKs 0 0 0\n";
    put(folder.path(), &[("b.obj", &obj.replace("a.mtl", "b.mtl")), ("b.mtl", blue)]);
    runs(folder.path(), &["export", "a.obj", "b.obj", "--out", "c.obj"]);
    let model = load(folder.path(), "c.obj").model;
    let objects: Vec<_> = called(&model).iter().filter_map(|it| it.object.as_deref()).collect();
    assert_eq!(objects, ["Body", "Wheel", "Body.001", "Wheel.001"]);
    let groups: Vec<_> = called(&model).iter().map(|it| it.group.as_deref()).collect();
    assert_eq!(groups, [Some("door"), None, Some("door.001"), None]);
    let materials: Vec<_> = model.materials.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(materials, ["p", "p.001"]);
}

#[test]
fn presets_are_called_by_their_names_and_objects_as_the_user_calls_them() {
    let folder = tempfile::tempdir().unwrap();
    let (mut scene, view) = io::default_scene();
    let gold = MaterialChoice::Preset(PresetId::named("gold").unwrap());
    let ids: Vec<_> = scene.objects.ids().collect();
    for (id, name) in ids.iter().zip(["one # two\nthree", "same", "same"]) {
        let mut object = scene.objects.get(*id).unwrap().clone();
        (object.name, object.material) = (name.to_owned(), gold.clone());
        let item = marraztu_core::scene::Item::Object(*id, Box::new(object));
        marraztu_core::scene::Command::Replace(item).apply(&mut scene).unwrap();
    }
    let path = folder.path().join("first.obj");
    io::export(&path, &scene, &view, ExportOptions::SCENE, &Sources::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let named = |statement: &str| -> Vec<String> {
        text.lines().filter_map(|line| line.strip_prefix(statement)).map(str::to_owned).collect()
    };
    assert_eq!(named("o "), ["one _ two three", "same", "same.001"]);
    assert_eq!(named("usemtl "), ["gold"]);
}

#[test]
fn other_line_ends_and_a_byte_order_mark_do_not_make_an_export_foreign() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    put_picture(folder.path(), "t.png", 2, |x, y| [u8::from(x > y) * 255, 9, 9, 255]);
    let obj = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1/1 2/2 3/3 4/4\n");
    put(folder.path(), &[("a.obj", &obj), ("a.mtl", "newmtl m\nmap_Kd t.png\n")]);
    runs(folder.path(), &["export", "a.obj", "--out", "b.obj"]);
    // Ka and Ns of other programs are repaired.
    let own = "# exported by Marraztu\nnewmtl m\nKa 1 1 1\nKd .5 .5 .5\nKs .4 .4 .4\nNs 0.5\n\
               map_Kd b-texture-1.png\n";
    for (mark, end) in [("", "\n"), ("", "\r\n"), ("", "\r"), ("\u{feff}", "\r\n")] {
        std::fs::write(path("b.mtl"), mark.to_owned() + &own.replace('\n', end)).unwrap();
        let Loaded { model, findings } = load(folder.path(), "b.obj");
        assert_eq!(findings, [], "{mark:?} {end:?}");
        let material = model.materials[0].material;
        assert_eq!((material.ambient, material.exponent), ([1.0; 3], 0.5));
        // A texture without a mark is ours if our MTL file names it.
        std::fs::copy(path("t.png"), path("b-texture-1.png")).unwrap();
        runs(folder.path(), &["export", "a.obj", "--out", "b.obj"]);
    }
}
