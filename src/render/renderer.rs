//! Draws plans into a picture.
//!
//! A picture is drawn as a whole, or only the damaged tiles of the last one are drawn again, to the
//! same bytes. Picking reads the last finished picture, even after a frame was cancelled. No
//! setting is read here: the plan holds every decision.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use fearless_simd::Level;

use super::shading::context::ShadingContext;
use super::shading::explain::{Asked, PixelColor, explain};
use super::shading::face_colors::FaceColors;
use super::shading::light::Lit;
use super::shading::painter::{Band, Painter, TileSums, bounds_of};
use super::shading::shown_faces::have_colors;
use crate::accuracy::{Arithmetic, Samples};
use crate::base::cancellation::Cancellation;
use crate::base::color::Color;
use crate::base::image::{Picture, Size};
use crate::base::work_stealing::{own, together};
use crate::render::damage::{Damage, DamageCause};
use crate::render::frame::{FramePlan, Rules};
use crate::render::plan::uses::EffectUse;
use crate::render::raster::geometry::ScreenGeometry;
use crate::render::raster::visibility_buffer::Visible;
use crate::render::raster::{depth_format, visibility_buffer};
use crate::render::screen::sample_positions::{SamplePositions, passes, shifts};
use crate::render::screen::tiles::{BLOCK_PIXELS, TILE, TILE_SIDE, block_at, tiles_of};
use crate::render::shading::interpolated::ShadingNumber;
use crate::render::shading::light_terms::LightTerms;
use crate::render::shadow::maps::ShadowMaps;
use crate::render::shadow::rays::RayCount;
use crate::render::shadow::tracer::Tracer;
use crate::render::tile_layers::TileLayers;
use crate::render::timings::{Laps, Timings};
use crate::scene::ItemId;

/// Draws pictures, and keeps their memory from one frame to the next.
#[derive(Debug)]
pub struct Renderer {
    level: Level,
    picture: Picture,
    frame: ScreenGeometry,
    /// For each tile the colour that fills all of it, if one is known to.
    filled: Vec<Option<Color>>,
    caches: ShadingCaches,
    /// The plan of the last finished picture.
    plan: Option<FramePlan>,
    /// Whether the picture is still that one: nothing has been painted over it.
    finished: bool,
    /// Whether the screen geometry is that of the last finished picture.
    built: bool,
    timings: Timings,
    rays: RayCount,
    maps: ShadowMaps,
}

/// The frame was cancelled by a newer request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

/// The polygon that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object, the camera whose mark it is, or the bulb's light.
    pub item: ItemId,
    /// The polygon of its mesh.
    pub polygon: u32,
    /// The depth: 1 at the near plane, 0 at the far one.
    pub depth: f32,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::new(Level::new())
    }
}

impl Renderer {
    /// Makes a renderer for a SIMD level. Pictures are the same on every level.
    #[must_use]
    pub fn new(level: Level) -> Self {
        Self {
            level,
            picture: Picture::default(),
            frame: ScreenGeometry::default(),
            filled: Vec::new(),
            caches: ShadingCaches::default(),
            plan: None,
            finished: false,
            built: false,
            timings: Timings::default(),
            rays: RayCount::default(),
            maps: ShadowMaps::default(),
        }
    }

    /// Draws a plan from scratch, whatever was drawn before.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.render_watched(plan, &|_, _| {})
    }

    /// Draws a plan from scratch and reports progress between tiles: the number of painted tiles,
    /// and of all. With several samples per pixel, each tile is painted in several passes and
    /// counts in each.
    pub fn render_watched(
        &mut self,
        plan: &FramePlan,
        tell: &(dyn Fn(usize, usize) + Sync),
    ) -> &Picture {
        self.finished = false;
        self.frame.forget();
        self.redraw_by(plan, &Cancellation::new(&|| true).telling(tell))
            .expect("it is always wanted");
        &self.picture
    }

    /// Draws again what another plan changes of the last picture, and returns the damage. The
    /// picture is the one that [`Self::render`] draws.
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

    fn redraw_by(
        &mut self,
        plan: &FramePlan,
        watch: &Cancellation<'_>,
    ) -> Result<Damage, Cancelled> {
        let damage = self.damage(plan);
        self.built &= !damage.geometry;
        if plan.rules == Rules::Ignored || !damage.is_nothing() {
            self.resize(plan.size);
            self.finished = false;
            // Runs on a drawing thread, so that the caller sleeps and wakes once per frame.
            rayon::scope(|_| {
                plan.prepare();
                self.draw_damage(plan, &damage, watch);
            });
            if watch.is_given_up() {
                return Err(Cancelled);
            }
            // If each sample was drawn by itself, the geometry is that of the last sample.
            (self.finished, self.built) = (true, !plan.lit_by_sample);
        }
        self.plan = Some(plan.clone());
        Ok(damage)
    }

    /// Resizes the picture if its size changed.
    fn resize(&mut self, size: Size) {
        if self.picture.size() != size {
            self.picture.resize(size);
            let [columns, rows] = [size.width, size.height].map(|n| n.div_ceil(TILE_SIDE));
            self.filled.clear();
            self.filled.resize(columns * rows, None);
        }
    }

    fn draw_damage(&mut self, plan: &FramePlan, damage: &Damage, watch: &Cancellation<'_>) {
        self.timings = Timings::default();
        self.rays = RayCount::default();
        let passes = passes(plan.samples);
        let pictures = if plan.lit_by_sample { shifts(plan.samples).len() } else { passes.len() };
        watch.expect_tiles(pictures * damage.tiles());
        let mut sums = Vec::new();
        if passes.len() > 1 || plan.lit_by_sample {
            // If this is cancelled, the geometry belongs to no finished picture.
            self.built = false;
            let [columns, rows] = tiles_of(plan.size);
            let tiles = usize::try_from(columns * rows).expect("not negative");
            sums.resize_with(tiles, TileSums::default);
        }
        if plan.lit_by_sample {
            return self.draw_each_sample(plan, damage, &sums, watch);
        }
        // The first pass comes last, so that picking reads its geometry.
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

    /// Draws a picture for each sample, as if it were the centre of its pixel, and averages them.
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
            let own = plan.seen_from(shift);
            self.timings += self.frame.build(self.level, &own, SamplePositions::default(), watch);
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
        match plan.arithmetic {
            Arithmetic::F32 => self.draw::<f32>(plan, damage, pass, watch),
            Arithmetic::F64 => self.draw::<f64>(plan, damage, pass, watch),
        }
    }

    /// The damage that [`Self::redraw`] would repair.
    #[must_use]
    pub fn damage(&self, plan: &FramePlan) -> Damage {
        match &self.plan {
            Some(before) if self.finished => Damage::between(before, plan),
            _ => Damage::all(DamageCause::First, plan.size),
        }
    }

    /// Builds the geometry of the last finished picture again, if another frame was begun since.
    fn build_again(&mut self) {
        if let (false, Some(plan)) = (self.built, &self.plan) {
            let sample_positions = passes(plan.samples)[0];
            let watch = Cancellation::new(&|| true);
            self.frame.build(self.level, plan, sample_positions, &watch);
            self.maps.update(self.level, plan, &watch);
            self.built = true;
        }
    }

    /// The picture that was drawn last.
    #[must_use]
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The time that each stage of the last picture took.
    #[must_use]
    pub const fn timings(&self) -> Timings {
        self.timings
    }

    /// The rays of shadows that the last picture took.
    #[must_use]
    pub const fn rays(&self) -> RayCount {
        self.rays
    }

    /// The number of triangles of the last picture.
    #[must_use]
    pub fn triangles_drawn(&self) -> usize {
        self.frame.triangles()
    }

    /// What the last picture shows in column `x` of row `y`; `None` for the background. If the
    /// pixel has several samples, it is what most of the four nearest to its centre show.
    #[must_use]
    pub fn hit(&mut self, x: usize, y: usize) -> Option<Hit> {
        self.build_again();
        let plan = self.plan.as_ref()?;
        let Size { width, height } = plan.size;
        if x >= width || y >= height {
            return None;
        }
        let [x, y] = [x, y].map(|i| i32::try_from(i).expect("inside the picture"));
        let [columns, _] = tiles_of(plan.size);
        let tile = usize::try_from(y / TILE * columns + x / TILE).expect("not negative");
        let mut tile_seen = TileLayers::default();
        tile_seen.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
        let mut word = 0;
        tile_seen.each(self.level, &self.frame, block_at(x % TILE, y % TILE), |at, nearest, _| {
            if at == [x, y] {
                word = nearest;
            }
        });
        let (draw, polygon) = self.seen(plan, word)?;
        let depth = depth_format::depth(plan.variants.depth, visibility_buffer::key(word));
        Some(Hit { item: plan.draws[draw as usize].item, polygon, depth })
    }

    /// What the last picture shows in column `x` of row `y`, and what its colour is made of. A
    /// pixel of several samples is explained by the light at its centre.
    #[must_use]
    pub fn explain(&mut self, x: usize, y: usize) -> Option<PixelColor> {
        self.build_again();
        let plan = self.plan.as_ref()?;
        let Size { width, height } = plan.size;
        if x >= width || y >= height {
            return None;
        }
        plan.prepare();
        let at = [x, y].map(|i| i32::try_from(i).expect("inside the picture"));
        Some(match plan.arithmetic {
            Arithmetic::F32 => self.explain_in::<f32>(plan, at),
            Arithmetic::F64 => self.explain_in::<f64>(plan, at),
        })
    }

    fn explain_in<T: ShadingNumber>(&self, plan: &FramePlan, at: [i32; 2]) -> PixelColor {
        let (mut terms, mut lit) = (LightTerms::<T>::default(), Lit::<T>::default());
        terms.prepare(plan);
        lit.prepare(plan);
        let (level, frame) = (self.level, &self.frame);
        let tracer = Tracer::new(plan, &self.maps);
        let tracer = tracer.as_ref();
        let (lit, terms) = (&lit, &terms);
        let context = ShadingContext { level, plan, frame, lit, terms, faces: None, tracer };
        let [x, y] = at;
        let [columns, _] = tiles_of(plan.size);
        let tile = usize::try_from(y / TILE * columns + x / TILE).expect("not negative");
        let bounds = bounds_of(tile, plan.size);
        let mut tile_seen = TileLayers::default();
        tile_seen.draw(level, plan, frame, (tile, bounds));
        let depths = tile_seen.depths(level);
        let mut shown = Vec::new();
        tile_seen.each(level, frame, block_at(x % TILE, y % TILE), |place, nearest, words| {
            if place == at {
                // Of several samples, what most of them show.
                let one = plan.samples == Samples::One;
                shown = if one { words.to_vec() } else { vec![nearest] };
            }
        });
        let [column, row] = at.map(|i| usize::try_from(i).expect("inside the picture"));
        let [r, g, b, _] = self.picture.pixel(column, row);
        explain(&context, &Asked { at, bounds, depths, words: &shown, bytes: [r, g, b] })
    }

    /// Marks the pixels at which the last picture shows an item, also through transparent ones: a
    /// flag for each pixel, row by row from the top.
    #[must_use]
    pub fn pixels_of(&mut self, item: ItemId) -> Vec<bool> {
        self.pixels_of_any(&[item])
    }

    /// Marks the pixels at which the last picture shows any of these items, as
    /// [`Self::pixels_of`].
    #[must_use]
    pub fn pixels_of_any(&mut self, items: &[ItemId]) -> Vec<bool> {
        let mut pixels = vec![false; self.seen_size().area()];
        self.look(|renderer, plan, at, _, words| {
            pixels[at] = words.iter().any(|word| {
                let seen = renderer.seen(plan, *word);
                seen.is_some_and(|(draw, _)| items.contains(&plan.draws[draw as usize].item))
            });
            ControlFlow::Continue(())
        });
        pixels
    }

    /// The item that the last picture shows at each pixel, row by row from the top; nothing if all
    /// of these items are seen.
    pub(super) fn items_unless_all_seen(
        &mut self,
        mut items: BTreeSet<ItemId>,
    ) -> Option<Vec<Option<ItemId>>> {
        let mut pixels = vec![None; self.seen_size().area()];
        let mut last = None;
        self.look(|renderer, plan, at, nearest, words| {
            let item = |word: u64| {
                renderer.seen(plan, word).map(|(draw, _)| plan.draws[draw as usize].item)
            };
            pixels[at] = item(nearest);
            if pixels[at] != last || words.len() > 1 {
                last = pixels[at];
                words.iter().filter_map(|word| item(*word)).for_each(|item| {
                    items.remove(&item);
                });
            }
            if items.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        (!items.is_empty()).then_some(pixels)
    }

    /// Counts the pixels that each effect of the last picture takes part in, and returns the
    /// largest error of a channel in steps of a byte. Takes about as long as rasterizing the
    /// picture.
    pub fn count(&mut self, uses: &mut [EffectUse]) -> f64 {
        self.build_again();
        self.plan.as_ref().map_or(0.0, |plan| plan.count(self.level, &self.frame, uses))
    }

    /// The primitive that each pixel of the last picture shows, row by row from the top: 0 for the
    /// background, else a number that is unique to each triangle and line of the scene.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the lower half of a word names what is seen"
    )]
    pub fn primitives(&mut self) -> Vec<u32> {
        let mut pixels = vec![0; self.seen_size().area()];
        self.look(|_, _, at, word, _| {
            pixels[at] = word as u32;
            ControlFlow::Continue(())
        });
        pixels
    }

    /// The size of the last finished picture; 0 x 0 before the first.
    fn seen_size(&self) -> Size {
        self.plan.as_ref().map_or(Size::new(0, 0), |plan| plan.size)
    }

    /// Calls `each` with the index of each pixel of the last picture, its nearest word and all that
    /// it shows, tile by tile, until it breaks. See [`TileLayers::each`].
    fn look(
        &mut self,
        mut each: impl FnMut(&Self, &FramePlan, usize, u64, &[u64]) -> ControlFlow<()>,
    ) {
        self.build_again();
        let Some(plan) = &self.plan else { return };
        let [columns, rows] = tiles_of(plan.size);
        let mut tile_seen = TileLayers::default();
        for tile in 0..usize::try_from(columns * rows).expect("not negative") {
            tile_seen.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
            for block in 0..BLOCK_PIXELS {
                let mut flow = ControlFlow::Continue(());
                tile_seen.each(self.level, &self.frame, block, |at, nearest, words| {
                    let [x, y] = at.map(|i| usize::try_from(i).expect("inside the picture"));
                    if flow.is_continue() {
                        flow = each(self, plan, y * plan.size.width + x, nearest, words);
                    }
                });
                if flow.is_break() {
                    return;
                }
            }
        }
    }

    /// The draw and the polygon that a sample of the visibility buffer names.
    fn seen(&self, plan: &FramePlan, word: u64) -> Option<(u32, u32)> {
        match visibility_buffer::seen(word) {
            Visible::Background => None,
            Visible::Triangle(number) => {
                let (draw, start) = self.frame.draw_of(number);
                let mesh = &plan.draws[draw as usize].model.mesh;
                Some((draw, mesh.polygon_of(number - start.number)))
            }
            Visible::Line(line) => self.frame.line_seen(plan, line),
        }
    }

    /// Draws tiles in parallel: each thread has its own painter.
    fn draw<T: Painted>(
        &mut self,
        plan: &FramePlan,
        damage: &Damage,
        pass: &Pass<'_>,
        watch: &Cancellation<'_>,
    ) {
        let mut laps = Laps::start();
        self.maps.update(self.level, plan, watch);
        let ShadingCache { terms, lit, faces, painters } = T::cache(&mut self.caches);
        terms.prepare(plan);
        lit.prepare(plan);
        let looks_up = have_colors(plan) && !self.frame.sample_positions().are_many();
        if looks_up {
            faces.begin(self.frame.triangle_numbers());
        }
        let (level, frame) = (self.level, &self.frame);
        let tracer = Tracer::new(plan, &self.maps);
        let tracer = tracer.as_ref();
        let faces = looks_up.then_some(&*faces);
        let context = ShadingContext { level, plan, frame, lit, terms, faces, tracer };
        let Size { width, .. } = plan.size;
        let columns = width.div_ceil(TILE_SIDE);
        let bands: Vec<Mutex<Band<'_>>> = self
            .picture
            .pixels_mut()
            .chunks_mut(width * TILE_SIDE)
            .zip(self.filled.chunks_mut(columns))
            .map(|(pixels, filled)| Mutex::new(Band { pixels, filled }))
            .collect();
        let tiles = bands.len() * columns;
        let shares = frame.shares_of_tiles(tiles);
        painters.resize_with(rayon::current_num_threads(), Painter::default);
        let painters: Vec<Mutex<&mut Painter<T>>> = painters.iter_mut().map(Mutex::new).collect();
        together(painters.len(), || {
            let painter = &mut own(&painters);
            painter.begin();
            loop {
                let Some(tile) = shares.next().filter(|_| watch.goes_on()) else { return };
                let row = tile / columns;
                if damage.tiles.contains(tile) {
                    match pass.sums.get(tile) {
                        None => painter.paint(&context, tile, &bands[row]),
                        Some(sums) => painter.add(&context, tile, sums),
                    }
                    if let (true, Some(sums)) = (pass.is_last, pass.sums.get(tile)) {
                        painter.put_means(&context, tile, sums, &bands[row]);
                    }
                    watch.tile_is_painted();
                }
            }
        });
        for painter in painters {
            self.rays += painter.into_inner().unwrap_or_else(PoisonError::into_inner).ray_count();
        }
        self.timings.tiles += laps.lap();
    }
}

/// One of the passes over a picture.
#[derive(Debug)]
struct Pass<'a> {
    /// For each tile the colours of earlier passes, block by block; empty if there is one pass.
    sums: &'a [TileSums],
    is_last: bool,
}

/// What shading keeps from frame to frame, for one arithmetic.
#[derive(Debug, Default)]
struct ShadingCache<T> {
    terms: LightTerms<T>,
    lit: Lit<T>,
    faces: FaceColors,
    /// One for each thread.
    painters: Vec<Painter<T>>,
}

#[derive(Debug, Default)]
struct ShadingCaches {
    fast: ShadingCache<f32>,
    exact: ShadingCache<f64>,
}

/// Numbers that pictures are painted in.
trait Painted: ShadingNumber {
    fn cache(caches: &mut ShadingCaches) -> &mut ShadingCache<Self>;
}

impl Painted for f32 {
    fn cache(caches: &mut ShadingCaches) -> &mut ShadingCache<Self> {
        &mut caches.fast
    }
}

impl Painted for f64 {
    fn cache(caches: &mut ShadingCaches) -> &mut ShadingCache<Self> {
        &mut caches.exact
    }
}
