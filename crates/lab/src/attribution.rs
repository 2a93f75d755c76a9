//! Attributes the error of one pixel to the axes of accuracy.
//!
//! The picture is drawn again with one axis at a time at its most exact choice. The reduction of
//! the error is the share of that axis. Shares need not add up to the error, since errors may
//! cancel or depend on each other.

use serde::Serialize;

use super::picture_source::PictureSource;
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Settings};

/// One pixel, with the sources of its error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attribution {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// The reference's red, green and blue.
    pub exact: [u8; 3],
    /// Red, green and blue of the judged settings.
    pub ours: [u8; 3],
    /// Whether the reference shows a different primitive.
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
    let mut look = |settings: &Settings| -> Option<([u8; 3], u32)> {
        source.draw(settings);
        let size = source.picture().size();
        if at[0] >= size.width || at[1] >= size.height {
            return None;
        }
        let [r, g, b, _] = source.picture().pixel(at[0], at[1]);
        Some(([r, g, b], source.primitives()[at[1] * size.width + at[0]]))
    };
    // A pixel with several samples is judged against the same number, each lit.
    let (exact, exact_primitive) = look(&settings.reference())?;
    let (ours, primitive) = look(settings)?;
    // Make one axis exact at a time, starting from the judged settings.
    let mut shares = Vec::new();
    let judged = |axis: &&Axis| axis.kind == AxisKind::Scored && axis.key != "samples";
    for axis in AXES.iter().filter(judged) {
        let (chosen, best) = (axis.chosen(settings), axis.most_exact(settings));
        if chosen.word == best.word {
            continue;
        }
        let (value, _) = look(&best.of(settings))?;
        let steps = distance(ours, exact) - distance(value, exact);
        let (chosen, exact) = (chosen.word, best.word);
        shares.push(Share { axis: axis.key, chosen, exact, value, steps });
    }
    shares.sort_by_key(|share| std::cmp::Reverse(share.steps));
    let coverage_differs = primitive != exact_primitive;
    Some(Attribution { at, exact, ours, coverage_differs, shares })
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
            format!("  exact  {}", color(self.exact)),
            format!("  ours   {}: {} byte steps off", color(self.ours), self.steps()),
        ];
        if self.coverage_differs {
            lines.push("  the exact picture shows another triangle there".to_owned());
        }
        // Shares may be negative: errors can cancel.
        for Share { axis, chosen, exact, value, steps } in &self.shares {
            let how = match steps {
                0 => "no nearer".to_owned(),
                1.. => format!("{steps} steps nearer"),
                _ => format!("{} steps farther", -steps),
            };
            lines.push(format!("  {axis} {exact} instead of {chosen}: {}, {how}", color(*value)));
        }
        if self.shares.is_empty() {
            lines.push("  every axis is at its most exact".to_owned());
        }
        lines
    }
}
