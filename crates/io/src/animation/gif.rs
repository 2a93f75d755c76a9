//! Writes a GIF.
//!
//! A GIF has up to 256 colours per picture. If every picture fits, each gets an exact palette.
//! Otherwise all pictures share one palette, chosen when all are known. Dithering depends only on
//! the position and colour of a pixel, so still regions do not flicker. Until the palette is known,
//! the pictures are kept in memory, compressed.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::palette::{Colors, Dither, Palette};
use crate::picture::sides_of;
use marraztu_core::base::image::{Picture, Size};

/// The most colours of a picture.
const MOST_COLORS: usize = 256;

/// Pixels with a smaller alpha are transparent.
const LEAST_ALPHA: u8 = 128;

/// Collects the pictures of a GIF.
#[derive(Debug)]
pub(super) struct GifWriter {
    size: Size,
    transparent: bool,
    /// The compressed pictures.
    pictures: Vec<Vec<u8>>,
    colors: Colors,
    /// Whether a picture has more colours than a palette.
    needs_dither: bool,
}

impl GifWriter {
    pub(super) fn new(size: Size, transparent: bool) -> Self {
        let colors = Colors::default();
        Self { size, transparent, pictures: Vec::new(), colors, needs_dither: false }
    }

    /// Adds a picture.
    pub(super) fn push(&mut self, picture: &Picture) -> std::io::Result<()> {
        if picture.size() != self.size {
            return Err(std::io::Error::other("a picture has another size"));
        }
        let transparent = self.transparent;
        let shown = picture.pixels().iter().filter_map(|pixel| shown(*pixel, transparent));
        let distinct = self.colors.add(shown);
        self.needs_dither |= distinct > self.most_colors();
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(picture.pixels().as_flattened())?;
        self.pictures.push(encoder.finish()?);
        Ok(())
    }

    const fn most_colors(&self) -> usize {
        MOST_COLORS - self.transparent as usize
    }

    /// Encodes the file. `delay` is the time of each picture, in hundredths of a second.
    pub(super) fn finish(self, delay: impl Fn(usize) -> u16) -> Result<Vec<u8>, EncodingError> {
        let [width, height] = sides_of(self.size).map(|side| u16::try_from(side).ok());
        let (Some(width), Some(height)) = (width, height) else {
            return Err(std::io::Error::other("a GIF has at most 65535 pixels a side").into());
        };
        // Without dithering, each picture gets its exact palette instead of a global one.
        // All pictures are known now, so the shared palette can be chosen.
        let palette = self.needs_dither.then(|| Palette::of(&self.colors, self.most_colors()));
        let global = palette.as_ref().map_or(Vec::new(), |it| self.table(&it.colors));
        let mut encoder = Encoder::new(Vec::new(), width, height, &global)?;
        encoder.set_repeat(Repeat::Infinite)?;
        let mut dither = palette.map(Dither::new);
        for (number, compressed) in self.pictures.iter().enumerate() {
            // Only one picture at a time is unpacked.
            let mut bytes = Vec::with_capacity(4 * self.size.area());
            DeflateDecoder::new(&compressed[..]).read_to_end(&mut bytes)?;
            let (pixels, _) = bytes.as_chunks::<4>();
            let (buffer, own) = match &mut dither {
                Some(dither) => (self.dithered(pixels, dither), None),
                None => self.exact(pixels),
            };
            encoder.write_frame(&Frame {
                width,
                height,
                delay: delay(number),
                dispose: match self.transparent {
                    true => DisposalMethod::Background,
                    false => DisposalMethod::Keep,
                },
                transparent: self.transparent.then_some(0),
                palette: own,
                buffer: Cow::Owned(buffer),
                ..Frame::default()
            })?;
        }
        encoder.into_inner()
    }

    /// Returns a palette in the layout of the file, with the transparent colour first.
    fn table(&self, colors: &[[u8; 3]]) -> Vec<u8> {
        let transparent = self.transparent.then_some([0; 3]);
        transparent.into_iter().chain(colors.iter().copied()).flatten().collect()
    }

    fn dithered(&self, pixels: &[[u8; 4]], dither: &mut Dither) -> Vec<u8> {
        let width = self.size.width.max(1);
        let first = u8::from(self.transparent);
        let index = |(place, pixel): (usize, &[u8; 4])| match shown(*pixel, self.transparent) {
            Some(color) => first + dither.index(color, [place % width, place / width]),
            None => 0,
        };
        pixels.iter().enumerate().map(index).collect()
    }

    /// Returns the pixels as indices into their exact palette.
    fn exact(&self, pixels: &[[u8; 4]]) -> (Vec<u8>, Option<Vec<u8>>) {
        let shown = || pixels.iter().map(|pixel| shown(*pixel, self.transparent));
        let mut indices: BTreeMap<[u8; 3], u8> =
            shown().flatten().map(|color| (color, 0)).collect();
        let first = u8::from(self.transparent);
        for (index, number) in indices.values_mut().zip(first..=u8::MAX) {
            *index = number;
        }
        let colors: Vec<[u8; 3]> = indices.keys().copied().collect();
        let index = |color: Option<[u8; 3]>| color.map_or(0, |color| indices[&color]);
        (shown().map(index).collect(), Some(self.table(&colors)))
    }
}

/// Returns the colour of a pixel, or `None` if it is transparent.
fn shown([r, g, b, alpha]: [u8; 4], transparent: bool) -> Option<[u8; 3]> {
    (!transparent || alpha >= LEAST_ALPHA).then_some([r, g, b])
}
