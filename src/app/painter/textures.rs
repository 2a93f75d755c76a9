//! The textures of egui: the atlas of glyphs, and pictures.
//!
//! A picture that replaces a whole texture is kept as it was given, without being copied. Every
//! change of a texture gives it another version, so that what shows it is painted again.

use std::collections::HashMap;
use std::sync::Arc;

use egui::epaint::ImageDelta;
use egui::{Color32, ColorImage, ImageData, TextureFilter, TextureId};
use egui::{TextureOptions, TextureWrapMode, TexturesDelta};

/// All textures, under their ids.
#[derive(Debug, Default)]
pub(super) struct Textures {
    all: HashMap<TextureId, Texture>,
    changes: u64,
}

/// A picture that meshes show.
#[derive(Debug)]
pub(super) struct Texture {
    image: Arc<ColorImage>,
    options: TextureOptions,
    /// Another one after each change of any texture.
    pub(super) version: u64,
}

/// How a texture is read between its texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    /// The nearest texel.
    Nearest,
    /// The mean of the nearest four, weighted by distance.
    Linear,
}

impl Textures {
    /// Takes new textures and changed parts of known ones.
    pub(super) fn set(&mut self, delta: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "each texture stands for itself")]
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                self.set_one(id, delta);
            }
        }
    }

    /// Forgets textures that nothing shows any more.
    pub(super) fn free(&mut self, delta: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "each texture stands for itself")]
        for id in delta.free.drain() {
            self.all.remove(&id);
        }
    }

    /// The texture of this id, if there is one with texels.
    pub(super) fn get(&self, id: TextureId) -> Option<&Texture> {
        self.all.get(&id).filter(|texture| !texture.image.pixels.is_empty())
    }

    fn set_one(&mut self, id: TextureId, delta: ImageDelta) {
        self.changes += 1;
        let ImageData::Color(image) = delta.image;
        let (options, version) = (delta.options, self.changes);
        match (delta.pos, self.all.get_mut(&id)) {
            (Some(at), Some(texture)) if at != [0, 0] || image.size != texture.image.size => {
                copy(&image, Arc::make_mut(&mut texture.image), at);
                (texture.options, texture.version) = (options, version);
            }
            _ => {
                self.all.insert(id, Texture { image, options, version });
            }
        }
    }
}

/// Copies a picture into another, its first pixel to `at`; what lies beyond the border is left out.
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
    /// The width and height in texels.
    pub(super) fn size(&self) -> [usize; 2] {
        self.image.size
    }

    /// A row of texels.
    pub(super) fn row(&self, y: usize) -> &[Color32] {
        let [width, _] = self.image.size;
        &self.image.pixels[y * width..(y + 1) * width]
    }

    /// The filter if a step of one pixel moves by this number of texels.
    pub(super) fn filter(&self, texels: f64) -> Filter {
        let chosen = match texels > 1.0 {
            true => self.options.minification,
            false => self.options.magnification,
        };
        match chosen {
            TextureFilter::Nearest => Filter::Nearest,
            TextureFilter::Linear => Filter::Linear,
        }
    }

    /// The texel at index `i` of a row or column of `count`, beyond its ends as the options say.
    pub(super) fn wrapped(&self, i: i64, count: usize) -> usize {
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

    /// The colour at a place, in texels from the upper left corner; 0 to 255 each, premultiplied.
    pub(super) fn at(&self, filter: Filter, u: f32, v: f32) -> [f32; 4] {
        let [width, height] = self.size();
        match filter {
            Filter::Nearest => {
                let x = self.wrapped(floor(u), width);
                let y = self.wrapped(floor(v), height);
                self.row(y)[x].to_array().map(f32::from)
            }
            Filter::Linear => {
                let (u, v) = (u - 0.5, v - 0.5);
                let (right, down) = (u - u.floor(), v - v.floor());
                let [x, y] = [floor(u), floor(v)];
                let [left, next] = [x, x + 1].map(|x| self.wrapped(x, width));
                let [upper, lower] = [y, y + 1].map(|y| self.row(self.wrapped(y, height)));
                let above = mix(upper[left], upper[next], right);
                let below = mix(lower[left], lower[next], right);
                std::array::from_fn(|i| above[i] + (below[i] - above[i]) * down)
            }
        }
    }
}

/// The colour on the way from `a` to `b`, in floats.
fn mix(a: Color32, b: Color32, part: f32) -> [f32; 4] {
    let (a, b) = (a.to_array().map(f32::from), b.to_array().map(f32::from));
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

#[expect(clippy::cast_possible_truncation, reason = "saturates far beyond every texture")]
fn floor(x: f32) -> i64 {
    x.floor() as i64
}
