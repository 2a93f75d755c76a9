//! Draws plans into a picture.
//!
//! A picture is either drawn completely, or only the damaged tiles of the last one are drawn again,
//! with the same bytes as a result. No setting is read here: the plan holds every decision. Queries
//! about the last picture are in [`picking`].

mod enlarged;
mod layers;
pub(crate) mod picking;
mod supersampled;

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use fearless_simd::Level;

use super::shading::context::Prepared;
use super::shading::face_colors::FaceColors;
use super::shading::painter::{Band, Filled, Painter, TileSums};
use crate::cancellation::Cancellation;
use crate::damage::kept_shadows::KeptShadows;
use crate::damage::{Damage, DamageCause};
use crate::frame::program::PathPixels;
use crate::frame::{FramePlan, Rules};
use crate::raster::geometry::ScreenGeometry;
use crate::screen::sample_positions::{SamplePositions, passes, shifts};
use crate::screen::tiles::TILE_SIDE;
use crate::shading::path_number::PathNumber;
use crate::shadow::maps::ShadowMaps;
use crate::shadow::rays::RayCount;
use crate::shadow::tracer::Tracer;
use crate::simd::level::is_compiled;
use crate::timings::{Laps, Timings};
use crate::work_stealing::{own, together};
use marraztu_core::accuracy::Arithmetic;
use marraztu_core::base::image::{Picture, Size};

/// Draws pictures, and reuses memory from one frame to the next.
#[derive(Debug)]
pub struct Renderer {
    level: Level,
    /// The drawn picture, or a band of it.
    picture: Picture,
    /// The first row of tiles in `picture`; not 0 only in a band.
    first_row: usize,
    /// The finished picture, if it was drawn at half resolution.
    enlarged: Picture,
    /// Draws larger pictures to be averaged.
    larger: Option<Box<Self>>,
    frame: ScreenGeometry,
    /// The blocks of each tile that are filled with one colour.
    filled: Vec<Filled>,
    caches: ShadingCaches,
    /// The plan of the last finished picture.
    plan: Option<FramePlan>,
    /// Whether the picture still is the last finished one: nothing has been painted over it.
    finished: bool,
    /// Whether the screen geometry belongs to the last finished picture.
    built: bool,
    timings: Timings,
    rays: RayCount,
    path_pixels: PathPixels,
    /// Whether the last picture was drawn completely.
    drew_all: bool,
    maps: ShadowMaps,
    shadows: KeptShadows,
}

/// The frame was cancelled by a newer request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Default for Renderer {
    /// A renderer with the best instruction set of the processor.
    ///
    /// # Panics
    /// See [`Self::new`].
    fn default() -> Self {
        Self::new(Level::new())
    }
}

impl Renderer {
    /// Makes a renderer for an instruction set. Pictures are the same with each.
    ///
    /// # Panics
    /// On x86-64, for a set before SSE4.2: see [`levels`](crate::simd::levels).
    #[must_use]
    pub fn new(level: Level) -> Self {
        assert!(is_compiled(level), "drawing needs a processor with SSE4.2");
        Self {
            level,
            picture: Picture::default(),
            first_row: 0,
            enlarged: Picture::default(),
            larger: None,
            frame: ScreenGeometry::default(),
            filled: Vec::new(),
            caches: ShadingCaches::default(),
            plan: None,
            finished: false,
            built: false,
            timings: Timings::default(),
            rays: RayCount::default(),
            path_pixels: PathPixels::default(),
            drew_all: false,
            maps: ShadowMaps::default(),
            shadows: KeptShadows::default(),
        }
    }

    /// Draws a plan from scratch, independently of earlier pictures.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.render_while(plan, &|| true).expect("it is always wanted");
        self.picture()
    }

    /// Draws a plan from scratch and reports progress between tiles: the number of painted tiles,
    /// and their total. With several samples per pixel, each tile is painted in several passes and
    /// counts in each.
    ///
    /// # Errors
    /// See [`Self::redraw`].
    pub fn render_watched(
        &mut self,
        plan: &FramePlan,
        wanted: &(dyn Fn() -> bool + Sync),
        tell: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<&Picture, Cancelled> {
        self.forget();
        self.redraw_watched(plan, wanted, tell)?;
        Ok(self.picture())
    }

    /// Draws a plan from scratch, like [`Self::render`].
    ///
    /// # Errors
    /// See [`Self::redraw`].
    pub fn render_while(
        &mut self,
        plan: &FramePlan,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<&Picture, Cancelled> {
        self.forget();
        self.redraw_by(plan, &Cancellation::new(wanted))?;
        Ok(self.picture())
    }

    /// Forces the next picture to be drawn completely.
    fn forget(&mut self) {
        self.finished = false;
        self.frame.forget();
        self.shadows.forget();
    }

    /// Redraws the parts of the last picture that another plan changes, and returns the damage. The
    /// result equals the picture drawn by [`Self::render`].
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted`, which every thread calls between tiles, returns false. The
    /// picture is then undefined until the next one is finished.
    pub fn redraw(
        &mut self,
        plan: &FramePlan,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Damage, Cancelled> {
        self.redraw_by(plan, &Cancellation::new(wanted))
    }

    /// Works like [`Self::redraw`], and reports progress like [`Self::render_watched`].
    ///
    /// # Errors
    /// See [`Self::redraw`].
    pub fn redraw_watched(
        &mut self,
        plan: &FramePlan,
        wanted: &(dyn Fn() -> bool + Sync),
        tell: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Damage, Cancelled> {
        self.redraw_by(plan, &Cancellation::new(wanted).telling(tell))
    }

    /// See [`Self::redraw`].
    pub(crate) fn redraw_by(
        &mut self,
        plan: &FramePlan,
        watch: &Cancellation<'_>,
    ) -> Result<Damage, Cancelled> {
        let damage = self.damage(plan);
        // Screen geometry stays valid if only colours changed.
        self.built &= !damage.geometry;
        // Without the rules, even an unchanged picture is drawn.
        if plan.rules == Rules::Ignored || !damage.is_nothing() {
            self.resize(plan.size, 0);
            // Until all tiles are painted, the picture mixes two frames.
            self.finished = false;
            // Runs on a drawing thread, so the caller sleeps and wakes only once per frame.
            rayon::scope(|_| {
                plan.prepare();
                self.draw_damage(plan, &damage, watch);
            });
            if watch.is_given_up() {
                return Err(Cancelled);
            }
            // If each sample was drawn separately, the geometry is that of the last sample.
            (self.finished, self.built) = (true, !plan.lit_by_sample);
            if let Some(size) = plan.enlarged {
                enlarged::enlarge(self.level, &self.picture, size, &mut self.enlarged);
            }
        }
        self.plan = Some(plan.clone());
        Ok(damage)
    }

    /// Draws some rows of tiles of a plan, and returns the band of the picture that they fill.
    /// `follows` says that the last call drew the rows before them, so their geometry is reused.
    ///
    /// # Errors
    /// See [`Self::redraw`].
    pub(crate) fn render_rows(
        &mut self,
        plan: &FramePlan,
        rows: &Range<usize>,
        follows: bool,
        watch: &Cancellation<'_>,
    ) -> Result<&mut Picture, Cancelled> {
        if !follows {
            self.forget();
            self.built = false;
        }
        self.finished = false;
        let Size { width, height } = plan.size;
        // The last row of tiles may reach beyond the picture.
        let band = (rows.end * TILE_SIDE).min(height) - rows.start * TILE_SIDE;
        self.resize(Size::new(width, band), rows.start);
        let damage = Damage::rows(plan.size, rows);
        rayon::scope(|_| {
            plan.prepare();
            self.draw_damage(plan, &damage, watch);
        });
        self.built = !watch.is_given_up() && !plan.lit_by_sample;
        if watch.is_given_up() { Err(Cancelled) } else { Ok(&mut self.picture) }
    }

    /// Resizes the picture if its size or place changed. It begins with the row of tiles
    /// `first_row`.
    fn resize(&mut self, size: Size, first_row: usize) {
        if self.picture.size() != size || self.first_row != first_row {
            self.picture.resize(size);
            self.first_row = first_row;
            let [columns, rows] = [size.width, size.height].map(|n| n.div_ceil(TILE_SIDE));
            self.filled.clear();
            self.filled.resize(columns * rows, Filled::default());
        }
    }

    fn draw_damage(&mut self, plan: &FramePlan, damage: &Damage, watch: &Cancellation<'_>) {
        self.timings = Timings::default();
        self.rays = RayCount::default();
        self.path_pixels = PathPixels::default();
        self.drew_all = damage.tiles() == damage.tiles_in_all() && !plan.is_supersampled();
        if plan.is_supersampled() {
            self.built = false;
            return self.draw_supersampled(plan, damage, watch);
        }
        self.shadows.update(plan);
        let passes = passes(plan.samples);
        // Progress counts each tile once in every pass.
        let pictures = if plan.lit_by_sample { shifts(plan.samples).len() } else { passes.len() };
        watch.expect_tiles(pictures * damage.tiles());
        let mut sums = Vec::new();
        if passes.len() > 1 || plan.lit_by_sample {
            // If this frame is cancelled, the geometry belongs to no finished picture.
            self.built = false;
            sums.resize_with(damage.tiles_in_all(), TileSums::default);
        }
        if plan.lit_by_sample {
            return self.draw_each_sample(plan, damage, &sums, watch);
        }
        self.prepare(plan);
        // The first pass is drawn last, because picking reads its geometry.
        for (i, sample_positions) in passes.iter().enumerate().rev() {
            if !self.built {
                self.timings += self.frame.build(self.level, plan, *sample_positions, watch);
            }
            if watch.is_given_up() {
                return;
            }
            self.draw_pass(plan, damage, &Pass { sums: &sums, is_last: i == 0 }, watch);
        }
    }

    /// Draws a picture for each sample, as if it were the pixel's centre, and averages the
    /// pictures.
    fn draw_each_sample(
        &mut self,
        plan: &FramePlan,
        damage: &Damage,
        sums: &[TileSums],
        watch: &Cancellation<'_>,
    ) {
        let shifts = shifts(plan.samples);
        let last = shifts.len() - 1;
        for (i, shift) in shifts.enumerate() {
            let sample = u32::try_from(i).expect("at most 64 samples");
            let own = FramePlan { sample, ..plan.seen_from(shift) };
            self.prepare(&own);
            let one = SamplePositions::default();
            self.timings += self.frame.build(self.level, &own, one, watch);
            if watch.is_given_up() {
                return;
            }
            self.draw_pass(&own, damage, &Pass { sums, is_last: i == last }, watch);
        }
    }

    fn draw_pass(
        &mut self,
        plan: &FramePlan,
        damage: &Damage,
        pass: &Pass<'_>,
        watch: &Cancellation<'_>,
    ) {
        // Taken out, because `draw` borrows the renderer as a whole.
        let mut caches = std::mem::take(&mut self.caches);
        match plan.arithmetic {
            Arithmetic::F32 => self.draw(&mut caches.fast, plan, damage, pass, watch),
            Arithmetic::F64 => self.draw(&mut caches.exact, plan, damage, pass, watch),
        }
        self.caches = caches;
    }

    /// Returns the damage that [`Self::redraw`] would repair.
    #[must_use]
    pub fn damage(&self, plan: &FramePlan) -> Damage {
        match &self.plan {
            Some(before) if self.finished => Damage::between(before, plan),
            _ => Damage::all(DamageCause::First, plan.size),
        }
    }

    /// Returns the last picture.
    #[must_use]
    pub fn picture(&self) -> &Picture {
        let is_enlarged = self.plan.as_ref().is_some_and(|plan| plan.enlarged.is_some());
        if is_enlarged { &self.enlarged } else { &self.picture }
    }

    /// Returns the last picture without copying it. The next one is drawn completely, and queries
    /// about the last one find nothing.
    #[must_use]
    pub fn take_picture(&mut self) -> Picture {
        self.forget();
        match self.plan.take().and_then(|plan| plan.enlarged) {
            Some(_) => std::mem::take(&mut self.enlarged),
            None => std::mem::take(&mut self.picture),
        }
    }

    /// Returns the time taken by each stage of the last picture.
    #[must_use]
    pub const fn timings(&self) -> Timings {
        self.timings
    }

    /// Returns the rays of the last picture.
    #[must_use]
    pub const fn rays(&self) -> RayCount {
        self.rays
    }

    /// Returns the number of pixels that each path has coloured in the last picture, in each pass
    /// over several samples. `None` if only a part was drawn again, or it was cancelled.
    #[must_use]
    pub fn path_pixels(&self) -> Option<PathPixels> {
        (self.finished && self.drew_all).then_some(self.path_pixels)
    }

    /// Returns the number of triangles in the last picture.
    #[must_use]
    pub fn triangles_drawn(&self) -> usize {
        self.frame.triangles()
    }

    /// Prepares the light of a plan.
    fn prepare(&mut self, plan: &FramePlan) {
        match plan.arithmetic {
            Arithmetic::F32 => self.caches.fast.prepared.prepare(plan),
            Arithmetic::F64 => self.caches.exact.prepared.prepare(plan),
        }
    }

    /// Draws tiles in parallel, with a painter per thread.
    fn draw<T: PathNumber>(
        &mut self,
        cache: &mut ShadingCache<T>,
        plan: &FramePlan,
        damage: &Damage,
        pass: &Pass<'_>,
        watch: &Cancellation<'_>,
    ) {
        // Shadow maps and the cache of face colours come first: all threads read them.
        let mut laps = Laps::start();
        self.maps.update(self.level, plan, watch);
        let ShadingCache { prepared, faces, painters } = cache;
        let looks_up = prepared.looks_up_faces() && !self.frame.sample_positions().are_many();
        if looks_up {
            faces.begin(self.frame.triangle_numbers());
        }
        let (level, frame) = (self.level, &self.frame);
        let tracer = Tracer::new(plan, &self.maps).map(|it| it.with_known(self.shadows.known()));
        let tracer = tracer.as_ref();
        let faces = looks_up.then_some(&*faces);
        let around_plan = plan.surroundings.as_deref();
        let around_tracer = around_plan.and_then(|around| Tracer::new(around, &self.maps));
        let around = prepared.around(level, plan, around_tracer.as_ref());
        let context = prepared.context(level, (plan, frame), faces, (tracer, around.as_ref()));
        let first_row = self.first_row;
        let Size { width, .. } = plan.size;
        let columns = width.div_ceil(TILE_SIDE);
        // One band per row of tiles. A thread locks a band while it writes a tile to it.
        let bands: Vec<Mutex<Band<'_>>> = self
            .picture
            .pixels_mut()
            .chunks_mut(width * TILE_SIDE)
            .zip(self.filled.chunks_mut(columns))
            .map(|(pixels, filled)| Mutex::new(Band { pixels, filled }))
            .collect();
        let tiles = plan.size.height.div_ceil(TILE_SIDE) * columns;
        let shares = frame.shares_of_tiles(tiles);
        painters.resize_with(rayon::current_num_threads(), Painter::default);
        // Every painter begins, even if its thread comes too late to paint a tile.
        painters.iter_mut().for_each(|painter| painter.shader.begin());
        let painters: Vec<Mutex<&mut Painter<T>>> = painters.iter_mut().map(Mutex::new).collect();
        together(painters.len(), || {
            let painter = &mut own(&painters);
            loop {
                // Each thread takes the next tile until none is left or the frame is cancelled.
                let Some(tile) = shares.next().filter(|_| watch.goes_on()) else { return };
                if damage.tiles.contains(tile) {
                    let row = tile / columns - first_row;
                    // A single pass paints pixels directly; several passes add up colours.
                    match pass.sums.get(tile) {
                        None => painter.paint(&context, tile, &bands[row]),
                        Some(sums) => painter.add(&context, tile, sums),
                    }
                    // After the last pass, the sums are complete and give the means.
                    if let (true, Some(sums)) = (pass.is_last, pass.sums.get(tile)) {
                        painter.put_means(&context, tile, sums, &bands[row]);
                    }
                    watch.tile_is_painted();
                }
            }
        });
        // Painters count separately, so that threads share no counter while they draw.
        for painter in painters {
            let painter = painter.into_inner().unwrap_or_else(PoisonError::into_inner);
            self.rays += painter.shader.ray_count();
            self.path_pixels += painter.shader.path_pixels;
        }
        self.timings.tiles += laps.lap();
    }
}

/// One pass over a picture.
#[derive(Debug)]
struct Pass<'a> {
    /// The summed colours of earlier passes for each tile, block by block; empty with a single
    /// pass.
    sums: &'a [TileSums],
    is_last: bool,
}

/// Shading results reused from frame to frame, for one arithmetic.
#[derive(Debug, Default)]
struct ShadingCache<T> {
    prepared: Prepared<T>,
    faces: FaceColors,
    /// One painter per thread.
    painters: Vec<Painter<T>>,
}

#[derive(Debug, Default)]
struct ShadingCaches {
    fast: ShadingCache<f32>,
    exact: ShadingCache<f64>,
}
