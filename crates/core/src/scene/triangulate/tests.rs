//! Hard cases: notches, bridges, corners in a row, outlines that touch themselves.

use proptest::prelude::*;

use super::*;
use crate::base::math;
use crate::scene::newell;

fn outline(places: &[(f64, f64)]) -> Vec<DVec3> {
    places.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
}

/// Returns twice the signed areas of the triangles about `normal`.
fn areas(outline: &[DVec3], normal: DVec3, triangles: &[[u32; 3]]) -> Vec<f64> {
    let area = |t: &[u32; 3]| newell(t.iter().map(|&i| outline[i as usize])).dot(normal);
    triangles.iter().map(area).collect()
}

/// Cuts a polygon, seen from +Z, with the sweep alone.
fn swept(outline: &[DVec3]) -> Vec<[u32; 3]> {
    let flat: Vec<DVec2> = outline.iter().map(|p| p.truncate()).collect();
    let mut triangles = Vec::new();
    let ring: Vec<u32> = (0..number(flat.len())).collect();
    sweep::cut(&flat, &ring, &mut triangles);
    triangles
}

/// Checks that the sweep cuts a polygon into triangles inside it.
fn is_swept_rightly(outline: &[DVec3]) {
    let triangles = swept(outline);
    assert_eq!(triangles.len(), outline.len() - 2);
    let areas = areas(outline, DVec3::Z, &triangles);
    let sum = newell(outline.iter().copied()).z;
    assert!((areas.iter().sum::<f64>() / sum - 1.0).abs() < 1e-9);
    let worst = areas.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(worst >= -1e-9 * sum, "a triangle of {worst} in a polygon of {sum}");
}

/// Returns the areas of the triangles, after checking that they are positive and sum to the
/// polygon's area.
fn sound(outline: &[DVec3]) -> Vec<f64> {
    let twice = newell(outline.iter().copied());
    let normal = math::unit(twice).unwrap();
    let triangles = triangulate(outline, normal);
    assert_eq!(triangles.len(), outline.len() - 2);
    let areas = areas(outline, normal, &triangles);
    let sum: f64 = areas.iter().sum();
    assert!((sum / twice.length() - 1.0).abs() < 1e-9, "{sum} is not {}", twice.length());
    let worst = areas.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(worst >= -1e-9 * sum, "a triangle of {worst} in a polygon of {sum}");
    areas
}

/// Returns a square with a square hole. A bridge joins the first corner of each.
fn square_with_a_hole() -> Vec<DVec3> {
    outline(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 4.0),
        (0.0, 4.0),
        (0.0, 0.0),
        (1.0, 1.0),
        (1.0, 3.0),
        (3.0, 3.0),
        (3.0, 1.0),
        (1.0, 1.0),
    ])
}

#[test]
fn an_arrow_is_cut_from_its_notch_wherever_its_corners_begin() {
    let mut arrow = outline(&[(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)]);
    for _ in 0..4 {
        sound(&arrow);
        arrow.rotate_left(1);
    }
}

#[test]
fn a_hole_joined_by_a_bridge_stays_a_hole_seen_from_any_side() {
    let mut ring = square_with_a_hole();
    for turn in 0..ring.len() {
        let turned = math::rotation(DVec3::new(0.6, 0.0, 0.8), turn as f64);
        let placed: Vec<DVec3> = ring.iter().map(|p| turned * *p + DVec3::X * 1e3).collect();
        assert!((sound(&placed).iter().sum::<f64>() - 24.0).abs() < 1e-6);
        ring.rotate_left(1);
    }
}

/// Returns the outline of an island of 6 x 6 cells, one cell side after the other. The island
/// consists of the cells that are connected to the first by sides, and of enclosed cells.
fn island(cells: &[bool; 36]) -> Vec<DVec3> {
    type Cell = (i32, i32);
    let land = |(x, y): Cell| {
        (0..6).contains(&x) && (0..6).contains(&y) && (cells[(y * 6 + x) as usize] || y == 0)
    };
    let flood = |from: Cell, steps: &[Cell], into: &dyn Fn(Cell) -> bool| {
        let (mut found, mut open) = (std::collections::BTreeSet::from([from]), vec![from]);
        while let Some((x, y)) = open.pop() {
            for (dx, dy) in steps {
                let cell = (x + dx, y + dy);
                if into(cell) && found.insert(cell) {
                    open.push(cell);
                }
            }
        }
        found
    };
    let sides = [(1, 0), (0, 1), (-1, 0), (0, -1)];
    let around = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];
    let island = flood((0, 0), &sides, &land);
    let near = |(x, y): Cell| (-1..7).contains(&x) && (-1..7).contains(&y);
    let sea = flood((-1, -1), &around, &|cell| near(cell) && !island.contains(&cell));
    // Walk along cell sides with the island to the left. At a corner where two cells touch, the
    // path stays at the same cell.
    let ahead_left = |(x, y): Cell, (dx, dy): Cell| match (dx, dy) {
        (1, 0) => (x, y),
        (0, 1) => (x - 1, y),
        (-1, 0) => (x - 1, y - 1),
        _ => (x, y - 1),
    };
    let runs = |at: Cell, step: Cell| {
        let right = match step {
            (1, 0) => (at.0, at.1 - 1),
            (0, 1) => (at.0, at.1),
            (-1, 0) => (at.0 - 1, at.1),
            _ => (at.0 - 1, at.1 - 1),
        };
        !sea.contains(&ahead_left(at, step)) && sea.contains(&right)
    };
    let (mut at, mut step, mut outline) = ((0, 0), (1, 0), Vec::new());
    loop {
        outline.push(DVec3::new(f64::from(at.0), f64::from(at.1), 0.0));
        at = (at.0 + step.0, at.1 + step.1);
        let turns = [(-step.1, step.0), step, (step.1, -step.0)];
        step = turns.into_iter().find(|step| runs(at, *step)).unwrap();
        if at == (0, 0) && step == (1, 0) {
            return outline;
        }
    }
}

/// Returns a plate with square holes in a row, each joined to the previous one.
fn plate(holes: u8) -> Vec<DVec3> {
    let x = |i: u8| f64::from(i) * 4.0;
    let mut places = vec![(0.0, 0.0), (x(holes), 0.0), (x(holes), 4.0), (0.0, 4.0), (0.0, 0.0)];
    for i in 0..holes {
        let left = x(i) + 1.0;
        places.extend([(left, 1.0), (left, 3.0), (left + 2.0, 3.0), (left + 2.0, 1.0)]);
    }
    for i in (0..holes).rev() {
        places.push((x(i) + 1.0, 1.0));
        if i > 0 {
            places.push((x(i) - 1.0, 1.0));
        }
    }
    outline(&places)
}

#[test]
fn holes_joined_one_to_the_other_stay_holes_wherever_the_corners_begin() {
    for holes in 1..6 {
        let mut plate = plate(holes);
        for _ in 0..plate.len() {
            let areas = sound(&plate);
            assert!((areas.iter().sum::<f64>() - 24.0 * f64::from(holes)).abs() < 1e-9);
            plate.rotate_left(1);
        }
    }
}

#[test]
fn corners_in_a_row_leave_no_triangle_without_area() {
    let mut square: Vec<(f64, f64)> = Vec::new();
    for i in 0..4 {
        let t = f64::from(i);
        square.extend([(t, 0.0), (4.0, t), (4.0 - t, 4.0), (0.0, 4.0 - t)]);
    }
    square.sort_by(|a, b| {
        let angle = |p: &(f64, f64)| libm::atan2(p.1 - 2.0, p.0 - 2.0);
        angle(a).total_cmp(&angle(b))
    });
    let mut square = outline(&square);
    for _ in 0..square.len() {
        assert!(sound(&square).iter().all(|area| *area > 0.5));
        square.rotate_left(1);
    }
}

#[test]
fn a_thin_quad_far_from_the_origin_keeps_its_shape() {
    let at = |x: f32, z: f32| DVec3::new(f64::from(x), 0.0, f64::from(z));
    sound(&[
        at(14680.0, 9605.0),
        at(14680.002, 9606.5),
        at(14680.001, 9608.0),
        at(14679.999, 9608.0),
    ]);
}

#[test]
fn a_polygon_that_crosses_itself_has_as_many_triangles_as_any_other() {
    let star: Vec<(f64, f64)> =
        (0..5).map(|i| f64::from(i) * 2.513_274).map(|a| (libm::cos(a), libm::sin(a))).collect();
    let bow = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)];
    for places in [&star[..], &bow, &[(1.0, 1.0); 7]] {
        let corners = outline(places);
        let triangles = triangulate(&corners, DVec3::Z);
        assert_eq!(triangles.len(), corners.len() - 2);
        let sum: f64 = areas(&corners, DVec3::Z, &triangles).iter().sum();
        assert!((sum - newell(corners.iter().copied()).z).abs() < 1e-9);
    }
}

/// Polygons with this number of corners and few or hidden ears, and whether each is simple.
fn hard_shapes(corners: u32) -> Vec<(&'static str, bool, Vec<DVec3>)> {
    let n = f64::from(corners);
    let round = |i: u32, radius: f64, turns: f64| {
        let angle = f64::from(i) / n * turns * std::f64::consts::TAU;
        DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * radius
    };
    let shape =
        |corner: &dyn Fn(u32) -> DVec3| -> Vec<DVec3> { (0..corners).map(corner).collect() };
    let scattered = |i: u32| {
        let bits = i.wrapping_mul(0x9E37_79B9);
        let [x, y] = [bits >> 16, bits.wrapping_mul(0x85EB_CA6B) >> 16].map(f64::from);
        DVec3::new(x, y, 0.0)
    };
    let tooth = |i: u32, height: f64| {
        let [x, y] = match (corners - i, i % 2) {
            (1, _) => [0.0, -1.0],
            (2, _) => [n, -1.0],
            (_, odd) => [f64::from(i), height * f64::from(odd)],
        };
        DVec3::new(n - x, y, 0.0)
    };
    let spiral = |i: u32| {
        let (turn, side) = if i < corners / 2 { (i, 0.5) } else { (corners - 1 - i, -0.5) };
        let turns = n / 16.0;
        round(2 * turn, 10.0 + 8.0 * f64::from(turn) / n * turns + side, turns)
    };
    vec![
        ("comb", true, shape(&|i| tooth(i, 1.0))),
        ("long comb", true, shape(&|i| tooth(i, n))),
        ("star", true, shape(&|i| round(i, if i % 2 == 0 { 1.0 } else { 1000.0 }, 1.0))),
        ("ragged star", true, shape(&|i| round(i, 1.0 + scattered(i).y, 1.0))),
        ("spiral", true, shape(&spiral)),
        ("row", false, shape(&|i| DVec3::new(0.7, 0.1, 0.0) * f64::from(i))),
        (
            "rounded row",
            false,
            shape(&|i| (DVec3::new(0.7, 0.1, 0.0) * f64::from(i)).as_vec3().into()),
        ),
        ("one place", false, shape(&|_| DVec3::ONE)),
        ("pentagram", false, shape(&|i| round(i, 1.0, n / 2.0 - 1.0))),
        ("scribble", false, shape(&scattered)),
        ("few places", false, shape(&|i| (scattered(i) / 16384.0).floor())),
    ]
}

#[test]
fn polygons_of_many_corners_are_cut_correctly_whatever_their_shape() {
    for (name, is_simple, corners) in hard_shapes(30_000) {
        if is_simple {
            sound(&corners);
            is_swept_rightly(&corners);
        } else {
            let triangles = triangulate(&corners, DVec3::Z);
            assert_eq!(triangles.len(), corners.len() - 2, "{name}");
            let sum: f64 = areas(&corners, DVec3::Z, &triangles).iter().sum();
            let all = newell(corners.iter().copied()).z;
            let size = corners.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
            assert!((sum - all).abs() <= 1e-9 * size * size, "{name}: {sum} is not {all}");
        }
    }
}

/// The number of visited corners grows no faster than the polygon, even if each corner blocks many
/// ears.
#[test]
fn the_work_on_a_polygon_grows_with_its_corners_whatever_its_shape() {
    for corners in [10_000, 100_000] {
        for (name, _, outline) in hard_shapes(corners) {
            let mut ring = Ring::new(outline.iter().map(|p| p.truncate()).collect());
            assert_eq!(ring.cut().len(), outline.len() - 2);
            let share = ring.looked_at / outline.len();
            assert!(share < 150, "{name}: {share} looks for each of {corners} corners");
        }
    }
}

proptest! {
    /// Star-shaped polygons about the origin: simple, and very concave.
    #[test]
    fn simple_polygons_are_cut_into_triangles_inside_them(
        radii in prop::collection::vec(1_u8..=10, 4..80),
        turn in 0.0..6.3_f64,
    ) {
        let sector = 2.0 * std::f64::consts::PI / radii.len() as f64;
        let corner = |(i, r): (usize, &u8)| {
            let angle = sector * i as f64;
            DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * f64::from(*r)
        };
        let turned = math::rotation(DVec3::new(0.0, 0.6, 0.8), turn);
        let corners: Vec<DVec3> = radii.iter().enumerate().map(corner).collect();
        is_swept_rightly(&corners);
        let corners: Vec<DVec3> = corners.into_iter().map(|p| turned * p).collect();
        sound(&corners);
    }

    /// Islands of cells: outlines that touch themselves at corners, also around bays that only such
    /// a corner closes, with or without corners on straight sides.
    #[test]
    fn islands_that_touch_themselves_are_cut_into_triangles_inside_them(
        cells in prop::array::uniform::<_, 36>(prop::bool::weighted(0.65)),
        all_corners in any::<bool>(),
        first in 0..100_usize,
    ) {
        let mut corners = island(&cells);
        if !all_corners {
            let turns = |i: usize| {
                let at = |i: usize| corners[i % corners.len()];
                (at(i + 1) - at(i)).cross(at(i + 2) - at(i + 1)) != DVec3::ZERO
            };
            let kept = (0..corners.len()).filter(|&i| turns(i));
            corners = kept.map(|i| corners[(i + 1) % corners.len()]).collect();
        }
        let length = corners.len();
        corners.rotate_left(first % length);
        let areas = sound(&corners);
        prop_assert!(areas.iter().all(|area| *area > 0.5), "{areas:?}");
    }

    /// Stairs on a grid: many corners in a row, and many on the borders of ears.
    #[test]
    fn stairs_are_cut_into_triangles_inside_them(
        heights in prop::collection::vec(1_u8..6, 2..30),
    ) {
        let mut places = vec![(0.0, 0.0)];
        places.extend((0..=heights.len()).skip(1).map(|x| (x as f64, 0.0)));
        for (x, height) in heights.iter().enumerate().rev() {
            let top = f64::from(*height);
            places.extend([((x + 1) as f64, top), (x as f64, top)]);
        }
        sound(&outline(&places));
        is_swept_rightly(&outline(&places));
    }

    /// Random corners on a small grid: many coincide, and most outlines cross themselves.
    #[test]
    fn areas_sum_to_the_polygons_whatever_its_shape(
        places in prop::collection::vec((0_u8..4, 0_u8..4), 3..24),
    ) {
        let places: Vec<(f64, f64)> =
            places.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
        let corners = outline(&places);
        for triangles in [triangulate(&corners, DVec3::Z), swept(&corners)] {
            prop_assert_eq!(triangles.len(), corners.len() - 2);
            let sum: f64 = areas(&corners, DVec3::Z, &triangles).iter().sum();
            prop_assert!((sum - newell(corners.iter().copied()).z).abs() < 1e-9);
        }
    }
}
