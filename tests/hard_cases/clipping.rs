//! Clipping: triangles that reach beyond the view or behind the observer.

use crate::claims::exact::span;
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Filter, Settings};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Fill, List, MeshSource, Object, ObjectId, Pose, Sides, SourceCorner, Surface, Tracked, View,
};
use marraztu_lab::pictures::flat::{self, Flat};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

use super::cases::quick_round;
use super::common::{covered, draw, edit, model, model_of, scene};
use super::figures::Figure;
use super::oracle::{Eye, inside_by, meet};

const SIDE: usize = 128;

/// Builds a scene with one double-sided triangle, seen by the eye at (0, 0, 400).
fn alone(corners: [DVec3; 3]) -> (marraztu_core::scene::Scene, View) {
    let positions = corners.map(|corner| corner.as_vec3().to_array());
    let (mut scene, view) =
        scene(&[(model("triangle", &positions, &[&[0, 1, 2]]), DMat4::IDENTITY)]);
    edit(&mut scene, ObjectId(10), |object: &mut Object| object.sides = Sides::Two);
    (scene, View { marks: false, ..view })
}

/// Counts the pixels of a picture of one triangle that contradict ray casting with a depth range
/// from 1 to 2000. Pixels within a hundredth of a pixel of its border are skipped, because other
/// cases test them.
fn wrong_pixels(corners: [DVec3; 3], picture: &Picture, seen: &[bool]) -> usize {
    let eye = Eye::first(picture.size().width);
    let mut wrong = 0;
    for (i, seen) in seen.iter().enumerate() {
        let (x, y) = (i % eye.side, i / eye.side);
        let within = |dx: f64, dy: f64| {
            let step = 2.0 * eye.tangent / eye.side as f64;
            let ray = eye.ray(x, y) + DVec3::new(dx * step, dy * step, 0.0);
            meet(eye.at, ray, corners).is_some_and(|(t, _)| (1.0..=2000.0).contains(&t))
        };
        // The rays around the centre agree with it only away from the border.
        let around = [(0.0, 0.0), (0.01, 0.0), (-0.01, 0.0), (0.0, 0.01), (0.0, -0.01)]
            .map(|(dx, dy)| within(dx, dy));
        let sure = around.iter().all(|other| *other == around[0]);
        wrong += usize::from(sure && around[0] != *seen);
    }
    wrong
}

#[test]
fn case_11_corners_in_the_observers_plane_harm_nothing() {
    let mut wrong = 0;
    let mut naive = 0.0_f64;
    for w in [0.0, -0.0, 1e-39, -1e-39, 1e-45, 1e-300, 1e-7, -1.0] {
        // The placement moves z = 0 of the file to a distance of w in front of the eye's plane.
        let corners = [[-30.0, -20.0, 0.0], [35.0, -25.0, 0.0], [2.0, 10.0, -300.0]];
        let (mut scene, view) = alone(corners.map(DVec3::from_array));
        let front = DMat4::from_translation(DVec3::new(0.0, 0.0, 400.0 - w));
        edit(&mut scene, ObjectId(10), |object| {
            object.placement = object.placement.replaced(front);
        });
        let placed = corners.map(|corner| front.transform_point3(DVec3::from_array(corner)));
        for light in
            [marraztu_core::accuracy::LightAt::Pixel, marraztu_core::accuracy::LightAt::Vertex]
        {
            let settings = Settings { light, ..Settings::default() };
            let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(SIDE, SIDE)));
            let mut renderer = Renderer::default();
            let picture = renderer.render(&plan).clone();
            wrong += wrong_pixels(placed, &picture, &covered(&picture, &scene));
            for i in 0..64 {
                let depth = renderer.hit(i * 2, 100).map_or(0.5, |hit| hit.depth);
                assert!((0.0..=1.0).contains(&depth), "a depth of {depth} at w {w}");
            }
        }
        // The naive projection divides a corner's x by w.
        naive = naive.max((-30.0 / (w as f32)).abs().into());
    }
    Figure {
        case: 11,
        what: "wrong pixels with w of 0, 1e-39, 1e-45",
        naive: Some(("x / w in f32, in pixels", naive)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_11_scenes_of_absurd_numbers_are_refused_or_drawn() {
    let tally = quick_round("scenes");
    assert!(tally.counts["refusals"] > 1000 && tally.counts["pictures"] > 10_000, "{tally}");
}

#[test]
fn case_12_a_line_through_the_observers_plane_stays_on_its_side() {
    // The line of ancestor A's fault, seen from the origin: one end is 2 behind the eye, the other
    // 1 in front. It meets the near plane, 1/2 in front, at y = -0.3, 1/6 of its length.
    let (behind, front) = (DVec3::new(0.5, 0.2, 2.0), DVec3::new(0.5, -0.4, -1.0));
    let third = DVec3::new(0.5, -2.0, -1.0);
    // Both orders of the ends.
    let pictures = [[behind, front, third], [front, behind, third]].map(|corners| {
        let positions = corners.map(|corner| corner.as_vec3().to_array());
        let line = model("line", &positions, &[&[0, 1, 2], &[2, 1, 0]]);
        let (mut scene, view) = scene(&[(line, DMat4::IDENTITY)]);
        let mut camera = scene.selected_camera(&view).clone();
        camera.pose = Tracked::new(Pose::facing_minus_z(DVec3::ZERO));
        camera.lens.half_angle = 60.0;
        camera.lens.near = 0.5;
        scene.cameras = List::from_iter([(view.camera, camera)]);
        edit(&mut scene, ObjectId(10), |object| object.edge_color = Color::WHITE);
        let view = View { marks: false, fill: Fill::Edges, ..view };
        draw(&scene, &view, &Settings::default(), SIDE)
    });
    let eye = Eye { side: SIDE, at: DVec3::ZERO, tangent: 3.0_f64.sqrt() };
    // The visible part runs from the front end to the near plane.
    let cut = DVec3::new(0.5, -0.3, -0.5);
    let ([x0, y0], [x1, y1]) = (eye.pixel(front), eye.pixel(cut));
    let [wrong_x, wrong_y] = eye.pixel(behind);
    // The distance of a pixel from the visible part of the line, in pixels.
    let off = |x: usize, y: usize| {
        let (px, py) = (x as f64 + 0.5 - x0, y as f64 + 0.5 - y0);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let t = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (px - t * dx).hypot(py - t * dy)
    };
    let mut ours = 0.0_f64;
    for picture in &pictures {
        let drawn = (0..SIDE * SIDE)
            .filter(|i| picture.pixels()[*i] == [255; 4])
            .map(|i| (i % SIDE, i / SIDE))
            // Excludes the edge to the third corner, which goes down from the front end.
            .filter(|(x, _)| *x as f64 > x0 + 1.0);
        let (count, worst) =
            drawn.fold((0, 0.0_f64), |(n, worst), (x, y)| (n + 1, worst.max(off(x, y))));
        assert!(count > 10, "the line is drawn");
        ours = ours.max(worst);
    }
    Figure {
        case: 12,
        what: "a line from (0.5, 0.2, 2) to (0.5, -0.4, -1)",
        naive: Some((
            "its end behind the eye divided by its w",
            off(wrong_x.max(0.0) as usize, wrong_y.max(0.0) as usize),
        )),
        ours,
        bound: 1.0,
        unit: "pixels off",
    }
    .hold();
}

#[test]
fn case_13_two_faces_that_share_a_cut_edge_stay_together() {
    let mut rng = Rng::new(13);
    let (mut wrong, mut parted) = (0, 0);
    let pairs = 400;
    for _ in 0..pairs {
        // Two triangles with a shared edge through the near plane, at distance 1.
        let depth = |rng: &mut Rng| rng.real(-30.0, 30.0) + 399.0;
        let mut corner = |side: f64| {
            let z = depth(&mut rng);
            DVec3::new(rng.real(-9.0, 9.0) + side, rng.real(-9.0, 9.0), z)
        };
        let quad = [corner(-30.0), corner(0.0), corner(30.0), corner(0.0)];
        let positions = quad.map(|corner| corner.as_vec3().to_array());
        // Draws both faces and samples the visible polygon on an 8 x 8 grid.
        let shown = |faces: [&[u32]; 2]| {
            let both = model("pair", &positions, &faces);
            let (mut scene, view) = scene(&[(both, DMat4::IDENTITY)]);
            edit(&mut scene, ObjectId(10), |object| object.sides = Sides::Two);
            let view = View { marks: false, ..view };
            let plan =
                plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(32, 32)));
            let mut renderer = Renderer::default();
            renderer.render(&plan);
            let mut face = |x: usize, y: usize| renderer.hit(x, y).and_then(|hit| hit.polygon);
            (0..64).map(|i| face(i % 8 * 4, i / 8 * 4)).collect::<Vec<_>>()
        };
        let (one, other) = (shown([&[0, 1, 3], &[1, 2, 3]]), shown([&[1, 2, 3], &[0, 1, 3]]));
        // Reversing the order of the faces changes only their numbers. If faces overlap, the
        // nearer one is seen in both orders.
        let turned = |face: Option<u32>| face.map(|face| 1 - face);
        wrong += one.iter().zip(&other).filter(|(a, b)| **a != turned(**b)).count();
        parted += usize::from(parts_where_cut_by_direction(quad[1], quad[3]));
    }
    Figure {
        case: 13,
        what: "samples at which it shows in which order two cut neighbours come",
        naive: Some((
            "edges whose cut has other bits from its other end, of 400",
            f64::from(u32::try_from(parted).unwrap()),
        )),
        ours: wrong as f64,
        bound: 0.0,
        unit: "samples",
    }
    .hold();
}

#[test]
fn case_13_a_face_is_cut_at_the_same_places_from_both_sides() {
    // A face, and the same face with reversed winding. The near plane cuts its edges inside the
    // view; they begin up to 10^13 behind it, where one ulp of their length is as large as a pixel.
    let mut rng = Rng::new(131);
    let (mut wrong, mut parted, mut pixels) = (0, 0, 0);
    for _ in 0..400 {
        let long = rng.one_of(&[1.0, 1e4, 1e9, 1e13]);
        let mut beside =
            |wide: f64| DVec3::new(rng.real(-wide, wide), rng.real(-wide, wide), 399.0);
        let corners = [beside(0.8), beside(9.0 * long), beside(0.8)];
        // Two corners just in front of the near plane, the third far behind it.
        let [near, far] = [rng.real(0.05, 0.9), long * rng.real(1.0, 30.0)];
        let corners = [
            corners[0] - DVec3::Z * near,
            corners[1] + DVec3::Z * far,
            corners[2] - DVec3::Z * (1.0 - near),
        ];
        let positions = corners.map(|corner| corner.as_vec3().to_array());
        let shown = |face: &[u32]| {
            let (mut scene, view) = scene(&[(model("face", &positions, &[face]), DMat4::IDENTITY)]);
            edit(&mut scene, ObjectId(10), |object| object.sides = Sides::Two);
            let view = View { marks: false, ..view };
            let plan =
                plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(64, 64)));
            let mut renderer = Renderer::default();
            renderer.render(&plan);
            let seen = |i: usize| renderer.hit(i % 64, i / 64).is_some();
            (0..64 * 64).map(seen).collect::<Vec<_>>()
        };
        let (one, other) = (shown(&[0, 1, 2]), shown(&[2, 1, 0]));
        pixels += one.iter().filter(|seen| **seen).count();
        wrong += one.iter().zip(&other).filter(|(a, b)| a != b).count();
        let doubles = positions.map(|p| DVec3::from(p.map(f64::from)));
        parted += usize::from(parts_where_cut_by_direction(doubles[0], doubles[1]));
    }
    assert!(pixels > 10_000, "{pixels} pixels were looked at");
    Figure {
        case: 13,
        what: "pixels that a cut face has only one way round, of 400 faces",
        naive: Some((
            "edges whose cut has other bits from its other end, of 400",
            f64::from(u32::try_from(parted).unwrap()),
        )),
        ours: f64::from(u32::try_from(wrong).unwrap()),
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// Whether the cut of an edge has other bits if it is computed from the other end.
fn parts_where_cut_by_direction(a: DVec3, b: DVec3) -> bool {
    let (da, db) = (399.0 - a.z, 399.0 - b.z);
    if (da > 0.0) == (db > 0.0) {
        return false;
    }
    let cut = |a: DVec3, b: DVec3, da: f64, db: f64| a + (b - a) * (da / (da - db));
    cut(a, b, da, db) != cut(b, a, db, da)
}

#[test]
fn case_14_a_corner_on_a_plane_belongs_to_the_view() {
    // The near plane is at z = 399, the far one at z = -1600.
    let near = [
        [DVec3::new(-0.2, -0.2, 399.0), DVec3::new(0.3, -0.1, 399.0), DVec3::new(0.0, 0.3, 399.0)],
        [
            DVec3::new(-0.2, -0.2, 399.0),
            DVec3::new(30.0, -10.0, 300.0),
            DVec3::new(0.0, 30.0, 300.0),
        ],
        [DVec3::new(-0.2, -0.2, 399.0), DVec3::new(3.0, -1.0, 420.0), DVec3::new(0.0, 30.0, 300.0)],
        [
            DVec3::new(-300.0, -200.0, -1600.0),
            DVec3::new(300.0, -200.0, -1600.0),
            DVec3::new(9.0, 300.0, -1600.0),
        ],
        [
            DVec3::new(-300.0, -200.0, -1600.0),
            DVec3::new(300.0, -200.0, -1700.0),
            DVec3::new(9.0, 30.0, 10.0),
        ],
    ];
    let mut wrong = 0;
    let mut seen = 0;
    for corners in near {
        let (scene, view) = alone(corners);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        let covered = covered(&picture, &scene);
        seen += covered.iter().filter(|seen| **seen).count();
        wrong += wrong_pixels(corners, &picture, &covered);
    }
    assert!(seen > 1000);
    Figure {
        case: 14,
        what: "wrong pixels with corners on the near and the far plane",
        naive: Some(("corners on a plane taken for outside: all of them are missing", seen as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_15_a_triangle_through_all_six_planes_is_seen_where_it_is() {
    let mut rng = Rng::new(15);
    let (mut wrong, mut naive) = (0, 0);
    for _ in 0..60 {
        let mut corner = || DVec3::new(0.0, 0.0, 300.0) + rng.vector(4000.0);
        let corners = [corner(), corner(), corner()].map(|c| c.as_vec3().as_dvec3());
        let (scene, view) = alone(corners);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        let covered = covered(&picture, &scene);
        wrong += wrong_pixels(corners, &picture, &covered);
        naive += folded(corners, &covered);
    }
    Figure {
        case: 15,
        what: "wrong pixels of triangles far beyond all planes",
        naive: Some(("corners divided by w and not clipped", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// Counts the wrong pixels if corners are divided by w even behind the eye.
fn folded(corners: [DVec3; 3], covered: &[bool]) -> usize {
    let eye = Eye::first(SIDE);
    let snapped = corners.map(|corner| {
        let [x, y] = eye.pixel(corner).map(|p| (p.clamp(-1e6, 1e6) * 256.0).round() as i32);
        Snapped { x, y }
    });
    let wrong = |i: &usize| {
        let (x, y) = ((i % SIDE) as i64, i32::try_from(i / SIDE).unwrap());
        span(snapped, y).contains(&x) != covered[*i]
    };
    (0..SIDE * SIDE).filter(wrong).count()
}

#[test]
fn case_16_triangles_beyond_the_range_of_integers_are_clipped() {
    let mut rng = Rng::new(116);
    let (mut wrong, mut seen, mut naive) = (0, 0, 0);
    for _ in 0..60 {
        // One corner in view, the others about ten million pixels away.
        let off = |rng: &mut Rng| rng.vector(1.0) * DVec3::new(7e6, 7e6, 50.0);
        let corners = [rng.vector(30.0), off(&mut rng), off(&mut rng)];
        let corners = corners.map(|c| (c + DVec3::Z * 300.0).as_vec3().as_dvec3());
        let (scene, view) = alone(corners);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        let covered = covered(&picture, &scene);
        seen += covered.iter().filter(|seen| **seen).count();
        wrong += wrong_pixels(corners, &picture, &covered);
        // Counts corners with subpixel coordinates beyond i32.
        let beyond = |x: &f64| (x * f64::from(SUBPIXELS)).abs() > f64::from(i32::MAX);
        let eye = Eye::first(SIDE);
        naive += corners.iter().filter(|corner| eye.pixel(**corner).iter().any(beyond)).count();
    }
    assert!(seen > 10_000, "{seen} pixels");
    Figure {
        case: 16,
        what: "wrong pixels of triangles whose corners are ten million pixels off",
        naive: Some(("corners that 32 bits have no room for, of 180", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_16_corners_a_million_pixels_off_leave_no_hole_and_no_double() {
    const SIDE: usize = 512;
    let mut rng = Rng::new(16);
    let (mut wrong, mut naive) = (0, 0);
    for _ in 0..40 {
        // A fan with its hub in the picture and its outline a million pixels away.
        let far = 1_000_000 * SUBPIXELS;
        let coordinate = |rng: &mut Rng, reach: i32| rng.between(-reach, reach) / 16 * 16;
        let hub =
            Snapped { x: rng.between(0, 511) * 256 + 128, y: rng.between(0, 511) * 256 + 128 };
        let (a, b, c, d) = (
            coordinate(&mut rng, far),
            coordinate(&mut rng, far),
            coordinate(&mut rng, far),
            coordinate(&mut rng, far),
        );
        let outline = [(a, -far), (far, b), (c, far), (-far, d)].map(|(x, y)| Snapped { x, y });
        let fan: Vec<Flat> =
            (0..4).map(|i| Flat::new([hub, outline[i], outline[(i + 1) % 4]])).collect();
        // The same fan in both orders.
        let back: Vec<Flat> = fan.iter().rev().copied().collect();
        let draw = |fan: &[Flat]| flat::draw_triangles(fan, SIDE, &mut Renderer::default());
        let (forth, back) = (draw(&fan), draw(&back));
        for (i, (a, b)) in forth.pixels().iter().zip(back.pixels()).enumerate() {
            let [a, b] = [a, b].map(|pixel| flat::number_of(*pixel));
            // Exactly one triangle covers each pixel, the one that integer crossings find; so the
            // first and the last that was drawn are the same.
            let exact = (0..4)
                .find(|n| span(fan[*n].corners, (i / SIDE) as i32).contains(&((i % SIDE) as i64)));
            wrong += usize::from(a != exact || b.map(|b| 3 - b) != exact);
            naive += usize::from(single_counts(&fan, i % SIDE, i / SIDE) != 1);
        }
    }
    Figure {
        case: 16,
        what: "holes and doubles in 40 fans to a million pixels off, of 10 million samples",
        naive: Some(("edge functions in f32", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "samples",
    }
    .hold();
}

/// Counts the triangles of a fan that cover a pixel, by edge functions in f32.
fn single_counts(fan: &[Flat], x: usize, y: usize) -> usize {
    let (cx, cy) = (x as f32 + 0.5, y as f32 + 0.5);
    let single = |corner: Snapped| (corner.x as f32 / 256.0, corner.y as f32 / 256.0);
    let covers = |triangle: &&Flat| {
        let [p, q, r] = triangle.corners.map(single);
        let edge = |p: (f32, f32), q: (f32, f32)| {
            (p.1 - q.1) * cx + (q.0 - p.0) * cy + (p.0 * q.1 - p.1 * q.0)
        };
        let edges = [edge(p, q), edge(q, r), edge(r, p)];
        edges.iter().all(|e| *e >= 0.0) || edges.iter().all(|e| *e <= 0.0)
    };
    fan.iter().filter(covers).count()
}

#[test]
fn case_17_triangles_larger_than_32_bits_of_edge_are_filled_rightly() {
    const SIDE: usize = 1024;
    let mut rng = Rng::new(17);
    let (mut wrong, mut naive) = (0, 0);
    for _ in 0..30 {
        let mut corner =
            || Snapped { x: rng.between(-200_000, 400_000), y: rng.between(-200_000, 400_000) };
        let corners = [corner(), corner(), corner()];
        let picture = flat::draw_triangles(&[Flat::new(corners)], SIDE, &mut Renderer::default());
        for (i, pixel) in picture.pixels().iter().enumerate() {
            let exact = span(corners, (i / SIDE) as i32).contains(&((i % SIDE) as i64));
            wrong += usize::from(flat::number_of(*pixel).is_some() != exact);
            naive += usize::from(wrapping_covers(corners, i % SIDE, i / SIDE) != exact);
        }
    }
    Figure {
        case: 17,
        what: "wrong samples of large triangles, of 31 million",
        naive: Some(("edge functions in i32", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "samples",
    }
    .hold();
}

/// Whether edge functions of 32 bits, which overflow, cover a pixel.
fn wrapping_covers([p, q, r]: [Snapped; 3], x: usize, y: usize) -> bool {
    let (cx, cy) = (x as i32 * 256 + 128, y as i32 * 256 + 128);
    let edge = |p: Snapped, q: Snapped| {
        let a = (q.x - p.x).wrapping_mul(cy - p.y);
        a.wrapping_sub((q.y - p.y).wrapping_mul(cx - p.x))
    };
    let edges = [edge(p, q), edge(q, r), edge(r, p)];
    edges.iter().all(|e| *e >= 0) || edges.iter().all(|e| *e <= 0)
}

#[test]
fn case_18_objects_behind_the_observer_are_invisible() {
    let mut rng = Rng::new(18);
    let (mut drawn, mut naive) = (0, 0);
    for _ in 0..50 {
        let mut corner = || DVec3::new(0.0, 0.0, 600.0) + rng.vector(190.0);
        let corners = [corner(), corner(), corner()];
        let (scene, view) = alone(corners);
        let plan =
            plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE)));
        let mut renderer = Renderer::default();
        let picture = renderer.render(&plan);
        drawn += covered(picture, &scene).iter().filter(|seen| **seen).count();
        drawn += renderer.triangles_drawn();
        naive += folded(corners, &vec![false; SIDE * SIDE]);
    }
    Figure {
        case: 18,
        what: "pixels and triangles from behind the eye",
        naive: Some(("corners divided by w and not clipped", naive as f64)),
        ours: drawn as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// A texture with 256 texels in a row. The colour of a texel is its index.
pub(super) fn ruler(scale: f64) -> marraztu_core::base::Shared<marraztu_core::scene::Texture> {
    let texels = (0..=255).map(|i| [i, i, i, 255]).collect();
    let picture = Picture::from_pixels(Size::new(256, 1), texels).unwrap();
    let once = marraztu_core::scene::Texture::new("", picture);
    marraztu_core::scene::Texture { scale: [scale, 1.0], ..once }.into()
}

/// A triangle with a texture coordinate u at each corner.
pub(super) fn textured(
    corners: [DVec3; 3],
    u: [f32; 3],
    texture: &marraztu_core::base::Shared<marraztu_core::scene::Texture>,
) -> (marraztu_core::scene::Scene, View) {
    let source = MeshSource {
        positions: corners.map(|corner| corner.as_vec3().to_array()).to_vec(),
        uvs: u.map(|u| [u, 0.5]).to_vec(),
        ..MeshSource::of_polygons(
            [0, 1, 2].map(|i| SourceCorner {
                position: i,
                uv: i,
                normal: marraztu_core::scene::NONE,
            }),
            vec![3],
        )
    };
    let (mut scene, view) = scene(&[(model_of("triangle", source), DMat4::IDENTITY)]);
    edit(&mut scene, ObjectId(10), |object| {
        object.sides = Sides::Two;
        object.surface = Surface::Texture;
        object.texture = Some(texture.clone());
    });
    (scene, View { marks: false, ..view })
}

#[test]
fn case_19_clipping_a_face_does_not_move_its_texture() {
    let mut rng = Rng::new(19);
    // One texel is 2^-22, twice the f32 epsilon.
    let scale = f64::from(1 << 14);
    let ulp = f64::from(f32::EPSILON);
    let settings = Settings { filter: Filter::Nearest, ..Settings::default() };
    let (mut ours, mut naive, mut pixels) = (0.0_f64, 0.0_f64, 0);
    for _ in 0..60 {
        let mut corner = |z: f64| {
            DVec3::new(rng.real(-90.0, 90.0), rng.real(-90.0, 90.0), z + rng.real(-9.0, 9.0))
                .as_vec3()
                .as_dvec3()
        };
        // The first corner is behind the eye, so the near plane cuts the face.
        let corners = [corner(430.0), corner(100.0), corner(-200.0)];
        let (scene, view) = textured(corners, [0.0, 0.25, 1.0], &ruler(scale));
        let picture = draw(&scene, &view, &settings, SIDE);
        let eye = Eye::first(SIDE);
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let Some((t, parts)) = meet(eye.at, eye.ray(x, y), corners) else { continue };
            let [r, g, b, _] = picture.pixel(x, y);
            if inside_by(parts) < 1e-3 || !(1.1..1900.0).contains(&t) || (r, r) != (g, b) {
                continue;
            }
            let u = parts[1] * 0.25 + parts[2];
            // The shorter distance around the repeating texture.
            let texels = (u * scale).fract() * 256.0 - (f64::from(r) + 0.5);
            let off = (texels.rem_euclid(256.0)).min((-texels).rem_euclid(256.0));
            // Errors below half a texel are invisible.
            ours = ours.max((off - 0.5).max(0.0) / 256.0 / scale / ulp);
            pixels += 1;
            naive = naive.max((single_cut(corners, eye, [x, y]) - u).abs() / ulp);
        }
    }
    assert!(pixels > 5000, "{pixels} pixels are looked at");
    Figure {
        case: 19,
        what: "place on the texture of a face through the near plane",
        naive: Some(("the cut's own corners, in f32", naive)),
        ours,
        bound: 4.0,
        unit: "ulp of 1",
    }
    .hold();
}

/// Interpolates u as if the corners of the cut were ordinary corners in f32.
fn single_cut(corners: [DVec3; 3], eye: Eye, [x, y]: [usize; 2]) -> f64 {
    let [a, b, c] = corners;
    let cut = |to: DVec3, u: f64| {
        let t = (399.0 - a.z) / (to.z - a.z);
        ((a + (to - a) * t).as_vec3(), (u * t) as f32)
    };
    let [(p, up), (q, uq)] = [cut(b, 0.25), cut(c, 1.0)];
    let at = eye.at.as_vec3();
    let ray = eye.ray(x, y).as_vec3();
    let b = (b.as_vec3(), 0.25_f32);
    let c = (c.as_vec3(), 1.0_f32);
    // The cut leaves a quad, interpolated as two triangles.
    for [(k, uk), (l, ul), (m, um)] in [[(p, up), b, c], [(p, up), c, (q, uq)]] {
        let (e, f) = (l - k, m - k);
        let h = ray.cross(f);
        let determinant = e.dot(h);
        let from = at - k;
        let n = from.cross(e);
        let (v, w) = (from.dot(h) / determinant, ray.dot(n) / determinant);
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return f64::from(uk + (ul - uk) * v + (um - uk) * w);
        }
    }
    f64::NAN
}
