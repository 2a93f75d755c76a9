//! Models far from the origin, and unused vertices.

use super::*;

/// A wavy grid, moved by an offset.
fn wave(offset: [f64; 3]) -> String {
    const SIDE: u32 = 24;
    let mut text = String::new();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let [x, z] = [column, row].map(|i| (f64::from(i) - 12.0) * 0.25);
            let y = ((x * 1.5).sin() + (z * 1.5).cos()) * 0.5;
            let at = [x + offset[0], y + offset[1], z + offset[2]];
            text += &format!("v {:.4} {:.4} {:.4}\n", at[0], at[1], at[2]);
        }
    }
    for row in 0..SIDE {
        for column in 0..SIDE {
            let first = row * (SIDE + 1) + column + 1;
            let below = first + SIDE + 1;
            text += &format!("f {first} {below} {} {}\n", below + 1, first + 1);
        }
    }
    text
}

#[test]
fn a_model_far_away_has_the_picture_of_one_at_the_origin() {
    let far = [500_000.0, 300.0, -5_400_000.0];
    let folder = Folder::with(&[("local.obj", &wave([0.0; 3])), ("far.obj", &wave(far))]);
    let [local, moved] = ["local.obj", "far.obj"].map(|name| folder.drawn(&[name]));
    let pairs = local.pixels().iter().zip(moved.pixels());
    let apart = pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
    assert!(apart <= 4, "{apart} pixels differ by more than rounding");
    let info = folder.info("far.obj");
    assert!(info.contains("offset") && info.contains("500000"), "{info}");
    assert!(!folder.info("local.obj").contains("offset"));
}

#[test]
fn a_model_far_away_keeps_its_coordinates_through_scenes_and_exports() {
    let far = [500_000.0, 300.0, -5_400_000.0];
    let folder = Folder::with(&[("far.obj", &wave(far))]);
    let right = folder.drawn(&["far.obj"]);
    folder.ends(0, &["export", "far.obj", "--out", "again.obj"]);
    assert!(folder.drawn(&["again.obj"]) == right);
    let text = String::from_utf8(folder.read("again.obj")).unwrap();
    let first = text.lines().find(|line| line.starts_with("v ")).unwrap();
    let numbers: Vec<f64> = first.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
    let original = wave(far);
    let filed: Vec<f64> =
        original.lines().next().unwrap().split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
    assert!(numbers.iter().zip(&filed).all(|(a, b)| (a - b).abs() < 1e-6), "{numbers:?} {filed:?}");
}

#[test]
fn vertices_without_a_face_do_not_count_for_the_size() {
    let more = |vertex: &str| CUBE.replacen("v 1 1 1\n", &format!("v 1 1 1\nv {vertex}\n"), 1);
    let folder = Folder::with(&[
        ("plain.obj", CUBE),
        ("near.obj", &more("1000 1000 1000")),
        ("far.obj", &more("1e9 0 -1e9")),
    ]);
    let right = folder.drawn(&["plain.obj"]);
    for name in ["near.obj", "far.obj"] {
        assert!(folder.drawn(&[name]) == right, "{name}");
        assert!(
            folder.info(name).contains("a vertex is not used by any face, line or point"),
            "{name}"
        );
    }
    // An unused vertex at the origin does not change the offset of a distant model.
    let mut text = wave([500_000.0, 0.0, 0.0]);
    let right = Folder::with(&[("a.obj", &text)]).drawn(&["a.obj"]);
    text += "v 0 0 0\n";
    assert!(Folder::with(&[("a.obj", &text)]).drawn(&["a.obj"]) == right);
}
