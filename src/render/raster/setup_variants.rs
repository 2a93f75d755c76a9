//! Triangle setup for variants that draw triangles one by one. Corners are kept from before they
//! were snapped, since some variants of coverage use them.

use super::bins::Bins;
use super::setup::{Kind, Setup};
use super::unsnapped::UnsnappedTriangle;
use super::vertex_variants::{FINE_GUARD, Projected, coarse, project};
use crate::base::image::Size;
use crate::render::frame::draw::Pipeline;
use crate::render::frame::variants::Variants;
use crate::render::screen::clip::{Clip, Screen};
use crate::render::screen::coverage::{PixelBox, doubled_area};
use crate::render::screen::interpolation::subpixels;
use crate::scene::DrawTriangle;

/// Puts some of a draw's triangles into bins.
pub(crate) fn set_up(
    variants: Variants,
    setup: &Setup<'_>,
    triangles: &[DrawTriangle],
    pipelines: &[Pipeline],
    (size, bins): (Size, &mut Bins),
) {
    let screen = Screen::new(setup.draw.clip_from_object, size);
    let screen = if variants.has_fine_corners() { screen.guarded(FINE_GUARD) } else { screen };
    for triangle in triangles {
        let kind = setup.kind(triangle.number, pipelines);
        if kind == Kind::Not {
            continue;
        }
        let pieces = pieces(variants, setup, &screen, triangle);
        for i in 2..pieces.len() {
            let corners = [pieces[0], pieces[i - 1], pieces[i]];
            let number = setup.base + triangle.number;
            add_triangle(variants, setup, corners, (number, kind), bins);
        }
    }
}

/// A triangle's corners, or those of the triangles that are left of it after clipping.
fn pieces(
    variants: Variants,
    setup: &Setup<'_>,
    screen: &Screen,
    triangle: &DrawTriangle,
) -> Vec<Projected> {
    let place = |vertex: u32| {
        let i = vertex as usize;
        [setup.order.x[i], setup.order.y[i], setup.order.z[i]]
    };
    let whole = triangle.vertices.map(|vertex| project(variants, screen, place(vertex)));
    if whole.iter().all(|corner| corner.is_inside) {
        return whole.to_vec();
    }
    let clip = triangle.vertices.map(|vertex| screen.clip(place(vertex).map(f64::from)));
    let projected = |clip: Clip| {
        let vertex = screen.vertex(clip);
        let (depth, inverse_w) = (vertex.depth, vertex.inverse_w);
        Projected { at: screen.pixels(clip), depth, inverse_w, is_inside: true }
    };
    screen.cut_in_clip(clip).into_iter().map(projected).collect()
}

fn add_triangle(
    variants: Variants,
    setup: &Setup<'_>,
    corners: [Projected; 3],
    (number, kind): (u32, Kind),
    bins: &mut Bins,
) {
    let parts = f64::from(subpixels(variants));
    let snapped = corners.map(|corner| coarse(variants, corner.snapped(parts)).at());
    let area = doubled_area(snapped);
    let front = (area < 0) != setup.draw.mirrored;
    if area == 0 || (!front && setup.culls_back(kind)) {
        return;
    }
    let pixels = corners.map(|corner| corner.at);
    let depths = corners.map(|corner| corner.depth);
    let cutout = kind == Kind::Cutout;
    let plain = UnsnappedTriangle { corners: snapped, pixels, depths, number, cutout };
    let plain = plain.seen_from(setup.screen.shift(), subpixels(variants));
    bins.of(kind == Kind::Transparent).add_plain(plain, around(&plain.pixels));
}

/// The pixels that a triangle may cover by any variant: its bounding box and a pixel more to each
/// side.
#[expect(clippy::cast_possible_truncation, reason = "the guard band holds them")]
fn around(pixels: &[[f64; 2]; 3]) -> PixelBox {
    let low = |i: usize| pixels.iter().map(|at| at[i]).fold(f64::INFINITY, f64::min);
    let high = |i: usize| pixels.iter().map(|at| at[i]).fold(f64::NEG_INFINITY, f64::max);
    PixelBox {
        left: low(0).floor() as i32 - 1,
        top: low(1).floor() as i32 - 1,
        right: high(0).ceil() as i32 + 2,
        bottom: high(1).ceil() as i32 + 2,
    }
}
