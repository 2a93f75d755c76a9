//! Odd numbers and faces in files, scenes at other scales, empty scenes and huge ones.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Attenuation, Lens, Light, LightId, LightKind, List, LoadOptions, MeshSource, ObjectId, Orbit,
    Pose, Projection, Scene, Tracked, View, newell,
};
use marraztu_io::{FindingKind, LoadError, Loaded, Progress, parse};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

use super::cases::quick_round;
use super::common::{ball, covered, cube, draw, edit, model_of, scene};
use super::figures::Figure;

fn read(text: &str) -> Result<Loaded, LoadError> {
    parse(text.as_bytes(), "a.obj", None, &LoadOptions::default(), &Progress::new())
}

fn with_first_number(number: &str) -> Result<Loaded, LoadError> {
    read(&format!("v {number} 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 2 3 4\n"))
}

#[test]
fn case_64_numbers_are_read_to_the_nearest_f64_or_skipped() {
    let mut wrong = 0;
    // Digits are rounded to f64, then to f32. The expected bits were computed in integers.
    for (text, bits) in [
        ("1e-46", 0x0000_0000_u32),
        ("-1e-46", 0x8000_0000),
        ("1e-45", 0x0000_0001),
        ("7.0064923216240854e-46", 0x0000_0000),
        ("1.1754942e-38", 0x007f_ffff),
        ("0.30000000000000000000000001", 0x3e99_999a),
        // Half-way between 1 and the next f32, and one f64 step above half-way.
        ("1.00000005960464477539", 0x3f80_0000),
        ("1.00000005960464500", 0x3f80_0001),
        // The nearest f64 of these digits is exactly half-way, and ties go to even.
        ("1.0000000596046448", 0x3f80_0000),
        ("1.00000005960464477", 0x3f80_0000),
        ("16777217", 0x4b80_0000),
        ("16777219", 0x4b80_0002),
        ("3.4028235e38", 0x7f7f_ffff),
        ("123456789012345678901234567890", 0x6fc7_7488),
    ] {
        let loaded = with_first_number(text).unwrap();
        let got = loaded.model.mesh.positions()[0][0].to_bits();
        if got != bits {
            println!("{text}: {got:08x} and not {bits:08x}");
            wrong += 1;
        }
    }
    for text in ["1e39", "-1e39", "nan", "inf", "-infinity"] {
        let loaded = with_first_number(text).unwrap();
        let kinds: Vec<FindingKind> = loaded.findings.iter().map(|f| f.kind).collect();
        wrong += usize::from(kinds != [FindingKind::VertexNotFinite]);
        wrong += usize::from(loaded.model.mesh.positions().len() != 3);
    }
    // Two decimal points, a word, hexadecimal: the vertex is skipped, and the finding names its
    // line and text.
    for text in ["1.2.3", "one", "0x10", "1e", "--1"] {
        let loaded = with_first_number(text).unwrap();
        let named = matches!(&loaded.findings[..], [only]
            if only.kind == FindingKind::VertexUnreadable
                && only.line == Some(1)
                && only.text.contains(text));
        wrong += usize::from(!named || loaded.model.mesh.positions().len() != 3);
    }
    let loaded = with_first_number("0,5").unwrap();
    wrong += usize::from(loaded.model.mesh.positions()[0][0] != 0.5);
    // atof stops at the comma and keeps the digits before it.
    let comma = "0,5".split(',').next().unwrap().parse::<f64>().unwrap();
    Figure {
        case: 64,
        what: "numbers that are read wrongly, of 25",
        naive: Some(("atof of \"0,5\", off by", 0.5 - comma)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "numbers",
    }
    .hold();
}

#[test]
fn case_65_faces_are_kept_mended_or_left_out_and_concave_ones_are_filled_rightly() {
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let mut wrong = 0;
    for (faces, kind, kept) in [
        ("f 0 1 2\nf 1 2 3\n", FindingKind::FaceRange, 1),
        ("f 1 2 4\nf 1 2 3\n", FindingKind::FaceRange, 1),
        ("f -4 -2 -1\nf -3 -2 -1\n", FindingKind::FaceRange, 1),
        ("f 1 2 99999999999\nf 1 2 3\n", FindingKind::FaceRange, 1),
        // An index of -0, read as relative, would refer to the next vertex.
        ("f -0 1 2\nv 1 1 0\nf 1 2 3\n", FindingKind::FaceRange, 1),
        ("f 1 2\nf 1 2 3\n", FindingKind::FaceShort, 1),
        ("f 1 x 2\nf 1 2 3\n", FindingKind::FaceUnreadable, 1),
        ("f 1 2 2\nf 1 2 3\n", FindingKind::FaceRepeats, 2),
    ] {
        let loaded = read(&format!("{three}{faces}")).unwrap();
        wrong += usize::from(loaded.findings.iter().all(|finding| finding.kind != kind));
        wrong += usize::from(loaded.model.mesh.polygon_count() != kept);
    }
    assert!(read(&format!("{three}f 0 1 2\n")).is_err(), "a file without a usable face");
    assert_eq!(wrong, 0);
    // A star with many points: its triangles have to cover exactly the area of its outline.
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for points in [4, 5, 12, 100, 1001] {
        let place = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / points as f64 / 2.0;
            let radius = if i.is_multiple_of(2) { 1.0 } else { 0.2 };
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let outline: Vec<DVec3> = (0..2 * points).map(place).collect();
        let mut text = String::new();
        for p in &outline {
            text += &format!("v {} {} {}\n", p.x as f32, p.y as f32, p.z);
        }
        let names: Vec<String> = (1..=outline.len()).map(|i| i.to_string()).collect();
        let mesh = read(&format!("{text}f {}\n", names.join(" "))).unwrap().model.mesh;
        let at = |corner: u32| {
            let position = mesh.corners()[corner as usize].position as usize;
            DVec3::from_array(mesh.positions()[position].map(f64::from))
        };
        // Absolute areas, which count a triangle outside the star as an excess.
        let area = |[a, b, c]: [DVec3; 3]| newell([a, b, c].into_iter()).z.abs() / 2.0;
        let filled: f64 = mesh.triangles().iter().map(|t| area(t.corners.map(at))).sum();
        // The shoelace formula, and the naive fan from the first corner.
        let star: f64 = (0..outline.len())
            .map(|i| {
                let (p, q) = (outline[i], outline[(i + 1) % outline.len()]);
                (p.x * q.y - p.y * q.x) / 2.0
            })
            .sum();
        let fan: f64 =
            (2..outline.len()).map(|i| area([outline[0], outline[i - 1], outline[i]])).sum();
        ours = ours.max((filled - star).abs() / star);
        naive = naive.max((fan - star).abs() / star);
    }
    Figure {
        case: 65,
        what: "area of stars with 4 to 1001 points",
        naive: Some(("a fan from the first corner", naive)),
        ours,
        bound: 1e-5,
        unit: "of itself",
    }
    .hold();
}

/// A scene with all its lengths multiplied by a factor.
fn scaled(by: f64, projection: Projection) -> (Scene, View) {
    let turn = DMat4::from_rotation_y(0.6) * DMat4::from_rotation_x(0.3);
    let place = |scale: DVec3, to: DVec3| {
        DMat4::from_translation(to * by) * turn * DMat4::from_scale(scale * by)
    };
    let (mut scene, view) = scene(&[
        (ball(16), place(DVec3::splat(60.0), DVec3::new(-70.0, 10.0, 0.0))),
        (cube(), place(DVec3::new(50.0, 20.0, 70.0), DVec3::new(80.0, 0.0, -60.0))),
    ]);
    let mut camera = scene.selected_camera(&view).clone();
    let lens = Lens::default();
    camera.pose = Tracked::new(Pose::facing_minus_z(DVec3::Z * 400.0 * by));
    camera.lens = Lens {
        near: lens.near * by,
        far: lens.far * by,
        half_size: 200.0 * by,
        parallel_near: lens.parallel_near * by,
        parallel_far: lens.parallel_far * by,
        ..lens
    };
    scene.cameras = List::from_iter([(view.camera, camera)]);
    let fades = Attenuation { constant: 1.0, linear: 1e-3 / by, quadratic: 1e-5 / by / by };
    let lights = scene.lights.iter().map(|(id, light)| {
        let mut light: Light = light.clone();
        light.attenuation = fades;
        if let LightKind::Bulb { .. } = light.kind {
            let position = Tracked::new(DVec3::new(0.0, 90.0, 120.0) * by);
            light.kind = LightKind::Bulb { position, orbit: Orbit::default() };
        }
        (id, light)
    });
    let lights: List<LightId, Light> = lights.collect();
    scene.lights = lights;
    (scene, View { marks: false, projection, ..view })
}

#[test]
fn case_66_a_scene_of_another_size_is_the_same_picture() {
    let mut differ = 0;
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let settings = Settings { arithmetic, ..Settings::default() };
            let picture = |by: f64| -> Picture {
                let (scene, view) = scaled(by, projection);
                draw(&scene, &view, &settings, 128)
            };
            // Powers of two change no mantissa, so the pictures must be equal.
            let first = picture(1.0);
            for exponent in [-90, -40, -20, -10, -1, 1, 10, 20, 40, 90] {
                let other = picture(2.0_f64.powi(exponent));
                let wrong =
                    first.pixels().iter().zip(other.pixels()).filter(|(a, b)| a != b).count();
                if wrong > 0 {
                    println!("2^{exponent} {projection:?} {arithmetic:?}: {wrong} pixels differ");
                }
                differ += wrong;
            }
        }
    }
    // With a far plane at 1e39, squares of near distances underflow in f32 in units of the lens.
    let (mut far, view) = scaled(1.0, Projection::Perspective);
    let mut camera = far.selected_camera(&view).clone();
    camera.lens.far = 1e39;
    far.cameras = List::from_iter([(view.camera, camera)]);
    let [fast, exact] = [Arithmetic::F32, Arithmetic::F64]
        .map(|arithmetic| draw(&far, &view, &Settings { arithmetic, ..Settings::default() }, 128));
    let step = |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    differ += fast.pixels().iter().zip(exact.pixels()).filter(|pair| step(*pair)).count();
    // Normalisation in f32: at a length of 2^-80 the square is 0.
    let tiny = 2.0_f32.powi(-80);
    Figure {
        case: 66,
        what: "pixels that differ at 2^-90 to 2^90 times the size, or with a far plane at 1e39",
        naive: Some((
            "a normal of length 2^-80 by its length in f32",
            f64::from(tiny / (tiny * tiny).sqrt()),
        )),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_67_nothing_and_very_much_are_drawn() {
    // A mesh without faces, and a cube scaled to a point.
    let empty =
        model_of("empty", MeshSource { positions: vec![[0.0; 3]; 3], ..MeshSource::default() });
    let (mut scene, view) =
        scene(&[(empty, DMat4::IDENTITY), (cube(), DMat4::from_scale(DVec3::ZERO))]);
    let view = View { marks: false, ..view };
    let picture = draw(&scene, &view, &Settings::default(), 32);
    let seen = covered(&picture, &scene).iter().filter(|seen| **seen).count();
    edit(&mut scene, ObjectId(10), |object| object.visible = false);
    // Pictures of one pixel, one row, one column, and one size that is not a multiple of the tile.
    for size in [Size::new(1, 1), Size::new(1, 130), Size::new(130, 1), Size::new(65, 63)] {
        let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), size));
        assert_eq!(Renderer::default().render(&plan).size(), size);
    }
    // Sizes up to 2048 x 2048 pixels and 50,000 faces; `cargo test --test proofs -- sizes --whole`
    // checks the others.
    assert_eq!(quick_round("sizes").counts["sizes"], 6);
    Figure {
        case: 67,
        what: "pixels of a mesh without faces, and wrong ones of 0 to 50,000 faces",
        naive: None,
        ours: seen as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}
