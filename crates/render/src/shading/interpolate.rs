//! Interpolates attributes: from fragments and their triangles to positions, normals and light.
//!
//! Attributes at corners are weighted by the barycentric coordinates of each pixel
//! ([`Barycentrics`]). Only differences are weighted, so a value shared by all corners is returned
//! unchanged, bit for bit.
//!
//! The position of a pixel in space is the point of its ray at its depth. The direction to the
//! observer is therefore exact for any triangle.

use fearless_simd::Level;

use super::barycentrics::Barycentrics;
use super::colors::Colors;
use super::fragments::Fragments;
use super::triangle_attributes::{TriangleAttributes, picked};
use crate::frame::draw::Draw;
use crate::frame::{Eye, FramePlan, Viewport};
use crate::lights::{Batch, Rows, Sample, columns, load, store, turned};
use crate::screen::coverage::SUBPIXELS;
use crate::screen::perspective::between;
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Kernel, Lanes, Number, Real, Vec3};

/// Three numbers at the corners of some triangles: the first corner's numbers, and the differences
/// of the second and third from them.
pub(crate) type CornerValues<T> = [[[T; SLOTS]; 3]; 3];

/// Fragments with their triangles, and their places in them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Points<'a, T> {
    pub(crate) fragments: &'a Fragments,
    pub(crate) attributes: &'a TriangleAttributes<T>,
    pub(crate) barycentrics: &'a Barycentrics<T>,
}

/// Interpolates attributes at some pixels.
#[inline(always)]
pub(super) fn mixed<M: Lanes>(
    lanes: M,
    rows: &CornerValues<M::Number>,
    slots: M::Slots,
    weights: [M::R; 2],
) -> Vec3<M::R> {
    let a = picked(lanes, &rows[0], slots);
    let b = picked(lanes, &rows[1], slots);
    let c = picked(lanes, &rows[2], slots);
    between([a, b, c], weights)
}

/// The destination of interpolated attributes.
#[derive(Debug)]
pub(crate) enum Mixed<'a, T> {
    /// Light.
    Rows(&'a mut Rows<T>),
    /// Colours, which are multiplied by the attributes.
    Product(&'a mut Rows<T>),
    /// Colours, with their rounding thresholds.
    Colors(&'a mut Colors, &'a [T; BATCH]),
}

/// Interpolates values at every pixel.
pub(crate) fn mix<T: Number>(
    level: Level,
    points: Points<'_, T>,
    values: &CornerValues<T>,
    to: Mixed<'_, T>,
) {
    T::run(level, Mix { points, values, to });
}

struct Mix<'a, T> {
    points: Points<'a, T>,
    values: &'a CornerValues<T>,
    to: Mixed<'a, T>,
}

impl<T: Number> Kernel<T> for Mix<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { points: Points { fragments, attributes, barycentrics }, values, mut to } = self;
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots((&fragments.slots, attributes.count), at);
            let value = mixed(lanes, values, slots, barycentrics.weights_at(lanes, at));
            match &mut to {
                Mixed::Rows(rows) => store(lanes, value, rows, at),
                Mixed::Product(rows) => {
                    store(lanes, load(lanes, rows, at).product(value), rows, at);
                }
                Mixed::Colors(colors, thresholds) => {
                    colors.store_by(lanes, value, lanes.load(*thresholds, at), at);
                }
            }
        }
    }
}

/// Computes position, normal and direction to the observer of every pixel, from normals at the
/// corners.
pub(crate) fn surface_samples<T: Number>(
    level: Level,
    look: Look<T>,
    points: Points<'_, T>,
    batch: &mut Batch<T>,
) {
    match points.fragments.shared {
        true => T::run(level, SurfaceSamples::<T, true> { points, batch, look }),
        false => T::run(level, SurfaceSamples::<T, false> { points, batch, look }),
    }
}

/// The rays of the observer, and the normal transform of a draw. The rays of pixels: x = column a +
/// b, y = row c + d, each times w in perspective; z = -w.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look<T> {
    parallel: bool,
    x: [T; 2],
    y: [T; 2],
    /// The columns of the matrix that transforms normals to view space.
    normals: [[T; 3]; 3],
}

impl<T: Number> Look<T> {
    pub(crate) fn new(plan: &FramePlan, draw: &Draw) -> Self {
        let (px, py) = (plan.clip_from_view.x_axis.x, plan.clip_from_view.y_axis.y);
        let Viewport { width, height } = plan.viewport;
        let axis = plan.axis();
        // From pixels to -1..1 relative to the view axis, divided by the entries of the projection.
        let mut x = [2.0 / width / px, (-1.0 - axis[0]) / px];
        let mut y = [-2.0 / height / py, (1.0 - axis[1]) / py];
        // A sample is offset from the centre of its pixel.
        for (ray, shift) in [&mut x, &mut y].into_iter().zip(plan.shift) {
            if shift != 0 {
                ray[1] += ray[0] * f64::from(shift) / f64::from(SUBPIXELS);
            }
        }
        Self {
            parallel: plan.eye == Eye::Parallel,
            x: x.map(T::from_f64),
            y: y.map(T::from_f64),
            normals: columns(draw.view_from_normal),
        }
    }

    /// Computes position, normal and direction to the observer of some pixels, from their normals
    /// in object space, their positions in the picture and their w. In orthographic projection
    /// `depth` returns z.
    #[inline(always)]
    pub(crate) fn at<M: Lanes<Number = T>>(
        &self,
        lanes: M,
        normal: Vec3<M::R>,
        [column, row]: [M::R; 2],
        w: M::R,
        depth: impl FnOnce() -> M::R,
    ) -> Sample<M::R> {
        let normal = turned(lanes, self.normals, normal).unit();
        let (zero, one) = (lanes.lift(0.0), lanes.lift(1.0));
        let x = column * lanes.set(self.x[0]) + lanes.set(self.x[1]);
        let y = row * lanes.set(self.y[0]) + lanes.set(self.y[1]);
        // In perspective all rays start at the observer; in orthographic projection they are
        // parallel.
        let (position, to_eye) = if self.parallel {
            (Vec3([x, y, depth()]), Vec3([zero, zero, one]))
        } else {
            (Vec3([x * w, y * w, -w]), Vec3([-x, -y, one]).unit())
        };
        Sample { position, normal, to_eye, exponent: one }
    }
}

struct SurfaceSamples<'a, T, const SHARED: bool> {
    points: Points<'a, T>,
    batch: &'a mut Batch<T>,
    look: Look<T>,
}

impl<T: Number, const SHARED: bool> Kernel<T> for SurfaceSamples<'_, T, SHARED> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { points: Points { fragments, attributes, barycentrics }, batch, look } = self;
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots((&fragments.slots, attributes.count), at);
            let weights = barycentrics.weights_at(lanes, at);
            let normal = mixed(lanes, &attributes.values, slots, weights);
            let half = lanes.lift(0.5);
            // A shared pixel is lit where its triangle was clamped, others at their centre.
            let place = match SHARED {
                true => [
                    lanes.load(&barycentrics.positions[0], at),
                    lanes.load(&barycentrics.positions[1], at),
                ],
                false => {
                    [lanes.whole(&fragments.x, at) + half, lanes.whole(&fragments.y, at) + half]
                }
            };
            let w = lanes.load(&barycentrics.w, at);
            // z is only interpolated in orthographic projection.
            let sample = look.at(lanes, normal, place, w, || {
                depth_between(picked(lanes, &attributes.z, slots), weights)
            });
            batch.put(lanes, sample, at);
        }
    }
}

/// Interpolates z between corners, for orthographic projection.
#[inline(always)]
pub(crate) fn depth_between<R: Real>(Vec3([z0, z1, z2]): Vec3<R>, weights: [R; 2]) -> R {
    z0 + (z1 - z0) * weights[0] + (z2 - z0) * weights[1]
}
