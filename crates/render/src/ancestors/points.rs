//! Ancestor A's fill algorithm: separate points every 0.1 unit of the observer's space.
//!
//! A row of points lies at every 0.1 unit of height, with a point every 0.1 unit along the row. At
//! a distance of 400, with 800 pixels for 45 degrees, a pixel is written 17 times; at 966, a
//! hundred times. Nearer than 97, points are farther apart than pixels and leave holes.
//!
//! The lattice of points lies across the direction of view. A surface along that direction, such as
//! a floor under a level camera or a wall beside it, therefore lies between two rows or two columns
//! and vanishes, however large it is on the screen. Floors that are almost level become stripes.
//!
//! Beyond the distance at which a pixel gets [`MOST`] points along a side, the step grows with the
//! distance. A kept the step constant and took minutes.

use crate::accel::Accelerated as _;
use glam::{DVec3, DVec4};

use crate::frame::draw::Draw;
use crate::frame::{Eye, FramePlan};
use crate::screen::coverage::{PixelBox, SUBPIXELS};

/// The step, in world units.
const STEP: f64 = 0.1;

/// The largest number of points along the side of a pixel.
const MOST: f64 = 16.0;

/// Calls `take` with the pixel and depth of every point of a triangle that falls into `clip`, for a
/// sample with an offset in 1/256 pixel.
pub(crate) fn cover(
    plan: &FramePlan,
    draw: &Draw,
    number: u32,
    (clip, shift): (PixelBox, [i32; 2]),
    take: &mut dyn FnMut(i32, i32, f32),
) {
    let order = draw.model.mesh.draw_order();
    let corners = order.vertices_of(number).map(|vertex| {
        draw.view_from_object.transform_point3(DVec3::from_array(order.position(vertex)))
    });
    let Some(window) = Window::new(plan, (clip, shift), &corners) else { return };
    // Rows and columns are multiples of the step, so all triangles share one lattice of points.
    let step = window.step;
    let rows = |y: f64| (y / step).ceil();
    let mut row = rows(window.low[1].max(least(&corners, |p| p.y)));
    let last = window.high[1].min(most(&corners, |p| p.y)) / step;
    while row <= last {
        let y = row * step;
        // Depth is linear along a row of the observer's space.
        if let Some([from, to]) = span(&corners, y) {
            let mut column = rows(window.low[0].max(from.x));
            let end = window.high[0].min(to.x) / step;
            let per_unit = if to.x > from.x { (to.z - from.z) / (to.x - from.x) } else { 0.0 };
            while column <= end {
                let x = column * step;
                let z = from.z + (x - from.x) * per_unit;
                window.point(DVec3::new(x, y, z), take);
                column += 1.0;
            }
        }
        row += 1.0;
    }
}

fn least(corners: &[DVec3; 3], of: fn(&DVec3) -> f64) -> f64 {
    corners.iter().map(of).fold(f64::INFINITY, f64::min)
}

fn most(corners: &[DVec3; 3], of: fn(&DVec3) -> f64) -> f64 {
    corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the left and right end of a triangle at a height.
fn span(corners: &[DVec3; 3], y: f64) -> Option<[DVec3; 2]> {
    let mut ends: Option<[DVec3; 2]> = None;
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        // A level edge has no single point at this height; its neighbours end there.
        if y < p.y.min(q.y) || y > p.y.max(q.y) || p.y == q.y {
            continue;
        }
        let end = p + (q - p) * ((y - p.y) / (q.y - p.y));
        let [from, to] = ends.unwrap_or([end; 2]);
        ends = Some([if end.x < from.x { end } else { from }, if end.x > to.x { end } else { to }]);
    }
    ends
}

/// A box of pixels, and the part of the observer's space with points that may fall into it.
struct Window<'a> {
    plan: &'a FramePlan,
    clip: PixelBox,
    shift: [f64; 2],
    half: [f64; 2],
    step: f64,
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Window<'a> {
    fn new(
        plan: &'a FramePlan,
        (clip, shift): (PixelBox, [i32; 2]),
        corners: &[DVec3; 3],
    ) -> Option<Self> {
        let shift = shift.map(|shift| f64::from(shift) / f64::from(SUBPIXELS));
        let half = [plan.viewport.width / 2.0, plan.viewport.height / 2.0];
        let (px, py) = (plan.clip_from_view.x_axis.x, plan.clip_from_view.y_axis.y);
        // The length of a world unit in view space.
        let unit = plan.view_from_world.x_axis.truncate().length();
        let distances = match plan.eye {
            Eye::Point => {
                // The observer looks along -z.
                let (near, far) = (-most(corners, |p| p.z), -least(corners, |p| p.z));
                if far <= 0.0 {
                    return None;
                }
                [near.max(0.0), far]
            }
            Eye::Parallel => [1.0; 2],
        };
        // The step grows once a pixel has more than [`MOST`] points along a side.
        let pixel = distances[1] / (half[0] * px).min(half[1] * py);
        let step = (STEP * unit).max(pixel / MOST);
        if !step.is_finite() {
            return None;
        }
        // One more pixel on each side, for rounding.
        let axis = plan.axis();
        let x =
            [clip.left - 1, clip.right + 1].map(|x| (f64::from(x) / half[0] - 1.0 - axis[0]) / px);
        let y =
            [clip.bottom + 1, clip.top - 1].map(|y| (1.0 - f64::from(y) / half[1] - axis[1]) / py);
        // The view widens with the distance, so the extremes are at the nearest or farthest corner.
        let reach = |[low, high]: [f64; 2]| {
            let all = distances.map(|d| [low * d, high * d]);
            let all = all.as_flattened();
            let low = all.iter().copied().fold(f64::INFINITY, f64::min);
            [low, all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
        };
        let (x, y) = (reach(x), reach(y));
        Some(Self { plan, clip, shift, half, step, low: [x[0], y[0]], high: [x[1], y[1]] })
    }

    #[expect(clippy::cast_possible_truncation, reason = "a pixel of the picture, and its depth")]
    fn point(&self, place: DVec3, take: &mut dyn FnMut(i32, i32, f32)) {
        let DVec4 { x, y, z, w } = self.plan.clip_from_view * place.extend(1.0);
        let depth = z / w;
        // Points beyond the near or far plane are left out; negated, so that NaN is, too.
        if !(w > 0.0 && (0.0..=1.0).contains(&depth)) {
            return;
        }
        // A point belongs to the pixel that it falls into; centres do not matter.
        let column = ((x / w + 1.0) * self.half[0] - self.shift[0]).floor() as i32;
        let row = ((1.0 - y / w) * self.half[1] - self.shift[1]).floor() as i32;
        let PixelBox { left, top, right, bottom } = self.clip;
        if (left..right).contains(&column) && (top..bottom).contains(&row) {
            take(column, row, depth as f32);
        }
    }
}
