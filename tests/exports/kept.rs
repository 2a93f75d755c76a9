//! Parts of a model that an export keeps: the bytes of textures, and maps that are not drawn.

use std::path::Path;

use serde_json::{Value, json};

use super::{grey, image, image_bytes, json as read, put, put_picture, run, runs};
use ::image::codecs::jpeg::JpegEncoder;
use ::image::{DynamicImage, ExtendedColorType, RgbImage};

const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                      vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

/// Writes a square with two materials, `m` with these statements and `n` with others.
fn model(folder: &Path, m: &str, n: &str) {
    let faces = "usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 3/3 4/4\n";
    let mtl = format!("newmtl m\nKd 1 1 1\n{m}\nnewmtl n\nKd 1 1 1\n{n}\n");
    put(folder, &[("a.obj", &format!("{SQUARE}{faces}")), ("a.mtl", &mtl)]);
}

fn gltf(folder: &Path) -> Value {
    runs(folder, &["export", "a.obj", "--out", "b.gltf"]);
    read(&folder.join("b.gltf"))
}

/// Exports as OBJ, and returns the lines of the MTL file that begin with a keyword.
fn lines(folder: &Path, keyword: &str) -> Vec<String> {
    let mtl = std::fs::read_to_string(folder.join("b.mtl")).unwrap();
    mtl.lines().filter(|line| line.starts_with(keyword)).map(str::to_owned).collect()
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

fn noise() -> RgbImage {
    RgbImage::from_fn(32, 32, |x, y| {
        ::image::Rgb([x * 37 + y * 91, x * y, x].map(|n| n.to_le_bytes()[0]))
    })
}

/// Writes a JPEG of noise, in colours or grey.
fn put_jpeg(folder: &Path, name: &str, is_grey: bool) {
    let mut jpeg = Vec::new();
    let picture = DynamicImage::from(noise());
    let (texels, kind) = match is_grey {
        true => (picture.into_luma8().into_raw(), ExtendedColorType::L8),
        false => (picture.into_bytes(), ExtendedColorType::Rgb8),
    };
    JpegEncoder::new(&mut jpeg).encode(&texels, 32, 32, kind).unwrap();
    std::fs::write(folder.join(name), jpeg).unwrap();
}

#[test]
fn jpeg_and_png_textures_keep_their_bytes_whatever_their_names_end_in() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_jpeg(folder, "photo.jpg", false);
    put_jpeg(folder, "grey.jpeg", true);
    put_jpeg(folder, "jpeg.png", false);
    put_picture(folder, "soft.png", 8, |x, _| [9, 9, 9, u8::try_from(x * 30).unwrap()]);
    std::fs::copy(folder.join("soft.png"), folder.join("png.JPG")).unwrap();
    let deep = ::image::ImageBuffer::from_fn(8, 8, |x, y| {
        ::image::Rgb([x, y, 7].map(|n| u16::try_from(n * 5000).unwrap()))
    });
    DynamicImage::ImageRgb16(deep).save(folder.join("deep.png")).unwrap();
    let rows = [
        ("photo.jpg", "jpg"),
        ("grey.jpeg", "jpg"),
        ("jpeg.png", "jpg"),
        ("soft.png", "png"),
        ("png.JPG", "png"),
        ("deep.png", "png"),
    ];
    for (name, ending) in rows {
        let statement = format!("map_Kd -clamp on -o .5 0 0 -s 2 2 1 {name}");
        model(folder, &statement, &format!("Kd .5 .5 .5\nmap_Kd {name}"));
        let gltf = gltf(folder);
        assert_eq!(gltf["images"].as_array().unwrap().len(), 1, "{name}: both materials share it");
        let kind = if ending == "jpg" { "image/jpeg" } else { "image/png" };
        assert_eq!(gltf["images"][0]["mimeType"], kind, "{name}");
        let kept = image_bytes(&folder.join("b.gltf"), &gltf, 0);
        assert!(kept == bytes(folder, name), "{name}");
        runs(folder, &["export", "a.obj", "--out", "b.obj"]);
        let copy = format!("b-texture-1.{ending}");
        assert_eq!(
            lines(folder, "map_Kd"),
            [format!("map_Kd -clamp on -o 0.5 0 0 -s 2 2 1 {copy}"), format!("map_Kd {copy}")]
        );
        assert!(bytes(folder, &copy) == bytes(folder, name), "{name}");
        assert!(!folder.join("b-texture-2.png").exists());
    }
    // A second export may replace the copies, even without the files that name them.
    for lost in ["b.obj", "b.mtl"] {
        std::fs::remove_file(folder.join(lost)).unwrap();
    }
    runs(folder, &["export", "a.obj", "--out", "b.obj"]);
}

#[test]
fn a_copied_texture_does_not_replace_the_file_of_somebody_else() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_jpeg(folder, "photo.jpg", false);
    model(folder, "map_Kd photo.jpg", "");
    put_jpeg(folder, "b-texture-1.jpg", true);
    let theirs = bytes(folder, "b-texture-1.jpg");
    let output = run(folder, &["export", "a.obj", "--out", "b.obj"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(bytes(folder, "b-texture-1.jpg") == theirs && !folder.join("b.mtl").exists());
}

#[test]
fn textures_of_one_name_in_two_folders_stay_apart_and_equal_ones_are_shared() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("in")).unwrap();
    put_jpeg(folder, "t.jpg", false);
    put_jpeg(folder, "in/t.jpg", true);
    model(folder, "map_Kd t.jpg", "map_Kd in/t.jpg");
    // Another model reads one of them again.
    let obj = format!("{}usemtl c\nf 1/1 2/2 3/3\n", SQUARE.replace("a.mtl", "c.mtl"));
    put(folder, &[("c.obj", &obj), ("c.mtl", "newmtl c\nKd 1 1 1\nmap_Kd in/t.jpg\n")]);
    runs(folder, &["export", "a.obj", "c.obj", "--out", "b.obj"]);
    let mut copies = lines(folder, "map_Kd");
    copies.sort();
    let copy = |number: u32| format!("map_Kd b-texture-{number}.jpg");
    let shared = copies.iter().filter(|line| **line == copy(1) || **line == copy(2)).count();
    assert_eq!((copies.len(), shared), (3, 3), "{copies:?}");
    assert!(bytes(folder, "b-texture-1.jpg") != bytes(folder, "b-texture-2.jpg"));
}

#[test]
fn a_texture_that_is_merged_or_whose_file_is_gone_is_encoded() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_jpeg(folder, "photo.jpg", false);
    put_jpeg(folder, "holes.jpg", true);
    model(folder, "map_Kd photo.jpg\nmap_d holes.jpg", "");
    let gltf = gltf(folder);
    assert_eq!(gltf["images"][0]["mimeType"], "image/png");
    let merged = image(&folder.join("b.gltf"), &gltf, 0);
    let map = marraztu_io::load_picture(&folder.join("holes.jpg")).unwrap();
    assert_eq!(merged.pixel(3, 5)[3], map.pixel(3, 5)[0]);
    // A truncated JPEG is shown as far as it goes; not every program does that.
    let whole = bytes(folder, "photo.jpg");
    std::fs::write(folder.join("photo.jpg"), &whole[..whole.len() * 3 / 4]).unwrap();
    model(folder, "map_Kd photo.jpg", "");
    runs(folder, &["export", "a.obj", "--out", "b.obj"]);
    assert_eq!(lines(folder, "map_Kd"), ["map_Kd b-texture-1.png"]);
}

/// Returns the roughness and the metalness at a texel, and the factors.
fn rough_metal(folder: &Path, gltf: &Value, x: usize, y: usize) -> ([u8; 2], Value) {
    let surface = &gltf["materials"][0]["pbrMetallicRoughness"];
    let number = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let texture = number(&surface["metallicRoughnessTexture"]["index"]);
    let picture = number(&gltf["textures"][texture]["source"]);
    let [_, g, b, _] = image(&folder.join("b.gltf"), gltf, picture).pixel(x, y);
    // Factors of 1 are the default.
    let factor = |name: &str| surface.get(name).cloned().unwrap_or(json!(1.0));
    ([g, b], json!([factor("roughnessFactor"), factor("metallicFactor")]))
}

#[test]
fn maps_of_roughness_and_metalness_are_one_texture_of_gltf() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let byte = |n: usize| u8::try_from(n).unwrap();
    put_picture(folder, "rough.png", 8, |x, _| grey(byte(x * 30)));
    put_picture(folder, "metal.png", 8, |_, y| grey(byte(y / 2 * 60)));
    put_picture(folder, "packed.png", 8, |x, y| [7, byte(x * 20), byte(y * 10), 255]);
    let at = |statements: &str, x, y| {
        model(folder, statements, "");
        rough_metal(folder, &gltf(folder), x, y)
    };
    let ([rough, metal], factors) = at("map_Pr rough.png\nmap_Pm -s 1 1 1 metal.png", 5, 0);
    assert_eq!((rough, metal, factors), (150, 0, json!([1.0, 1.0])));
    let (texel, factors) = at("Pr .5\nPm .25\nmap_Pr rough.png\nMAP_PM metal.png", 5, 7);
    assert_eq!((texel, factors), ([150, 180], json!([0.5, 0.25])));
    // A factor of 0 would hide a map.
    assert_eq!(at("Pr 0\nPm 0\nmap_Pr rough.png\nmap_Pm metal.png", 1, 0).1, json!([1.0, 1.0]));
    assert_eq!(at("map_Pr rough.png", 5, 0), ([150, 150], json!([1.0, 0.0])));
    assert_eq!(at("Pm 1\nmap_Pr rough.png", 5, 0), ([150, 255], json!([1.0, 1.0])));
    assert_eq!(at("Pr .5\nmap_Pm metal.png", 0, 3), ([255, 60], json!([0.5, 1.0])));
    // Channels, stated or as glTF packs them.
    let channels = "map_Pr -imfchan g packed.png\nmap_Pm -imfchan b packed.png";
    assert_eq!(at(channels, 6, 3).0, [120, 30]);
    assert_eq!(at("map_Pr packed.png\nmap_Pm packed.png", 6, 3).0, [120, 30]);
    assert_eq!(at("bsdf pbr\nKs 1 1 1\nmap_Ks packed.png", 6, 3).0, [120, 30]);
    assert_eq!(at("map_Pr -imfchan r packed.png\nPm 1", 6, 3).0, [7, 255]);
    // An exponent map multiplies Ns: roughness is (2 / (4 n + 2))^(1/4).
    let ([rough, _], factors) = at("Ks 1 1 1\nNs 100\nmap_Ns rough.png", 4, 0);
    let expected = libm::pow(2.0 / (4.0 * 100.0 * 120.0 / 255.0 + 2.0), 0.25) * 255.0;
    assert!((f64::from(rough) - expected).abs() < 1.0, "{rough} instead of {expected}");
    assert_eq!(factors, json!([1.0, 0.0]));
    assert_eq!(at("Ns 100\nmap_Ns metal.png\nmap_Pr rough.png", 5, 0).0[0], 150);
}

#[test]
fn a_picture_in_the_layout_of_gltf_keeps_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_jpeg(folder, "orm.jpg", false);
    put_jpeg(folder, "rough.jpg", true);
    for (statements, name) in
        [("map_Pr orm.jpg\nmap_Pm orm.jpg", "orm.jpg"), ("map_Pr rough.jpg", "rough.jpg")]
    {
        model(folder, statements, statements);
        let gltf = gltf(folder);
        assert_eq!(gltf["images"].as_array().unwrap().len(), 1, "{name}");
        let kept = image_bytes(&folder.join("b.gltf"), &gltf, 0);
        assert!(kept == bytes(folder, name), "{name}");
    }
}

#[test]
fn maps_that_are_not_drawn_come_back_in_mtl_with_copies_of_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("in")).unwrap();
    put_picture(folder, "t.png", 4, |x, _| grey(u8::try_from(x * 30).unwrap()));
    put_jpeg(folder, "in/a b.jpg", false);
    std::fs::write(folder.join("h.hdr"), "#?RADIANCE\nrest").unwrap();
    std::fs::write(folder.join("secret.png"), "not a picture").unwrap();
    let maps = "map_Kd t.png\nmap_Pr t.png\nrefl -type sphere -mm 0 1 t.png\n\
                refl -type cube_top in\\a b.jpg\ndisp h.hdr\nmap_Ps -s 2 2 1 in/a b.jpg\n\
                decal secret.png\nmap_Pm gone.png";
    model(folder, maps, "");
    let notes = runs(folder, &["export", "a.obj", "--out", "b.obj"]);
    let expected = [
        ("map_Pr", "map_Pr b-texture-1.png"),
        ("refl -type s", "refl -type sphere -mm 0 1 b-texture-1.png"),
        ("refl -type c", "refl -type cube_top b-texture-2.jpg"),
        ("disp", "disp b-texture-3.hdr"),
        ("map_Ps", "map_Ps -s 2 2 1 b-texture-2.jpg"),
    ];
    for (keyword, line) in expected {
        assert_eq!(lines(folder, keyword), [line], "{notes}");
    }
    assert!(lines(folder, "decal").is_empty() && lines(folder, "map_Pm").is_empty());
    assert!(notes.contains("decal secret.png is left out: this is not a picture"), "{notes}");
    assert!(notes.contains("map_Pm gone.png is left out: there is no such file"), "{notes}");
    for (copy, name) in [("b-texture-2.jpg", "in/a b.jpg"), ("b-texture-3.hdr", "h.hdr")] {
        assert!(bytes(folder, copy) == bytes(folder, name), "{name}");
    }
    let notes = runs(folder, &["export", "a.obj", "--out", "b.glb"]);
    assert!(notes.contains("glTF has no maps like decal, disp, map_Ps, refl: left out"), "{notes}");
    assert!(notes.contains("map_Pm gone.png is left out: there is no such file"), "{notes}");
    // The files of these maps are inputs, too, even with the name of an earlier copy.
    model(folder, "map_Kd t.png", "disp b-texture-1.png");
    let output = run(folder, &["export", "a.obj", "--out", "b.obj"]);
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_model_is_exported_alone_and_a_scene_with_its_cameras_and_lights() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    model(folder, "", "");
    let object = "(id: 1, name: \"a\", model: File(path: \"a.obj\"))";
    let camera = "(id: 2, name: \"c\", eye: (0.5, 0.8, 8.0))";
    let light = "(id: 3, name: \"l\", slot: 0, kind: Sun(direction: (0.0, 1.0, 0.0)))";
    let scene =
        format!("(version: 1, objects: [{object}], cameras: [{camera}], lights: [{light}])");
    put(folder, &[("s.marraztu", &scene)]);
    let rows: [(&[&str], bool, bool); 9] = [
        (&["a.obj"], false, false),
        (&["a.obj", "--content", "scene"], true, true),
        (&["a.obj", "--lights", "1"], false, true),
        (&["a.obj", "--lights", "none"], false, false),
        (&["a.obj", "--from", "front"], true, false),
        (&["a.obj", "--lights", "1", "--content", "models"], false, false),
        (&["s.marraztu"], true, true),
        (&["s.marraztu", "a.obj"], true, true),
        (&["s.marraztu", "--content", "models"], false, false),
    ];
    for (arguments, cameras, lights) in rows {
        let notes = runs(folder, &[&["export", "--out", "b.gltf"], arguments].concat());
        let gltf = read(&folder.join("b.gltf"));
        let has_lights = !gltf["extensions"]["KHR_lights_punctual"].is_null();
        assert_eq!((gltf["cameras"].is_array(), has_lights), (cameras, lights), "{arguments:?}");
        assert!(lights || !notes.contains("light"), "{notes}");
        let notes = runs(folder, &[&["export", "--out", "b.obj"], arguments].concat());
        assert_eq!(notes.contains("OBJ has no cameras"), cameras || lights, "{arguments:?}");
    }
}
