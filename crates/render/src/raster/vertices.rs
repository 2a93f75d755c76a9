//! Transforms the vertices of a mesh to the screen, and fetches them sixteen at a time.
//!
//! The loop is plain arithmetic over rows of coordinates, compiled for each instruction set. It
//! handles eight vertices at once with the same bits as [`Screen::vertex`].

use crate::simd::dispatch;
use fearless_simd::{Level, Simd, SimdBase as _, SimdCombine as _, i32x4, i32x16};

use super::hits::PACK;
use crate::accel::{DrawOrder, DrawTriangle};
use crate::screen::clip::{Screen, ScreenVertex};

/// The vertices of a frame on the screen.
#[derive(Debug, Default)]
pub(crate) struct Vertices {
    /// The vertices on the usual grid.
    pub(crate) usual: Vec<ScreenVertex>,
    /// The vertices on a finer grid, if the settings choose one.
    pub(crate) fine: Vec<ScreenVertex>,
    /// The vertices in pixels before snapping, if the rule of coverage needs them.
    pub(crate) unsnapped: Vec<[f32; 2]>,
}

/// Transforms vertices of a mesh to the screen, starting at number `first`.
pub(crate) fn transform(
    level: Level,
    screen: &Screen,
    order: &DrawOrder,
    first: usize,
    out: &mut [ScreenVertex],
) {
    let rows = first..first + out.len();
    let [x, y, z] = [&order.x, &order.y, &order.z].map(|row| &row[rows.clone()]);
    dispatch!(level, simd => chunk(simd, screen, [x, y, z], out));
}

#[inline(always)]
fn chunk<S: Simd>(_: S, screen: &Screen, [x, y, z]: [&[f32]; 3], out: &mut [ScreenVertex]) {
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        // Positions are stored in f32 and transformed in f64.
        *out = screen.vertex(screen.clip([f64::from(*x), f64::from(*y), f64::from(*z)]));
    }
}

/// Fetches x, y, depth and 1/w of sixteen vertices by their numbers. A number beyond the last one
/// counts as the last one, which saves a bounds check per lane.
#[inline(always)]
pub(crate) fn fetch_vertices<S: Simd>(
    simd: S,
    vertices: &[ScreenVertex],
    number: impl Fn(usize) -> u32,
) -> [i32x16<S>; 4] {
    // Without vertices, numbers cannot fall back to the last one.
    if vertices.is_empty() {
        return [i32x16::splat(simd, 0); 4];
    }
    let last = vertices.len() - 1;
    fetch(
        simd,
        #[inline(always)]
        |lane| vertices[(number(lane) as usize).min(last)].row(),
    )
}

/// Fetches x, y, depth and 1/w of one corner of sixteen triangles.
#[inline(always)]
pub(crate) fn fetch_corners<S: Simd>(
    simd: S,
    vertices: &[ScreenVertex],
    triangles: &[DrawTriangle; PACK],
    corner: usize,
) -> [i32x16<S>; 4] {
    fetch_vertices(
        simd,
        vertices,
        #[inline(always)]
        |lane| triangles[lane].vertices[corner],
    )
}

/// Transposes sixteen rows of four numbers to four rows of sixteen.
#[inline(always)]
pub(crate) fn fetch<S: Simd>(simd: S, row: impl Fn(usize) -> [i32; 4]) -> [i32x16<S>; 4] {
    // The first round separates columns 0 and 2 from 1 and 3, the second 0 from 2 and 1 from 3.
    let (even_low, odd_low) = four(simd, 0, &row).deinterleave(four(simd, 4, &row));
    let (even_high, odd_high) = four(simd, 8, &row).deinterleave(four(simd, 12, &row));
    let (a, c) = even_low.deinterleave(even_high);
    let (b, d) = odd_low.deinterleave(odd_high);
    [a, b, c, d]
}

/// Loads four rows of four numbers one after another.
#[inline(always)]
fn four<S: Simd>(simd: S, at: usize, row: &impl Fn(usize) -> [i32; 4]) -> i32x16<S> {
    let a = i32x4::from_slice(simd, &row(at));
    let b = i32x4::from_slice(simd, &row(at + 1));
    let c = i32x4::from_slice(simd, &row(at + 2));
    let d = i32x4::from_slice(simd, &row(at + 3));
    a.combine(b).combine(c.combine(d))
}
