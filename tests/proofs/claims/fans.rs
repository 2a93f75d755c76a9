//! Closed fans of triangles around a hub have no cracks and cover no pixel twice.
//!
//! Three results are compared with the crossings of [`super::exact`]: the pixels of each triangle;
//! the number of triangles over a pixel, counted with the sign of their area, which equals the
//! winding number of the snapped outline even if snapping flipped slivers; and the triangle that
//! the renderer shows at each pixel of a picture of many fans.

use super::exact::{span, wind};
use super::{Proof, Tally};
use marraztu_core::base::rng::Rng;
use marraztu_lab::pictures::flat::{self, Flat};
use marraztu_render::Renderer;
use marraztu_render::screen::coverage::{PixelBox, SUBPIXELS, Snapped, Triangle, doubled_area};

pub(crate) const PROOF: Proof = Proof {
    name: "fans",
    claim: "closed fans cover the pixels that integer crossings say: no crack, no pixel twice, \
            and the picture shows the right triangle everywhere",
    unit: "fans",
    batch: FANS,
    quick: 100_000,
    whole: 1_000_000,
    shows: &[],
    regressions: &[],
    check,
};

/// The number of fans in a picture, `ROW` by `ROW`.
const FANS: u64 = (ROW * ROW) as u64;
const ROW: usize = 8;

/// The sides of the squares of fans in pixels; small ones are more frequent.
const SIDES: [i32; 20] = [8, 8, 8, 8, 8, 8, 8, 8, 16, 16, 16, 16, 16, 16, 32, 32, 32, 32, 64, 128];

fn check(batch: u64) -> Result<Tally, String> {
    let mut rng = Rng::new(batch);
    let side = rng.one_of(&SIDES);
    let mut tally = Tally::default();
    let mut triangles = Vec::new();
    for i in 0..ROW * ROW {
        let (hub, outline) = fan(&mut rng, side);
        let fan = triangles_of(hub, &outline);
        count(&fan, &outline, side).map_err(|what| format!("{what}: {hub:?} {outline:?}"))?;
        let [x, y] = [i % ROW, i / ROW].map(|i| i32::try_from(i).expect("few") * side * SUBPIXELS);
        let moved = fan.iter().map(|corners| {
            Flat::new(corners.map(|corner| Snapped { x: corner.x + x, y: corner.y + y }))
        });
        triangles.extend(moved);
    }
    let side = ROW * usize::try_from(side).expect("positive");
    compare(&triangles, side)?;
    tally.count("fans", FANS);
    tally.count("triangles", triangles.len() as u64);
    tally.count("samples", (side * side) as u64);
    Ok(tally)
}

/// A hub and an outline in a square. Half of the coordinates are on centres and borders of pixels.
/// Some corners are equal, or one subpixel apart.
fn fan(rng: &mut Rng, side: i32) -> (Snapped, Vec<Snapped>) {
    let far = side * SUBPIXELS;
    let coordinate = |rng: &mut Rng| {
        let at = rng.between(0, far);
        if rng.one_in(2) { at / 128 * 128 } else { at }
    };
    let mut outline: Vec<Snapped> = Vec::new();
    for _ in 0..rng.between(3, 8) {
        let fresh = Snapped { x: coordinate(rng), y: coordinate(rng) };
        let corner = match (rng.below(6), outline.last()) {
            (0, Some(last)) => {
                let beside = |at: i32, rng: &mut Rng| (at + rng.between(-1, 1)).clamp(0, far);
                Snapped { x: beside(last.x, rng), y: beside(last.y, rng) }
            }
            (1, Some(last)) => Snapped { x: last.x, ..fresh },
            (2, Some(last)) => Snapped { y: last.y, ..fresh },
            _ => fresh,
        };
        outline.push(corner);
    }
    let hub = match rng.below(8) {
        0 => rng.one_of(&outline),
        _ => Snapped { x: coordinate(rng), y: coordinate(rng) },
    };
    (hub, outline)
}

fn triangles_of(hub: Snapped, outline: &[Snapped]) -> Vec<[Snapped; 3]> {
    let side = |i: usize| [hub, outline[i], outline[(i + 1) % outline.len()]];
    (0..outline.len()).map(side).collect()
}

/// Compares the coverage of a fan, triangle by triangle and in total.
fn count(fan: &[[Snapped; 3]], outline: &[Snapped], side: i32) -> Result<(), String> {
    let square = PixelBox { left: 0, top: 0, right: side, bottom: side };
    let width = usize::try_from(side).expect("positive");
    let mut signed = vec![0; width * width];
    // Each triangle by itself: its pixels per row are one span, the exact one.
    for corners in fan {
        let mut rows = vec![0..0_i64; width];
        if let Some(triangle) = Triangle::new(*corners) {
            let sign = if doubled_area(*corners) > 0 { 1 } else { -1 };
            let mut torn = false;
            triangle.covered(square, |pixel| {
                let [x, y] = [pixel.x, pixel.y].map(|i| usize::try_from(i).expect("inside"));
                signed[y * width + x] += sign;
                let row = &mut rows[y];
                if row.is_empty() {
                    *row = i64::from(pixel.x)..i64::from(pixel.x);
                }
                torn |= row.end != i64::from(pixel.x);
                row.end += 1;
            });
            if torn {
                return Err("a row of a triangle has a hole".to_owned());
            }
        }
        for (y, row) in (0..).zip(&rows) {
            let exact = span(*corners, y);
            if *row != exact && !(row.is_empty() && exact.is_empty()) {
                return Err(format!("row {y} of {corners:?} is {row:?} and not {exact:?}"));
            }
        }
    }
    // All triangles together: signed counts equal the winding numbers.
    let mut windings = vec![0; width];
    for (y, counted) in (0..).zip(signed.chunks(width)) {
        wind(outline, y, &mut windings);
        if counted != windings {
            return Err(format!("row {y} is covered {counted:?}, wound about {windings:?}"));
        }
    }
    Ok(())
}

/// Checks that the renderer shows the first triangle that covers each pixel.
pub(crate) fn compare(triangles: &[Flat], side: usize) -> Result<(), String> {
    let picture = flat::draw_triangles(triangles, side, &mut Renderer::default());
    let expected = seen(triangles, side);
    for (i, (pixel, expected)) in picture.pixels().iter().zip(expected).enumerate() {
        let shown = flat::number_of(*pixel);
        if shown != expected {
            let corners = |number: Option<usize>| number.map(|i| triangles[i].corners);
            return Err(format!(
                "pixel ({}, {}) of {side} shows {shown:?} {:?} and not {expected:?} {:?}",
                i % side,
                i / side,
                corners(shown),
                corners(expected),
            ));
        }
    }
    Ok(())
}

/// The first triangle that covers each pixel of a square picture, by crossings.
pub(crate) fn seen(triangles: &[Flat], side: usize) -> Vec<Option<usize>> {
    let mut seen = vec![None; side * side];
    let width = i64::try_from(side).expect("small");
    for (number, triangle) in triangles.iter().enumerate().rev() {
        let rows = triangle.corners.map(|corner| i64::from(corner.y));
        let [low, high] = [rows.into_iter().min(), rows.into_iter().max()]
            .map(|row| row.expect("three").div_euclid(i64::from(SUBPIXELS)));
        for y in low.max(0)..(high + 1).min(width) {
            let span = span(triangle.corners, i32::try_from(y).expect("in the picture"));
            let [begin, end] = [span.start, span.end]
                .map(|x| usize::try_from(x.clamp(0, width)).expect("clamped"));
            let row = usize::try_from(y).expect("not negative") * side;
            if begin < end {
                seen[row + begin..row + end].fill(Some(number));
            }
        }
    }
    seen
}
