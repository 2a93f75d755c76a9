//! The largest and the smallest: pictures of one pixel and of 16,384 x 16,384, meshes without a face
//! and with ten million.

use super::dice::Dice;
use super::fans::seen;
use super::stage::{self, Flat};
use super::{Proof, Tally};
use crate::base::image::Size;
use crate::render::screen::coverage::{SUBPIXELS, Snapped};
use crate::render::{FramePlan, Renderer};
use crate::scene::Settings;

pub(super) const PROOF: Proof = Proof {
    name: "sizes",
    claim: "pictures from 1 x 1 to 16,384 x 16,384 and meshes of up to ten million faces are drawn, \
            each pixel as whole-number crossings say",
    unit: "sizes",
    lot: 1,
    tested: 6,
    whole: SIZES.len() as u64,
    check,
};

/// Side of the picture, and how many triangles; the first ones are looked at in every test.
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

fn check(lot: u64) -> Result<Tally, String> {
    let count = usize::try_from(lot).map_err(|_large| "there is no such size")? % SIZES.len();
    let (side, count) = SIZES[count];
    let mut dice = Dice::new(lot);
    let far = i32::try_from(side).expect("small") * SUBPIXELS;
    let size = (far / if count > 10_000 { 64 } else { 1 }).max(SUBPIXELS);
    let triangles: Vec<Flat> = (0..count)
        .map(|_| {
            let (x, y) = (dice.between(0, far), dice.between(0, far));
            let near = |at: i32, dice: &mut Dice| (at + dice.between(-size, size)).clamp(0, far);
            Flat::new([
                Snapped { x, y },
                Snapped { x: near(x, &mut dice), y: near(y, &mut dice) },
                Snapped { x: near(x, &mut dice), y: near(y, &mut dice) },
            ])
        })
        .collect();
    let picture = stage::draw_flat(&triangles, side, &mut Renderer::default());
    let expected = seen(&triangles, side);
    drop(triangles);
    for (i, (pixel, expected)) in picture.pixels().iter().zip(&expected).enumerate() {
        if stage::number_of(*pixel) != *expected {
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

/// Pictures of one row and of one column, all of which a triangle covers.
fn narrow(tally: &mut Tally) -> Result<(), String> {
    let at = |x: i32, y: i32| Snapped { x: x * SUBPIXELS, y: y * SUBPIXELS };
    let whole = [at(-20_000, -20_000), at(60_000, -20_000), at(-20_000, 60_000)];
    let (scene, view) = stage::scene(&[vec![Flat::new(whole)]], 1);
    let long = 1 << 14;
    for size in [Size::new(long, 1), Size::new(1, long), Size::new(7, 1), Size::new(1, 7)] {
        let plan = FramePlan::new(&scene, &view, &Settings::default(), size);
        let picture = Renderer::default().render(&plan).clone();
        let whole = picture.pixels().iter().all(|pixel| stage::number_of(*pixel) == Some(0));
        if picture.size() != size || !whole {
            return Err(format!("a picture of {size:?} has holes"));
        }
        tally.count("samples", size.area() as u64);
    }
    Ok(())
}
