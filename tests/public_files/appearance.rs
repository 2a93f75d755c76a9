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
