//! What is seen at each pixel of a tile.
//!
//! One word of 64 bits a pixel: the bits of the depth above, the inverted number of the primitive
//! below. The larger word wins: what is nearer, and among what is equally near the primitive with the
//! lower number, that is of the older object, the earlier face. The order in which primitives are
//! drawn cannot show.

use super::bins::{Bin, TILE};
use super::coverage::{Covered, PixelBox, Triangle};
use super::geometry::{Geometry, ScreenTriangle};
use super::lines;
use super::plan::{FramePlan, Pipeline};
use super::surface;

const PIXELS: usize = (TILE * TILE) as usize;

/// Numbers of lines have this bit.
const LINE: u32 = 1 << 31;

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    /// Nothing.
    Background,
    /// A triangle, by its place in the geometry.
    Triangle(u32),
    /// A line, by its place in the geometry.
    Line(u32),
}

/// The words of one tile.
#[derive(Debug)]
pub(super) struct Visibility {
    words: [u64; PIXELS],
    bounds: PixelBox,
}

impl Visibility {
    /// Sees nothing.
    pub(super) const fn new() -> Self {
        let bounds = PixelBox { left: 0, top: 0, right: 0, bottom: 0 };
        Self { words: [0; PIXELS], bounds }
    }

    /// Looks at everything that reaches into a tile.
    pub(super) fn draw(
        &mut self,
        plan: &FramePlan,
        geometry: &Geometry,
        bounds: PixelBox,
        bin: &Bin,
    ) {
        self.words.fill(0);
        self.bounds = bounds;
        for &number in &bin.triangles {
            self.draw_triangle(plan, geometry, number);
        }
        for &number in &bin.lines {
            let line = &geometry.lines[number as usize];
            lines::pixels(line, plan.line_width, bounds, |x, y, depth| {
                self.put(x, y, depth, number | LINE);
            });
        }
    }

    fn draw_triangle(&mut self, plan: &FramePlan, geometry: &Geometry, number: u32) {
        let triangle = &geometry.triangles[number as usize];
        let corners = triangle.corners.map(|corner| corner.at);
        let Some(coverage) = Triangle::new(corners) else { return };
        let cutout = match &plan.pipelines[triangle.pipeline as usize] {
            Pipeline::Shaded(shaded) => shaded.cutout.map(|opacity| (shaded, opacity)),
            Pipeline::Flat(_) => None,
        };
        coverage.covered(self.bounds, |pixel| {
            let depth = depth_at(triangle, &coverage, &pixel);
            if let Some((shaded, opacity)) = cutout {
                let weights = surface::weights(geometry, triangle, &coverage, pixel.edges);
                let alpha = surface::alpha(plan, triangle, shaded, weights);
                if alpha * opacity < 0.5 {
                    return;
                }
            }
            self.put(pixel.x, pixel.y, depth, number);
        });
    }

    fn put(&mut self, x: i32, y: i32, depth: f32, number: u32) {
        let word = u64::from(depth.to_bits()) << 32 | u64::from(!number);
        let at = self.at(x, y);
        self.words[at] = self.words[at].max(word);
    }

    fn at(&self, x: i32, y: i32) -> usize {
        usize::try_from((y - self.bounds.top) * TILE + x - self.bounds.left).expect("in the tile")
    }

    /// What is seen at a pixel of the tile.
    pub(super) fn seen(&self, x: i32, y: i32) -> Seen {
        seen(self.words[self.at(x, y)])
    }

    /// The word of a pixel of the tile, for [`seen`] and [`depth`].
    pub(super) fn word(&self, x: i32, y: i32) -> u64 {
        self.words[self.at(x, y)]
    }
}

/// What a word says is seen.
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(super) const fn seen(word: u64) -> Seen {
    match (word, !(word as u32)) {
        (0, _) => Seen::Background,
        (_, number) if number & LINE != 0 => Seen::Line(number & !LINE),
        (_, number) => Seen::Triangle(number),
    }
}

/// The depth that a word says.
#[expect(clippy::cast_possible_truncation, reason = "the upper half is meant")]
pub(super) const fn depth(word: u64) -> f32 {
    f32::from_bits((word >> 32) as u32)
}

/// The depth of a triangle at a pixel, linear on the screen and within the depths of its corners.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the nearest number is meant"
)]
fn depth_at(triangle: &ScreenTriangle, coverage: &Triangle, pixel: &Covered) -> f32 {
    let [a, b, c] = triangle.corners.map(|corner| f64::from(corner.depth));
    let area = coverage.doubled_area() as f64;
    let [_, l1, l2] = pixel.edges.map(|edge| edge as f64 / area);
    let depth = a + l1 * (b - a) + l2 * (c - a);
    depth.clamp(a.min(b).min(c), a.max(b).max(c)) as f32
}
