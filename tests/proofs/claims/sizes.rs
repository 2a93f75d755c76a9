//! Extreme sizes: pictures of 1 x 1 and of 16,384 x 16,384 pixels, meshes without faces and with
//! ten million.

use super::fans::seen;
use super::{Proof, Tally};
use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_lab::pictures::flat::{self, Flat};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

pub(crate) const PROOF: Proof = Proof {
    name: "sizes",
    claim: "pictures from 1 x 1 to 16,384 x 16,384 and meshes of up to ten million faces are \
            drawn, each pixel as integer crossings say",
    unit: "sizes",
    batch: 1,
    quick: 6,
    whole: SIZES.len() as u64,
    shows: &[],
    regressions: &[],
    check,
};

/// Side of the picture and number of triangles; the quick round draws the first ones.
const SIZES: [(usize, usize); 9] = [
    (1, 0),
    (1, 1),
    (1, 1000),
    (2, 3),
    (1024, 1),
    (2048, 50_000),
    (4096, 1_000_000),
    (2048, 10_000_000),
    (16_384, 1000),
];

fn check(batch: u64) -> Result<Tally, String> {
    let count = usize::try_from(batch).map_err(|_large| "there is no such size")? % SIZES.len();
    let (side, count) = SIZES[count];
    let mut rng = Rng::new(batch);
    // Large meshes have small triangles, or drawing them would take too long.
    let far = i32::try_from(side).expect("small") * SUBPIXELS;
    let size = (far / if count > 10_000 { 64 } else { 1 }).max(SUBPIXELS);
    let triangles: Vec<Flat> = (0..count)
        .map(|_| {
            let (x, y) = (rng.between(0, far), rng.between(0, far));
            let near = |at: i32, rng: &mut Rng| (at + rng.between(-size, size)).clamp(0, far);
            Flat::new([
                Snapped { x, y },
                Snapped { x: near(x, &mut rng), y: near(y, &mut rng) },
                Snapped { x: near(x, &mut rng), y: near(y, &mut rng) },
            ])
        })
        .collect();
    let picture = flat::draw_triangles(&triangles, side, &mut Renderer::default());
    let expected = seen(&triangles, side);
    // The largest mesh has ten million triangles, so its memory is released early.
    drop(triangles);
    for (i, (pixel, expected)) in picture.pixels().iter().zip(&expected).enumerate() {
        if flat::number_of(*pixel) != *expected {
            return Err(format!("pixel {i} of {side} x {side} shows {pixel:?}, not {expected:?}"));
        }
    }
    let mut tally = Tally::default();
    tally.count("sizes", 1);
    tally.count("triangles", count as u64);
    tally.count("samples", (side * side) as u64);
    if side == 1 {
        narrow(&mut tally)?;
    }
    Ok(tally)
}

/// Draws pictures with one row and with one column, covered by one triangle.
fn narrow(tally: &mut Tally) -> Result<(), String> {
    let at = |x: i32, y: i32| Snapped { x: x * SUBPIXELS, y: y * SUBPIXELS };
    let whole = [at(-20_000, -20_000), at(60_000, -20_000), at(-20_000, 60_000)];
    let (scene, view) = flat::scene(&[vec![Flat::new(whole)]], 1);
    let long = 1 << 14;
    for size in [Size::new(long, 1), Size::new(1, long), Size::new(7, 1), Size::new(1, 7)] {
        let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), size));
        let picture = Renderer::default().render(&plan).clone();
        let whole = picture.pixels().iter().all(|pixel| flat::number_of(*pixel) == Some(0));
        if picture.size() != size || !whole {
            return Err(format!("a picture of {size:?} has holes"));
        }
        tally.count("samples", size.area() as u64);
    }
    Ok(())
}
