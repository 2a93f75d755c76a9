//! Sets up the lines and points of meshes into bins, and finds their colours.

use std::ops::Range;

use fearless_simd::{Level, Simd};

use super::bins::Bins;
use super::edges::NEARER;
use super::lines::{LineNumber, ScreenLine};
use super::numbers::number;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::screen::clip::{Clip, Screen, ScreenVertex};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::simd::dispatch;
use marraztu_core::base::color::{Color, byte};
use marraztu_core::scene::Stroke;

/// The width in subpixels above which lines have round ends.
const ROUND: i32 = 2 * SUBPIXELS;

/// The inputs of the setup of one draw's strokes.
#[derive(Debug)]
pub(crate) struct StrokeSetup<'a> {
    pub(crate) draw: &'a Draw,
    pub(crate) screen: Screen,
    pub(crate) grid: Grid,
    /// The number of the draw's first stroke among the lines of the frame.
    pub(crate) first: u32,
    /// The width in subpixels.
    pub(crate) width: i32,
}

impl StrokeSetup<'_> {
    /// Sets up some of the draw's strokes into bins.
    pub(crate) fn run(&self, level: Level, some: Range<usize>, bins: &mut Bins) {
        // Dispatched so rounding uses the processor's instruction, if it has one.
        dispatch!(level, simd => self.all(simd, some.clone(), bins));
    }

    #[inline(always)]
    fn all<S: Simd>(&self, _: S, some: Range<usize>, bins: &mut Bins) {
        let Self { draw, screen, grid, first, width } = *self;
        let Some(drawn) = &draw.strokes else { return };
        let mesh = &draw.model.mesh;
        // Strokes are drawn over the faces that they lie on, like edges.
        let nearer = if draw.filled && mesh.polygon_count() > 0 { NEARER } else { 0 };
        for i in some {
            let stroke = &mesh.strokes()[i];
            if drawn.colors[stroke.part as usize].is_none() {
                continue;
            }
            let clip = mesh.stroke_ends(stroke).map(|end| screen.clip(end.to_array()));
            let is_point = stroke.is_point();
            let ends = if is_point { point(&screen, clip[0]) } else { screen.segment(clip) };
            let Some(ends) = ends else { continue };
            let number = LineNumber::new(first + number(i), false).bits();
            let line = ScreenLine { ends, number, nearer, grid, width, is_point };
            bins.add_line(line);
            // Round ends close the corners of wide polylines.
            if !is_point && width > ROUND {
                for end in ends {
                    bins.add_line(ScreenLine { ends: [end; 2], is_point: true, ..line });
                }
            }
        }
    }
}

/// Returns a point on the screen twice, unless it is beyond the clipping planes.
#[inline(always)]
fn point(screen: &Screen, clip: Clip) -> Option<[ScreenVertex; 2]> {
    screen.vertex(clip).is_inside().then(|| [screen.piece(clip); 2])
}

/// Returns the colour of a draw's stroke at a pixel: that of its part, or that of its vertices,
/// interpolated in perspective.
pub(super) fn color(plan: &FramePlan, draw: &Draw, stroke: u32, pixel: [i32; 2]) -> Color {
    let mesh = &draw.model.mesh;
    let stroke = &mesh.strokes()[stroke as usize];
    let of_part = draw.strokes.as_ref().and_then(|drawn| {
        if drawn.vertex_colors { None } else { drawn.colors[stroke.part as usize] }
    });
    of_part.unwrap_or_else(|| {
        let [from, to] = stroke.ends.map(|end| mesh.colors()[end as usize].map(f64::from));
        let t = if from == to { 0.0 } else { along(plan, draw, stroke, pixel) };
        Color(std::array::from_fn(|i| byte(from[i] + (to[i] - from[i]) * t)))
    })
}

/// Returns the place on a line, from 0 to 1, that is at a pixel along the line's longer axis. With
/// the ends a and b in homogeneous coordinates and p on the screen, x of a + t (b - a) is p w.
pub(crate) fn along(plan: &FramePlan, draw: &Draw, stroke: &Stroke, pixel: [i32; 2]) -> f64 {
    let screen = Screen::new(draw.clip_from_object, plan.viewport);
    let [a, b] = draw.model.mesh.stroke_ends(stroke).map(|end| screen.clip(end.to_array()));
    let [half_x, half_y] = screen.half;
    let at = |axis: usize| {
        f64::from(pixel[axis]) + 0.5 + f64::from(plan.shift[axis]) / f64::from(SUBPIXELS)
    };
    // Normalised device coordinates of the pixel, with y up.
    let place = [at(0) / half_x - 1.0, 1.0 - at(1) / half_y];
    let moves = |axis: usize| ((b[axis] - a[axis]) * a[3] - a[axis] * (b[3] - a[3])).abs();
    let axis = usize::from(moves(1) * half_y > moves(0) * half_x);
    let from = a[axis] - place[axis] * a[3];
    let t = from / (from - (b[axis] - place[axis] * b[3]));
    // Also NaN becomes 0.
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}
