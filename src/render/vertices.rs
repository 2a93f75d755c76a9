//! All vertices of a mesh to the screen.
//!
//! The loop is plain arithmetic over rows of coordinates, compiled for each set of instructions: it
//! does to eight vertices at once what [`Screen::vertex`] does to one, with the same bits.

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

use super::clip::{Screen, ScreenVertex};
use crate::scene::DrawOrder;

/// Vertices that one thread takes at a time.
const CHUNK: usize = 2048;

/// Brings the vertices of a mesh onto the screen.
pub(super) fn transform(
    level: Level,
    screen: &Screen,
    order: &DrawOrder,
    out: &mut [ScreenVertex],
) {
    let work = |(i, out): (usize, &mut [ScreenVertex])| {
        let rows = i * CHUNK..i * CHUNK + out.len();
        let [x, y, z] = [&order.x, &order.y, &order.z].map(|row| &row[rows.clone()]);
        dispatch!(level, simd => chunk(simd, screen, [x, y, z], out));
    };
    if out.len() <= CHUNK {
        work((0, out));
    } else {
        out.par_chunks_mut(CHUNK).enumerate().for_each(work);
    }
}

#[inline(always)]
fn chunk<S: Simd>(_: S, screen: &Screen, [x, y, z]: [&[f32]; 3], out: &mut [ScreenVertex]) {
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = screen.vertex(screen.clip([f64::from(*x), f64::from(*y), f64::from(*z)]));
    }
}
