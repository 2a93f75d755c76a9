//! Runs plans: does, and asks no setting.

use std::sync::Mutex;

use fearless_simd::Level;
use rayon::prelude::*;

use super::bins::tiles_of;
use super::coverage::PixelBox;
use super::effects::Light;
use super::frame::Frame;
use super::light::Lit;
use super::plan::FramePlan;
use super::surface::Shader;
use super::tile::{self, BLOCK_PIXELS, Seen, TILE, TILE_SIDE, Visibility};
use crate::base::image::{Picture, Size};
use crate::scene::{Arithmetic, ItemId};

/// Draws pictures, and keeps the memory that this takes from one to the next.
#[derive(Debug)]
pub struct Renderer {
    level: Level,
    picture: Picture,
    frame: Frame,
    /// The plan of the picture, for picking.
    plan: Option<FramePlan>,
}

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
        Self { level, picture: Picture::default(), frame: Frame::default(), plan: None }
    }

    /// Draws what is planned.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.picture.resize(plan.size);
        self.frame.build(self.level, plan);
        match plan.arithmetic {
            Arithmetic::F32 => self.draw::<f32>(plan),
            Arithmetic::F64 => self.draw::<f64>(plan),
        }
        self.plan = Some(plan.clone());
        &self.picture
    }

    /// The picture that was drawn last.
    #[must_use]
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// How many triangles the last picture was made of.
    #[must_use]
    pub fn triangles_drawn(&self) -> usize {
        self.frame.triangles()
    }

    /// What the last picture shows in column `x` of row `y`; `None` for the background.
    #[must_use]
    pub fn hit(&self, x: usize, y: usize) -> Option<Hit> {
        let plan = self.plan.as_ref()?;
        let Size { width, height } = self.picture.size();
        if x >= width || y >= height {
            return None;
        }
        let [x, y] = [x, y].map(|i| i32::try_from(i).expect("inside the picture"));
        let [columns, _] = tiles_of(plan.size);
        let tile = usize::try_from(y / TILE * columns + x / TILE).expect("not negative");
        let mut visibility = Visibility::default();
        visibility.draw(self.level, plan, &self.frame, (tile, bounds_of(tile, plan.size)));
        let word = visibility.word(x, y);
        let (draw, polygon) = self.seen(plan, word)?;
        Some(Hit { item: plan.draws[draw as usize].item, polygon, depth: tile::depth(word) })
    }

    /// Where the last picture shows an item: a flag for each pixel, row by row from the top.
    #[must_use]
    pub fn pixels_of(&self, item: ItemId) -> Vec<bool> {
        let size = self.picture.size();
        let mut pixels = vec![false; size.area()];
        let Some(plan) = &self.plan else { return pixels };
        let [columns, rows] = tiles_of(plan.size);
        let mut visibility = Visibility::default();
        for tile in 0..usize::try_from(columns * rows).expect("not negative") {
            let bounds = bounds_of(tile, plan.size);
            visibility.draw(self.level, plan, &self.frame, (tile, bounds));
            for (y, x) in (bounds.top..bounds.bottom)
                .flat_map(|y| (bounds.left..bounds.right).map(move |x| (y, x)))
            {
                let seen = self.seen(plan, visibility.word(x, y));
                let [x, y] = [x, y].map(|i| usize::try_from(i).expect("inside the picture"));
                pixels[y * size.width + x] =
                    seen.is_some_and(|(draw, _)| plan.draws[draw as usize].item == item);
            }
        }
        pixels
    }

    /// Which primitive each pixel of the last picture shows, row by row from the top: 0 for the
    /// background, else a number that is another for every triangle and line of one scene.
    #[must_use]
    pub fn primitives(&self) -> Vec<u32> {
        let size = self.picture.size();
        let mut pixels = vec![0; size.area()];
        let Some(plan) = &self.plan else { return pixels };
        let [columns, rows] = tiles_of(plan.size);
        let mut visibility = Visibility::default();
        for tile in 0..usize::try_from(columns * rows).expect("not negative") {
            let bounds = bounds_of(tile, plan.size);
            visibility.draw(self.level, plan, &self.frame, (tile, bounds));
            for (y, x) in (bounds.top..bounds.bottom)
                .flat_map(|y| (bounds.left..bounds.right).map(move |x| (y, x)))
            {
                let number = match tile::seen(visibility.word(x, y)) {
                    Seen::Background => 0,
                    Seen::Triangle(number) => number + 1,
                    // Counted from the other end, so that no line has the number of a triangle.
                    Seen::Line(number) => u32::MAX - number,
                };
                let [x, y] = [x, y].map(|i| usize::try_from(i).expect("inside the picture"));
                pixels[y * size.width + x] = number;
            }
        }
        pixels
    }

    /// The draw and the polygon that a word of the visibility stands for.
    fn seen(&self, plan: &FramePlan, word: u64) -> Option<(u32, u32)> {
        match tile::seen(word) {
            Seen::Background => None,
            Seen::Triangle(number) => {
                let (draw, start) = self.frame.draw_of(number);
                let mesh = &plan.draws[draw as usize].model.mesh;
                Some((draw, mesh.triangles()[(number - start.number) as usize].polygon))
            }
            Seen::Line(number) => {
                let line = &self.frame.lines[number as usize];
                Some((line.draw, line.polygon))
            }
        }
    }

    /// Draws the tiles, each thread its own; a band of rows is locked only while a tile is copied.
    fn draw<T: Light>(&mut self, plan: &FramePlan) {
        let lit = Lit::<T>::new(plan, self.level);
        let [columns, rows] = tiles_of(plan.size);
        let (level, frame) = (self.level, &self.frame);
        let bands = self.picture.pixels_mut().chunks_mut(plan.size.width * TILE_SIDE);
        let bands: Vec<Mutex<&mut [[u8; 4]]>> = bands.map(Mutex::new).collect();
        let tiles = usize::try_from(columns * rows).expect("not negative");
        (0..tiles).into_par_iter().with_max_len(1).for_each_init(
            || Painter::<T>::new(plan, frame, &lit, level),
            |painter, tile| {
                let bounds = bounds_of(tile, plan.size);
                painter.paint(tile, bounds);
                let band = &bands[usize::try_from(bounds.top / TILE).expect("not negative")];
                let mut band = band.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                painter.copy(&mut band, bounds, plan.size.width);
            },
        );
    }
}

/// The pixels of a tile; tiles are counted along rows.
fn bounds_of(tile: usize, size: Size) -> PixelBox {
    let [columns, _] = tiles_of(size);
    let tile = i32::try_from(tile).expect("pictures have 32-bit sizes");
    let (left, top) = (tile % columns * TILE, tile / columns * TILE);
    let [right, bottom] = [size.width, size.height]
        .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
    let picture = PixelBox { left: 0, top: 0, right, bottom };
    PixelBox { left, top, right: left + TILE, bottom: top + TILE }.intersection(picture)
}

/// Draws one tile after another.
#[derive(Debug)]
struct Painter<'a, T> {
    plan: &'a FramePlan,
    frame: &'a Frame,
    level: Level,
    shader: Shader<'a, T>,
    visibility: Visibility,
    pixels: Box<[[u8; 4]; TILE_SIDE * TILE_SIDE]>,
}

impl<'a, T: Light> Painter<'a, T> {
    fn new(plan: &'a FramePlan, frame: &'a Frame, lit: &'a Lit<T>, level: Level) -> Self {
        Self {
            plan,
            frame,
            level,
            shader: Shader::new(plan, frame, lit, level),
            visibility: Visibility::default(),
            pixels: Box::new([[0; 4]; TILE_SIDE * TILE_SIDE]),
        }
    }

    fn paint(&mut self, tile: usize, bounds: PixelBox) {
        self.pixels.fill(self.plan.background.opaque());
        if self.frame.is_empty(tile) {
            return;
        }
        self.visibility.draw(self.level, self.plan, self.frame, (tile, bounds));
        for block in 0..TILE_SIDE * TILE_SIDE / BLOCK_PIXELS {
            let (words, corner) = self.visibility.block(block);
            if words.iter().fold(0, |all, word| all | word) == 0 {
                continue;
            }
            let [x, y] = [corner[0] - bounds.left, corner[1] - bounds.top]
                .map(|i| usize::try_from(i).expect("not negative"));
            self.shader.block(words, corner, &mut self.pixels[..], y * TILE_SIDE + x);
        }
    }

    /// Copies the tile into its band of the picture.
    fn copy(&self, band: &mut [[u8; 4]], bounds: PixelBox, width: usize) {
        let [left, columns] = [bounds.left, bounds.right - bounds.left]
            .map(|i| usize::try_from(i).expect("not negative"));
        for (from, to) in self.pixels.chunks(TILE_SIDE).zip(band.chunks_mut(width)) {
            to[left..left + columns].copy_from_slice(&from[..columns]);
        }
    }
}
