//! Materials, maps and colours as exporters intend them.

use super::*;

#[test]
fn a_highlight_without_an_exponent_is_left_out() {
    let drawn = |lines: &str| {
        let folder = Folder::with(&[("a.obj", SQUARE), ("a.mtl", &format!("newmtl m\n{lines}"))]);
        (folder.drawn(&["a.obj"]), folder.info("a.obj"))
    };
    let (matt, _) = drawn("Kd .5 .5 .5\nKs 0 0 0\n");
    for lines in ["Kd .5 .5 .5\nKs 1 1 1\nNs 0\n", "Kd .5 .5 .5\nKs 1 1 1\n"] {
        let (picture, info) = drawn(lines);
        assert!(picture == matt, "{lines}");
        assert!(info.contains("matt"), "{info}");
    }
    assert!(drawn("Kd .5 .5 .5\nKs 1 1 1\nNs 10\n").0 != matt);
}

#[test]
fn colours_above_one_are_clamped_and_bytes_are_divided() {
    let with = |scale: &[&str; 3]| {
        let color = scale.join(" ");
        CUBE.lines()
            .map(|line| {
                if line.starts_with('v') {
                    format!("{line} {color}\n")
                } else {
                    format!("{line}\n")
                }
            })
            .collect::<String>()
    };
    let plain = |color: [&str; 3]| {
        let folder = Folder::with(&[("a.obj", &with(&color))]);
        (folder.drawn(&["a.obj"]), folder.info("a.obj"))
    };
    let (white, _) = plain(["1", "1", "1"]);
    for bright in [["1.2", "1.2", "1.2"], ["3.5", "2", "1"], ["2", "2", "2"], ["16", "1", "1"]] {
        let (picture, info) = plain(bright);
        assert!(picture == white, "{bright:?}");
        assert!(info.contains("clamped"), "{info}");
    }
    let (bytes, info) = plain(["255", "255", "255"]);
    assert!(bytes == white && info.contains("0 to 255"), "{info}");
    // One overbright vertex does not darken the others.
    let one = with(&["0.5", "0.5", "0.5"]).replacen("0.5 0.5 0.5", "1.05 0.5 0.5", 1);
    let folder = Folder::with(&[("a.obj", &one), ("b.obj", &with(&["0.5", "0.5", "0.5"]))]);
    let [a, b] = ["a.obj", "b.obj"].map(|name| middle(&folder.drawn(&[name])));
    assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 30), "{a:?} {b:?}");
}

#[test]
fn kd_above_one_is_clamped_and_bytes_are_divided() {
    let drawn = |kd: &str| {
        let mtl = format!("newmtl m\nKd {kd}\nKs 0 0 0\n");
        let folder = Folder::with(&[("a.obj", SQUARE), ("a.mtl", &mtl)]);
        folder.drawn(&["a.obj"])
    };
    assert!(drawn("1.2 0.5 0") == drawn("1 0.5 0"));
    assert!(drawn("255 0 51") == drawn("1 0 0.2"));
}

/// Draws the square with a material, next to a texture of red and blue halves.
#[track_caller]
fn textured(mtl: &str) -> (Picture, String) {
    let folder = Folder::with(&[("a.obj", SQUARE), ("a.mtl", mtl)]);
    folder.picture("t.png", 4, |x, _| if x < 2 { [255, 0, 0, 255] } else { [0, 0, 255, 255] });
    let soft = |x: usize, _| [255, 0, 0, if x < 2 { 255 } else { 0 }];
    folder.picture("soft.png", 4, soft);
    (folder.drawn(&["a.obj"]), folder.info("a.obj"))
}

#[test]
fn illum_0_without_a_texture_is_lit() {
    let drawn = |mtl: &str, texture: &str| {
        let folder = Folder::with(&[
            ("a.obj", &format!("mtllib a.mtl\nusemtl m\n{CUBE}")),
            ("a.mtl", &format!("newmtl m\nKa 0 0 0\nKd .17 .18 .69\nKs 0 0 0\n{mtl}{texture}")),
        ]);
        (folder.drawn(&["a.obj"]), folder.info("a.obj"))
    };
    let (lit, _) = drawn("illum 1\n", "");
    for mtl in ["illum 0\n", "illum 0.0\n", "illum 00\n"] {
        let (picture, info) = drawn(mtl, "");
        assert!(picture == lit, "{mtl}");
        assert!(info.contains("illum 0 without a texture is taken as 1"), "{info}");
        // A texture that is missing leaves a surface without one.
        assert!(drawn(mtl, "map_Kd gone.png\n").0 == lit);
    }
    // Scans have light in their textures.
    let [lit, plain] = ["illum 1", "illum 0.0"]
        .map(|illum| textured(&format!("newmtl m\nKa 0 0 0\nKd 1 1 1\n{illum}\nmap_Kd t.png\n")).0);
    assert!(lit != plain);
    assert!(plain.pixels().contains(&[255, 0, 0, 255]));
}

#[test]
fn an_opacity_map_that_is_the_texture_means_its_alpha() {
    let opaque = textured("newmtl m\nKd 1 1 1\nmap_Kd t.png\n").0;
    for name in
        ["t.png", "./t.png", ".\\T.PNG", "C:\\maps\\t.png", "-s 2 2 1 t.png", "-clamp on t.png"]
    {
        let (picture, info) =
            textured(&format!("newmtl m\nKd 1 1 1\nmap_Kd t.png\nmap_d {name}\n"));
        assert!(picture == opaque, "{name}");
        assert!(info.contains("map_d names the picture of map_Kd, which has no alpha"), "{info}");
    }
    let hole = textured("newmtl m\nKd 1 1 1\nmap_Kd soft.png\n").0;
    let (picture, info) = textured("newmtl m\nKd 1 1 1\nmap_Kd soft.png\nmap_d ./soft.png\n");
    assert!(picture == hole && hole != opaque);
    assert!(!info.contains("map_d names"), "{info}");
    // Another file is a map of opacity by its brightness.
    let (picture, info) = textured("newmtl m\nKd 1 1 1\nmap_Kd soft.png\nmap_d t.png\n");
    assert!(picture != hole && !info.contains("map_d names"), "{info}");
}

#[test]
fn a_lamp_leaves_the_colours_of_other_materials() {
    let with =
        |mtl: &str| textured(&format!("{mtl}newmtl m\nKd 1 1 1\nKs 0 0 0\nmap_Kd t.png\n")).0;
    let plain = with("");
    for other in [
        "newmtl l\nKd 30 27 11\n",
        "newmtl l\nKd 30 27 11\nnewmtl k\nKd 50 50 50\n",
        "newmtl l\nKd 255 0 0\n",
        "newmtl l\nKa 60 60 60\nKd 255 128 0\nKs 255 255 255\n",
        "newmtl l\nKd 20 20 20\nKe 30 30 30\n",
        "newmtl l\nKd 1000 1000 1000\n",
    ] {
        assert!(with(other) == plain, "{other}");
    }
    let brown = |kd: &str| textured(&format!("newmtl m\nKd {kd}\nKs .5 .5 .5\nNs 50\n"));
    let (picture, info) = brown("204 102 51");
    assert!(picture == brown("0.8 0.4 0.2").0);
    assert!(info.contains("read as 0 to 255") && !info.contains("clamped"), "{info}");
}

#[test]
fn a_model_that_its_opacity_would_hide_is_opaque() {
    let drawn = |opacity: &str| textured(&format!("newmtl m\nKd .5 .5 .5\nKs 0 0 0\n{opacity}\n"));
    let (opaque, _) = drawn("");
    for opacity in ["d 0", "d 0.000000", "Tr 1", "d 0\nTr 1", "d 0\nTr 0", "Tr 0\nd 0"] {
        let (picture, info) = drawn(opacity);
        assert!(picture == opaque, "{opacity}");
        assert!(info.contains("opaque") || info.contains("d 0 contradicts Tr 0"), "{info}");
    }
    // One material of several may be meant to be invisible.
    let (picture, info) = {
        let two =
            SQUARE.replace("usemtl m\nf 1/1 2/2 3/3 4/4", "usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4");
        let mtl = "newmtl m\nKd 1 0 0\nd 0\nnewmtl n\nKd 0 1 0\nillum 1\n";
        let folder = Folder::with(&[("a.obj", &two), ("a.mtl", mtl)]);
        (folder.drawn(&["a.obj"]), folder.info("a.obj"))
    };
    assert!(info.contains("wholly transparent"), "{info}");
    assert!(!picture.pixels().iter().any(|[r, _, b, _]| *r > 20 && *b == 0), "red is invisible");
}

#[test]
fn a_texture_replaces_vertex_colours() {
    let colored = |color: &str| {
        SQUARE
            .lines()
            .map(|line| match line.starts_with("v ") {
                true => format!("{line} {color}\n"),
                false => format!("{line}\n"),
            })
            .collect::<String>()
    };
    let mtl = "newmtl m\nKd 1 1 1\nKs 0 0 0\nmap_Kd t.png\n";
    let folder = Folder::with(&[
        ("plain.obj", SQUARE),
        ("dark.obj", &colored("0.1 0.1 0.8")),
        ("white.obj", &colored("1 1 1")),
        ("alone.obj", &colored("0.1 0.1 0.8").replace("usemtl m\n", "")),
        ("a.mtl", mtl),
    ]);
    folder.picture("t.png", 4, |x, _| if x < 2 { [255, 0, 0, 255] } else { [0, 255, 0, 255] });
    let plain = folder.drawn(&["plain.obj"]);
    assert!(folder.drawn(&["dark.obj"]) == plain);
    assert!(folder.info("dark.obj").contains("its texture replaces the vertex colours"));
    assert!(folder.drawn(&["white.obj"]) == plain);
    assert!(!folder.info("white.obj").contains("replaces"));
    // A texture that the user chooses replaces them as well; faces without one show them.
    let chosen = folder.drawn(&["alone.obj", "--texture", "t.png"]);
    assert!(chosen != folder.drawn(&["alone.obj"]));
    assert!(chosen.pixels().iter().any(|[r, _, b, _]| *r > b.saturating_add(50)));
    let attributes = |name: &str| {
        folder.ends(0, &["export", name, "--out", "a.gltf"]);
        String::from_utf8(folder.read("a.gltf")).unwrap().contains("COLOR_0")
    };
    assert!(!attributes("dark.obj") && attributes("alone.obj"));
    // OBJ keeps both, and shows them as before.
    folder.ends(0, &["export", "dark.obj", "--out", "b.obj"]);
    assert!(folder.drawn(&["b.obj"]) == plain);
    assert!(folder.info("b.obj").contains("vertex colours  yes"));
    // Grey ones are baked light.
    std::fs::write(folder.at("baked.obj"), colored("0.4 0.4 0.4")).unwrap();
    let baked = folder.drawn(&["baked.obj"]);
    let sum = |picture: &Picture| -> u32 {
        picture.pixels().iter().map(|[r, g, ..]| u32::from(*r) + u32::from(*g)).sum()
    };
    assert!(sum(&baked) < sum(&plain));
    assert!(!folder.info("baked.obj").contains("replaces"));
    assert!(attributes("baked.obj"));
}

#[test]
fn a_picture_of_normals_under_map_bump_is_a_normal_map() {
    let folder = Folder::with(&[("a.obj", SQUARE), ("a.mtl", "")]);
    folder.picture("n.png", 32, |x, y| {
        let [u, v] = [x, y].map(|i| ((i % 8) as f64 - 3.5) / 5.0);
        let z = (1.0 - u * u - v * v).max(0.0).sqrt();
        let [r, g, b] = [u, -v, z].map(|n| marraztu_core::base::color::byte((n + 1.0) / 2.0));
        [r, g, b, 255]
    });
    let drawn = |statement: &str, arguments: &[&str]| {
        std::fs::write(folder.at("a.mtl"), format!("newmtl m\nKd 1 1 1\n{statement} n.png\n"))
            .unwrap();
        (folder.drawn(&[&["a.obj"], arguments].concat()), folder.info("a.obj"))
    };
    let (right, info) = drawn("norm", &[]);
    assert!(!info.contains("normal map"), "{info}");
    for statement in ["map_Bump", "bump", "map_bump -bm 1.0"] {
        let (picture, info) = drawn(statement, &[]);
        assert!(picture == right, "{statement}");
        assert!(info.contains("read as a normal map"), "{info}");
        assert!(drawn(statement, &["--bump-maps", "heights"]).0 != right);
    }
    assert!(drawn("bump", &["--bump-maps", "normals"]).0 == right);
}

#[test]
fn a_polygon_of_many_corners_has_no_dark_rim() {
    let disc = |corners: u32| {
        let mut text = String::new();
        for i in 0..corners {
            let (sine, cosine) =
                (std::f64::consts::TAU * f64::from(i) / f64::from(corners)).sin_cos();
            text += &format!("v {cosine} {sine} 0\n");
        }
        text += "f";
        for i in 1..=corners {
            text += &format!(" {i}");
        }
        text
    };
    let folder = Folder::with(&[("many.obj", &disc(200_000)), ("few.obj", &disc(400))]);
    for from in ["0,0", "30,20"] {
        let darkest = |name: &str| {
            let render = ["render", name, "--size", "256", "--samples", "1", "--from", from];
            folder.ends(0, &[&render[..], &["--transparent", "--out", "a.png"]].concat());
            let picture = io::load_picture(&folder.at("a.png")).unwrap();
            picture.pixels().iter().filter(|pixel| pixel[3] == 255).map(|pixel| pixel[1]).min()
        };
        let (many, few) = (darkest("many.obj").unwrap(), darkest("few.obj").unwrap());
        assert!(many.abs_diff(few) < 8, "{from}: {many} beside {few}");
    }
}
