//! Paints egui's output into memory on computers without a graphics card.
//!
//! The picture is divided into bands of 32 rows, which are painted in parallel. Each band remembers
//! its last items and repaints only the columns in which they differ. While a user looks around in
//! the viewport, only its picture is repainted.
//!
//! `textures` holds the atlas of glyphs and the pictures. `items` splits egui's meshes into items.
//! `fill` paints them, with the arithmetic of `blend`.
//!
//! ```
//! use egui::{Color32, Context, RawInput, Rect, pos2};
//! use marraztu_painter::{Canvas, WindowFrame, WindowPainter};
//!
//! let ctx = Context::default();
//! let window = Rect::from_min_max(pos2(0.0, 0.0), pos2(64.0, 48.0));
//! let input = RawInput { screen_rect: Some(window), ..RawInput::default() };
//! let mut output = ctx.run_ui(input, |ui| {
//!     ui.painter().rect_filled(window.shrink(8.0), 0.0, Color32::RED);
//! });
//!
//! let primitives = ctx.tessellate(output.shapes, 1.0);
//! let frame = WindowFrame { primitives, scale: 1.0, ground: Color32::WHITE };
//! let mut pixels = vec![0; 64 * 48];
//! let mut canvas = Canvas { pixels: &mut pixels, size: [64, 48], age: 0 };
//! WindowPainter::new().paint(&mut canvas, frame, &mut output.textures_delta);
//! assert_eq!((pixels[0], pixels[24 * 64 + 32]), (0xff_ff_ff, 0xff_00_00));
//! # output.textures_delta.clear();
//! ```

mod blend;
mod fill;
mod items;
#[cfg(test)]
mod tests;
mod textures;

use std::collections::VecDeque;
use std::ops::Range;

use egui::epaint::{ClippedPrimitive, Mesh, Primitive};
use egui::{Color32, Rect, TexturesDelta};
use rayon::prelude::*;

use fill::Strip;
use items::Item;
use marraztu_render::screen::coverage::PixelBox;
use textures::Textures;

/// The number of rows in a band.
const ROWS: usize = 32;

/// The number of frames for which changes are remembered, for windows that swap several buffers.
const REMEMBERED: usize = 4;

/// The input of one frame.
#[derive(Debug)]
pub struct WindowFrame {
    /// egui's meshes, from the lowest to the uppermost.
    pub primitives: Vec<ClippedPrimitive>,
    /// Pixels per point.
    pub scale: f32,
    /// The background colour.
    pub ground: Color32,
}

/// The buffer to paint into.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// Row by row: blue in the lowest byte, then green, red and a zero.
    pub pixels: &'a mut [u32],
    /// The number of columns and of rows.
    pub size: [usize; 2],
    /// The number of frames since these pixels were painted; 0 if they never were.
    pub age: usize,
}

/// Paints a window, frame after frame.
#[derive(Debug)]
pub struct WindowPainter {
    /// `None` without threads.
    pool: Option<rayon::ThreadPool>,
    textures: Textures,
    layers: Vec<Layer>,
    bands: Vec<Band>,
    /// The size, the scale and the background of the last frame.
    setting: Option<([usize; 2], f32, Color32)>,
}

/// A mesh and its items.
#[derive(Debug)]
struct Layer {
    clip: Rect,
    mesh: Mesh,
    items: Vec<Item>,
}

/// An item in a band: its position, and a key that changes if anything about the item changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Listed {
    key: u64,
    layer: usize,
    item: usize,
    columns: (i32, i32),
}

#[derive(Debug, Default)]
struct Band {
    /// The items of the last frame and of this one.
    last: Vec<Listed>,
    now: Vec<Listed>,
    /// The columns that changed in each of the last frames, the latest first.
    changes: VecDeque<Range<i32>>,
}

impl Default for WindowPainter {
    fn default() -> Self {
        Self::new()
    }
}

impl WindowPainter {
    /// Creates a painter that has painted nothing.
    pub fn new() -> Self {
        // A separate pool, because the threads that draw the viewport may be busy for long.
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(8);
        let name = |i| format!("window {i}");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(name);
        let (textures, layers, bands) = (Textures::default(), Vec::new(), Vec::new());
        // At a limit of threads, and in WebAssembly, the calling thread paints.
        Self { pool: pool.build().ok(), textures, layers, bands, setting: None }
    }

    /// Paints a frame and returns the areas that changed since the frame before it. If none did,
    /// nothing is painted, unless the canvas is new.
    pub fn paint(
        &mut self,
        canvas: &mut Canvas<'_>,
        frame: WindowFrame,
        textures: &mut TexturesDelta,
    ) -> Vec<PixelBox> {
        self.textures.set(textures);
        // Another size, scale or background changes every pixel: all bands start anew.
        let setting = (canvas.size, frame.scale, frame.ground);
        if self.setting.replace(setting) != Some(setting) {
            self.layers.clear();
            self.bands.clear();
        }
        let [width, height] = canvas.size;
        let size = [width, height].map(|count| i32::try_from(count).unwrap_or(i32::MAX));
        let bands = height.div_ceil(ROWS);
        if self.bands.len() != bands {
            self.bands.resize_with(bands, Band::default);
        }
        self.layer(frame.primitives, frame.scale, canvas.size);
        self.list();
        // Each band compares its new items with its old ones.
        let is_new = |band: &Band| band.changes.is_empty();
        let changed = |band: &Band| if is_new(band) { 0..size[0] } else { band.changed() };
        let changes: Vec<_> = self.bands.iter().map(changed).collect();
        if canvas.age > 0 && changes.iter().all(Range::is_empty) {
            self.textures.free(textures);
            return Vec::new();
        }
        for (band, change) in self.bands.iter_mut().zip(changes) {
            band.changes.push_front(change);
            band.changes.truncate(REMEMBERED);
        }
        // Each band repaints all columns that changed since this buffer was last used.
        let Self { pool, textures: known, layers, bands, .. } = self;
        if width > 0 {
            let strips = canvas.pixels.par_chunks_mut(width * ROWS).zip(&*bands).enumerate();
            let paint = || {
                strips.for_each(|(i, (pixels, band))| {
                    let area = area_of(i, size, band.since(canvas.age, size[0]));
                    let strip = Strip { pixels, width, top: area.top };
                    band.paint(strip, area, (layers, known), frame.ground);
                });
            };
            match pool {
                Some(pool) => pool.install(paint),
                None => paint(),
            }
        }
        self.textures.free(textures);
        // The window system is told the changes since the last frame, whatever the age of the
        // buffer.
        let since = canvas.age.min(1);
        let changed = |(i, band): (usize, &Band)| area_of(i, size, band.since(since, size[0]));
        joined(self.bands.iter().enumerate().map(changed).filter(|area| !area.is_empty()))
    }

    /// Splits changed meshes into items and keeps the items of unchanged meshes.
    fn layer(&mut self, primitives: Vec<ClippedPrimitive>, scale: f32, size: [usize; 2]) {
        let mut count = 0;
        for ClippedPrimitive { clip_rect: clip, primitive } in primitives {
            // Callbacks would paint by OpenGL, but the window uses none.
            let Primitive::Mesh(mesh) = primitive else { continue };
            match self.layers.get_mut(count) {
                Some(layer) if layer.clip == clip && layer.mesh == mesh => {}
                Some(layer) => layer.change(clip, mesh, scale, size),
                None => {
                    let items = Vec::new();
                    let mut layer = Layer { clip, mesh: Mesh::default(), items };
                    layer.change(clip, mesh, scale, size);
                    self.layers.push(layer);
                }
            }
            count += 1;
        }
        self.layers.truncate(count);
    }

    /// Lists the items of each band.
    fn list(&mut self) {
        for band in &mut self.bands {
            std::mem::swap(&mut band.last, &mut band.now);
            band.now.clear();
        }
        for (i, layer) in self.layers.iter().enumerate() {
            let Some(texture) = self.textures.get(layer.mesh.texture_id) else { continue };
            // The version of the texture is part of the key: new texels repaint every item that
            // shows them.
            let version = texture.version.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            for (j, Item { area, key, .. }) in layer.items.iter().enumerate() {
                let columns = (area.left, area.right);
                let listed = Listed { key: key ^ version, layer: i, item: j, columns };
                let row = |y: i32| usize::try_from(y).unwrap_or(0);
                let (first, last) = (row(area.top) / ROWS, row(area.bottom - 1) / ROWS);
                for band in self.bands.iter_mut().take(last + 1).skip(first) {
                    band.now.push(listed);
                }
            }
        }
    }
}

impl Layer {
    fn change(&mut self, clip: Rect, mesh: Mesh, scale: f32, size: [usize; 2]) {
        self.items.clear();
        items::items_of(&mesh, items::clip_area(clip, scale, size), scale, &mut self.items);
        (self.clip, self.mesh) = (clip, mesh);
    }
}

impl Band {
    /// Returns the columns that have to be repainted since the last frame.
    fn changed(&self) -> Range<i32> {
        let (last, now) = (&self.last[..], &self.now[..]);
        let alike = |(a, b): &(&Listed, &Listed)| a.key == b.key;
        // Most frames change a few items: the equal ones at both ends of the lists are dropped
        // first.
        let before = last.iter().zip(now).take_while(alike).count();
        let (last, now) = (&last[before..], &now[before..]);
        let after = last.iter().rev().zip(now.iter().rev()).take_while(alike).count();
        let (last, now) = (&last[..last.len() - after], &now[..now.len() - after]);
        // If no items were added or removed, an item at the same index with the same key is
        // unchanged.
        let same = |i: usize| last.len() == now.len() && last[i].key == now[i].key;
        let others = |list: &'_ [Listed]| -> Option<Range<i32>> {
            let those = || list.iter().enumerate().filter(|(i, _)| !same(*i));
            let left = those().map(|(_, listed)| listed.columns.0).min()?;
            Some(left..those().map(|(_, listed)| listed.columns.1).max()?)
        };
        union(others(last).unwrap_or(0..0), others(now).unwrap_or(0..0))
    }

    /// Returns the columns that changed in the last `age` frames; all columns if that is unknown.
    fn since(&self, age: usize, width: i32) -> Range<i32> {
        if age == 0 || age > self.changes.len() {
            return 0..width;
        }
        self.changes.iter().take(age).cloned().fold(0..0, union)
    }

    fn paint(
        &self,
        mut strip: Strip<'_>,
        area: PixelBox,
        (layers, textures): (&[Layer], &Textures),
        ground: Color32,
    ) {
        if area.is_empty() {
            return;
        }
        let items: Vec<_> = self
            .now
            .iter()
            .filter(|listed| listed.columns.0 < area.right && listed.columns.1 > area.left)
            .filter_map(|listed| {
                let layer = layers.get(listed.layer)?;
                Some((layer.items.get(listed.item)?, textures.get(layer.mesh.texture_id)?))
            })
            .collect();
        // The last item that hides the whole area is the first that needs to be painted.
        let hiding = items.iter().rposition(|(item, texture)| fill::hides(item, texture, area));
        if hiding.is_none() {
            strip.clear(area, ground);
        }
        for (item, texture) in &items[hiding.unwrap_or(0)..] {
            fill::paint(&mut strip, item, texture, area);
        }
    }
}

/// Joins areas, listed from top to bottom, if they have the same columns and touch.
fn joined(areas: impl Iterator<Item = PixelBox>) -> Vec<PixelBox> {
    let mut joined: Vec<PixelBox> = Vec::new();
    for area in areas {
        match joined.last_mut() {
            Some(last)
                if (last.left, last.right, last.bottom) == (area.left, area.right, area.top) =>
            {
                last.bottom = area.bottom;
            }
            _ => joined.push(area),
        }
    }
    joined
}

/// Returns the smallest range that contains both; empty ranges are ignored.
fn union(a: Range<i32>, b: Range<i32>) -> Range<i32> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b,
        (_, true) => a,
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// Returns the area of these columns in band `i` of a picture.
fn area_of(i: usize, [width, height]: [i32; 2], columns: Range<i32>) -> PixelBox {
    let top = i32::try_from(i * ROWS).unwrap_or(i32::MAX);
    let rows = i32::try_from(ROWS).unwrap_or(i32::MAX);
    let bottom = top.saturating_add(rows).min(height);
    PixelBox { left: columns.start.max(0), top, right: columns.end.min(width), bottom }
}
