//! Texts of plots and sheets, and their pixels.
//!
//! plotters places glyphs at whole pixels and leaves out the space to their left, so letters of
//! small texts touch or drift apart. Here, glyphs have positions at fractions of a pixel, and pairs
//! are kerned.

use ab_glyph::{Font as _, FontRef, GlyphId, PxScale, PxScaleFont, ScaleFont as _, point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use marraztu_core::base::image::Size;

/// A font of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Face {
    #[default]
    Sans,
    /// All letters are equally wide.
    Mono,
}

impl Face {
    /// Returns the name in SVG, and the content of the file.
    const fn font(self) -> (&'static str, &'static [u8]) {
        match self {
            Self::Sans => ("sans-serif", epaint_default_fonts::UBUNTU_LIGHT),
            Self::Mono => ("monospace", epaint_default_fonts::HACK_REGULAR),
        }
    }
}

/// A text with its place.
pub(super) struct Label {
    pub(super) text: String,
    /// The point that the text is aligned with.
    pub(super) at: (i32, i32),
    /// The height of a line in pixels.
    pub(super) size: u32,
    pub(super) color: RGBColor,
    pub(super) aligned: (HPos, VPos),
    pub(super) face: Face,
}

impl Label {
    /// A label in the usual font with its upper left corner at a point.
    pub(super) fn new(text: impl Into<String>, at: (i32, i32), size: u32, color: RGBColor) -> Self {
        let aligned = (HPos::Left, VPos::Top);
        Self { text: text.into(), at, size, color, aligned, face: Face::Sans }
    }

    /// Aligns another point of the text.
    pub(super) fn aligned(self, h: HPos, v: VPos) -> Self {
        Self { aligned: (h, v), ..self }
    }

    /// Returns the label as an element of an SVG file, which has the font's name.
    pub(super) fn element(&self) -> Text<'static, (i32, i32), String> {
        let (h, v) = self.aligned;
        let color = self.color.to_backend_color();
        let style = TextStyle { color, pos: Pos::new(h, v), ..font(self.size) };
        Text::new(self.text.clone(), self.at, style)
    }

    /// Returns the width of the text in pixels.
    pub(super) fn width(&self) -> f32 {
        self.glyphs(&self.font()).1
    }

    #[expect(clippy::cast_precision_loss, reason = "pixels of a plot")]
    fn font(&self) -> PxScaleFont<FontRef<'static>> {
        let font = FontRef::try_from_slice(self.face.font().1).expect("the fonts are valid");
        font.into_scaled(PxScale::from(self.size as f32))
    }

    /// Returns the glyphs with their places from the left, and the width of all.
    fn glyphs(&self, font: &PxScaleFont<FontRef<'_>>) -> (Vec<(GlyphId, f32)>, f32) {
        let (mut glyphs, mut x, mut last) = (Vec::new(), 0.0, None);
        for sign in self.text.chars() {
            let id = font.glyph_id(sign);
            x += last.map_or(0.0, |last| font.kern(last, id));
            glyphs.push((id, x));
            x += font.h_advance(id);
            last = Some(id);
        }
        (glyphs, x)
    }

    /// Writes the label into a picture of three bytes per pixel. The border cuts it off.
    #[expect(clippy::cast_precision_loss, reason = "pixels of a plot")]
    pub(super) fn write(&self, bytes: &mut [u8], picture: Size) {
        let scaled = self.font();
        let (font, scale) = (&scaled.font, scaled.scale);
        // Places first: the alignment needs the width.
        let (glyphs, x) = self.glyphs(&scaled);
        let left = self.at.0 as f32
            - match self.aligned.0 {
                HPos::Left => 0.0,
                HPos::Center => x / 2.0,
                HPos::Right => x,
            };
        // Rows are whole pixels, so horizontal strokes stay sharp.
        let down = match self.aligned.1 {
            VPos::Top => CAPITALS,
            VPos::Center => CAPITALS / 2.0,
            VPos::Bottom => 0.0,
        };
        let baseline = (self.at.1 as f32 + down * self.size as f32).round();
        for (id, x) in glyphs {
            let glyph = id.with_scale_and_position(scale, point(left + x, baseline));
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, coverage| {
                self.blend(bytes, picture, [corner.x + x as f32, corner.y + y as f32], coverage);
            });
        }
    }

    /// Mixes the colour into a pixel.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked against the picture, and a byte"
    )]
    fn blend(&self, bytes: &mut [u8], picture: Size, [x, y]: [f32; 2], coverage: f32) {
        if x < 0.0 || y < 0.0 || x as usize >= picture.width || y as usize >= picture.height {
            return;
        }
        let begin = 3 * (y as usize * picture.width + x as usize);
        let RGBColor(r, g, b) = self.color;
        for (to, from) in bytes[begin..begin + 3].iter_mut().zip([r, g, b]) {
            let mixed = f32::from(*to) + (f32::from(from) - f32::from(*to)) * coverage.min(1.0);
            *to = mixed.round() as u8;
        }
    }
}

/// The height of capitals, in heights of a line.
const CAPITALS: f32 = 0.61;

/// Returns a font of the window, under its name in SVG.
pub(super) fn font(size: u32) -> TextStyle<'static> {
    let (name, content) = Face::Sans.font();
    // Registering a valid font cannot fail, and repeating it has no effect.
    let _ = register_font(name, FontStyle::Normal, content);
    (name, size).into_font().into()
}

/// Returns the size of a text, with a margin, since an SVG viewer may use another font.
#[expect(clippy::cast_precision_loss, reason = "pixels of a plot")]
pub(super) fn size_of(text: &str, size: u32) -> [f32; 2] {
    let (width, height) = font(size).font.box_size(text).unwrap_or((0, 0));
    [width as f32 * 1.06 + 4.0, (height as f32).max(size as f32) + 2.0]
}

#[cfg(test)]
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
mod tests {
    use super::*;

    /// Returns the inked columns of a text.
    fn columns(text: &str, at: i32, h: HPos) -> Vec<bool> {
        let size = Size::new(240, 60);
        let mut bytes = vec![255; 3 * size.area()];
        Label::new(text, (at, 5), 40, BLACK).aligned(h, VPos::Top).write(&mut bytes, size);
        let inked = |x: usize| (0..60).any(|y| bytes[3 * (y * size.width + x)] < 160);
        (0..size.width).map(inked).collect()
    }

    #[test]
    fn letters_keep_the_space_to_their_left() {
        let font = FontRef::try_from_slice(Face::Sans.font().1).unwrap();
        let font = font.as_scaled(40.0);
        let inked = columns("Hlli", 4, HPos::Left);
        let begins = (1..240).filter(|x| inked[*x] && !inked[x - 1]);
        let mut pen = 4.0;
        for (sign, begin) in "Hlli".chars().zip(begins) {
            let id = font.glyph_id(sign);
            let expected = pen + font.h_side_bearing(id);
            assert!((begin as f32 - expected).abs() <= 1.0, "{sign}: {begin}, not {expected}");
            pen += font.h_advance(id);
        }
    }

    #[test]
    fn texts_are_aligned_and_cut_off_at_the_border() {
        let last = |inked: &[bool]| inked.iter().rposition(|inked| *inked).unwrap();
        let first = |inked: &[bool]| inked.iter().position(|inked| *inked).unwrap();
        let right = columns("mean", 200, HPos::Right);
        assert!((192..200).contains(&last(&right)), "{right:?}");
        let centre = columns("mean", 120, HPos::Center);
        assert!((first(&centre) + last(&centre)).abs_diff(239) <= 5, "{centre:?}");
        assert!(columns("mean", -20, HPos::Left).iter().any(|inked| *inked));
        assert!(columns("mean", 900, HPos::Left).iter().all(|inked| !*inked));
    }
}
