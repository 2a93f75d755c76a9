//! Draws a picture in bands of rows, from top to bottom, so memory never holds all of it.
//!
//! With 16 samples per pixel, the sums and the bytes of a picture take twelve bytes per pixel: more
//! than three gigabytes at 16384 x 16384. A band needs them for its rows only, and can be encoded
//! while the next one is drawn. Several samples per pixel build the geometry again in each band, so
//! there are at most [`MOST_BANDS`].

use super::cancellation::Cancellation;
use super::frame::FramePlan;
use super::plan::plan_frame;
use super::renderer::{Cancelled, Renderer};
use super::screen::tiles::TILE_SIDE;
use super::without_ground::{over_black_and_white, uncover};
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};

/// The largest picture that is one band, in pixels: 4096 x 4096.
const LARGEST_BAND: usize = 1 << 24;

/// The most bands of a picture. Larger pictures have larger bands.
const MOST_BANDS: usize = 16;

/// A picture that is drawn band by band. Together, the bands are the bytes of [`Renderer::render`]
/// or [`without_ground`](super::without_ground()).
#[derive(Debug)]
pub struct Bands {
    /// The picture, or the same picture over black and over white.
    layers: Vec<(Renderer, FramePlan)>,
    /// The rows of tiles of a band, and of the picture.
    step: usize,
    rows: usize,
    /// The first row of the next band.
    next: usize,
    /// Whether the picture stays in the renderer.
    stays: bool,
}

impl Bands {
    /// Plans a picture, with a transparent background if requested.
    #[must_use]
    pub fn new(shot: &Shot, transparent: bool) -> Self {
        Self::with_at_most(shot, transparent, LARGEST_BAND)
    }

    /// Works like [`Self::new`], with bands of at most `pixels` pixels. A band has at least a row
    /// of tiles and a sixteenth of the picture.
    #[must_use]
    pub fn with_at_most(shot: &Shot, transparent: bool, pixels: usize) -> Self {
        let plans = match transparent {
            true => over_black_and_white(shot).to_vec(),
            false => vec![plan_frame(shot)],
        };
        let Size { width, height } = plans[0].size;
        let rows = height.div_ceil(TILE_SIDE);
        // A picture at half resolution is enlarged as a whole.
        let is_whole = plans[0].enlarged.is_some();
        let fitting = pixels / (width * TILE_SIDE).max(1);
        let step = if is_whole { rows } else { fitting.max(rows.div_ceil(MOST_BANDS)).min(rows) };
        let stays = step >= rows && plans[0].size().area() <= pixels;
        let layers = plans.into_iter().map(|plan| (Renderer::default(), plan)).collect();
        Self { layers, step: step.max(1), rows, next: 0, stays }
    }

    /// Returns the size of the whole picture in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        self.layers[0].1.size()
    }

    /// Returns whether the whole picture is a single band that stays in the renderer, for
    /// questions about it. A large picture at half resolution is one band that does not stay.
    #[must_use]
    pub const fn stays(&self) -> bool {
        self.stays
    }

    /// Draws the next band; `None` after the last one. `tell` receives the finished part of the
    /// picture and the whole, in the same unit.
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted`, which every thread calls between tiles, returns false.
    pub fn draw_next(
        &mut self,
        wanted: &(dyn Fn() -> bool + Sync),
        tell: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Option<Picture>, Cancelled> {
        let rows = self.next..(self.next + self.step).min(self.rows);
        if rows.is_empty() {
            return Ok(None);
        }
        let (all, count) = (self.rows * self.layers.len(), rows.len());
        let (follows, before) = (rows.start > 0, rows.start * self.layers.len());
        let mut band: Option<Picture> = None;
        for (i, (renderer, plan)) in self.layers.iter_mut().enumerate() {
            let done = before + i * count;
            // In rows of tiles, times the tiles of this call, so that fractions stay integers.
            let tell = |painted: usize, tiles: usize| {
                tell(done * tiles + count * painted, all * tiles);
            };
            let watch = Cancellation::new(wanted).telling(&tell);
            // A single band is drawn like any picture; several are drawn row by row.
            let drawn = if self.step >= self.rows {
                renderer.redraw_by(plan, &watch)?;
                if self.stays { renderer.picture().clone() } else { renderer.take_picture() }
            } else {
                std::mem::take(renderer.render_rows(plan, &rows, follows, &watch)?)
            };
            // The first layer is over black; the second one, over white, reveals the background.
            match &mut band {
                None => band = Some(drawn),
                Some(band) => uncover(band, &drawn, plan.variants.decoding()),
            }
        }
        self.next = rows.end;
        Ok(band)
    }

    /// Returns the renderer. If the picture [stays](Self::stays), it is the renderer's last one.
    #[must_use]
    pub fn into_renderer(mut self) -> Renderer {
        self.layers.swap_remove(0).0
    }
}
