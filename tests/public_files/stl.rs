//! STL files of printers, scanners and CAD programs.

use super::*;

/// The corners of a cube's triangles from -1 to 1, counter-clockwise from outside.
fn cube() -> Vec<[[f32; 3]; 3]> {
    let place = |i: u8| [i & 1, i >> 1 & 1, i >> 2].map(|bit| f32::from(bit) * 2.0 - 1.0);
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
        .map(|it| it.map(place))
        .collect()
}

/// A binary file with this beginning of its header, and the last two bytes of each facet.
fn binary(header: &[u8], triangles: &[[[f32; 3]; 3]], facet: impl Fn(usize) -> u16) -> Vec<u8> {
    let mut file = header.to_vec();
    file.resize(80, 0);
    file.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for (i, triangle) in triangles.iter().enumerate() {
        file.extend([0; 12]);
        file.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        file.extend(facet(i).to_le_bytes());
    }
    file
}

fn ascii(triangles: &[[[f32; 3]; 3]]) -> String {
    let mut text = String::from("solid a\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle {
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid a\n"
}

/// A hexagonal prism, and the same as an OBJ file.
fn hexagon() -> (Vec<[[f32; 3]; 3]>, String) {
    let at = |i: usize, z: f32| {
        let (sine, cosine) = (std::f32::consts::FRAC_PI_3 * i as f32 + 0.5).sin_cos();
        [cosine, sine, z]
    };
    let (mut triangles, mut obj) = (Vec::new(), String::new());
    for i in 0..6 {
        let [a, b] = [at(i, -0.5), at(i + 1, -0.5)];
        let [c, d] = [at(i + 1, 0.5), at(i, 0.5)];
        triangles.extend([[a, b, c], [a, c, d], [[0.0, 0.0, 0.5], d, c], [[0.0, 0.0, -0.5], b, a]]);
        obj += &format!("v {} {} -0.5\nv {} {} 0.5\n", a[0], a[1], d[0], d[1]);
    }
    obj += "f 2 4 6 8 10 12\nf 11 9 7 5 3 1\n";
    for i in 0..6 {
        let (a, b) = (2 * i + 1, 2 * ((i + 1) % 6) + 1);
        obj += &format!("f {a} {b} {} {}\n", b + 1, a + 1);
    }
    (triangles, obj)
}

/// The number of different normals, to three decimals, in an export.
#[expect(clippy::cast_possible_truncation, reason = "parts of a unit vector")]
fn normals(folder: &Folder, name: &str) -> usize {
    folder.ends(0, &["export", name, "--out", "normals.obj"]);
    let text = String::from_utf8(folder.read("normals.obj")).unwrap();
    let normals = text.lines().filter_map(|line| line.strip_prefix("vn "));
    let rounded = normals.map(|line| {
        let number = |word: &str| (word.parse::<f64>().unwrap() * 1000.0).round() as i64;
        line.split(' ').map(number).collect::<Vec<_>>()
    });
    rounded.collect::<std::collections::BTreeSet<_>>().len()
}

#[test]
fn stl_files_are_flat_and_a_chosen_crease_angle_smooths_them() {
    let (triangles, obj) = hexagon();
    let folder = Folder::with(&[("hex.obj", &obj), ("ascii.stl", &ascii(&triangles))]);
    std::fs::write(folder.at("hex.stl"), binary(b"", &triangles, |_| 0)).unwrap();
    std::fs::write(folder.at("copy"), binary(b"", &triangles, |_| 0)).unwrap();
    for name in ["hex.stl", "ascii.stl", "hex.obj", "copy"] {
        assert_eq!(normals(&folder, name), 8, "{name}");
    }
    assert!(folder.info("hex.stl").contains("crease 0 degrees"));
    let round = folder.drawn(&["hex.stl", "--crease", "80"]);
    assert!(round != folder.drawn(&["hex.stl"]));
}

#[test]
fn facets_have_the_colours_of_magics_and_viscam() {
    let cube = cube();
    let folder = Folder::with(&[]);
    let save = |name: &str, bytes: Vec<u8>| std::fs::write(folder.at(name), bytes).unwrap();
    let magics = b"COLOR=\xFF\x80\x00\xFF,MATERIAL=";
    let sides = |colors: [u16; 6]| move |i: usize| colors[i / 2];
    save("magics.stl", binary(magics, &cube, sides([31, 31 << 5, 31 << 10, 0x8000, 31, 31])));
    let [red, green, blue] = [0xFC00, 0x83E0, 0x801F];
    save("viscam.stl", binary(b"part", &cube, sides([red, green, blue, 0, red, red])));
    save("body.stl", binary(magics, &cube, |_| 0));
    save("plain.stl", binary(b"", &cube, |_| 0));
    for (name, colors) in [
        ("magics.stl", &["rgb_ff0000", "rgb_00ff00", "rgb_0000ff", "rgb_ff8000"][..]),
        ("viscam.stl", &["rgb_ff0000", "rgb_00ff00", "rgb_0000ff"][..]),
        ("body.stl", &["rgb_ff8000"][..]),
        ("plain.stl", &[][..]),
    ] {
        let info = folder.info(name);
        assert_eq!(colors.len(), info.matches("\n  \"rgb_").count() / 2, "{name}: {info}");
        assert!(colors.iter().all(|color| info.contains(color)), "{name}: {info}");
        assert!(info.contains("closed          yes"), "{info}");
    }
    // Blue is on the side towards -y, which faces the camera with z up.
    let shown = middle(&folder.drawn(&["magics.stl", "--from", "front"]));
    assert!(shown[2] > 100 && shown[0] < 20 && shown[1] < 20, "{shown:?}");
    assert!(folder.drawn(&["magics.stl", "--material", "silver"]) == folder.drawn(&["plain.stl"]));
    // Exports keep the colours.
    folder.ends(0, &["export", "magics.stl", "--out", "b.obj"]);
    assert!(folder.drawn(&["b.obj"]) == folder.drawn(&["magics.stl"]));
}

#[test]
fn comments_and_words_before_the_first_solid_are_skipped() {
    let text = ascii(&cube());
    for (name, odd) in [
        ("+", format!("+\n {text}")),
        ("comment", text.replacen('\n', "\n# made by hand\n", 1)),
        ("comments", format!("# made by hand\n{}", text.replacen("endloop", "endloop # c", 1))),
        ("lines", format!("\u{feff};\r\n{}", text.replace('\n', "\r\n").to_uppercase())),
    ] {
        let folder = Folder::with(&[("odd.stl", &odd), ("unnamed", &odd), ("a.stl", &text)]);
        let info = folder.info("odd.stl");
        assert!(info.contains("triangles       12\n"), "{name}: {info}");
        assert_eq!(name == "+", info.contains("is not a statement of STL"), "{info}");
        assert!(folder.drawn(&["unnamed"]) == folder.drawn(&["a.stl"]), "{name}");
    }
}

#[test]
fn a_triangle_with_nan_or_infinity_costs_no_other() {
    let cube = cube();
    for wrong in [f32::NAN, f32::INFINITY] {
        let mut more = cube.clone();
        more.insert(5, [[0.0; 3], [1.0, wrong, 0.0], [0.0, 1.0, 0.0]]);
        let folder = Folder::with(&[("ascii.stl", &ascii(&more)), ("whole.stl", &ascii(&cube))]);
        std::fs::write(folder.at("binary.stl"), binary(b"", &more, |_| 0)).unwrap();
        for name in ["ascii.stl", "binary.stl"] {
            let info = folder.info(name);
            assert!(info.contains("triangles       12\n"), "{info}");
            assert!(info.contains("a triangle has a corner that is unreadable"), "{info}");
            assert!(folder.drawn(&[name]) == folder.drawn(&["whole.stl"]));
        }
    }
}

/// The vertices of an OBJ file.
fn vertices(folder: &Folder, name: &str) -> Vec<String> {
    let text = String::from_utf8(folder.read(name)).unwrap();
    text.lines().filter(|line| line.starts_with("v ")).map(str::to_owned).collect()
}

#[test]
fn an_export_of_stl_as_obj_keeps_its_numbers() {
    let place = |[x, y, z]: [f32; 3]| [x + 1.0, y + 1.0, 2.5 * z + 2.5];
    let tall: Vec<_> = cube().into_iter().map(|it| it.map(place)).collect();
    let folder = Folder::with(&[("tall.stl", &ascii(&tall)), ("cube.obj", CUBE)]);
    let told = folder.ends(0, &["export", "tall.stl", "--out", "t.obj"]);
    assert!(told.contains("z is up in the OBJ file, as in the STL files"), "{told}");
    let mut expected: Vec<String> = Vec::new();
    for [x, y, z] in tall.iter().flatten() {
        let line = format!("v {x} {y} {z}");
        if !expected.contains(&line) {
            expected.push(line);
        }
    }
    assert_eq!(vertices(&folder, "t.obj"), expected);
    assert!(folder.drawn(&["t.obj"]) == folder.drawn(&["tall.stl"]), "it says that z is up");
    folder.ends(0, &["export", "tall.stl", "--up", "y", "--out", "y.obj"]);
    assert_eq!(vertices(&folder, "y.obj"), expected);
    // With models of other axes, y is up for all.
    let told = folder.ends(0, &["export", "tall.stl", "cube.obj", "--out", "both.obj"]);
    assert!(told.contains("models with another up axis are turned: 1"), "{told}");
    let both = vertices(&folder, "both.obj");
    assert!(both.contains(&"v 2 5 0".to_owned()) || both.contains(&"v 2 5 -0".to_owned()));
    // In glTF, y is up.
    folder.ends(0, &["export", "tall.stl", "--out", "t.gltf"]);
    let gltf = String::from_utf8(folder.read("t.gltf")).unwrap();
    let gltf: String = gltf.split_whitespace().collect();
    assert!(gltf.contains("\"max\":[2.0,5.0"), "{gltf}");
}
