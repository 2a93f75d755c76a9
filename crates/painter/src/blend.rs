//! The arithmetic of colours.
//!
//! A colour is multiplied by a texel and blended over the pixel below it. All values are
//! gamma-encoded, as stored, and premultiplied by alpha, as in egui:
//!
//!   c = s t / 255,   p' = c + p (255 - c_alpha) / 255     s colour, t texel, p pixel; 0 to 255

use egui::Color32;

/// Blends one colour over all pixels of a row.
pub(crate) fn lay(row: &mut [u32], source: [f32; 4]) {
    // Whole, premultiplied values allow integer arithmetic with the same result.
    let whole = source.map(f32::round);
    if is_opaque(source) {
        let [r, g, b, _] = whole.map(byte);
        row.fill(packed(Color32::from_rgb(r, g, b)));
    } else if whole == source && source[..3].iter().all(|value| *value <= source[3]) {
        lay_premultiplied(row, whole.map(byte));
    } else {
        row.iter_mut().for_each(|pixel| *pixel = over(*pixel, source));
    }
}

/// Blends in whole numbers, two channels at a time.
///
/// x / 255 rounded is (y + (y >> 8)) >> 8 with y = x + 128, for every x up to 255 * 255.
fn lay_premultiplied(row: &mut [u32], [r, g, b, a]: [u8; 4]) {
    let source = packed(Color32::from_rgb(r, g, b));
    let rest = 255 - u32::from(a);
    const TWO: u32 = 0x00ff_00ff;
    for pixel in row {
        let part = |two: u32| {
            let y = two * rest + 0x0080_0080;
            ((y + ((y >> 8) & TWO)) >> 8) & TWO
        };
        // No sum exceeds 255, since no channel of the source exceeds its alpha.
        *pixel = source + (part(*pixel & TWO) | (part((*pixel >> 8) & 0xff) << 8));
    }
}

pub(crate) fn tint(pixel: &mut u32, color: [u8; 4], texel: Color32) {
    // Most texels of glyphs are transparent: they are skipped.
    if texel != Color32::TRANSPARENT {
        *pixel = over(*pixel, product(color.map(f32::from), texel.to_array().map(f32::from)));
    }
}

pub(crate) fn product(color: [f32; 4], texel: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| color[i] * texel[i] / 255.0)
}

pub(crate) fn is_opaque(source: [f32; 4]) -> bool {
    source[3] >= 255.0
}

/// Blends a colour over a pixel.
#[inline(always)]
pub(crate) fn over(below: u32, [r, g, b, a]: [f32; 4]) -> u32 {
    let rest = 1.0 - a / 255.0;
    let [blue, green, red, _] = below.to_le_bytes().map(f32::from);
    let channel = |source: f32, below: f32| u32::from(byte(source + below * rest + 0.5));
    channel(r, red) << 16 | channel(g, green) << 8 | channel(b, blue)
}

pub(crate) fn all_opaque(texels: &[Color32]) -> bool {
    let all = texels.iter().fold(u32::MAX, |all, texel| all & u32::from_le_bytes(texel.to_array()));
    all >> 24 == 0xff
}

/// Packs a colour as it is stored: blue in the lowest byte, then green, red and a zero.
#[inline(always)]
pub(crate) fn packed(color: Color32) -> u32 {
    let color = u32::from_le_bytes(color.to_array());
    (color & 0xff) << 16 | (color & 0xff00) | (color >> 16 & 0xff)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
#[inline(always)]
fn byte(value: f32) -> u8 {
    value as u8
}
