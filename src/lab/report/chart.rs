//! Lays out a scatter plot of time against error, for the window and for files.
//!
//! Both scales are logarithmic, since choices differ by factors. An error of 0 has no logarithm: it
//! is drawn one decade below the smallest error above 0, and labelled 0.

use super::{Report, brief};
use crate::lab::error::Measure;

/// The kind of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// The default, which all are measured against.
    Default,
    /// A preset.
    Preset,
    /// Another choice of one axis.
    Axis,
    /// Other choices of several axes.
    Combination,
    /// Judged against the most samples per pixel, each lit.
    Apart,
    /// Another model, which cannot stand in for this one.
    Model,
}

/// A point of the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The index of the report's point.
    pub point: usize,
    /// Its position on the scales.
    pub at: [f64; 2],
    /// Its kind.
    pub kind: MarkKind,
    /// Whether it is on the front.
    pub on_front: bool,
    /// Whether the picture is drawn with it now.
    pub current: bool,
    /// Its name.
    pub name: String,
}

/// One side of the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Its label.
    pub label: String,
    /// Its ends.
    pub range: [f64; 2],
    /// The positions and labels of its ticks.
    pub ticks: Vec<(f64, String)>,
}

/// A scatter of time against error.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Time, from left to right.
    pub x: Scale,
    /// Error, from below.
    pub y: Scale,
    /// All points.
    pub marks: Vec<Mark>,
    /// The indices of the front in `marks`, from left to right.
    pub front: Vec<usize>,
    /// The same for the points that are judged against the most samples.
    pub front_apart: Vec<usize>,
    /// The interval of `x` within the noise of the default.
    pub floor: [f64; 2],
}

impl Chart {
    /// The plot of a report.
    #[must_use]
    pub fn new(report: &Report) -> Self {
        let points = report.points();
        let (front, front_apart) = (report.front(), report.front_apart());
        let (current, default_ms) = (report.current(), points.first().map_or(1.0, |p| p.time));
        let floor = [1.0 - report.findings.floor, 1.0 + report.findings.floor]
            .map(|part| libm::log10(default_ms * part.max(0.01)));
        let times = points.iter().map(|p| libm::log10(p.time));
        let x = time_scale(times.chain(floor));
        let (y, zero) = error_scale(report.measure, points.iter().map(|p| p.error));
        let marks = points.iter().enumerate().map(|(i, point)| Mark {
            point: i,
            at: [
                libm::log10(point.time),
                if point.error > 0.0 { libm::log10(point.error) } else { zero },
            ],
            kind: report.kind(i),
            on_front: front.contains(&i) || front_apart.contains(&i),
            current: current == Some(i),
            name: report.findings.points[i].name.clone(),
        });
        let marks = marks.collect();
        Self { x, y, marks, front, front_apart, floor }
    }
}

/// A scale of milliseconds with ticks at 1, 2 and 5 of each decade, and more if it is short.
fn time_scale(logarithms: impl Iterator<Item = f64>) -> Scale {
    let range = padded(logarithms);
    let at = |digits: &[f64]| -> Vec<(f64, String)> {
        let decades = (-6..8).map(f64::from);
        let places =
            decades.flat_map(|decade| digits.iter().map(move |d| libm::log10(*d) + decade));
        let inside = places.filter(|place| (range[0]..=range[1]).contains(place));
        inside.map(|place| (place, brief(libm::pow(10.0, place)))).collect()
    };
    let mut ticks = at(&[1.0, 2.0, 5.0]);
    if ticks.len() < 3 {
        ticks = at(&[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]);
    }
    Scale { label: "milliseconds a picture".to_owned(), range, ticks }
}

/// A scale of errors with a tick at each decade and one at 0, and the position of 0.
fn error_scale(measure: Measure, errors: impl Iterator<Item = f64> + Clone) -> (Scale, f64) {
    let above = errors.filter(|error| *error > 0.0).map(libm::log10);
    let [least, most] = bounds(above);
    let (least, most) = (libm::floor(least), libm::ceil(most).max(libm::floor(least) + 1.0));
    let zero = least - 1.0;
    let mut ticks = vec![(zero, "0".to_owned())];
    let mut place = least;
    while place <= most {
        ticks.push((place, brief(libm::pow(10.0, place))));
        place += 1.0;
    }
    let range = [zero - 0.3, most + 0.2];
    (Scale { label: measure.label().to_owned(), range, ticks }, zero)
}

/// The smallest and the largest; 0 and 1 if there are none.
fn bounds(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let all = places.fold(None, |all: Option<[f64; 2]>, place| {
        Some(all.map_or([place; 2], |[a, b]| [a.min(place), b.max(place)]))
    });
    all.unwrap_or([0.0, 1.0])
}

fn padded(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, most] = bounds(places);
    let room = ((most - least) * 0.08).max(0.05);
    [least - room, most + room]
}
