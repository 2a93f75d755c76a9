//! The textures of egui: the atlas of glyphs, and pictures.
//!
//! A picture that replaces a whole texture is kept without a copy. Each change gives the texture a
//! new version, so every item that shows it is painted again.

use std::collections::HashMap;
use std::sync::Arc;

use egui::epaint::ImageDelta;
use egui::{Color32, ColorImage, ImageData, TextureFilter, TextureId};
use egui::{TextureOptions, TextureWrapMode, TexturesDelta};

use crate::blend::all_opaque;

/// All textures by their ids.
#[derive(Debug, Default)]
pub(crate) struct Textures {
    all: HashMap<TextureId, Texture>,
    changes: u64,
}

/// A picture that meshes show.
#[derive(Debug)]
pub(crate) struct Texture {
    image: Arc<ColorImage>,
    options: TextureOptions,
    /// Whether all texels are opaque.
    pub(crate) is_opaque: bool,
    /// A number that changes with the texture. No two changes have the same number.
    pub(crate) version: u64,
}

/// The way to read a texture between its texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Filter {
    /// The nearest texel.
    Nearest,
    /// The mean of the nearest four, weighted by distance.
    Linear,
}

impl Textures {
    /// Adds new textures and updates parts of known ones.
    pub(crate) fn set(&mut self, delta: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "each texture stands for itself")]
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                self.set_one(id, delta);
            }
        }
    }

    /// Removes textures that are not shown any more.
    pub(crate) fn free(&mut self, delta: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "each texture stands for itself")]
        for id in delta.free.drain() {
            self.all.remove(&id);
        }
    }

    /// Returns the texture of this id, if it exists and has texels.
    pub(crate) fn get(&self, id: TextureId) -> Option<&Texture> {
        self.all.get(&id).filter(|texture| !texture.image.pixels.is_empty())
    }

    fn set_one(&mut self, id: TextureId, delta: ImageDelta) {
        self.changes += 1;
        let ImageData::Color(image) = delta.image;
        let (options, version) = (delta.options, self.changes);
        let is_opaque = all_opaque(&image.pixels);
        match (delta.pos, self.all.get_mut(&id)) {
            (Some(at), Some(texture)) if at != [0, 0] || image.size != texture.image.size => {
                copy(&image, Arc::make_mut(&mut texture.image), at);
                (texture.options, texture.version) = (options, version);
                texture.is_opaque &= is_opaque;
            }
            _ => {
                self.all.insert(id, Texture { image, options, is_opaque, version });
            }
        }
    }
}

/// Copies a picture into another, its first pixel to `at`; pixels beyond the border are left out.
fn copy(from: &ColorImage, to: &mut ColorImage, [x, y]: [usize; 2]) {
    let [width, _] = to.size;
    let count = from.size[0].min(width.saturating_sub(x));
    if count == 0 {
        return;
    }
    let rows = from.pixels.chunks_exact(from.size[0]);
    for (row, into) in rows.zip(to.pixels.chunks_exact_mut(width).skip(y)) {
        into[x..x + count].copy_from_slice(&row[..count]);
    }
}

impl Texture {
    /// Returns the width and height in texels.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.image.size
    }

    /// Returns a row of texels.
    pub(crate) fn row(&self, y: usize) -> &[Color32] {
        let [width, _] = self.image.size;
        &self.image.pixels[y * width..(y + 1) * width]
    }

    /// Returns the filter for a step of this number of texels per pixel.
    pub(crate) fn filter(&self, texels: f64) -> Filter {
        let chosen = match texels > 1.0 {
            true => self.options.minification,
            false => self.options.magnification,
        };
        match chosen {
            TextureFilter::Nearest => Filter::Nearest,
            TextureFilter::Linear => Filter::Linear,
        }
    }

    /// Returns the texel of index `i` in a row or column of `count`, wrapped by the texture's
    /// options.
    pub(crate) fn wrapped(&self, i: i64, count: usize) -> usize {
        let last = i64::try_from(count).unwrap_or(i64::MAX) - 1;
        let index = match self.options.wrap_mode {
            TextureWrapMode::ClampToEdge => i.clamp(0, last),
            TextureWrapMode::Repeat => i.rem_euclid(last + 1),
            TextureWrapMode::MirroredRepeat => {
                let there = i.rem_euclid(2 * (last + 1));
                there.min(2 * last + 1 - there)
            }
        };
        usize::try_from(index).unwrap_or(0)
    }

    /// Samples the texture at a position in texels from the upper left corner. Channels are from 0
    /// to 255, premultiplied.
    pub(crate) fn at(&self, filter: Filter, u: f32, v: f32) -> [f32; 4] {
        let [width, height] = self.size();
        match filter {
            Filter::Nearest => {
                let x = self.wrapped(floor(u), width);
                let y = self.wrapped(floor(v), height);
                self.row(y)[x].to_array().map(f32::from)
            }
            Filter::Linear => {
                let (x, y) = (self.between(u, width), self.between(v, height));
                let [above, below] = [y.first, y.next].map(|y| x.mixed(self.row(y)));
                mix(above, below, y.part)
            }
        }
    }

    /// Returns the texels next to a position in a row or column of `count`.
    pub(crate) fn between(&self, at: f32, count: usize) -> Between {
        let at = at - 0.5;
        let [first, next] = [floor(at), floor(at) + 1].map(|i| self.wrapped(i, count));
        Between { first, next, part: at - at.floor() }
    }
}

/// A position between two texels of a row or column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Between {
    pub(crate) first: usize,
    pub(crate) next: usize,
    /// From 0 at the first to 1 at the next.
    pub(crate) part: f32,
}

impl Between {
    /// Interpolates between two texels of a row.
    pub(crate) fn mixed(self, row: &[Color32]) -> [f32; 4] {
        let [first, next] = [self.first, self.next].map(|i| row[i].to_array().map(f32::from));
        mix(first, next, self.part)
    }
}

/// Interpolates between `a` and `b`.
#[inline(always)]
pub(crate) fn mix(a: [f32; 4], b: [f32; 4], part: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

#[expect(clippy::cast_possible_truncation, reason = "saturates far beyond every texture")]
fn floor(x: f32) -> i64 {
    x.floor() as i64
}
