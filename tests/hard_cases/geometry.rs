//! Normals, placements, mirrored scenes, and degenerate shapes.

use crate::claims::double_double::Double;
use glam::{DMat3, DMat4, DVec3};
use marraztu_core::accuracy::Settings;
use marraztu_core::base::math;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, Refusal, placement};
use marraztu_core::scene::{
    Frame, Light, LightId, LightKind, List, ObjectId, Scene, Sides, Subject, Tracked,
    Transformation, View, newell,
};
use marraztu_render::screen::coverage::{Snapped, Triangle, doubled_area};

use super::camera::{apply, desk, linear};
use super::common::{at, ball, covered, cube, draw, edit, model, scene};
use super::figures::Figure;
use super::oracle::angle;

/// a b - c d in double-double.
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    (Double::from(a) * Double::from(b) - Double::from(c) * Double::from(d)).nearest()
}

/// The exact normal of a triangle: differences of f32 corners are exact in f64.
fn exact_normal([p, q, r]: [[f32; 3]; 3]) -> DVec3 {
    let from = |a: [f32; 3], b: [f32; 3], i: usize| f64::from(b[i]) - f64::from(a[i]);
    let axis = |i: usize, j: usize| {
        difference_of_products(from(p, q, i), from(p, r, j), from(p, q, j), from(p, r, i))
    };
    DVec3::new(axis(1, 2), axis(2, 0), axis(0, 1))
}

/// Newell's sum of p x q over the sides, as textbooks have it, in f32.
fn naive_normal(corners: [[f32; 3]; 3]) -> DVec3 {
    let mut sum = [0.0_f32; 3];
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        for (axis, sum) in sum.iter_mut().enumerate() {
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += p[j] * q[k] - p[k] * q[j];
        }
    }
    DVec3::from_array(sum.map(f64::from))
}

#[test]
fn case_1_a_triangle_of_two_millimetres_half_a_kilometre_away_keeps_its_normal() {
    let mut rng = Rng::new(1);
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for _ in 0..500 {
        let middle = DVec3::splat(500.0) + rng.vector(1.0);
        let corners = [0, 1, 2].map(|_| (middle + rng.vector(0.001)).as_vec3().to_array());
        let exact = exact_normal(corners);
        // Twice the area. Slivers are tested by another case.
        if exact.length() < 5e-7 {
            continue;
        }
        let model = model("small", &corners, &[&[0, 1, 2]]);
        let normal = DVec3::from_array(model.mesh.polygon_normals()[0].map(f64::from));
        ours = ours.max(angle(normal, exact).to_degrees());
        naive = naive.max(angle(naive_normal(corners), exact).to_degrees());
    }
    Figure {
        case: 1,
        what: "normal of a 2 mm triangle 500 units off",
        naive: Some(("the sum of p x q in f32", naive)),
        ours,
        bound: 0.01,
        unit: "degrees",
    }
    .hold();
}

#[test]
fn case_2_a_difference_of_products_keeps_its_digits() {
    let mut rng = Rng::new(2);
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for _ in 0..10_000 {
        // Integers of 23 bits, for which i64 has the exact result.
        let [a, b] = [0, 1].map(|_| rng.between(1 << 22, 1 << 23));
        let (c, d) = (a + rng.between(-2, 2), b + rng.between(-2, 2));
        let exact = (i64::from(a) * i64::from(d) - i64::from(b) * i64::from(c)) as f64;
        if exact == 0.0 {
            continue;
        }
        let corner = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.0);
        let got = newell([DVec3::ZERO, corner(a, b), corner(c, d)].into_iter()).z;
        let ulp = exact.abs() * f64::EPSILON;
        ours = ours.max((got - exact).abs() / ulp);
        let [a, b, c, d] = [a, b, c, d].map(|x| x as f32);
        let single = f64::from(a * d - b * c);
        naive = naive.max((single - exact).abs() / (exact.abs() * f64::from(f32::EPSILON)));
    }
    Figure {
        case: 2,
        what: "a d - b c of 23 bits each",
        naive: Some(("in f32", naive)),
        ours,
        bound: 2.0,
        unit: "ulp",
    }
    .hold();
}

/// A vernier that locates the screen to 1/10,000 pixel: strips of one row each, with left sides at
/// offsets around a pixel centre that grow by 1/10,000 pixel per row.
struct Vernier {
    corners: Vec<[f32; 3]>,
    /// The offset of each strip's left side from the pixel centre, to the right.
    offsets: Vec<f64>,
}

const ROWS: usize = 256;
const COLUMN: f64 = 140.5;

impl Vernier {
    /// Builds the strips; `unit` is the size of a pixel at their distance.
    fn new(unit: f64) -> Self {
        let (mut corners, mut offsets) = (Vec::new(), Vec::new());
        for row in 0..ROWS {
            let offset = (row as f64 - 128.0) * 1e-4;
            let x = |pixels: f64| ((pixels - 128.0) * unit) as f32;
            let y = |pixels: f64| ((128.0 - pixels) * unit) as f32;
            let (left, right) = (x(COLUMN + offset), x(COLUMN + 3.0));
            // From a quarter row above the row's centre to a quarter below.
            let (top, bottom) = (y(row as f64 + 0.25), y(row as f64 + 0.75));
            for (x, y) in [(left, bottom), (right, bottom), (right, top), (left, top)] {
                corners.push([x, y, 0.0]);
            }
            // The offset after rounding to f32.
            offsets.push(f64::from(left) / unit + 128.0 - COLUMN);
        }
        Self { corners, offsets }
    }
}

#[test]
fn case_3_screen_positions_are_stable_far_from_the_origin() {
    // At a distance of 100, with 45 degrees across 256 pixels.
    let tangent = 2.0_f64.sqrt() - 1.0;
    let vernier = Vernier::new(200.0 * tangent / ROWS as f64);
    let polygons: Vec<[u32; 4]> =
        (0..ROWS as u32).map(|i| [0, 1, 2, 3].map(|corner| 4 * i + corner)).collect();
    let polygons: Vec<&[u32]> = polygons.iter().map(<[u32; 4]>::as_slice).collect();
    let strips = model("vernier", &vernier.corners, &polygons);
    for (far, name) in [
        (0.0, "screen position, camera at the origin"),
        (500.0, "screen position, camera at 500"),
        (5e3, "screen position, camera at 5e3"),
        (1e5, "screen position, camera at 1e5"),
    ] {
        // Positions that f32 cannot represent.
        let away = DVec3::new(far, -far, far) * (1.0 + 1.0 / 3e3);
        let (mut scene, view) =
            scene(&[(strips.clone(), DMat4::from_translation(away + DVec3::Z * 300.0))]);
        // Camera and scene move together, so the picture must not change.
        let mut camera = scene.selected_camera(&view).clone();
        camera.pose =
            Tracked::new(marraztu_core::scene::Pose::facing_minus_z(away + DVec3::Z * 400.0));
        scene.cameras = List::from_iter([(view.camera, camera)]);
        let view = View { marks: false, ..view };
        let picture = draw(&scene, &view, &Settings::default(), ROWS);
        let seen = covered(&picture, &scene);
        // Snapping moves corners up to 1/512 pixel right of the centre onto it; those still cover
        // it.
        let mut ours = 0.0_f64;
        for (row, offset) in vernier.offsets.iter().enumerate() {
            let past = offset - 1.0 / 512.0;
            if seen[row * ROWS + 140] != (past <= 0.0) {
                ours = ours.max(past.abs());
            }
        }
        let naive = naive_shift(&vernier, away, tangent);
        Figure {
            case: 3,
            what: name,
            naive: (far > 1e4).then_some(("places of the world in f32", naive)),
            ours,
            bound: 0.001,
            unit: "pixels",
        }
        .hold();
    }
}

/// The largest shift of the strips' left sides if world positions are f32.
fn naive_shift(vernier: &Vernier, away: DVec3, tangent: f64) -> f64 {
    let mut worst = 0.0_f64;
    let single = |x: f64| x as f32;
    for (corners, offset) in vernier.corners.chunks(4).zip(&vernier.offsets) {
        let world = [corners[0][0] + single(away.x), single(away.z + 300.0)];
        let view = [world[0] - single(away.x), world[1] - single(away.z + 400.0)];
        let pixel = 128.0 + f64::from(view[0]) / -f64::from(view[1]) / tangent * 128.0;
        worst = worst.max((pixel - COLUMN - offset).abs());
    }
    worst
}

#[test]
fn case_4_normals_of_stretched_objects_stay_across_their_surfaces() {
    let mut rng = Rng::new(4);
    for (stretch, what) in
        [(2.0, "normals under a stretch of 1:2"), (10.0, "normals under a stretch of 1:10")]
    {
        let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
        for _ in 0..1000 {
            let m = math::rotation(super::oracle::unit(rng.vector(1.0)), rng.real(0.0, 6.0))
                * DMat3::from_diagonal(DVec3::new(1.0, stretch, 1.0));
            let (p, q) = (rng.vector(1.0), rng.vector(1.0));
            // The expected normal is perpendicular to two transformed tangents.
            let (n, exact) = (p.cross(q), (m * p).cross(m * q));
            if n.length() < 0.1 {
                continue;
            }
            ours = ours.max(angle(math::normal_matrix(m) * n, exact));
            naive = naive.max(angle(m * n, exact));
        }
        Figure {
            case: 4,
            what,
            naive: Some(("the matrix as it is", naive)),
            ours,
            bound: 1e-6,
            unit: "radians",
        }
        .hold();
    }
}

#[test]
fn case_5_an_object_made_smaller_329_times_is_still_an_object() {
    let (mut scene, view) = desk(Subject::Object, Transformation::Scaling);
    let mut single = 1.0_f32;
    for _ in 0..329 {
        let command = transform::scale(&scene, &view, 0.9, GesturePhase::First);
        apply(&mut scene, command);
        single *= 0.9;
    }
    let m = linear(&scene, &view);
    // The expected size, in double-double.
    let nine_tenths = Double::from(0.9);
    let exact = (0..329).fold(Double::ONE, |power, _| power * nine_tenths).nearest();
    assert!(m.is_finite() && math::has_full_rank(m));
    Figure {
        case: 5,
        what: "size after 329 steps of 0.9",
        naive: Some((
            "its volume in f32, which is 0",
            f64::from(1.0 - (single * single * single).min(1.0)),
        )),
        ours: (m.x_axis.x / exact - 1.0).abs(),
        bound: 1e-12,
        unit: "of itself",
    }
    .hold();
    for _ in 0..329 {
        let command = transform::take_back(&scene, &view);
        apply(&mut scene, command);
    }
    assert_eq!(linear(&scene, &view), DMat3::IDENTITY);
}

#[test]
fn case_6_a_mirrored_scene_gives_the_mirrored_picture() {
    const SIDE: usize = 200;
    let picture = |sign: f64| {
        let mirror = DMat4::from_scale(DVec3::new(sign, 1.0, 1.0));
        let turn = DMat4::from_rotation_z(0.3) * DMat4::from_rotation_x(0.4);
        let (mut scene, view) = scene(&[
            (ball(12), mirror * at(60.1, 50.3, 10.7, 0.0)),
            (cube(), mirror * at(40.3, -70.9, -20.1, 30.0) * turn),
        ]);
        let lights = [
            LightKind::Ambient,
            LightKind::Sun {
                direction: Tracked::new(super::oracle::unit(DVec3::new(-sign, -2.0, -1.0))),
            },
            LightKind::Bulb {
                position: Tracked::new(DVec3::new(90.0 * sign, 60.0, 150.0)),
                orbit: marraztu_core::scene::Orbit::default(),
            },
        ];
        let lights = lights.into_iter().zip(1..);
        scene.lights =
            lights.map(|(kind, id)| (LightId(id), Light::new("light", id, kind))).collect();
        let view = View { marks: false, light: None, ..view };
        draw(&scene, &view, &Settings::default(), SIDE)
    };
    // The mirrored picture, read from right to left, equals the plain one.
    let (plain, mirrored) = (picture(1.0), picture(-1.0));
    let mut differ = 0;
    let mut drawn = 0;
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        drawn += usize::from(plain.pixel(x, y) != plain.pixel(0, 0));
        differ += usize::from(plain.pixel(x, y) != mirrored.pixel(SIDE - 1 - x, y));
    }
    assert!(drawn > 5000, "there is something to see");
    // The naive renderer takes front faces from the sign of the area alone and culls every visible
    // face.
    Figure {
        case: 6,
        what: "pixels that are not those of the mirrored picture",
        naive: Some(("fronts by the area alone: all of both objects", drawn as f64)),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_7_a_scale_of_zero_is_refused_whatever_way_it_comes() {
    let (scene, view) = desk(Subject::Object, Transformation::Scaling);
    let id = view.object.unwrap();
    for factors in [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -0.0, 1.0)] {
        for frame in [Frame::Local, Frame::Global] {
            let view = View { frame, ..view.clone() };
            let dragged = transform::stretch(&scene, &view, factors, GesturePhase::First);
            assert_eq!(dragged, Err(Refusal::Flat));
        }
        let typed = placement::object_scale(&scene, &view, id, factors, GesturePhase::First);
        assert_eq!(typed, Err(Refusal::Flat));
    }
    let mut view = view;
    view.steps.scaling = 0.0;
    for sign in [Sign::Positive, Sign::Negative] {
        assert!(transform::step(&scene, &view, math::Axis::X, sign, GesturePhase::First).is_err());
    }
}

#[test]
fn case_7_a_placement_without_room_draws_nothing() {
    let (mut scene, view) = scene(&[(cube(), at(50.0, 0.0, 0.0, 0.0))]);
    let mut drawn = 0;
    for flat in [
        DVec3::new(50.0, 50.0, 0.0),
        DVec3::new(0.0, 50.0, 0.0),
        DVec3::ZERO,
        DVec3::new(f64::MIN_POSITIVE, 50.0, 50.0),
    ] {
        edit(&mut scene, ObjectId(10), |object| {
            object.placement = object.placement.replaced(DMat4::from_scale(flat));
            object.sides = Sides::Two;
        });
        let view = View { marks: false, vertex_normals: true, ..view.clone() };
        let picture = draw(&scene, &view, &Settings::default(), 64);
        drawn += covered(&picture, &scene).iter().filter(|seen| **seen).count();
    }
    let inverse = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)).inverse();
    Figure {
        case: 7,
        what: "pixels of a flat object",
        naive: Some(("the inverse of its matrix", (inverse * DVec3::ZERO).x)),
        ours: drawn as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_8_vectors_of_any_length_are_brought_to_length_one() {
    let mut ours = 0.0_f64;
    let mut naive = 0.0_f64;
    let mut rng = Rng::new(8);
    for exponent in [-1030, -700, -150, -76, 0, 67, 700, 1020] {
        // In two steps, because the smallest powers of two are subnormal.
        let size = 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2);
        for _ in 0..500 {
            let v = rng.vector(1.0);
            let got = math::unit(v * size).unwrap();
            // The oracle normalises the unscaled vector in double-double. Both have the same
            // direction, except that subnormal numbers lose digits; hence the wider bound.
            let square = |x: f64| Double::from(x) * Double::from(x);
            let length = (square(v.x) + square(v.y) + square(v.z)).sqrt();
            for i in 0..3 {
                let exact = (Double::from(v[i]) / length).nearest();
                let bound = if size > 1e-300 { f64::EPSILON } else { 1e-13 };
                ours = ours.max((got[i] - exact).abs() / bound);
            }
            let single = (v * size).as_vec3();
            let by_length = single / single.dot(single).sqrt();
            let length = f64::from(by_length.length());
            naive = naive.max(if length.is_nan() { 1.0 } else { (length - 1.0).abs() } / 6e-8);
        }
    }
    assert_eq!(math::unit(DVec3::ZERO), None, "who asks has to say what then");
    assert_eq!(math::unit(DVec3::splat(f64::INFINITY)), None);
    Figure {
        case: 8,
        what: "unit vectors from 2^-1030 to 2^1020",
        naive: Some(("v / sqrt(v.v) in f32", naive)),
        ours,
        bound: 2.0,
        unit: "ulp",
    }
    .hold();
}

#[test]
fn case_9_shapes_without_area_have_no_pixel() {
    let corner = |x: i32, y: i32| Snapped { x, y };
    let mut naive = 0.0;
    for corners in [
        [corner(0, 0), corner(0, 0), corner(0, 0)],
        [corner(128, 128), corner(640, 640), corner(128, 128)],
        [corner(0, 0), corner(128, 128), corner(1024, 1024)],
        [corner(-256, 128), corner(1024, 128), corner(512, 128)],
    ] {
        assert_eq!(Triangle::new(corners), None, "{corners:?}");
        let area = doubled_area(corners) as f64;
        naive = area / area;
    }
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let polygons: [&[u32]; 5] = [&[0, 0, 0], &[0, 1, 0], &[0, 1, 2], &[1, 1, 3, 3], &[0, 1, 2, 1]];
    let mut drawn = 0;
    for polygon in polygons {
        let (mut scene, view) =
            scene(&[(model("none", &positions, &[polygon]), at(60.0, -60.0, 0.0, 0.0))]);
        edit(&mut scene, ObjectId(10), |object| object.sides = Sides::Two);
        let view = View { marks: false, ..view };
        let picture = draw(&scene, &view, &Settings::default(), 64);
        drawn += covered(&picture, &scene).iter().filter(|seen| **seen).count();
    }
    Figure {
        case: 9,
        what: "pixels of faces without area",
        naive: Some(("an edge function by the area", naive)),
        ours: drawn as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_10_normals_that_cancel_out_fall_back_to_face_normals() {
    // A triangle with both windings: at each vertex the two face normals cancel except for
    // rounding.
    let picture = |model| {
        let (scene, view) = scene(&[(model, at(60.0, 20.0, -10.0, 0.0))]);
        draw(&scene, &View { marks: false, ..view }, &Settings::default(), 64)
    };
    let mut rng = Rng::new(10);
    let mut differ = 0;
    for _ in 0..30 {
        let corners = [0, 1, 2].map(|_| rng.vector(1.0).as_vec3().to_array());
        let one = picture(model("side", &corners, &[&[0, 1, 2]]));
        let two = picture(model("leaf", &corners, &[&[0, 1, 2], &[2, 1, 0]]));
        // If the single face is seen from behind, the leaf shows its other side.
        let background = Scene::BACKGROUND.opaque();
        let both = one.pixels().iter().zip(two.pixels());
        differ += both.filter(|(one, two)| **one != background && one != two).count();
    }
    let sum = DVec3::Z + DVec3::NEG_Z;
    Figure {
        case: 10,
        what: "pixels of a leaf that are not those of its one side",
        naive: Some(("the mean of its normals, brought to length 1", (sum / sum.length()).z)),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}
