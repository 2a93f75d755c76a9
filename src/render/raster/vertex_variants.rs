//! Variants of transforming vertices: in f32, or snapped to another subpixel grid.
//!
//! Coarser subpixels are multiples of the default's, so only positions change. Finer ones are not:
//! such corners are stored separately, in units of 1/4096 pixel, and with a guard band of 2^17
//! pixels instead of 2^20, so that edge functions stay below 2^62.

use fearless_simd::Level;

use super::vertices;
use crate::accuracy::{Subpixels, VertexArithmetic};
use crate::render::frame::variants::Variants;
use crate::render::screen::clip::{Screen, ScreenVertex};
use crate::render::screen::coverage::{SUBPIXELS, Snapped};
use crate::scene::DrawOrder;

/// The guard band of fine corners, in pixels.
pub(crate) const FINE_GUARD: f64 = 131_072.0;

/// A vertex that is not snapped yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projected {
    /// In pixels.
    pub(crate) at: [f64; 2],
    pub(crate) depth: f32,
    pub(crate) inverse_w: f32,
    /// Whether it is inside the clipping planes.
    pub(crate) is_inside: bool,
}

impl Projected {
    /// Snaps it to 1/`parts` pixel.
    #[expect(clippy::cast_possible_truncation, reason = "the guard band holds it")]
    pub(crate) fn snapped(&self, parts: f64) -> ScreenVertex {
        let [x, y] = self.at.map(|pixels| libm::rint(pixels * parts) as i32);
        let vertex = ScreenVertex::placed(Snapped { x, y }, self.depth, self.inverse_w);
        if self.is_inside { vertex } else { vertex.beyond() }
    }
}

/// Transforms vertices of a mesh to the screen, from number `first` on.
pub(crate) fn transform(
    variants: Variants,
    level: Level,
    screen: &Screen,
    order: &DrawOrder,
    first: usize,
    out: &mut [ScreenVertex],
) {
    if variants.vertices == VertexArithmetic::F64 {
        vertices::transform(level, screen, order, first, out);
    } else {
        let screen32 = Screen32::new(screen);
        for (i, out) in out.iter_mut().enumerate() {
            let place = [order.x[first + i], order.y[first + i], order.z[first + i]];
            *out = screen32.vertex(screen, place).snapped(f64::from(SUBPIXELS));
        }
    }
    for vertex in out {
        *vertex = coarse(variants, *vertex);
    }
}

/// Transforms vertices to the screen, snapped to 1/4096 pixel.
pub(crate) fn transform_finely(
    variants: Variants,
    screen: &Screen,
    order: &DrawOrder,
    first: usize,
    out: &mut [ScreenVertex],
) {
    let screen = screen.guarded(FINE_GUARD);
    for (i, out) in out.iter_mut().enumerate() {
        let place = [order.x[first + i], order.y[first + i], order.z[first + i]];
        *out = project(variants, &screen, place).snapped(4096.0);
    }
}

/// Projects a position of object space to the screen.
pub(crate) fn project(variants: Variants, screen: &Screen, place: [f32; 3]) -> Projected {
    if variants.vertices == VertexArithmetic::F64 {
        let clip = screen.clip(place.map(f64::from));
        let vertex = screen.vertex(clip);
        let (depth, inverse_w, is_inside) = (vertex.depth, vertex.inverse_w, vertex.is_inside());
        Projected { at: screen.pixels(clip), depth, inverse_w, is_inside }
    } else {
        Screen32::new(screen).vertex(screen, place)
    }
}

/// Snaps a vertex to coarser subpixels, if the settings choose them.
pub(crate) fn coarse(variants: Variants, vertex: ScreenVertex) -> ScreenVertex {
    let parts = match variants.subpixels {
        Subpixels::Bits0 => SUBPIXELS,
        Subpixels::Bits4 => SUBPIXELS / 16,
        Subpixels::Bits8 | Subpixels::Bits12 => return vertex,
    };
    if !vertex.is_inside() {
        return vertex;
    }
    let Snapped { x, y } = vertex.at();
    let snap = |i: i32| (i + parts / 2).div_euclid(parts) * parts;
    let at = Snapped { x: snap(x), y: snap(y) };
    ScreenVertex::placed(at, vertex.depth, vertex.inverse_w)
}

/// The transform from object space to the screen, in f32.
struct Screen32 {
    rows: [[f32; 4]; 4],
    half: [f32; 2],
}

impl Screen32 {
    #[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
    fn new(screen: &Screen) -> Self {
        let rows = screen.rows.map(|row| row.map(|x| x as f32));
        Self { rows, half: screen.half.map(|x| x as f32) }
    }

    fn vertex(&self, screen: &Screen, [x, y, z]: [f32; 3]) -> Projected {
        let clip = self.rows.map(|[a, b, c, d]| a * x + b * y + c * z + d);
        let is_inside = screen.vertex(clip.map(f64::from)).is_inside();
        let [x, y, z, w] = clip;
        let inverse_w = 1.0 / w;
        let at = [(x * inverse_w + 1.0) * self.half[0], (1.0 - y * inverse_w) * self.half[1]];
        let depth = z * inverse_w;
        let depth = if depth > 0.0 { depth } else { 0.0 };
        let depth = if depth < 1.0 { depth } else { 1.0 };
        Projected { at: at.map(f64::from), depth, inverse_w, is_inside }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;
    use crate::base::image::Size;
    use crate::base::math;

    /// The largest error on the screen, in pixels, of vertices 400 in front of a camera that is
    /// `offset` from the origin.
    fn worst(vertices: VertexArithmetic, offset: f64) -> f64 {
        let size = Size::new(800, 800);
        let clip_from_view = math::perspective(22.5_f64.to_radians(), 1.0, 2000.0, size);
        let (mut worst, ways) = (0.0_f64, Variants { vertices, ..Variants::default() });
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
                _ => exact,
            };
            let place = [13.7, -31.1, 7.3 + i as f32];
            let got = project(ways, &screen, place).at;
            let want = exact.pixels(exact.clip(place.map(f64::from)));
            worst = worst.max((got[0] - want[0]).hypot(got[1] - want[1]));
        }
        worst
    }

    #[test]
    fn vertices_are_as_far_off_as_the_table_of_axes_says() {
        assert!(worst(VertexArithmetic::F64, 1e5) < 1e-9);
        let composed = worst(VertexArithmetic::F32ComposedInF64, 1e5);
        assert!((1e-6..2e-4).contains(&composed), "{composed}");
        let throughout = worst(VertexArithmetic::F32, 1e5);
        assert!((0.01..2.5).contains(&throughout), "{throughout}");
    }

    #[test]
    fn coarse_corners_are_the_nearest_of_their_parts() {
        for (subpixels, parts) in [(Subpixels::Bits0, 256), (Subpixels::Bits4, 16)] {
            let ways = Variants { subpixels, ..Variants::default() };
            for x in -600..600 {
                let vertex = ScreenVertex::placed(Snapped { x, y: -x }, 0.5, 0.25);
                let Snapped { x: got, y } = coarse(ways, vertex).at();
                assert_eq!((got % parts, y % parts), (0, 0));
                assert!((got - x).abs() * 2 <= parts && (y + x).abs() * 2 <= parts, "{x}: {got}");
            }
            assert!(!coarse(ways, ScreenVertex::default().beyond()).is_inside());
        }
    }
}
