//! Contact sheets: pictures in rows, with labels below them.

use super::text::{Face, Label, size_of};
use super::{LIGHT, PlotError};
use marraztu_core::base::image::{Picture, Size};

/// The size of labels and notes, in pixels.
const FONT: u32 = 14;

/// The height of a line of text.
const LINE: usize = 20;

/// The space around pictures.
const GAP: usize = 8;

/// A picture with its label.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetCell {
    /// The picture. Transparent pixels show the paper.
    pub picture: Picture,
    /// The label below it.
    pub label: String,
}

/// Arranges pictures in rows of `columns`, each with its label below it, and notes below all. The
/// sheet is as wide as the longest note, at least.
///
/// # Errors
/// If there are no pictures, or the text cannot be drawn.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "pixels of a sheet"
)]
pub fn contact_sheet(
    cells: &[SheetCell],
    columns: usize,
    notes: &[String],
) -> Result<Picture, PlotError> {
    if cells.is_empty() || columns == 0 {
        return Err(PlotError("there are no pictures".to_owned()));
    }
    let most = |side: fn(Size) -> usize| cells.iter().map(|cell| side(cell.picture.size())).max();
    let width = most(|size| size.width).unwrap_or_default();
    let height = most(|size| size.height).unwrap_or_default();
    let columns = columns.min(cells.len());
    let rows = cells.len().div_ceil(columns);
    let (step_x, step_y) = (width + GAP, height + LINE + GAP);
    let notes_height = if notes.is_empty() { 0 } else { notes.len() * LINE + GAP };
    let label = |text: String, [x, y]: [usize; 2], size: u32| {
        let place = |side: usize| i32::try_from(side).unwrap_or(i32::MAX);
        Label::new(text, (place(x), place(y + 4)), size, LIGHT.ink)
    };
    let mut labels = Vec::new();
    let mut notes_width = 0.0_f32;
    for (i, note) in notes.iter().enumerate() {
        let at = [GAP, rows * step_y + GAP + i * LINE];
        // The columns of notes are aligned with blanks.
        let note = Label { face: Face::Mono, ..label(note.clone(), at, FONT - 2) };
        notes_width = notes_width.max(note.width());
        labels.push(note);
    }
    let sheet_width = (columns * step_x + GAP).max(notes_width.ceil() as usize + 2 * GAP);
    let size = Size::new(sheet_width, rows * step_y + GAP + notes_height);
    let paper = [LIGHT.paper.0, LIGHT.paper.1, LIGHT.paper.2];
    let mut bytes = paper.repeat(size.area());
    for (i, cell) in cells.iter().enumerate() {
        let (x, y) = (GAP + i % columns * step_x, GAP + i / columns * step_y);
        paste(&mut bytes, size, [x, y], &cell.picture);
        labels.push(label(shortened(&cell.label, width as f32), [x, y + height], FONT));
    }
    labels.iter().for_each(|label| label.write(&mut bytes, size));
    let pixels = bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2], 255]).collect();
    Picture::from_pixels(size, pixels).ok_or_else(|| PlotError("its size is wrong".to_owned()))
}

/// Copies a picture to a place on the paper.
fn paste(bytes: &mut [u8], size: Size, [left, top]: [usize; 2], picture: &Picture) {
    let from = picture.size();
    for (y, row) in picture.pixels().chunks(from.width.max(1)).enumerate() {
        let begin = 3 * ((top + y) * size.width + left);
        for (to, pixel) in bytes[begin..].chunks_exact_mut(3).zip(row) {
            let alpha = u16::from(pixel[3]);
            for (to, from) in to.iter_mut().zip(pixel) {
                let mixed = u16::from(*from) * alpha + u16::from(*to) * (255 - alpha);
                *to = u8::try_from((mixed + 127) / 255).unwrap_or(u8::MAX);
            }
        }
    }
}

/// Shortens a text to a width in pixels.
fn shortened(text: &str, width: f32) -> String {
    if size_of(text, FONT)[0] <= width {
        return text.to_owned();
    }
    let signs: Vec<char> = text.chars().collect();
    let short = |count: usize| signs[..count].iter().chain(['.'; 3].iter()).collect::<String>();
    let counts: Vec<usize> = (0..signs.len()).collect();
    let fits = counts.partition_point(|count| size_of(&short(*count), FONT)[0] <= width);
    short(fits.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_in_rows_with_labels_below() {
        let cell = |color: [u8; 4], label: &str| SheetCell {
            picture: Picture::filled(Size::new(40, 30), color),
            label: label.to_owned(),
        };
        let cells =
            [cell([255, 0, 0, 255], "a"), cell([0, 255, 0, 0], "b"), cell([0, 0, 255, 255], "c")];
        let sheet = contact_sheet(&cells, 2, &["a note".to_owned()]).unwrap();
        let size = sheet.size();
        assert_eq!(size, Size::new(2 * 48 + 8, 2 * 58 + 8 + 28));
        assert_eq!(sheet.pixel(9, 9), [255, 0, 0, 255]);
        assert_eq!(sheet.pixel(60, 9), [255; 4], "a transparent picture shows the paper");
        assert_eq!(sheet.pixel(9, 70), [0, 0, 255, 255]);
        let is_inked = |y: std::ops::Range<usize>| {
            y.clone()
                .any(|y| (0..40).any(|x| sheet.pixel(x, y)[0] < 128 && sheet.pixel(x, y)[2] < 128))
        };
        assert!(is_inked(38..58) && is_inked(124..150), "labels and notes are written");
        assert!(contact_sheet(&[], 2, &[]).is_err());
        let note = "a long note ends inside".to_owned();
        let wide = contact_sheet(&cells[..1], 1, &[note]).unwrap();
        let Size { width, height } = wide.size();
        let is_ink = |x: usize| (height - 28..height).any(|y| wide.pixel(x, y)[0] < 128);
        let last = (0..width).rfind(|x| is_ink(*x)).unwrap();
        assert!(last > 100 && last < width - 8, "{last} of {width}");
    }

    #[test]
    fn long_labels_are_shortened() {
        let long = "a very long name of a model".repeat(4);
        let short = shortened(&long, 100.0);
        assert!(short.ends_with("...") && size_of(&short, FONT)[0] <= 100.0, "{short}");
        assert_eq!(shortened("a", 100.0), "a");
    }
}
