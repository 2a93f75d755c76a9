//! Content of exported glTF files: colours, opacity, textures and names.

use std::path::Path;

use serde_json::{Value, json};

use super::{grey, image, json as read, put, put_picture, runs};

const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                      vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

/// Exports a square with a material of these statements as glTF.
fn exported(folder: &Path, statements: &str) -> Value {
    let text = format!("{SQUARE}usemtl m\nf 1/1 2/2 3/3 4/4\n");
    put(folder, &[("a.obj", &text), ("a.mtl", &format!("newmtl m\n{statements}\n"))]);
    runs(folder, &["export", "a.obj", "--out", "b.gltf"]);
    read(&folder.join("b.gltf"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[track_caller]
fn near(value: &Value, expected: &[f64]) {
    let found = numbers(value);
    assert_eq!(found.len(), expected.len());
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-6;
    assert!(found.iter().zip(expected).all(is_near), "{found:?} instead of {expected:?}");
}

#[test]
fn the_colour_of_a_textured_material_is_its_factor() {
    let folder = tempfile::tempdir().unwrap();
    put_picture(folder.path(), "t.png", 4, |x, y| [u8::from(x < y) * 200, 9, 9, 255]);
    let gltf = exported(folder.path(), "Kd .5 .25 1\nKs 0 0 0\nmap_Kd t.png");
    let material = &gltf["materials"][0];
    assert_eq!(material["name"], "m");
    let surface = &material["pbrMetallicRoughness"];
    // The sRGB decoding ((s + 0.055) / 1.055)^2.4 of 1/2 and 1/4.
    near(&surface["baseColorFactor"], &[0.214_041_14, 0.050_876_09, 1.0, 1.0]);
    assert_eq!(surface["baseColorTexture"]["index"], 0);
    assert!(material.get("alphaMode").is_none_or(|mode| mode == "OPAQUE"));
    assert_eq!(gltf["images"][0]["name"], "t");
}

#[test]
fn opacity_between_all_and_nothing_blends_and_holes_are_masked() {
    let folder = tempfile::tempdir().unwrap();
    let soft = |x: usize, _| [255, 0, 0, u8::try_from(x * 80).unwrap()];
    put_picture(folder.path(), "soft.png", 4, soft);
    let hard = |x: usize, _| [255, 0, 0, if x < 2 { 0 } else { 255 }];
    put_picture(folder.path(), "hard.png", 4, hard);
    let white = |x: usize, _| if x < 2 { [0, 0, 0, 255] } else { [255; 4] };
    put_picture(folder.path(), "white.png", 4, white);
    put_picture(folder.path(), "grey.png", 4, |_, _| grey(100));
    let rows = [
        ("map_Kd soft.png", json!("BLEND"), Value::Null),
        ("map_Kd hard.png", json!("MASK"), json!(0.5)),
        ("map_Kd hard.png\nd .5", json!("BLEND"), Value::Null),
        ("d .5", json!("BLEND"), Value::Null),
        ("map_d white.png", json!("MASK"), json!(0.5)),
        ("map_Kd grey.png\nmap_d white.png", json!("MASK"), json!(0.5)),
        ("map_d grey.png", json!("BLEND"), Value::Null),
        ("map_d soft.png", json!("BLEND"), Value::Null),
        ("map_Kd soft.png\nmap_d soft.png", json!("BLEND"), Value::Null),
    ];
    for (statements, mode, cutoff) in rows {
        let gltf = exported(folder.path(), &format!("Kd 1 1 1\nKs 0 0 0\n{statements}"));
        let material = &gltf["materials"][0];
        assert_eq!(material["alphaMode"], mode, "{statements}");
        assert_eq!(material["alphaCutoff"], cutoff, "{statements}");
        let texture = &material["pbrMetallicRoughness"]["baseColorTexture"];
        assert_eq!(texture.is_null(), !statements.contains("map"), "{statements}");
    }
}

#[test]
fn a_map_of_opacity_is_in_the_alpha_of_the_texture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.gltf");
    let color =
        |x: usize, y: usize| [u8::try_from(x * 50).unwrap(), u8::try_from(y).unwrap(), 7, 255];
    put_picture(folder.path(), "color.png", 4, color);
    let map = |x: usize, y: usize| grey(u8::try_from(x * 60 + y).unwrap());
    put_picture(folder.path(), "map.png", 4, map);
    put_picture(folder.path(), "large.png", 8, |x, y| map(x / 2, y / 2));

    // At equal sizes each texel keeps its colour, and the brightness of the map becomes its alpha.
    let gltf = exported(folder.path(), "Kd 1 1 1\nKs 0 0 0\nmap_Kd color.png\nmap_d map.png");
    let merged = image(&path, &gltf, 0);
    for (i, pixel) in merged.pixels().iter().enumerate() {
        let (x, y) = (i % 4, i / 4);
        let ([r, g, b, _], [alpha, ..]) = (color(x, y), map(x, y));
        assert_eq!(*pixel, [r, g, b, alpha]);
    }
    // Without a colour texture the colour is white.
    let gltf = exported(folder.path(), "Kd 1 1 1\nKs 0 0 0\nmap_d map.png");
    let merged = image(&path, &gltf, 0);
    assert_eq!(merged.pixel(2, 3), [255, 255, 255, 123]);
    // The larger size wins; in the middle of four equal texels interpolation changes nothing.
    let gltf = exported(folder.path(), "Kd 1 1 1\nKs 0 0 0\nmap_Kd map.png\nmap_d large.png");
    let merged = image(&path, &gltf, 0);
    assert_eq!(merged.size(), marraztu_core::base::image::Size::new(8, 8));
    assert_eq!(merged.pixel(4, 2)[3], map(2, 1)[0]);
    // The layouts differ: a map at twice the scale repeats twice.
    let gltf =
        exported(folder.path(), "Kd 1 1 1\nKs 0 0 0\nmap_Kd large.png\nmap_d -s 2 2 1 map.png");
    let merged = image(&path, &gltf, 0);
    for x in 0..4 {
        assert_eq!(merged.pixel(x, 5)[3], map(x, 1)[0]);
        assert_eq!(merged.pixel(x + 4, 1)[3], map(x, 1)[0]);
    }
}

/// Returns the pairs of floats of an accessor.
fn pairs(path: &Path, gltf: &Value, accessor: &Value) -> Vec<[f64; 2]> {
    let number = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let view = &gltf["bufferViews"][number(&gltf["accessors"][number(accessor)]["bufferView"])];
    let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
    let bytes = std::fs::read(path.with_extension("bin")).unwrap();
    let (floats, _) = bytes[start..start + length].as_chunks();
    let floats: Vec<f64> = floats.iter().map(|it| f64::from(f32::from_le_bytes(*it))).collect();
    floats.as_chunks().0.to_vec()
}

#[test]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
fn texture_and_map_of_opacity_keep_their_places_whatever_their_layouts() {
    const SIDE: usize = 16;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.gltf");
    // Quarters of different colours, and of different opacity.
    let quarter = |x: bool, y: bool| [u8::from(x) * 255, u8::from(y) * 255, 9, 255];
    let opacity = |x: bool, y: bool| [255, 200, 100, 0][usize::from(x) + 2 * usize::from(y)];
    let right = |x: usize| x >= SIDE / 2;
    put_picture(folder.path(), "t.png", SIDE, |x, y| quarter(right(x), right(y)));
    put_picture(folder.path(), "d.png", SIDE, |x, y| grey(opacity(right(x), right(y))));

    // Scale and offset of both, and whether they are clamped.
    let rows = [
        ([4.0, 4.0], [0.0; 2], [1.0, 1.0], [0.0; 2], "off"),
        ([4.0, 4.0], [0.125, 0.5], [1.0, 2.0], [0.25, 0.0], "off"),
        ([2.0, 3.0], [0.0; 2], [3.0, 2.0], [0.0; 2], "off"),
        ([-2.0, 1.0], [0.25, 0.0], [1.0, 0.3333], [0.5, 0.0], "off"),
        ([0.0, 1.0], [0.25, 0.0], [2.0, 0.0], [0.0, 0.25], "off"),
        ([4.0, -2.0], [0.0, 1.5], [1.0, 3.0], [0.0; 2], "on"),
        ([1.0, 1.0], [0.0; 2], [1.0, 1.0], [0.5, -1.0], "on"),
    ];
    for (scale, offset, map_scale, map_offset, clamp) in rows {
        let options = |[s, t]: [f64; 2], [u, v]: [f64; 2]| {
            format!("-s {s} {t} 1 -o {u} {v} 0 -clamp {clamp}")
        };
        let of_texture = options(scale, offset);
        let of_map = options(map_scale, map_offset);
        let maps = format!("map_Kd {of_texture} t.png\nmap_d {of_map} d.png");
        let gltf = exported(folder.path(), &format!("Kd 1 1 1\nKs 0 0 0\n{maps}"));
        let merged = image(&path, &gltf, 0);
        let uvs = &gltf["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"];
        let uvs = pairs(&path, &gltf, uvs);
        // The half of a picture at a point of the surface; `None` near the middle and the borders.
        let half = |at: f64, scale: f64, offset: f64| {
            let at = at * scale + offset;
            let at = if clamp == "on" { at.clamp(0.2, 0.8) } else { at.rem_euclid(1.0) };
            let is_near = [0.0, 0.5, 1.0].into_iter().any(|edge| (at - edge).abs() < 0.1);
            (!is_near).then_some(at >= 0.5)
        };
        // Pictures begin at the top.
        let halves = |at: [f64; 2], scale: [f64; 2], offset: [f64; 2]| {
            let [x, y] = [0, 1].map(|i| half(at[i], scale[i], offset[i]));
            Some((x?, !y?))
        };
        let texel = |at: f64, count: usize| {
            let at = if clamp == "on" { at.clamp(0.0, 1.0) } else { at.rem_euclid(1.0) };
            ((at * count as f64) as usize).min(count - 1)
        };
        let mut seen = 0;
        for i in 0..29 * 29 {
            let at = [i % 29, i / 29].map(|i| f64::from(i) / 29.0);
            let (Some((x, y)), Some((over, under))) =
                (halves(at, scale, offset), halves(at, map_scale, map_offset))
            else {
                continue;
            };
            seen += 1;
            // The first vertex is at (0, 0), the third at (1, 1).
            let place = |i: usize| uvs[0][i] + (uvs[2][i] - uvs[0][i]) * at[i];
            let size = merged.size();
            let pixel = merged.pixel(texel(place(0), size.width), texel(place(1), size.height));
            let [r, g, b, _] = quarter(x, y);
            assert_eq!(pixel, [r, g, b, opacity(over, under)], "{maps} at {at:?}: {size:?}");
        }
        assert!(seen > 50, "{maps}: {seen}");
    }
}

#[test]
fn a_texture_without_texture_coordinates_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    put_picture(folder.path(), "t.png", 2, |_, _| [1, 2, 3, 100]);
    let mtl = "newmtl m\nKd .5 .25 1\nKs 0 0 0\nmap_Kd t.png\nmap_d t.png\nnorm t.png\n";
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n";
    put(folder.path(), &[("a.obj", obj), ("a.mtl", mtl)]);
    runs(folder.path(), &["export", "a.obj", "--out", "b.gltf"]);
    let gltf = read(&folder.path().join("b.gltf"));
    let material = &gltf["materials"][0];
    assert!(material["normalTexture"].is_null() && gltf["textures"].is_null());
    let surface = &material["pbrMetallicRoughness"];
    assert!(surface["baseColorTexture"].is_null());
    near(&surface["baseColorFactor"], &[0.214_041_14, 0.050_876_09, 1.0, 1.0]);
}

#[test]
fn faces_without_texture_coordinates_show_no_texture_next_to_faces_that_have_them() {
    let folder = tempfile::tempdir().unwrap();
    put_picture(folder.path(), "t.png", 2, |_, _| [1, 2, 3, 100]);
    let mtl = "newmtl m\nKd .5 .25 1\nKs 0 0 0\nmap_Kd t.png\nmap_d t.png\nnewmtl plain\n";
    // A mapped square, an unmapped one, one with one mapped triangle; and both without a texture.
    let faces = "usemtl m\nf 1/1 2/2 3/3 4/4\nf 1 2 3 4\nf 1/1 2/2 3/3 4\n\
                 usemtl plain\nf 1/1 2/2 3/3\nf 1 3 4\n";
    put(folder.path(), &[("a.obj", &format!("{SQUARE}{faces}")), ("a.mtl", mtl)]);
    runs(folder.path(), &["export", "a.obj", "--out", "b.gltf"]);
    let gltf = read(&folder.path().join("b.gltf"));
    let list = |value: &Value| value.as_array().unwrap().clone();
    let materials = list(&gltf["materials"]).into_iter().map(|material| {
        let has_texture = !material["pbrMetallicRoughness"]["baseColorTexture"].is_null();
        (material["name"].clone(), has_texture, material["alphaMode"] == "BLEND")
    });
    let expected = [("m", true, true), ("m.001", false, false), ("plain", false, false)];
    assert!(materials.eq(expected.map(|(name, texture, fades)| (json!(name), texture, fades))));
    let primitives = list(&gltf["meshes"][0]["primitives"]).into_iter().map(|primitive| {
        let indices = usize::try_from(primitive["indices"].as_u64().unwrap()).unwrap();
        (primitive["material"].clone(), gltf["accessors"][indices]["count"].clone())
    });
    assert!(
        primitives.eq([(0, 9), (1, 9), (2, 6)].map(|(look, count)| (json!(look), json!(count))))
    );
}

#[test]
fn maps_that_are_laid_out_differently_have_texture_coordinates_each() {
    let folder = tempfile::tempdir().unwrap();
    put_picture(folder.path(), "t.png", 2, |_, _| [128, 128, 255, 255]);
    let statements = "Kd 1 1 1\nKs 0 0 0\nmap_Kd t.png\nmap_Ke -s 2 2 1 t.png\nnorm t.png";
    let gltf = exported(folder.path(), statements);
    let material = &gltf["materials"][0];
    let set = |info: &Value| info["texCoord"].as_u64().unwrap_or(0);
    assert_eq!(set(&material["pbrMetallicRoughness"]["baseColorTexture"]), 0);
    assert_eq!(set(&material["emissiveTexture"]), 1);
    assert_eq!(set(&material["normalTexture"]), 0);
    let attributes = &gltf["meshes"][0]["primitives"][0]["attributes"];
    assert!(attributes["TEXCOORD_1"].is_u64() && attributes["TEXCOORD_2"].is_null());
    assert_eq!(gltf["textures"].as_array().unwrap().len(), 1, "one picture is one texture");
}

#[test]
fn roughness_and_metalness_of_the_file_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let gltf = exported(folder.path(), "Kd 1 1 1\nKs 0 0 0\nNs 90\nPr .25\nPm .75\nKe 2 0 .5");
    let material = &gltf["materials"][0];
    let surface = &material["pbrMetallicRoughness"];
    assert_eq!(
        (&surface["roughnessFactor"], &surface["metallicFactor"]),
        (&json!(0.25), &json!(0.75))
    );
    let strength = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
        .as_f64()
        .unwrap();
    assert!((strength - 4.953_837).abs() < 1e-5, "2 as linear light: {strength}");
    near(&material["emissiveFactor"], &[1.0, 0.0, 0.214_041_14 / strength]);
}

/// The hierarchy of nodes with meshes, as names.
fn tree(gltf: &Value, node: &Value) -> Value {
    let node = &gltf["nodes"][usize::try_from(node.as_u64().unwrap()).unwrap()];
    let children = node["children"].as_array().cloned().unwrap_or_default();
    let below: Vec<Value> = children.iter().map(|child| tree(gltf, child)).collect();
    json!([node["name"], node["mesh"].is_u64(), below])
}

fn trees(folder: &Path, obj: &str) -> Vec<Value> {
    put(folder, &[("a.obj", obj)]);
    runs(folder, &["export", "a.obj", "--out", "b.gltf"]);
    let gltf = read(&folder.join("b.gltf"));
    let nodes = gltf["scenes"][0]["nodes"].as_array().unwrap();
    let of_objects = nodes.iter().filter(|node| {
        let node = &gltf["nodes"][usize::try_from(node.as_u64().unwrap()).unwrap()];
        node["camera"].is_null() && node["extensions"].is_null()
    });
    of_objects.map(|node| tree(&gltf, node)).collect()
}

#[test]
fn each_object_and_group_of_a_file_is_a_node() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [
        ("f 1 2 3\n", json!(["a", true, []])),
        ("o Body\nf 1 2 3\n", json!(["Body", true, []])),
        ("o Body\ng Body\nf 1 2 3\n", json!(["Body", true, []])),
        ("g door\nf 1 2 3\n", json!(["door", true, []])),
        ("o Body\ng door\nf 1 2 3\n", json!(["Body", false, [["door", true, []]]])),
        (
            "g door\nf 1 2 3\ng roof\nf 1 3 4\ng door\nf 2 3 4\n",
            json!(["a", false, [["door", true, []], ["roof", true, []]]]),
        ),
        (
            "o Body\nf 1 2 3\ng door\nf 1 3 4\no Wheels\ng door\nf 2 3 4\n",
            json!([
                "a",
                false,
                [["Body", true, [["door", true, []]]], ["Wheels", false, [["door.001", true, []]]],]
            ]),
        ),
    ];
    for (faces, expected) in rows {
        let found = trees(folder.path(), &format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{faces}"));
        assert_eq!(found, [expected], "{faces}");
    }
}
