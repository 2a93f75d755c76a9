//! What is known of the triangles that pixels show, gathered into rows, and what follows from it.
//!
//! Each quantity of each corner has a row, with one number for each pixel of a block, so that sixteen
//! pixels are computed at once whichever triangles they show.

use fearless_simd::{Level, Simd, SimdBase as _, SimdInt as _, dispatch, f32x16, i32x16};
use glam::DVec3;

use super::clip::Screen;
use super::corners::{Corners, Wide, cut_weights};
use super::coverage::SUBPIXELS;
use super::effects::{BATCH, Light, Rows};
use super::plan::{Draw, Eye, FramePlan};
use super::real::{Kernel, Machine};
use crate::scene::LightAt;

/// What is known at the pixels of a block. See the [module](self).
#[derive(Debug)]
pub struct Gathered<T> {
    pub(super) len: usize,
    /// x and y of the first two corners, in parts of a pixel.
    first_two: [[i32; 4]; BATCH],
    /// x and y of the third corner and of the pixel's middle.
    third: [[i32; 4]; BATCH],
    /// Column and row of the pixel's middle.
    pub(super) pixel: [[T; BATCH]; 2],
    /// Normal and one by w of each corner.
    pub(super) corners: [[[T; 4]; BATCH]; 3],
    pub(super) z: Rows<T>,
    /// Diffuse and specular light of each corner.
    pub(super) light: [[[[T; 4]; BATCH]; 2]; 3],
    pub(super) back: [bool; BATCH],
    /// Bit i: the barycentric coordinates of pixel i are already there.
    pub(super) exact: u64,
    /// The second and third barycentric coordinate, linear on the screen.
    linear: [[T; BATCH]; 2],
    /// The same with perspective.
    pub(super) weights: [[T; BATCH]; 2],
    /// The distance along the observer's axis.
    pub(super) w: [T; BATCH],
}

impl<T: Light> Default for Gathered<T> {
    fn default() -> Self {
        let row = [T::default(); BATCH];
        Self {
            len: 0,
            first_two: [[0; 4]; BATCH],
            third: [[0; 4]; BATCH],
            pixel: [row; 2],
            corners: [[[T::default(); 4]; BATCH]; 3],
            z: [row; 3],
            light: [[[[T::default(); 4]; BATCH]; 2]; 3],
            back: [false; BATCH],
            exact: 0,
            linear: [row; 2],
            weights: [row; 2],
            w: row,
        }
    }
}

impl<T: Light> Gathered<T> {
    /// Writes what pixel `i` of the group shows.
    #[inline(always)]
    pub(super) fn put(
        &mut self,
        i: usize,
        at: [i32; 2],
        corners: &Corners<T>,
        plan: &FramePlan,
        draw: &Draw,
        number: u32,
    ) {
        assert!(i < BATCH, "a group has no more pixels than a block");
        self.pixel[0][i] = T::from_f64(f64::from(at[0]) + 0.5);
        self.pixel[1][i] = T::from_f64(f64::from(at[1]) + 0.5);
        let [a, b, c] = corners.at;
        let middle = |i: i32| i * SUBPIXELS + SUBPIXELS / 2;
        self.first_two[i] = [a.x, a.y, b.x, b.y];
        self.third[i] = [c.x, c.y, middle(at[0]), middle(at[1])];
        self.corners[0][i] = corners.corners[0];
        self.corners[1][i] = corners.corners[1];
        self.corners[2][i] = corners.corners[2];
        if plan.light_at != LightAt::Pixel {
            for (rows, light) in self.light.iter_mut().zip(corners.light) {
                rows[0][i] = light[0];
                rows[1][i] = light[1];
            }
        }
        if plan.eye == Eye::Parallel {
            for corner in 0..3 {
                self.z[corner][i] = corners.z[corner];
            }
        }
        self.back[i] = corners.back;
        if let Some(wide) = &corners.wide {
            let [second, third] = wide.barycentric(at);
            self.exact |= 1 << i;
            self.linear[0][i] = T::from_f64(second);
            self.linear[1][i] = T::from_f64(third);
        } else if corners.cut {
            self.put_cut(i, at, plan, draw, number);
        }
    }

    /// Writes what a whole block shows of one triangle, where that has to be neither cut nor looked at
    /// by its small edges; says whether it did.
    pub(super) fn put_whole(
        &mut self,
        level: Level,
        [left, top]: [i32; 2],
        corners: &Corners<T>,
        plan: &FramePlan,
    ) -> bool {
        let Some(wide) = corners.wide else { return false };
        T::run(level, Whole { rows: self, corners, at: [left, top], wide });
        if plan.light_at != LightAt::Pixel {
            for (rows, light) in self.light.iter_mut().zip(corners.light) {
                rows[0].fill(light[0]);
                rows[1].fill(light[1]);
            }
        }
        if plan.eye == Eye::Parallel {
            for (row, z) in self.z.iter_mut().zip(corners.z) {
                row.fill(z);
            }
        }
        self.back.fill(corners.back);
        self.exact = u64::MAX;
        true
    }

    /// Writes the place in the triangle of a pixel of a triangle that was cut.
    #[cold]
    fn put_cut(&mut self, i: usize, at: [i32; 2], plan: &FramePlan, draw: &Draw, number: u32) {
        // With one w for all corners, what has perspective already stays as it is.
        let weights = cut_weights(plan, draw, number, at);
        let screen = Screen::new(draw.clip_from_object, plan.size);
        let order = draw.model.mesh.draw_order();
        let w = order.vertices_of(number).map(|vertex| screen.clip(order.position(vertex))[3]);
        let w = weights.dot(DVec3::from_array(w));
        for corner in &mut self.corners {
            corner[i][3] = T::from_f64(1.0 / w);
        }
        self.exact |= 1 << i;
        self.linear[0][i] = T::from_f64(weights.y);
        self.linear[1][i] = T::from_f64(weights.z);
    }

    /// The parts that the corners have in pixel `i` of the group.
    pub(super) fn weights(&self, i: usize) -> DVec3 {
        let (b, c): (f64, f64) = (self.weights[0][i].into(), self.weights[1][i].into());
        DVec3::new(1.0 - b - c, b, c)
    }

    /// Finds the barycentric coordinates of every pixel, first linear, then with perspective.
    pub(super) fn locate(&mut self, level: Level) {
        T::barycentric(level, self);
        T::run(level, Perspective(self));
    }
}

/// One triangle over a whole block.
struct Whole<'a, T> {
    rows: &'a mut Gathered<T>,
    corners: &'a Corners<T>,
    at: [i32; 2],
    wide: Wide,
}

impl<T: Light> Kernel<T> for Whole<'_, T> {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    fn run<M: Machine<Number = T>>(self, _: M) {
        let Self { rows, corners, at: [left, top], wide } = self;
        let [_, second, third] = wide.triangle.edges_at(left, top);
        let [[_, second_right, third_right], [_, second_down, third_down]] = wide.triangle.steps();
        for y in 0..8_i32 {
            let (second, third) =
                (second + i64::from(y) * second_down, third + i64::from(y) * third_down);
            for x in 0..8_i32 {
                let i = (y * 8 + x) as usize;
                let across = i64::from(x);
                let second = (second + across * second_right) as f64 * wide.per_area;
                let third = (third + across * third_right) as f64 * wide.per_area;
                rows.linear[0][i] = T::from_f64(second);
                rows.linear[1][i] = T::from_f64(third);
                rows.pixel[0][i] = T::from_f64(f64::from(left + x) + 0.5);
                rows.pixel[1][i] = T::from_f64(f64::from(top + y) + 0.5);
            }
        }
        for (rows, corner) in rows.corners.iter_mut().zip(corners.corners) {
            rows.fill(corner);
        }
    }
}

/// Numbers that attributes are computed in.
pub trait Locate: Sized {
    /// Whether barycentric coordinates come from whole numbers and f64 one by one.
    const EXACT: bool;
    /// Finds the linear barycentric coordinates that are not there yet.
    fn barycentric(level: Level, gathered: &mut Gathered<Self>);
}

impl Locate for f64 {
    const EXACT: bool = true;

    fn barycentric(_: Level, _: &mut Gathered<Self>) {}
}

impl Locate for f32 {
    const EXACT: bool = false;

    fn barycentric(level: Level, gathered: &mut Gathered<Self>) {
        if gathered.exact == u64::MAX {
            return;
        }
        if gathered.exact == 0 {
            dispatch!(level, simd => barycentric(simd, gathered));
            return;
        }
        let linear = gathered.linear;
        dispatch!(level, simd => barycentric(simd, gathered));
        let mut exact = gathered.exact;
        while exact != 0 {
            let i = exact.trailing_zeros() as usize;
            exact &= exact - 1;
            for (row, kept) in gathered.linear.iter_mut().zip(&linear) {
                row[i] = kept[i];
            }
        }
    }
}

/// The edge functions are exact in 32 bits, even where products of theirs are not: what overflows is
/// taken away again.
#[inline(always)]
fn barycentric<S: Simd>(simd: S, gathered: &mut Gathered<f32>) {
    for at in (0..gathered.len).step_by(16) {
        let [x0, y0, x1, y1] = load_four(simd, &gathered.first_two, at);
        let [x2, y2, cx, cy] = load_four(simd, &gathered.third, at);
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let second = (y2 - y0) * (cx - x2) + (x0 - x2) * (cy - y2);
        let third = (y0 - y1) * (cx - x0) + (x1 - x0) * (cy - y0);
        let per_area = f32x16::splat(simd, 1.0) / area.to_float::<f32x16<S>>();
        let second = second.to_float::<f32x16<S>>() * per_area;
        let third = third.to_float::<f32x16<S>>() * per_area;
        second.store_slice(&mut gathered.linear[0][at..at + 16]);
        third.store_slice(&mut gathered.linear[1][at..at + 16]);
    }
}

/// Four rows of whole numbers that lie side by side, from `at` on.
#[inline(always)]
fn load_four<S: Simd>(simd: S, rows: &[[i32; 4]; BATCH], at: usize) -> [i32x16<S>; 4] {
    let flat = rows[at..at + 16].as_flattened();
    let first = i32x16::from_slice(simd, &flat[..16]);
    let second = i32x16::from_slice(simd, &flat[16..32]);
    let third = i32x16::from_slice(simd, &flat[32..48]);
    let fourth = i32x16::from_slice(simd, &flat[48..]);
    let (even_low, odd_low) = first.deinterleave(second);
    let (even_high, odd_high) = third.deinterleave(fourth);
    let (a, c) = even_low.deinterleave(even_high);
    let (b, d) = odd_low.deinterleave(odd_high);
    [a, b, c, d]
}

/// m1 = l1 / w1 / (l0 / w0 + l1 / w1 + l2 / w2), and m2 alike; the sum is one by the pixel's own w.
struct Perspective<'a, T>(&'a mut Gathered<T>);

impl<T: Light> Kernel<T> for Perspective<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self(rows) = self;
        for at in (0..rows.len).step_by(M::LANES) {
            let second = machine.load(&rows.linear[0], at);
            let third = machine.load(&rows.linear[1], at);
            let [_, _, _, w0] = machine.load_four(&rows.corners[0], at);
            let [_, _, _, w1] = machine.load_four(&rows.corners[1], at);
            let [_, _, _, w2] = machine.load_four(&rows.corners[2], at);
            let w = machine.lift(1.0) / (w0 + second * (w1 - w0) + third * (w2 - w0));
            machine.store(w, &mut rows.w, at);
            machine.store(second * w1 * w, &mut rows.weights[0], at);
            machine.store(third * w2 * w, &mut rows.weights[1], at);
        }
    }
}
