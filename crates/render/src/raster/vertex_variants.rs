//! Variants of transforming vertices: in f32, snapped to another grid, or not snapped.
//!
//! Like the default, each is a loop of plain arithmetic over rows of coordinates, compiled for each
//! instruction set. Coarser subpixels are multiples of the default's, so only positions change.

use crate::simd::dispatch;
use fearless_simd::{Level, Simd};

use super::vertices;
use crate::accel::DrawOrder;
use crate::frame::raster_mode::RasterMode;
use crate::screen::clip::{Screen, ScreenVertex, snapped};
use crate::screen::coverage::Snapped;
use marraztu_core::accuracy::VertexArithmetic;

/// Transforms vertices of a mesh to the screen, from number `first` on.
pub(crate) fn transform(
    mode: RasterMode,
    level: Level,
    screen: &Screen,
    order: &DrawOrder,
    first: usize,
    out: &mut [ScreenVertex],
) {
    if mode.vertices == VertexArithmetic::F64 {
        vertices::transform(level, screen, order, first, out);
    } else {
        let (screen, rows) = (Screen32::new(screen), rows(order, first, out.len()));
        dispatch!(level, simd => chunk(simd, &screen, rows, out));
    }
    // Coarser subpixels come from a second rounding.
    if mode.step > 1 {
        dispatch!(level, _ => coarse(mode.step, out));
    }
}

/// Transforms vertices of a mesh to pixels, from number `first` on, without snapping them.
pub(crate) fn to_pixels(
    mode: RasterMode,
    level: Level,
    screen: &Screen,
    order: &DrawOrder,
    first: usize,
    out: &mut [[f32; 2]],
) {
    let rows = rows(order, first, out.len());
    if mode.vertices == VertexArithmetic::F64 {
        dispatch!(level, simd => pixels(simd, screen, rows, out));
    } else {
        let screen = Screen32::new(screen);
        dispatch!(level, simd => pixels32(simd, &screen, rows, out));
    }
}

/// Returns the coordinates of some vertices.
fn rows(order: &DrawOrder, first: usize, count: usize) -> [&[f32]; 3] {
    [&order.x, &order.y, &order.z].map(|row| &row[first..first + count])
}

#[inline(always)]
fn chunk<S: Simd>(_: S, screen: &Screen32, [x, y, z]: [&[f32]; 3], out: &mut [ScreenVertex]) {
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = screen.vertex([*x, *y, *z]);
    }
}

#[inline(always)]
fn pixels<S: Simd>(_: S, screen: &Screen, [x, y, z]: [&[f32]; 3], out: &mut [[f32; 2]]) {
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        *out = screen.pixels_seen(screen.clip([f64::from(*x), f64::from(*y), f64::from(*z)]));
    }
}

#[inline(always)]
fn pixels32<S: Simd>(_: S, screen: &Screen32, [x, y, z]: [&[f32]; 3], out: &mut [[f32; 2]]) {
    for (((out, x), y), z) in out.iter_mut().zip(x).zip(y).zip(z) {
        let [x, y] = screen.pixels(screen.clip([*x, *y, *z]));
        *out = [x - screen.shift[0], y - screen.shift[1]];
    }
}

/// Rounds vertices to multiples of some grid steps.
#[inline(always)]
fn coarse(step: i32, out: &mut [ScreenVertex]) {
    for vertex in out {
        let Snapped { x, y } = vertex.at();
        // The nearest multiple of a power of two. A vertex beyond the planes may overflow, and
        // keeps its marker in x.
        let snap = |i: i32| i.wrapping_add(step / 2) & -step;
        let at = Snapped { x: if vertex.is_inside() { snap(x) } else { x }, y: snap(y) };
        *vertex = ScreenVertex::placed(at, vertex.depth, vertex.inverse_w);
    }
}

/// The transform from object space to the screen, in f32.
struct Screen32 {
    rows: [[f32; 4]; 4],
    half: [f32; 2],
    guard: [f32; 2],
    parts: f32,
    /// The sample's offset in pixels.
    shift: [f32; 2],
}

impl Screen32 {
    #[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
    fn new(screen: &Screen) -> Self {
        let rows = screen.rows.map(|row| row.map(|x| x as f32));
        let [half, guard] = [screen.half, screen.guard].map(|two| two.map(|x| x as f32));
        let shift = screen.shift_in_pixels().map(|x| x as f32);
        Self { rows, half, guard, parts: screen.parts as f32, shift }
    }

    #[inline(always)]
    fn clip(&self, [x, y, z]: [f32; 3]) -> [f32; 4] {
        let row = |i: usize| {
            let [a, b, c, d] = self.rows[i];
            a * x + b * y + c * z + d
        };
        [row(0), row(1), row(2), row(3)]
    }

    #[inline(always)]
    fn pixels(&self, [x, y, _, w]: [f32; 4]) -> [f32; 2] {
        let inverse_w = 1.0 / w;
        [(x * inverse_w + 1.0) * self.half[0], (1.0 - y * inverse_w) * self.half[1]]
    }

    #[inline(always)]
    fn vertex(&self, place: [f32; 3]) -> ScreenVertex {
        let clip = self.clip(place);
        let [x, y, z, w] = clip;
        let [gx, gy] = [self.guard[0] * w, self.guard[1] * w];
        // The planes of `Screen::distances`; `&` compiles to SIMD code without branches.
        let inside = (w - z >= 0.0)
            & (z >= 0.0)
            & (gx + x >= 0.0)
            & (gx - x >= 0.0)
            & (gy + y >= 0.0)
            & (gy - y >= 0.0);
        let inverse_w = 1.0 / w;
        let depth = z * inverse_w;
        // Comparisons also turn NaN into 0.
        let depth = if depth > 0.0 { depth } else { 0.0 };
        let depth = if depth < 1.0 { depth } else { 1.0 };
        let [x, y] = self.pixels(clip);
        let [x, y] = [x, y].map(|pixels| snapped(f64::from(pixels * self.parts)));
        let at = Snapped { x: if inside { x } else { ScreenVertex::BEYOND }, y };
        ScreenVertex::placed(at, depth, inverse_w)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;
    use crate::frame::variants::Variants;
    use marraztu_core::accuracy::{Settings, Subpixels};
    use marraztu_core::base::image::Size;
    use marraztu_core::base::math;

    /// Returns the largest error on the screen, in pixels, of vertices 400 in front of a camera
    /// that is `offset` from the origin.
    fn worst(vertices: VertexArithmetic, offset: f64) -> f64 {
        let size = Size::new(800, 800);
        let clip_from_view = math::perspective(22.5_f64.to_radians(), 1.0, 2000.0, size);
        let settings = Settings { vertices, ..Settings::default() };
        let (mut worst, ways) = (0.0_f64, Variants::of(&settings).raster_mode());
        for i in 0..100 {
            let eye = DVec3::new(offset + 0.37 * f64::from(i), 0.61 * offset, -offset);
            let turn = DMat4::from_rotation_y(0.1 * f64::from(i));
            let ahead = turn.transform_vector3(DVec3::Z) * -400.0;
            let world = DMat4::from_translation(eye + ahead) * DMat4::from_rotation_x(0.7);
            let view = turn.transpose() * DMat4::from_translation(-eye);
            let exact = Screen::new(clip_from_view * (view * world), size);
            let matrices = (clip_from_view, view, world);
            let screen = match vertices {
                VertexArithmetic::F32 => {
                    let (p, v, w) = matrices;
                    Screen::new((p.as_mat4() * (v.as_mat4() * w.as_mat4())).as_dmat4(), size)
                }
                VertexArithmetic::F64 => exact,
            };
            let place = [13.7, -31.1, 7.3 + i as f32];
            let mut got = [[0.0; 2]];
            let mut order = DrawOrder::default();
            (order.x, order.y, order.z) = (vec![place[0]], vec![place[1]], vec![place[2]]);
            to_pixels(ways, Level::new(), &screen, &order, 0, &mut got);
            let got = got[0].map(f64::from);
            let want = exact.pixels(exact.clip(place.map(f64::from)));
            worst = worst.max((got[0] - want[0]).hypot(got[1] - want[1]));
        }
        worst
    }

    #[test]
    fn vertices_are_as_far_off_as_the_table_of_axes_says() {
        // The precision of f32 for a coordinate up to 800.
        assert!(worst(VertexArithmetic::F64, 1e5) < 5e-5);
        let throughout = worst(VertexArithmetic::F32, 1e5);
        assert!((0.01..2.5).contains(&throughout), "{throughout}");
    }

    #[test]
    fn coarse_corners_are_the_nearest_of_their_parts() {
        for (subpixels, parts) in [(Subpixels::Bits0, 256), (Subpixels::Bits4, 16)] {
            let settings = Settings { subpixels, ..Settings::default() };
            let step = Variants::of(&settings).raster_mode().step;
            for x in -600..600 {
                let vertex = ScreenVertex::placed(Snapped { x, y: -x }, 0.5, 0.25);
                let mut all = [vertex];
                coarse(step, &mut all);
                let Snapped { x: got, y } = all[0].at();
                assert_eq!((got % parts, y % parts), (0, 0));
                assert!((got - x).abs() * 2 <= parts && (y + x).abs() * 2 <= parts, "{x}: {got}");
            }
            let at = Snapped { x: ScreenVertex::BEYOND, y: 0 };
            let mut all = [ScreenVertex::placed(at, 0.5, 0.25)];
            coarse(step, &mut all);
            assert!(!all[0].is_inside());
        }
    }
}
