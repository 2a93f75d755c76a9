//! Colours of hits: with light at vertices, the pixels of small triangles are coloured during
//! rasterisation, before it is known which of them are visible.
//!
//! At that time the triangle, its neighbours and the light of their vertices are in the L1 cache,
//! and the edge functions are available. A visible pixel with a colour needs no list of triangles
//! and no further loads: a model of 70,000 triangles takes 0.8 to 0.9 of the time. The work on
//! hidden pixels is wasted, so this does not pay for triangles that are mostly smaller than a
//! pixel. The creator of the [`CornerLight`] decides.
//!
//! A pixel coloured later gets the same bits. An unknown colour is 0.

use std::fmt::Debug;

use fearless_simd::{Bytes as _, Simd, SimdBase as _, f32x16, i32x16, u32x16};

use super::hits::PACK;
use super::inputs::Inputs;
use crate::screen::perspective::{between, weighed};
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};
use crate::simd::gather::{of_lanes, pick};
use crate::simd::{Encoding, Lanes as _, Sixteen, Vec3};
use marraztu_core::accuracy::Interpolation;

/// The light at the vertices of a frame, as final colours.
pub(crate) trait CornerLight: Debug + Sync {
    /// Returns the conversion of colours to bytes.
    fn conversion(&self) -> Conversion<'_>;
    /// Creates the look-up of one thread.
    fn begin<'a>(&'a self, inputs: &'a Inputs) -> Box<dyn LookUp + 'a>;
}

/// Looks up the light at corners of triangles.
pub(crate) trait LookUp: Debug {
    /// Sets the colours at the corners of some triangles. Returns whether all of them are known; if
    /// not, none is set.
    fn set(&mut self, triangles: &Triangles<'_>, to: &mut Corners) -> bool;
    /// Returns the colours at the corners of one triangle, if known. The triangle is given by its
    /// number in the frame, its vertices in the draw order of its mesh, and whether it runs
    /// clockwise on the screen.
    fn corners(&mut self, number: u32, vertices: [u32; 3], clockwise: bool)
    -> Option<CornerColors>;
}

/// Red, green and blue at the corners of a triangle; the fourth number is unused.
pub(crate) type CornerColors = [[f32; 4]; 3];

/// Some of sixteen triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangles<'a> {
    /// The triangles' numbers in the frame.
    pub(crate) numbers: &'a [u32; PACK],
    /// The vertices of each corner, in the draw order of the mesh.
    pub(crate) vertices: &'a [[u32; PACK]; 3],
    /// The bit mask of the triangles meant.
    pub(crate) some: u64,
    /// The bit mask of triangles that run clockwise on the screen.
    pub(crate) clockwise: u64,
}

/// The colours at the corners of sixteen triangles.
#[derive(Debug, Default)]
#[repr(align(64))]
pub(crate) struct Corners {
    /// 1/w of each corner.
    pub(crate) by_w: [[f32; PACK]; 3],
    /// Red, green and blue of the first corner, and the differences of the others from it.
    pub(crate) colors: [[[f32; PACK]; 3]; 3],
}

/// The conversion of interpolated colours to bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conversion<'a> {
    pub(crate) interpolation: Interpolation,
    /// The rounding thresholds of a block's pixels.
    pub(crate) thresholds: &'a [f32; BLOCK_PIXELS],
    /// The encoding, if colours are linear.
    pub(crate) encoding: Option<&'a Encoding>,
}

/// One thread's means to colour hits; by default none.
#[derive(Debug, Default)]
pub(crate) struct Brush<'a> {
    /// The look-up and conversion; `None` if hits have no colours.
    own: Option<(Box<dyn LookUp + 'a>, Conversion<'a>)>,
    corners: Corners,
}

impl<'a> Brush<'a> {
    pub(crate) fn new(light: Option<&'a dyn CornerLight>, inputs: &'a Inputs) -> Self {
        let own = light.map(|light| (light.begin(inputs), light.conversion()));
        Self { own, corners: Corners::default() }
    }

    /// Returns a mixer for the pixels of some triangles, if their colours are known.
    #[inline(always)]
    pub(crate) fn mix<S: Simd>(
        &mut self,
        per_area: f32x16<S>,
        triangles: &Triangles<'_>,
    ) -> Option<Mix<'a, S>> {
        let (look_up, conversion) = self.own.as_mut()?;
        let is_known = look_up.set(triangles, &mut self.corners);
        is_known.then(|| Mix::new(&self.corners, per_area, *conversion))
    }

    /// Returns the colours at the corners of one triangle, like [`LookUp::corners`].
    pub(crate) fn corners(
        &mut self,
        number: u32,
        vertices: [u32; 3],
        clockwise: bool,
    ) -> Option<CornerColors> {
        let (look_up, _) = self.own.as_mut()?;
        look_up.corners(number, vertices, clockwise)
    }
}

/// Colours the pixels of sixteen triangles.
#[derive(Clone, Copy)]
pub(crate) struct Mix<'a, S: Simd> {
    per_area: f32x16<S>,
    by_w: [f32x16<S>; 3],
    colors: [[f32x16<S>; 3]; 3],
    conversion: Conversion<'a>,
    /// The rounding threshold, if all pixels share one.
    threshold: Option<f32>,
}

impl<'a, S: Simd> Mix<'a, S> {
    #[inline(always)]
    fn new(
        Corners { by_w: [w0, w1, w2], colors: [a, b, c] }: &Corners,
        per_area: f32x16<S>,
        conversion: Conversion<'a>,
    ) -> Self {
        let simd = per_area.simd;
        let [first, second, ..] = *conversion.thresholds;
        Self {
            per_area,
            by_w: [row(simd, w0), row(simd, w1), row(simd, w2)],
            colors: [
                [row(simd, &a[0]), row(simd, &a[1]), row(simd, &a[2])],
                [row(simd, &b[0]), row(simd, &b[1]), row(simd, &b[2])],
                [row(simd, &c[0]), row(simd, &c[1]), row(simd, &c[2])],
            ],
            conversion,
            // Only ordered dithering has thresholds that differ between neighbours.
            threshold: (first.to_bits() == second.to_bits()).then_some(first),
        }
    }

    /// Computes the colours of sixteen pixels of the triangles in these lanes, from the edge
    /// functions of the second and third corner there.
    #[inline(always)]
    pub(crate) fn colors(
        &self,
        lanes: i32x16<S>,
        [second, third]: [f32x16<S>; 2],
        [x, y]: [i32x16<S>; 2],
    ) -> u32x16<S> {
        let simd = lanes.simd;
        let Self { by_w: [w0, w1, w2], colors: [a, b, c], .. } = self;
        // Each pixel takes the numbers of its triangle from that triangle's lane.
        let per_area = of_lanes(self.per_area, lanes);
        let linear = [second * per_area, third * per_area];
        let by_w = Vec3([of_lanes(*w0, lanes), of_lanes(*w1, lanes), of_lanes(*w2, lanes)]);
        let corners = [colors(a, lanes), colors(b, lanes), colors(c, lanes)];
        // Ordered dithering uses a threshold per pixel of the block.
        let threshold = match self.threshold {
            Some(threshold) => f32x16::splat(simd, threshold),
            None => {
                let place = (y & (BLOCK - 1)) * BLOCK + (x & (BLOCK - 1));
                // The 64 thresholds fill four pages of a table.
                let thresholds = bytemuck::cast_ref(self.conversion.thresholds);
                pick::<S, 4>(simd, thresholds, place).bitcast()
            }
        };
        self.conversion.pixels(simd, linear, (by_w, corners), threshold)
    }
}

impl Conversion<'_> {
    /// Computes the colours of sixteen pixels from the linear coordinates of the second and third
    /// corner there, from 1/w, and from the colours of the corners: the first one's, and the
    /// differences of the others from it.
    #[inline(always)]
    pub(super) fn pixels<S: Simd>(
        &self,
        simd: S,
        linear: [f32x16<S>; 2],
        (by_w, corners): (Vec3<f32x16<S>>, [Vec3<f32x16<S>>; 3]),
        threshold: f32x16<S>,
    ) -> u32x16<S> {
        // The same functions as in later shading, for the same bits.
        let (weights, _) = weighed(self.interpolation, Sixteen(simd), linear, by_w);
        let mut color = between(corners, weights);
        // Linear colours are encoded after interpolation.
        if let Some(encoding) = self.encoding {
            let Vec3([r, g, b]) = color;
            color = Vec3([encoding.of(r), encoding.of(g), encoding.of(b)]);
        }
        let mut pixels = [0; PACK];
        Sixteen(simd).store_pixels_by(color, threshold, &mut pixels, 0);
        u32x16::from_slice(simd, &pixels)
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, numbers: &[f32; PACK]) -> f32x16<S> {
    f32x16::from_slice(simd, numbers)
}

/// Returns the colours at one corner of the triangles in these lanes.
#[inline(always)]
fn colors<S: Simd>([r, g, b]: &[f32x16<S>; 3], lanes: i32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([of_lanes(*r, lanes), of_lanes(*g, lanes), of_lanes(*b, lanes)])
}
