//! A texture with the mipmap levels that its filter reads.

use marraztu_core::accuracy::Filter;
use marraztu_core::scene::Texture;

/// The largest number of mipmap levels: textures have at most 32,768 texels a side.
pub(super) const LEVELS: usize = 16;

/// A texture with the mipmap levels that its filter reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler<'a> {
    pub(super) levels: &'a [Texture],
    pub(crate) filter: Filter,
    /// Width and height of each level.
    pub(super) sizes: [[f32; LEVELS]; 2],
    /// The sizes divided by the size of the first level.
    pub(super) scales: [[f32; LEVELS]; 2],
}

impl<'a> Sampler<'a> {
    /// Creates a sampler of the first level, or of all levels if the filter reads mipmaps. `None`
    /// if the texture has no texels.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
    pub(crate) fn new(levels: &'a [Texture], filter: Filter) -> Option<Self> {
        let levels = &levels[..levels.len().min(LEVELS)];
        let mut sizes = [[1.0; LEVELS]; 2];
        for (i, level) in levels.iter().enumerate() {
            let size = level.picture.size();
            (sizes[0][i], sizes[1][i]) = (size.width as f32, size.height as f32);
        }
        let has_texels = levels.first()?.picture.size().area() > 0;
        // Positions are in texels of the first level; these factors convert them to each level.
        let mut scales = sizes;
        for (scales, sides) in scales.iter_mut().zip(&sizes) {
            scales.iter_mut().for_each(|side| *side /= sides[0]);
        }
        has_texels.then_some(Self { levels, filter, sizes, scales })
    }

    /// Returns the pixels of a level, or an empty slice if the level does not exist.
    #[inline(always)]
    pub(super) fn pixels_of(&self, level: i32) -> &[[u8; 4]] {
        let level = level.cast_unsigned() as usize % LEVELS;
        self.levels.get(level).map_or(&[], |level| level.picture.pixels())
    }
}
