//! Time against error, as places of a plot, whoever draws it.
//!
//! Both scales are logarithmic, since choices lie factors apart. An error of 0 has no logarithm: its
//! place is a decade under the smallest that is above 0, and is labelled so.

use super::{Report, brief};
use crate::lab::error::Measure;

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// The default, that all are measured against.
    Default,
    /// A preset.
    Preset,
    /// The default but for one axis.
    Axis,
    /// Several axes.
    Combination,
    /// Judged against the most samples a pixel, each lit.
    Apart,
    /// Another model, which cannot stand in for this one.
    Model,
}

/// A point of the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its place among the report's points.
    pub point: usize,
    /// Where it stands, on the scales.
    pub at: [f64; 2],
    /// What it stands for.
    pub kind: MarkKind,
    /// Whether no other that is judged against the same picture beats it.
    pub on_front: bool,
    /// Whether the picture is drawn so now.
    pub current: bool,
    /// What it is called.
    pub name: String,
}

/// One side of the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// What is counted.
    pub label: String,
    /// The first and the last place.
    pub range: [f64; 2],
    /// Places with what they stand for.
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
    /// The places of the front in `marks`, from left to right.
    pub front: Vec<usize>,
    /// The same of what is judged against the most samples.
    pub front_apart: Vec<usize>,
    /// From where to where on `x` nothing differs from the default but by noise.
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

/// A scale of milliseconds, with ticks at 1, 2 and 5 of each decade; at more digits where it is short.
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

/// A scale of errors with a tick at each decade and one at 0; and where 0 stands.
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

/// The least and the most; 0 and 1 where there is none.
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
