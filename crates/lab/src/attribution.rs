//! Attributes the error of one pixel to the axes of accuracy.
//!
//! The reference is the ideal, as wherever errors of a picture are shown. The picture is drawn
//! again with one axis at a time at its most exact choice. The reduction of the error is the share
//! of that axis. Shares need not add up to the error, since errors may cancel or depend on each
//! other.

use serde::Serialize;

use super::picture_source::PictureSource;
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Samples, Settings};

/// One pixel, with the sources of its error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attribution {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// The ideal's red, green and blue.
    pub exact: [u8; 3],
    /// Red, green and blue of the judged settings.
    pub ours: [u8; 3],
    /// Whether exact coverage shows a different primitive at the centre of the pixel.
    pub coverage_differs: bool,
    /// The axes that are not at their most exact choice, the largest share first.
    pub shares: Vec<Share>,
}

/// The share of one axis in the error of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// The axis's key.
    pub axis: &'static str,
    /// The current choice.
    pub chosen: &'static str,
    /// The most exact choice.
    pub exact: &'static str,
    /// The pixel with only this axis made exact.
    pub value: [u8; 3],
    /// The reduction of the error in byte steps, summed over the channels; negative if it grows.
    pub steps: i32,
}

/// Attributes the error of a pixel; `None` if the pixel is outside the picture.
pub fn attribute(
    source: &mut dyn PictureSource,
    settings: &Settings,
    at: [usize; 2],
) -> Option<Attribution> {
    let (ours, _) = look(source, settings, at)?;
    // The centre of the pixel, in both pictures.
    let once = Settings { samples: Samples::One, ..*settings };
    let (_, primitive) = look(source, &once, at)?;
    let (_, exact_primitive) = look(source, &once.reference(), at)?;
    let coverage_differs = primitive != exact_primitive;
    let ideal = settings.ideal();
    let exact = source.ideal_pixel(&ideal, at);
    // Make one axis exact at a time, starting from the judged settings.
    let mut shares = Vec::new();
    for axis in AXES.iter().filter(|axis| axis.kind == AxisKind::Scored) {
        let (chosen, best) = (axis.chosen(settings), axis.most_exact(settings));
        if chosen.word == best.word {
            continue;
        }
        let alone = best.of(settings);
        let value = if alone == ideal { exact } else { look(source, &alone, at)?.0 };
        let steps = distance(ours, exact) - distance(value, exact);
        let (chosen, exact) = (chosen.word, best.word);
        shares.push(Share { axis: axis.key, chosen, exact, value, steps });
    }
    shares.sort_by_key(|share| std::cmp::Reverse(share.steps));
    Some(Attribution { at, exact, ours, coverage_differs, shares })
}

/// Draws a picture, and returns a pixel with its primitive; `None` if it is outside.
fn look(
    source: &mut dyn PictureSource,
    settings: &Settings,
    [x, y]: [usize; 2],
) -> Option<([u8; 3], u32)> {
    source.draw(settings);
    let size = source.picture().size();
    if x >= size.width || y >= size.height {
        return None;
    }
    let [r, g, b, _] = source.picture().pixel(x, y);
    Some(([r, g, b], source.primitives()[y * size.width + x]))
}

/// Returns the difference of two colours in byte steps, summed over the channels.
fn distance(a: [u8; 3], b: [u8; 3]) -> i32 {
    (0..3).map(|i| i32::from(a[i].abs_diff(b[i]))).sum()
}

impl Attribution {
    /// Returns the error in byte steps, summed over the channels.
    pub fn steps(&self) -> i32 {
        distance(self.ours, self.exact)
    }

    /// Describes the result, line by line.
    pub fn lines(&self) -> Vec<String> {
        let [x, y] = self.at;
        let color = |[r, g, b]: [u8; 3]| format!("({r}, {g}, {b})");
        let mut lines = vec![
            format!("pixel {x},{y}"),
            format!("  ideal  {}", color(self.exact)),
            format!("  ours   {}: {} byte steps off", color(self.ours), self.steps()),
        ];
        if self.coverage_differs {
            lines.push("  exact coverage shows another triangle at its centre".to_owned());
        }
        // Shares may be negative: errors can cancel.
        for Share { axis, exact, value, steps, .. } in self.shares.iter().filter(|it| it.steps != 0)
        {
            let how = match steps {
                1.. => format!("{steps} steps nearer"),
                _ => format!("{} steps farther", -steps),
            };
            let name = Axis::named(axis).and_then(|axis| {
                let choice = axis.choices.iter().find(|choice| choice.word == *exact)?;
                Some(axis.in_words(choice))
            });
            let name = name.unwrap_or_else(|| format!("{axis} {exact}"));
            lines.push(format!("  {name}: {}, {how}", color(*value)));
        }
        let others = self.shares.iter().filter(|share| share.steps == 0).count();
        if others > 0 && others < self.shares.len() {
            lines.push(format!("  {others} other choices change nothing here"));
        } else if others > 0 && self.steps() > 0 {
            lines.push("  no choice alone brings it nearer".to_owned());
        }
        if self.shares.is_empty() {
            lines.push("  every axis is at its most exact".to_owned());
        }
        lines
    }
}
