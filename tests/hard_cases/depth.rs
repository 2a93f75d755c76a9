//! Depth: which surface is in front.

use crate::claims::double_double::Double;
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Command, ItemId, MaterialChoice, ObjectId, PresetId, Projection, Scene, Sides, Surface, View,
};
use marraztu_lab::pictures::flat::{self, FAR, Flat};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

use super::common::{at, draw, edit, model, scene, square};
use super::figures::Figure;
use super::oracle::{Eye, meet};

const SIDE: usize = 64;

/// Perspective depth at a distance, with planes at 1 and 2000: 0 near, 1 far.
fn usual(z: f64) -> f64 {
    2000.0 / 1999.0 * (1.0 - 1.0 / z)
}

/// Counts the pixels that show the farther of two squares, `gap` apart, that fill the view. The
/// farther one is older and wins ties, so it is seen exactly if the depths merge or swap.
fn hidden_ones(z: f64, gap: f64, projection: Projection) -> usize {
    let place = |z: f64| at(z.max(600.0), 0.0, 0.0, 400.0 - z);
    let (mut scene, view) = scene(&[(square(), place(z + gap)), (square(), place(z))]);
    edit(&mut scene, ObjectId(11), |object| {
        object.material = MaterialChoice::Preset(PresetId::EMERALD);
    });
    let view = View { marks: false, projection, ..view };
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(8, 8)));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    renderer.pixels_of(ItemId::Object(ObjectId(10))).into_iter().filter(|seen| *seen).count()
}

#[test]
fn case_30_at_a_thousand_units_a_ten_thousandth_is_resolved() {
    // One step of reversed f32 at z = 1000 is 5.8e-5; two roundings can add up to two steps.
    let separated = |gap: f64| hidden_ones(1000.0, gap, Projection::Perspective) == 0;
    let mut gap = 1e-6;
    while !separated(gap) {
        gap *= 1.1;
    }
    // The least gap that other depth formats separate, computed from the formula alone.
    let naive = |merged: &dyn Fn(f64) -> bool| {
        let mut gap = 1e-6;
        while merged(gap) {
            gap *= 1.1;
        }
        gap
    };
    let single = naive(&|gap| usual(1000.0) as f32 == usual(1000.0 + gap) as f32);
    let bits = |bits: i32| {
        let steps = f64::from((1 << bits) - 1);
        naive(&move |gap| {
            (usual(1000.0) * steps).round() as i32 == (usual(1000.0 + gap) * steps).round() as i32
        })
    };
    for (how, naive) in [
        ("f32 from 0 near to 1 far", single),
        ("24 bits, by number", bits(24)),
        ("16 bits, by number", bits(16)),
    ] {
        let what = match how {
            "16 bits, by number" => "least distance told apart at z 1000, against 16 bits",
            "24 bits, by number" => "least distance told apart at z 1000, against 24 bits",
            _ => "least distance told apart at z 1000, against f32",
        };
        Figure {
            case: 30,
            what,
            naive: Some((how, naive)),
            ours: gap,
            bound: 1.2e-4,
            unit: "units",
        }
        .hold();
    }
}

#[test]
fn case_31_surfaces_a_thousandth_apart_are_resolved_up_to_two_thousand_units() {
    let (mut wrong, mut naive) = (0, 0);
    let steps = f64::from((1 << 24) - 1);
    for i in 0..400 {
        let z = 2.0 + 1997.0 * f64::from(i) / 400.0;
        wrong += hidden_ones(z, 1e-3, Projection::Perspective);
        let fixed = |z: f64| (usual(z) * steps).round() as i64;
        naive += 64 * usize::from(fixed(z) == fixed(z + 1e-3));
    }
    Figure {
        case: 31,
        what: "wrong pixels of 400 pairs 0.001 apart from z 2 to 2000",
        naive: Some(("24 bits, by number", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_32_of_the_same_plane_cut_otherwise_the_older_is_seen() {
    // Drawn on the test stage, where corners and depths are exact: both cuts lie in the same plane.
    const SIDE: usize = 256;
    let mut rng = Rng::new(32);
    let (mut level, mut leaning, mut pixels) = (0, 0, 0);
    for i in 0..40 {
        let far = SIDE as i32 * SUBPIXELS;
        let (x0, y0) = (rng.between(0, far / 2), rng.between(0, far / 2));
        let (x1, y1) = (x0 + rng.between(256, far / 2), y0 + rng.between(256, far / 2));
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Snapped { x, y });
        let lean = if i % 2 == 0 { 0.0 } else { 64.0 };
        let distances = [300.0, 300.0 + lean, 300.0 + 3.0 * lean, 300.0 + 2.0 * lean];
        let triangle = |of: [usize; 3]| Flat {
            corners: of.map(|i| corners[i]),
            distances: of.map(|i| distances[i]),
        };
        // The two ways to cut a quad along a diagonal.
        let old = vec![triangle([0, 1, 2]), triangle([0, 2, 3])];
        let new = vec![triangle([1, 2, 3]), triangle([1, 3, 0])];
        let picture = flat::draw(&flat::scene(&[old, new], SIDE), SIDE, &mut Renderer::default());
        for pixel in picture.pixels() {
            let Some(number) = flat::number_of(*pixel) else { continue };
            pixels += 1;
            let count = if lean == 0.0 { &mut level } else { &mut leaning };
            *count += usize::from(number >= 2);
        }
    }
    assert!(pixels > 100_000);
    Figure {
        case: 32,
        what: "pixels of a plane that faces the eye that show the younger",
        naive: None,
        ours: level as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
    // On a leaning plane each cut rounds its depth once, from its own corners, so either may be one
    // ulp nearer. The figure states the share of such pixels.
    Figure {
        case: 32,
        what: "pixels of a leaning plane that show the younger, by the last place of depth",
        naive: None,
        ours: 100.0 * leaning as f64 / f64::from(u32::try_from(pixels).unwrap()),
        bound: 35.0,
        unit: "percent",
    }
    .hold();
}

/// Depth at a pixel centre in double-double: integer edge functions divided by their sum.
fn exact_depth(flat: &Flat, x: i32, y: i32) -> f64 {
    let [p, q, r] = flat.corners;
    let edge = |p: Snapped, q: Snapped| {
        let (cx, cy) = (i64::from(x) * 256 + 128, i64::from(y) * 256 + 128);
        let e = (i64::from(q.x) - i64::from(p.x)) * (cy - i64::from(p.y))
            - (i64::from(q.y) - i64::from(p.y)) * (cx - i64::from(p.x));
        Double::from(e as f64)
    };
    let parts = [edge(q, r), edge(r, p), edge(p, q)];
    let depth = |i: usize| Double::from(1.0 - flat.distances[i] / FAR);
    let sum = parts[0] + parts[1] + parts[2];
    ((parts[0] * depth(0) + parts[1] * depth(1) + parts[2] * depth(2)) / sum).nearest()
}

/// The same depth by a plane equation through the corners, in f32.
fn planar_depth(flat: &Flat, x: i32, y: i32) -> f64 {
    planar(flat.corners, flat.distances.map(|d| (1.0 - d / FAR) as f32), x, y)
}

/// The value at a pixel centre, by a plane equation in f32 through the values at the corners.
pub(super) fn planar(corners: [Snapped; 3], values: [f32; 3], x: i32, y: i32) -> f64 {
    let [p, q, r] = corners.map(|c| [c.x as f32 / 256.0, c.y as f32 / 256.0]);
    let [a, b, c] = values;
    let (e, f) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    let area = e[0] * f[1] - e[1] * f[0];
    let dx = ((b - a) * f[1] - (c - a) * e[1]) / area;
    let dy = ((c - a) * e[0] - (b - a) * f[0]) / area;
    let constant = a - dx * p[0] - dy * p[1];
    f64::from(constant + dx * (x as f32 + 0.5) + dy * (y as f32 + 0.5))
}

#[test]
fn case_33_on_slivers_depth_is_right_to_two_last_places_and_within_the_corners() {
    const SIDE: usize = 512;
    let mut rng = Rng::new(33);
    let (mut ours, mut naive, mut pixels, mut outside) = (0.0_f64, 0.0_f64, 0, 0);
    for _ in 0..300 {
        // Slivers: as long as the picture and a few 1/256 pixel wide.
        let along = |rng: &mut Rng| rng.between(0, SIDE as i32 * SUBPIXELS);
        let (x, y) = (along(&mut rng), along(&mut rng));
        let (tx, ty) = (along(&mut rng), along(&mut rng));
        let width = rng.one_of(&[1, 3, 20, 300, 3000]);
        let beside = Snapped {
            x: (x + tx) / 2 + rng.between(-width, width),
            y: (y + ty) / 2 + rng.between(-width, width),
        };
        let distances = [0, 1, 2].map(|_| f64::from(rng.between(0, 1 << 12)) / 4.0);
        let flat =
            Flat { corners: [Snapped { x, y }, Snapped { x: tx, y: ty }, beside], distances };
        let (scene, view) = flat::scene(&[vec![flat]], SIDE);
        let plan =
            plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE)));
        let mut renderer = Renderer::default();
        let picture = renderer.render(&plan).clone();
        let seen = (0..SIDE * SIDE).filter(|i| flat::number_of(picture.pixels()[*i]).is_some());
        let seen: Vec<usize> = seen.collect();
        let step = seen.len() / 30 + 1;
        let depths = distances.map(|d| 1.0 - d / FAR);
        let largest = depths.into_iter().fold(0.0, f64::max);
        let least = depths.into_iter().fold(1.0, f64::min);
        // One ulp of the largest depth, as f32.
        let ulp = f64::from(
            (largest as f32)
                .to_bits()
                .checked_sub(1)
                .map_or(f32::MIN_POSITIVE, |bits| largest as f32 - f32::from_bits(bits)),
        );
        // Compares some 30 pixels per sliver.
        for i in seen.into_iter().step_by(step) {
            let (x, y) = (i % SIDE, i / SIDE);
            let got = f64::from(renderer.hit(x, y).unwrap().depth);
            let exact = exact_depth(&flat, x as i32, y as i32);
            ours = ours.max((got - exact).abs() / ulp);
            naive = naive.max((planar_depth(&flat, x as i32, y as i32) - exact).abs() / ulp);
            outside += usize::from(got < least || got > largest);
            pixels += 1;
        }
    }
    assert!(pixels > 1000, "{pixels} pixels were looked at");
    assert_eq!(outside, 0, "depths beyond those of the corners");
    Figure {
        case: 33,
        what: "depth on slivers",
        naive: Some(("a plane equation in f32", naive)),
        ours,
        bound: 2.0,
        unit: "ulp of the largest corner",
    }
    .hold();
}

#[test]
fn case_33_depths_of_small_triangles_stay_within_their_corners() {
    // One triangle in each field of eight pixels, with its corners on pixel centres. At a corner
    // two edge functions are 0 and the third is the whole area, so rounding shows at once.
    const SIDE: usize = 512;
    let mut rng = Rng::new(330);
    let mut flats = Vec::new();
    for field in 0..64 * 64 {
        let (x, y) = (field % 64 * 8, field / 64 * 8);
        let mut middle = |from: i32| (from + rng.between(0, 7)) * SUBPIXELS + SUBPIXELS / 2;
        let corners = [0; 3].map(|_| Snapped { x: middle(x), y: middle(y) });
        let distances = [0; 3].map(|_| f64::from(rng.between(0, 1 << 12)) / 4.0);
        flats.push(Flat { corners, distances });
    }
    let (mut scene, view) = flat::scene(&[flats.clone()], SIDE);
    edit(&mut scene, ObjectId(1), |object| object.sides = Sides::Two);
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE)));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    let (mut ours, mut naive, mut pixels) = (0, 0, 0);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let Some(hit) = renderer.hit(x, y) else { continue };
        let flat = &flats[y / 8 * 64 + x / 8];
        let depths = flat.distances.map(|d| 1.0 - d / FAR);
        // Interpolation must not leave the range of the corners.
        let (least, most) =
            depths.iter().fold((1.0_f64, 0.0_f64), |(a, b), d| (a.min(*d), b.max(*d)));
        let beyond = |depth: f64| usize::from(!(least..=most).contains(&depth));
        ours += beyond(f64::from(hit.depth));
        naive += beyond(planar_depth(flat, x as i32, y as i32));
        pixels += 1;
    }
    assert!(pixels > 10_000, "{pixels} pixels were looked at");
    Figure {
        case: 33,
        what: "pixels of small triangles with depths beyond their corners'",
        naive: Some(("a plane equation in f32", f64::from(u32::try_from(naive).unwrap()))),
        ours: f64::from(u32::try_from(ours).unwrap()),
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_34_two_faces_that_meet_in_a_line_meet_in_that_line() {
    const SIDE: usize = 256;
    let eye = Eye::first(SIDE);
    let mut ours = 0.0_f64;
    for (i, turns) in [(0.3, 0.9), (-0.7, 0.2), (1.0, -1.1)].into_iter().enumerate() {
        let plane = |turn: f64| {
            DMat4::from_rotation_z(0.4 * i as f64)
                * DMat4::from_rotation_y(turn)
                * DMat4::from_scale(DVec3::splat(120.0))
        };
        let placements = [plane(turns.0), plane(turns.1)];
        let (mut scene, view) = scene(&placements.map(|placement| (square(), placement)));
        for id in [10, 11] {
            edit(&mut scene, ObjectId(id), |object| object.sides = Sides::Two);
        }
        let view = View { marks: false, ..view };
        let plan =
            plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE)));
        let mut renderer = Renderer::default();
        renderer.render(&plan);
        let first = renderer.pixels_of(ItemId::Object(ObjectId(10)));
        let second = renderer.pixels_of(ItemId::Object(ObjectId(11)));
        // Both planes turn about the same line through the origin.
        let line = DMat4::from_rotation_z(0.4 * i as f64).transform_vector3(DVec3::Y);
        let [lx, ly] = eye.pixel(line * 50.0);
        let (dx, dy) = (lx - SIDE as f64 / 2.0, ly - SIDE as f64 / 2.0);
        let corners = |placement: DMat4| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| placement.transform_point3(DVec3::new(x, y, 0.0)))
        };
        // The oracle: distance along a ray through the pixel centre.
        let distance = |placement: DMat4, x: usize, y: usize| {
            let [a, b, c, d] = corners(placement);
            let ray = eye.ray(x, y);
            [[a, b, c], [a, c, d]].into_iter().find_map(|t| meet(eye.at, ray, t)).map(|m| m.0)
        };
        // A wrong pixel counts by its distance from the line on the screen.
        for j in 0..SIDE * SIDE {
            let (x, y) = (j % SIDE, j / SIDE);
            let both = [distance(placements[0], x, y), distance(placements[1], x, y)];
            let [Some(a), Some(b)] = both else { continue };
            let right = if a < b { first[j] } else { second[j] };
            if !right {
                let from_line = |p: f64, q: f64| (p * dy - q * dx).abs() / dx.hypot(dy);
                let half = SIDE as f64 / 2.0;
                ours = ours.max(from_line(x as f64 + 0.5 - half, y as f64 + 0.5 - half));
            }
        }
    }
    // 16 bits of depth let a face show through up to one depth step at this distance.
    let slope = f64::abs(0.3_f64.tan() - 0.9_f64.tan());
    let step = 400.0 * 400.0 / 65536.0 * 1999.0 / 2000.0;
    let naive = step / slope / (2.0 * eye.tangent * 400.0 / SIDE as f64);
    Figure {
        case: 34,
        what: "how far from the line where two faces meet the wrong one is seen",
        naive: Some(("16 bits of depth, by number", naive)),
        ours,
        bound: 1.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_35_in_parallel_projection_depth_is_as_fine_far_off_as_near_by() {
    let (mut wrong, mut naive) = (0, 0);
    for i in 0..200 {
        // A gap of 0.01; 16 bits from 0 to 2000 have steps of 0.03.
        let z = 5.0 + 1990.0 * f64::from(i) / 200.0;
        wrong += hidden_ones(z, 1e-2, Projection::Orthographic);
        let fixed = |z: f64| (z / 2000.0 * 65535.0).round() as i64;
        naive += 64 * usize::from(fixed(z) == fixed(z + 1e-2));
    }
    // Small things near the camera, while the far plane stays at 2000.
    for z in [1.0, 0.1, 1e-2, 1e-3] {
        wrong += hidden_ones(z, 1e-5 * z, Projection::Orthographic);
    }
    Figure {
        case: 35,
        what: "wrong pixels of 200 pairs 0.01 apart in parallel projection",
        naive: Some(("16 bits, by number", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_36_the_order_of_drawing_does_not_show() {
    // Squares that intersect, in pairs at the same place.
    let placements: Vec<_> = (0..12)
        .map(|i| {
            let same = f64::from(i / 2);
            (square(), DMat4::from_rotation_y(0.4 * same) * at(70.0, 0.0, 0.0, 0.0))
        })
        .collect();
    let (mut scene, view) = scene(&placements);
    for (id, preset) in (10..22).zip(PresetId::all()) {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = MaterialChoice::Preset(preset);
            object.sides = Sides::Two;
        });
    }
    let view = View { marks: false, ..view };
    let picture = |scene: &Scene| draw(scene, &view, &Settings::default(), SIDE);
    let first = picture(&scene);
    let mut rng = Rng::new(36);
    let mut differ = 0;
    for _ in 0..40 {
        let id = ItemId::Object(ObjectId(10 + rng.below(12) as u32));
        Command::Reorder { id, to: rng.index(12) }.apply(&mut scene).unwrap();
        let now = picture(&scene);
        differ += first.pixels().iter().zip(now.pixels()).filter(|(a, b)| a != b).count();
    }
    // The picture if the last one drawn were visible: the younger of each pair.
    let mut younger = scene.clone();
    for id in (10..22).step_by(2) {
        edit(&mut younger, ObjectId(id), |object| object.visible = false);
    }
    let other = picture(&younger);
    let naive = first.pixels().iter().zip(other.pixels()).filter(|(a, b)| a != b).count();
    Figure {
        case: 36,
        what: "pixels that change in 40 shuffles of the list",
        naive: Some(("the last one drawn is seen", naive as f64)),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_36_the_order_of_faces_shows_by_their_numbers_alone() {
    // A mesh of two coincident faces: the lower number wins.
    let square = [[-60.0, -60.0, 0.0], [60.0, -60.0, 0.0], [60.0, 60.0, 0.0], [-60.0, 60.0, 0.0]];
    let twice = model("twice", &square, &[&[0, 1, 2, 3], &[0, 1, 2, 3]]);
    let (mut scene, view) = scene(&[(twice, DMat4::IDENTITY)]);
    edit(&mut scene, ObjectId(10), |object| object.surface = Surface::Material);
    let plan = plan_frame(&Shot::new(
        &scene,
        &View { marks: false, ..view },
        &Settings::default(),
        Size::new(SIDE, SIDE),
    ));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    for i in 0..SIDE {
        let hit = renderer.hit(i, i).and_then(|hit| hit.polygon);
        assert_ne!(hit, Some(1), "the lower number of what is equally near");
    }
}
