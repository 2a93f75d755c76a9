//! Runs plans: does, and asks no setting.
//!
//! A picture is drawn as a whole, or what has changed of the last one is drawn again, to the same
//! bytes. What is picked is asked of the last picture that was finished, also after a frame that was
//! given up.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Mutex;

use fearless_simd::Level;

use super::shading::context::ShadingContext;
use super::shading::light::Lit;
use super::shading::painter::{Band, Painter, TileSums, bounds_of};
use crate::accuracy::Arithmetic;
use crate::base::cancellation::Cancellation;
use crate::base::color::Color;
use crate::base::image::{Picture, Size};
use crate::base::work_stealing::{own, together};
use crate::render::damage::{Cause, Changes};
use crate::render::frame::{FramePlan, Rules};
use crate::render::plan::uses::EffectUse;
use crate::render::raster::depth_format;
use crate::render::raster::geometry::ScreenGeometry;
use crate::render::raster::tile::Visibility;
use crate::render::raster::visibility_buffer;
use crate::render::raster::visibility_buffer::Visible;
use crate::render::screen::sample_positions::{SamplePositions, passes, shifts};
use crate::render::screen::tiles::{TILE, TILE_SIDE, tiles_of};
use crate::render::shading::interpolated::ShadingNumber;
use crate::render::shading::light_terms::LightTerms;
use crate::render::timings::{Laps, Stages};
use crate::scene::ItemId;

/// Draws pictures, and keeps the memory that this takes from one to the next.
#[derive(Debug)]
pub struct Renderer {
    level: Level,
    picture: Picture,
    frame: ScreenGeometry,
    /// For each tile of the picture the colour that fills it as a whole, where one is known to.
    filled: Vec<Option<Color>>,
    rooms: Rooms,
    /// The plan of the last picture that was finished.
    plan: Option<FramePlan>,
    /// Whether the picture is that one still: nothing has been painted over it.
    finished: bool,
    /// Whether the frame holds what is on that picture.
    built: bool,
    stages: Stages,
}

/// A frame was given up before it was finished: something else was wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GivenUp;

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object, the camera whose mark it is, or the bulb's light.
    pub item: ItemId,
    /// The polygon of its mesh.
    pub polygon: u32,
    /// The depth in the picture: 1 at the near plane, 0 at the far one.
    pub depth: f32,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::new(Level::new())
    }
}

impl Renderer {
    /// A renderer that uses instructions of this level. The pictures are the same on every level.
    #[must_use]
    pub fn new(level: Level) -> Self {
        Self {
            level,
            picture: Picture::default(),
            frame: ScreenGeometry::default(),
            filled: Vec::new(),
            rooms: Rooms::default(),
            plan: None,
            finished: false,
            built: false,
            stages: Stages::default(),
        }
    }

    /// Draws all that is planned, whatever was drawn before.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.render_watched(plan, &|_, _| {})
    }

    /// Draws all that is planned, and tells between tiles how many of how many are painted: with
    /// several samples a pixel each tile is painted in several passes, and counts in each.
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

    /// Draws again what another plan changes of the last picture, and says what that was. The picture
    /// is the one that [`Self::render`] draws.
    ///
    /// # Errors
    /// Where `wanted`, which every thread asks between tiles, says no: then the picture is of no
    /// meaning until the next one is finished.
    pub fn redraw(
        &mut self,
        plan: &FramePlan,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Changes, GivenUp> {
        self.redraw_by(plan, &Cancellation::new(wanted))
    }

    fn redraw_by(
        &mut self,
        plan: &FramePlan,
        watch: &Cancellation<'_>,
    ) -> Result<Changes, GivenUp> {
        let changes = self.changes(plan);
        self.built &= !changes.geometry;
        if plan.rules == Rules::Ignored || !changes.is_nothing() {
            self.resize(plan.size);
            self.finished = false;
            // From one of the threads that draw, so that the caller sleeps and wakes once a frame.
            rayon::scope(|_| {
                plan.prepare();
                self.draw_changes(plan, &changes, watch);
            });
            if watch.is_given_up() {
                return Err(GivenUp);
            }
            // What each sample sees was brought onto the screen by itself.
            (self.finished, self.built) = (true, !plan.lit_by_sample);
        }
        self.plan = Some(plan.clone());
        Ok(changes)
    }

    /// Makes the picture as large as it has to be.
    fn resize(&mut self, size: Size) {
        if self.picture.size() != size {
            self.picture.resize(size);
            let [columns, rows] = [size.width, size.height].map(|n| n.div_ceil(TILE_SIDE));
            self.filled.clear();
            self.filled.resize(columns * rows, None);
        }
    }

    fn draw_changes(&mut self, plan: &FramePlan, changes: &Changes, watch: &Cancellation<'_>) {
        self.stages = Stages::default();
        let passes = passes(plan.samples);
        let pictures = if plan.lit_by_sample { shifts(plan.samples).len() } else { passes.len() };
        watch.expect_tiles(pictures * changes.tiles());
        let mut sums = Vec::new();
        if passes.len() > 1 || plan.lit_by_sample {
            // Whenever this is given up, the frame holds what is on none of the finished pictures.
            self.built = false;
            let [columns, rows] = tiles_of(plan.size);
            let tiles = usize::try_from(columns * rows).expect("not negative");
            sums.resize_with(tiles, TileSums::default);
        }
        if plan.lit_by_sample {
            return self.draw_each_sample(plan, changes, &sums, watch);
        }
        // The first pass comes last, so that its frame is what is asked of what is seen.
        for (i, places) in passes.iter().enumerate().rev() {
            if !self.built {
                self.stages += self.frame.build(self.level, plan, *places, watch);
            }
            if watch.is_given_up() {
                return;
            }
            self.draw_pass(plan, changes, &Pass { sums: &sums, is_last: i == 0 }, watch);
        }
    }

    /// Draws a picture for each sample, as if it were the middle of its pixel, and gives the means of them
    /// all.
    fn draw_each_sample(
        &mut self,
        plan: &FramePlan,
        changes: &Changes,
        sums: &[TileSums],
        watch: &Cancellation<'_>,
    ) {
        let shifts = shifts(plan.samples);
        let last = shifts.len() - 1;
        for (i, shift) in shifts.enumerate() {
            let own = plan.seen_from(shift);
            self.stages += self.frame.build(self.level, &own, SamplePositions::default(), watch);
            if watch.is_given_up() {
                return;
            }
            self.draw_pass(&own, changes, &Pass { sums, is_last: i == last }, watch);
        }
    }

    fn draw_pass(
        &mut self,
        plan: &FramePlan,
        changes: &Changes,
        pass: &Pass<'_>,
        watch: &Cancellation<'_>,
    ) {
        match plan.arithmetic {
            Arithmetic::F32 => self.draw::<f32>(plan, changes, pass, watch),
            Arithmetic::F64 => self.draw::<f64>(plan, changes, pass, watch),
        }
    }

    /// What [`Self::redraw`] would draw again.
    #[must_use]
    pub fn changes(&self, plan: &FramePlan) -> Changes {
        match &self.plan {
            Some(before) if self.finished => Changes::between(before, plan),
            _ => Changes::all(Cause::First, plan.size),
        }
    }

    /// Brings what the last finished picture shows onto the screen again, where something else was
    /// begun since.
    fn build_again(&mut self) {
        if let (false, Some(plan)) = (self.built, &self.plan) {
            let places = passes(plan.samples)[0];
            self.frame.build(self.level, plan, places, &Cancellation::new(&|| true));
            self.built = true;
        }
    }

    /// The picture that was drawn last.
    #[must_use]
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// Where the time of the last picture went.
    #[must_use]
    pub const fn stages(&self) -> Stages {
        self.stages
    }

    /// How many triangles the last picture was made of.
    #[must_use]
    pub fn triangles_drawn(&self) -> usize {
        self.frame.triangles()
    }

    /// What the last picture shows in column `x` of row `y`; `None` for the background. Of a pixel with
    /// several samples the four nearest to its middle are asked: it is what most of them show.
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
        let mut visibility = Visibility::default();
        visibility.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
        let word = visibility.word(self.level, x, y);
        let (draw, polygon) = self.seen(plan, word)?;
        let depth = depth_format::depth(plan.variants.depth, visibility_buffer::key(word));
        Some(Hit { item: plan.draws[draw as usize].item, polygon, depth })
    }

    /// Where the last picture shows an item: a flag for each pixel, row by row from the top.
    #[must_use]
    pub fn pixels_of(&mut self, item: ItemId) -> Vec<bool> {
        let mut pixels = vec![false; self.seen_size().area()];
        self.look(|renderer, plan, at, word| {
            pixels[at] = renderer
                .seen(plan, word)
                .is_some_and(|(draw, _)| plan.draws[draw as usize].item == item);
            ControlFlow::Continue(())
        });
        pixels
    }

    /// The item that the last picture shows at each pixel, row by row from the top; nothing if all of
    /// these items are seen.
    pub(super) fn items_unless_all_seen(
        &mut self,
        mut items: BTreeSet<ItemId>,
    ) -> Option<Vec<Option<ItemId>>> {
        let mut pixels = vec![None; self.seen_size().area()];
        let mut last = None;
        self.look(|renderer, plan, at, word| {
            let seen = renderer.seen(plan, word).map(|(draw, _)| plan.draws[draw as usize].item);
            pixels[at] = seen;
            if seen != last {
                last = seen;
                seen.map(|item| items.remove(&item));
            }
            if items.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        (!items.is_empty()).then_some(pixels)
    }

    /// Says of each effect of the last picture how many pixels it takes part in, and gives by how many
    /// steps of a byte a channel of theirs may be off. Takes about as long as finding what is seen.
    pub fn count(&mut self, uses: &mut [EffectUse]) -> f64 {
        self.build_again();
        self.plan.as_ref().map_or(0.0, |plan| plan.count(self.level, &self.frame, uses))
    }

    /// Which primitive each pixel of the last picture shows, row by row from the top: 0 for the
    /// background, else a number that is another for every triangle and line of one scene.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the lower half of a word names what is seen"
    )]
    pub fn primitives(&mut self) -> Vec<u32> {
        let mut pixels = vec![0; self.seen_size().area()];
        self.look(|_, _, at, word| {
            pixels[at] = word as u32;
            ControlFlow::Continue(())
        });
        pixels
    }

    /// The size of the last picture that was finished; 0 x 0 before the first.
    fn seen_size(&self) -> Size {
        self.plan.as_ref().map_or(Size::new(0, 0), |plan| plan.size)
    }

    /// Calls `each` with the place and the word of each pixel of the last picture, tile by tile, until
    /// it breaks off.
    fn look(&mut self, mut each: impl FnMut(&Self, &FramePlan, usize, u64) -> ControlFlow<()>) {
        self.build_again();
        let Some(plan) = &self.plan else { return };
        let [columns, rows] = tiles_of(plan.size);
        let mut visibility = Visibility::default();
        for tile in 0..usize::try_from(columns * rows).expect("not negative") {
            let bounds = bounds_of(tile, plan.size);
            visibility.draw(self.level, plan, &self.frame, (tile, bounds));
            for (y, x) in (bounds.top..bounds.bottom)
                .flat_map(|y| (bounds.left..bounds.right).map(move |x| (y, x)))
            {
                let word = visibility.word(self.level, x, y);
                let [x, y] = [x, y].map(|i| usize::try_from(i).expect("inside the picture"));
                if each(self, plan, y * plan.size.width + x, word).is_break() {
                    return;
                }
            }
        }
    }

    /// The draw and the polygon that a word of the visibility stands for.
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

    /// Draws tiles, each thread its own.
    fn draw<T: Painted>(
        &mut self,
        plan: &FramePlan,
        changes: &Changes,
        pass: &Pass<'_>,
        watch: &Cancellation<'_>,
    ) {
        let mut laps = Laps::start();
        let Room { shines, lit, painters } = T::room(&mut self.rooms);
        shines.prepare(plan);
        lit.prepare(plan);
        let (level, frame) = (self.level, &self.frame);
        let context = ShadingContext { level, plan, frame, lit, shines };
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
                if changes.tiles.contains(tile) {
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
        self.stages.tiles += laps.lap();
    }
}

/// One of the passes that a picture is made of.
#[derive(Debug)]
struct Pass<'a> {
    /// For each tile the colours of earlier passes, block by block; none where there is one pass.
    sums: &'a [TileSums],
    is_last: bool,
}

/// What is kept from frame to frame for one kind of numbers.
#[derive(Debug, Default)]
struct Room<T> {
    shines: LightTerms<T>,
    lit: Lit<T>,
    /// One for each thread.
    painters: Vec<Painter<T>>,
}

#[derive(Debug, Default)]
struct Rooms {
    fast: Room<f32>,
    exact: Room<f64>,
}

/// Numbers that pictures are painted in.
trait Painted: ShadingNumber {
    fn room(rooms: &mut Rooms) -> &mut Room<Self>;
}

impl Painted for f32 {
    fn room(rooms: &mut Rooms) -> &mut Room<Self> {
        &mut rooms.fast
    }
}

impl Painted for f64 {
    fn room(rooms: &mut Rooms) -> &mut Room<Self> {
        &mut rooms.exact
    }
}
