//! Paints tiles: visibility, shading, and the copy into the picture.
//!
//! Each thread reuses its painter from frame to frame, so a frame allocates and clears nothing for
//! its tiles. A block that showed only background before and still does is not touched.
//!
//! Tiles are painted into a buffer and copied. Stores to the picture miss the L1 cache and hold up
//! later stores. Where shading stores numbers one by one and loads them sixteen at a time, store
//! forwarding fails, and the load must wait for all earlier stores. A whole tile with little
//! computation left is painted straight into the picture: if many of its blocks are filled, and no
//! other thread works in its rows.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::colors::Sums;
use super::context::{ShadingContext, group_of};
use super::full_blocks::{Blocks, Canvas};
use super::layers::Layered;
use super::path_number::PathNumber;
use super::samples::{Kept, Samples};
use super::shader::{Out, Shader};
use crate::frame::FramePlan;
use crate::raster::tile::Visibility;
use crate::screen::background::Background;
use crate::screen::coverage::PixelBox;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE, TILE_SIDE, pixel_of, tiles_of};
use crate::simd::{BATCH, Bits};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;

/// Returns the pixels of a tile; tiles are counted along rows.
pub(crate) fn bounds_of(tile: usize, size: Size) -> PixelBox {
    let [columns, _] = tiles_of(size);
    let tile = i32::try_from(tile).expect("pictures have 32-bit sizes");
    let (left, top) = (tile % columns * TILE, tile / columns * TILE);
    let [right, bottom] = [size.width, size.height]
        .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
    // Tiles at the right and lower border end with the picture.
    let picture = PixelBox { left: 0, top: 0, right, bottom };
    PixelBox { left, top, right: left + TILE, bottom: top + TILE }.intersection(picture)
}

/// The rows of pixels of a row of tiles.
#[derive(Debug)]
pub(crate) struct Band<'a> {
    pub(crate) pixels: &'a mut [[u8; 4]],
    /// The blocks of each tile that are filled with one colour.
    pub(crate) filled: &'a mut [Filled],
}

/// The blocks of a tile known to be filled with a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Filled {
    color: Color,
    /// A bit for each block.
    blocks: u64,
}

impl Filled {
    /// Returns the blocks that are filled with this background.
    fn with(self, background: Background<'_>) -> u64 {
        if background.even() == Some(self.color) { self.blocks } else { 0 }
    }

    /// Notes the blocks that show a background, if it is the same everywhere.
    fn new(background: Background<'_>, blocks: u64) -> Self {
        background.even().map_or_else(Self::default, |color| Self { color, blocks })
    }
}

/// Locks a band for this thread.
fn locked<'a, 'b>(band: &'a Mutex<Band<'b>>) -> MutexGuard<'a, Band<'b>> {
    band.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The pixels along a side of a block.
const ROW: usize = BLOCK as usize;
/// The blocks in a row of a tile.
const BLOCKS: usize = TILE_SIDE / ROW;

/// The colours of a tile, summed over several passes.
#[derive(Debug, Default)]
pub(crate) struct TileSums(Mutex<TilePasses>);

#[derive(Debug, Default)]
struct TilePasses {
    /// The samples of every pixel in passes that showed only the background.
    background: i32,
    /// The sums block by block; empty until the tile shows anything.
    blocks: Vec<BlockPasses>,
}

#[derive(Clone, Debug)]
struct BlockPasses {
    sums: Sums,
    kept: Kept,
    /// The samples of every pixel that show the background and are not in the sums.
    background: i32,
}

impl TileSums {
    fn lock(&self) -> MutexGuard<'_, TilePasses> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl TilePasses {
    /// Returns the blocks, and creates them if necessary.
    fn blocks(&mut self, is_linear: bool) -> &mut [BlockPasses] {
        let sums = Sums::new(is_linear);
        let nothing = BlockPasses { sums, kept: Kept::default(), background: 0 };
        self.blocks.resize(BLOCK_PIXELS, nothing);
        &mut self.blocks
    }
}

/// Returns the first pixel of a block, by column and row of the tile.
const fn corner_in_tile(block: usize) -> [usize; 2] {
    [block % BLOCKS * ROW, block / BLOCKS * ROW]
}

/// Adds the background to the sums of a block of a tile, for a number of samples.
fn add_background(
    sums: &mut Sums,
    background: Background<'_>,
    (block, bounds): (usize, PixelBox),
    samples: i32,
) {
    if let Some(color) = background.even() {
        return sums.add_everywhere(color.opaque(), samples);
    }
    let [x, y] = corner_in_tile(block).map(|at| i32::try_from(at).expect("in the tile"));
    for place in (0..BLOCK_PIXELS).filter(|_| samples > 0) {
        let pixel = pixel_of([bounds.left + x, bounds.top + y], place);
        sums.add(place, background.at(pixel), samples);
    }
}

/// Draws one tile after another. It is aligned so painters never share a cache line.
#[derive(Debug)]
#[repr(align(128))]
pub(crate) struct Painter<T> {
    pub(crate) shader: Shader<T>,
    visibility: Visibility,
    layered: Layered,
    samples: Samples,
    /// A buffer for tiles that are not painted straight into the picture.
    pixels: Vec<[u8; 4]>,
}

impl<T: PathNumber> Default for Painter<T> {
    fn default() -> Self {
        Self {
            shader: Shader::default(),
            visibility: Visibility::default(),
            layered: Layered::default(),
            samples: Samples::default(),
            pixels: vec![[0; 4]; TILE_SIDE * TILE_SIDE],
        }
    }
}

impl<T: PathNumber> Painter<T> {
    /// Paints a tile of the picture into its band.
    pub(crate) fn paint(
        &mut self,
        context: &ShadingContext<'_, T>,
        tile: usize,
        band: &Mutex<Band<'_>>,
    ) {
        let ShadingContext { plan, .. } = *context;
        let (size, background) = (plan.size, plan.behind());
        let bounds = bounds_of(tile, size);
        // An empty tile costs a fill at most, and no store if it holds the background already.
        if !self.see(context, tile, bounds) {
            return Self::fill((tile, bounds), size, background, &mut locked(band));
        }
        // The direct path needs a whole tile with little work left, and a free band.
        let whole = (bounds.width(), bounds.height()) == (TILE, TILE);
        let (column, columns) = Self::columns(tile, size);
        let full = self.visibility.full_blocks().count_ones() as usize;
        let is_done = full >= BLOCK_PIXELS / 4;
        if whole
            && context.programs.are_quick
            && is_done
            && let Ok(mut band) = band.try_lock()
        {
            let Band { pixels, filled } = &mut *band;
            let mut canvas = Canvas { pixels: &mut pixels[columns.start..], stride: size.width };
            let blocks = std::mem::take(&mut filled[column]).with(background);
            let blocks = self.blocks(context, bounds, &mut canvas, (blocks, true));
            filled[column] = Filled::new(background, blocks);
            return;
        }
        // The usual path: shade into the buffer without a lock, then copy the changed blocks.
        let before = locked(band).filled[column].with(background);
        let mut pixels = std::mem::take(&mut self.pixels);
        let mut canvas = Canvas { pixels: &mut pixels[..], stride: TILE_SIDE };
        let blocks = self.blocks(context, bounds, &mut canvas, (before, false));
        self.pixels = pixels;
        let mut band = locked(band);
        // Blocks that showed only background before and still do are not copied.
        self.copy(tile, size, !(before & blocks), &mut band);
        band.filled[column] = Filled::new(background, blocks);
    }

    /// Finds the visible primitives of a tile. Returns whether there may be any.
    fn see(&mut self, context: &ShadingContext<'_, T>, tile: usize, bounds: PixelBox) -> bool {
        let ShadingContext { level, plan, frame, .. } = *context;
        if frame.is_empty(tile) {
            return false;
        }
        let Self { shader, visibility, layered: Layered { layers, .. }, .. } = self;
        visibility.draw(level, plan, frame, (tile, bounds));
        // Transparent triangles are kept apart: they hide nothing, and are sorted per pixel later.
        if frame.is_layered(tile) {
            layers.begin(level, plan, frame, (tile, bounds));
        } else {
            layers.begin_none();
        }
        if visibility.is_empty() && layers.touched() == 0 {
            return false;
        }
        // Lights that do not reach the depths of the tile, layers included, are left out.
        shader.tile.begin(plan, bounds, || layers.depths_with(visibility.depths(level)));
        true
    }

    /// Colours the blocks of a tile. Blocks in `filled` already hold the background in the picture,
    /// and also in the canvas if it is `straight` a part of the picture. Returns the blocks that
    /// only show background.
    fn blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        bounds: PixelBox,
        canvas: &mut Canvas<'_>,
        (filled, straight): (u64, bool),
    ) -> u64 {
        let layered = self.layered.layers.touched();
        let whole = self.visibility.full_blocks();
        let background = context.plan.behind();
        let even = background.even().map(|color| u32::from_le_bytes(color.opaque()));
        // A row longer than a block, because runs of equal pixels are filled a row at a time.
        let mut colors = [0; BLOCK_PIXELS + ROW];
        // Faces without a known colour are lit first, for the whole tile in few batches.
        if let Some(faces) = context.faces {
            self.shader.light_shown_faces(context, faces, &self.visibility);
        }
        self.fully_covered(context, bounds, canvas, layered);
        let mut background_blocks = 0;
        for block in 0..BLOCK_PIXELS {
            let at = canvas.offset(corner_in_tile(block));
            // The colour to fill in around the visible primitives.
            let is_filled = filled >> block & 1 != 0;
            let fill = (!(is_filled && straight)).then_some(background);
            let mut shows = true;
            // From the most special case to the most common one: layers, full blocks, then blocks
            // to be shaded.
            if layered >> block & 1 != 0 {
                // Layers reuse the fragment list, so waiting blocks are coloured before.
                self.shader.finish_waiting(context, canvas);
                let mut sums = Sums::new(context.mode().is_linear());
                let corner = self.visibility.corner(block);
                let Self { shader, visibility, layered, .. } = self;
                layered.add(context, (shader, visibility), (block, corner), &mut sums);
                canvas.put(at, &sums.means(context.frame.sample_positions().count().ilog2()));
            } else if whole >> block & 1 != 0 {
                // Already coloured by `fully_covered`.
                continue;
            } else if self.visibility.shows(block) {
                let corner = self.visibility.corner(block);
                shows = if context.frame.sample_positions().are_many() {
                    self.block_of_samples(context, (block, corner), (canvas, at), fill)
                } else {
                    let visibility = self.visibility.block(block);
                    let runs = (visibility, self.shader.runs[block]);
                    let faces = context.faces;
                    // If the colours of all faces in the block are known, a look-up is enough.
                    if let Some((faces, even)) = faces.zip(even)
                        && faces.of_block(runs, even, &mut colors)
                    {
                        canvas.put(at, &colors[..BLOCK_PIXELS]);
                        self.shader.path_pixels.faces += BLOCK_PIXELS as u64;
                        visibility.iter().any(|word| *word != 0)
                    } else {
                        self.shader.block_later(context, visibility, corner, (canvas, at), fill)
                    }
                };
            } else {
                // A block filled by an earlier frame needs no store: the picture keeps it.
                if !is_filled {
                    canvas.fill_behind(at, self.visibility.corner(block), background);
                }
                shows = false;
            }
            background_blocks |= u64::from(!shows) << block;
        }
        // No block waits for the next tile, which has another canvas.
        self.shader.finish_waiting(context, canvas);
        background_blocks
    }

    /// Colours the blocks of a tile that one triangle covers fully, except layered blocks: all
    /// blocks of a triangle at once.
    fn fully_covered(
        &mut self,
        context: &ShadingContext<'_, T>,
        bounds: PixelBox,
        canvas: &mut Canvas<'_>,
        layered: u64,
    ) {
        let mut left = self.visibility.full_blocks() & !layered;
        while left != 0 {
            let first = left.trailing_zeros() as usize;
            let Some(number) = self.visibility.whole(first) else { return };
            // All blocks of this triangle are coloured together, so it is prepared once.
            let own = |block| u64::from(self.visibility.whole(block) == Some(number)) << block;
            let which = Bits(left).fold(0, |which, block| which | own(block));
            left &= !which;
            let blocks = Blocks { which, corner: [bounds.left, bounds.top] };
            self.shader.full_blocks(context, number, blocks, canvas);
        }
    }

    /// Colours a block of pixels with several samples.
    fn block_of_samples(
        &mut self,
        context: &ShadingContext<'_, T>,
        (block, corner): (usize, [i32; 2]),
        (canvas, at): (&mut Canvas<'_>, usize),
        fill: Option<Background<'_>>,
    ) -> bool {
        let Self { shader, visibility, samples, .. } = self;
        let count = context.frame.sample_positions().count();
        // If the samples of each pixel agree, the block costs no more than with one sample.
        if samples.compare(context.level, visibility.samples_of(block), count) {
            return shader.block_later(context, &samples.first, corner, (canvas, at), fill);
        }
        // Separate samples need the fragment list, so waiting blocks are coloured before.
        shader.finish_waiting(context, canvas);
        let mut sums = Sums::new(context.mode().is_linear());
        let shows = shader.add_samples(context, samples, corner, (&mut sums, None));
        canvas.put(at, &sums.means(count.ilog2()));
        shows
    }

    /// Adds the colours of a tile, for the samples of a pass, to the sums.
    pub(crate) fn add(&mut self, context: &ShadingContext<'_, T>, tile: usize, to: &TileSums) {
        let ShadingContext { plan, frame, .. } = *context;
        let mut to = to.lock();
        let bounds = bounds_of(tile, plan.size);
        let many = frame.sample_positions().are_many();
        if !self.see(context, tile, bounds) {
            // A pass without primitives adds background to every pixel, and needs no sums.
            to.background += frame.sample_positions().shares();
        } else {
            for (block, to) in to.blocks(context.mode().is_linear()).iter_mut().enumerate() {
                match many {
                    true => self.add_block(context, block, to),
                    false => self.add_block_of_one(context, block, to),
                }
            }
        }
    }

    /// Adds the colours of a block of one sample.
    fn add_block_of_one(
        &mut self,
        context: &ShadingContext<'_, T>,
        block: usize,
        BlockPasses { sums, background, .. }: &mut BlockPasses,
    ) {
        let Self { shader, visibility, layered, .. } = self;
        let corner = visibility.corner(block);
        if layered.layers.touches(block) {
            layered.add(context, (shader, visibility), (block, corner), sums);
        } else if !visibility.shows(block) {
            *background += 1;
        } else if let Some(number) = visibility.whole(block) {
            shader.fragments.list_full_block(number, corner);
            shader.fragments.shares = [1; BATCH];
            shader.color_group(&group_of(context, number), &mut Out::Sums(sums));
        } else {
            shader.add_sample(context, visibility.block(block), corner, sums);
        }
    }

    /// Adds the colours of a block of several samples.
    fn add_block(
        &mut self,
        context: &ShadingContext<'_, T>,
        block: usize,
        BlockPasses { sums, kept, background }: &mut BlockPasses,
    ) {
        let Self { shader, visibility, samples, layered, .. } = self;
        let (corner, all) = (visibility.corner(block), context.frame.sample_positions().shares());
        if layered.layers.touches(block) {
            layered.add(context, (shader, visibility), (block, corner), sums);
        } else if !visibility.shows(block) {
            *background += all;
        } else if let Some(number) = visibility.whole(block) {
            // An earlier pass has lit this triangle in all pixels of the block.
            if kept.are_all_of(number) {
                sums.add_to_all(context.level, kept.parts(), &[all; BLOCK_PIXELS]);
            } else {
                let mut out = Out::Kept(sums, kept, BLOCK_PIXELS);
                shader.fragments.list_full_block(number, corner);
                shader.fragments.shares = [all; BATCH];
                shader.color_group(&group_of(context, number), &mut out);
            }
        } else {
            let count = context.frame.sample_positions().count();
            samples.compare(context.level, visibility.samples_of(block), count);
            shader.add_samples(context, samples, corner, (sums, Some(kept)));
        }
    }

    /// Stores the means of all samples of a tile in its band of the picture (MSAA resolve).
    pub(crate) fn put_means(
        &mut self,
        context: &ShadingContext<'_, T>,
        tile: usize,
        of: &TileSums,
        band: &Mutex<Band<'_>>,
    ) {
        let mut of = of.lock();
        let FramePlan { size, samples, .. } = *context.plan;
        let (background, bounds) = (context.plan.behind(), bounds_of(tile, size));
        let TilePasses { background: everywhere, blocks } = &mut *of;
        if blocks.is_empty() {
            return Self::fill((tile, bounds), size, background, &mut locked(band));
        }
        let mut canvas = Canvas { pixels: &mut self.pixels, stride: TILE_SIDE };
        for (block, BlockPasses { sums, background: own, .. }) in blocks.iter_mut().enumerate() {
            // Passes that showed only background are added here, together.
            add_background(sums, background, (block, bounds), *everywhere + *own);
            let at = canvas.offset(corner_in_tile(block));
            canvas.put(at, &sums.means(samples.count().ilog2()));
        }
        let mut band = locked(band);
        self.copy(tile, size, u64::MAX, &mut band);
        // Blocks of background are not tracked over several passes.
        band.filled[tile % size.width.div_ceil(TILE_SIDE)] = Filled::default();
    }

    /// Copies the blocks of a mask from a tile's buffer into its band.
    fn copy(&self, tile: usize, size: Size, blocks: u64, band: &mut Band<'_>) {
        let (_, columns) = Self::columns(tile, size);
        let rows = self.pixels.chunks(TILE_SIDE).zip(band.pixels.chunks_mut(size.width));
        for (row, (from, to)) in rows.enumerate() {
            let mut own = blocks >> (row / ROW * BLOCKS) & 0xff;
            // Neighbouring blocks are copied together.
            while own != 0 {
                let first = own.trailing_zeros() as usize;
                let end = first + (own >> first).trailing_ones() as usize;
                own &= u64::MAX << end;
                let [first, end] = [first, end].map(|block| columns.len().min(block * ROW));
                to[columns.start..][first..end].copy_from_slice(&from[first..end]);
            }
        }
    }

    /// Fills a tile with the background, unless it already holds it.
    fn fill(
        (tile, bounds): (usize, PixelBox),
        size: Size,
        background: Background<'_>,
        band: &mut Band<'_>,
    ) {
        let (column, columns) = Self::columns(tile, size);
        if band.filled[column].with(background) == u64::MAX {
            return;
        }
        band.filled[column] = Filled::new(background, u64::MAX);
        for (row, y) in band.pixels.chunks_mut(size.width).zip(bounds.top..) {
            let row = &mut row[columns.clone()];
            match background.even() {
                Some(color) => row.fill(color.opaque()),
                None => {
                    row.iter_mut()
                        .zip(bounds.left..)
                        .for_each(|(to, x)| *to = background.at([x, y]));
                }
            }
        }
    }

    /// Returns the index of a tile in its band, and its columns of the picture.
    fn columns(tile: usize, size: Size) -> (usize, std::ops::Range<usize>) {
        let column = tile % size.width.div_ceil(TILE_SIDE);
        let left = column * TILE_SIDE;
        (column, left..size.width.min(left + TILE_SIDE))
    }
}
