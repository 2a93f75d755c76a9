//! Lays out the plots of a report, for the window and for files: small multiples, one panel an
//! axis, and an overview of the front.
//!
//! All panels share one scale: time relative to the default from left to right, error from below,
//! both logarithmic, since choices differ by factors. An error of 0 has no logarithm: it is drawn
//! one decade below the smallest error above 0, on a line of its own.

use super::{Report, brief};
use crate::sweep::Row;
use marraztu_core::accuracy::{AXES, Axis, AxisKind};

/// A choice in a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelMark {
    /// The index of the report's point.
    pub point: usize,
    /// Its position on the scales.
    pub at: [f64; 2],
    /// The interval of `x` that its time may mean.
    pub noise: [f64; 2],
    /// Its name.
    pub label: String,
    /// Whether it is the default.
    pub is_default: bool,
    /// Whether the picture is drawn with it now.
    pub current: bool,
}

/// The choices of an axis, or the front.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The axis; `None` for the overview.
    pub axis: Option<&'static Axis>,
    /// Its title.
    pub title: String,
    /// What its errors are against, if it is not the reference of the others.
    pub note: &'static str,
    /// Its choices, from coarse to exact; those of the overview from fast to slow.
    pub marks: Vec<PanelMark>,
}

/// One side of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Its label.
    pub label: String,
    /// Its ends.
    pub range: [f64; 2],
    /// The positions and labels of its ticks.
    pub ticks: Vec<(f64, String)>,
}

/// The plots of a report.
#[derive(Clone, Debug)]
pub struct Panels {
    /// Time, from left to right.
    pub x: Scale,
    /// Error, from below.
    pub y: Scale,
    /// The position of an error of 0.
    pub zero: f64,
    /// The interval of `x` within the noise of the default against itself.
    pub noise: [f64; 2],
    /// The default and the front, by the error against 256 samples per pixel.
    pub overview: Panel,
    /// A panel for each axis that was measured.
    pub axes: Vec<Panel>,
}

impl Panels {
    /// The plots of a report.
    #[must_use]
    pub fn new(report: &Report) -> Self {
        let findings = &report.findings;
        let floor = findings.floor;
        let noise = [1.0 - floor, 1.0 + floor].map(|part| libm::log10(part.max(0.01)));
        let points = report.points();
        let of_axes = || AXES.iter().flat_map(|axis| findings.rows_of(axis));
        let overview = report.overview();
        let time = |point: usize| libm::log10(ratio(report, point));
        let shown = of_axes().map(|row| row.point).chain(overview.iter().copied());
        // Much noise is no reason for a wide scale.
        let near = noise.map(|x| x.clamp(-0.2, 0.2));
        let x = time_scale(shown.map(time).chain(near));
        let errors = of_axes().map(|row| report.error(row));
        let errors = errors.chain(overview.iter().map(|point| points[*point].error));
        let (y, zero) = error_scale(report, errors);
        let current = report.current();
        let mark = |point: usize, error: f64, label: String| PanelMark {
            point,
            at: [time(point), if error > 0.0 { libm::log10(error) } else { zero }],
            noise: findings.noise_of(point).map(|ratio| libm::log10(ratio.max(1e-3))),
            label,
            is_default: point == 0,
            current: current == Some(point),
        };
        let of_row = |row: &Row| mark(row.point, report.error(row), row.name.clone());
        let panel = |axis: &'static Axis| Panel {
            axis: Some(axis),
            title: axis.label.to_owned(),
            note: match axis.kind {
                AxisKind::Scored => "",
                AxisKind::ScoredApart => "against 256 samples per pixel",
                AxisKind::Model => "a model, not scored",
            },
            marks: findings.rows_of(axis).map(of_row).collect(),
        };
        let named = |i: &usize| mark(*i, points[*i].error, findings.points[*i].name.clone());
        Self {
            overview: Panel {
                axis: None,
                title: "Overview: nothing else is both faster and more exact".to_owned(),
                note: "against 256 samples per pixel",
                marks: overview.iter().map(named).collect(),
            },
            axes: AXES.iter().map(panel).filter(|panel| !panel.marks.is_empty()).collect(),
            x,
            y,
            zero,
            noise,
        }
    }

    /// The panel of an axis; the overview if it was not measured.
    #[must_use]
    pub fn of(&self, key: Option<&str>) -> &Panel {
        let is_it = |panel: &&Panel| panel.axis.map(|axis| axis.key) == key;
        self.axes.iter().find(is_it).unwrap_or(&self.overview)
    }
}

/// How many times as long as the default a point takes; the default takes 1.
fn ratio(report: &Report, point: usize) -> f64 {
    if point == 0 { 1.0 } else { report.findings.points[point].ratio.quartiles.median.max(1e-3) }
}

/// A scale of ratios with ticks at 1, 2 and 5 of each decade, and more if it is short.
fn time_scale(logarithms: impl Iterator<Item = f64>) -> Scale {
    let [least, most] = bounds(logarithms);
    let room = ((most - least) * 0.1).max(0.08);
    let range = [least - room, most + room];
    let at = |digits: &[f64]| -> Vec<(f64, String)> {
        let places = (-3..4).map(f64::from);
        let places = places.flat_map(|decade| digits.iter().map(move |d| libm::log10(*d) + decade));
        let inside = places.filter(|place| (range[0]..=range[1]).contains(place));
        inside.map(|place| (place, format!("{}x", brief(libm::pow(10.0, place))))).collect()
    };
    let mut ticks = at(&[1.0, 2.0, 5.0]);
    if ticks.len() < 3 {
        ticks = at(&[0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0]);
    }
    Scale { label: "time, the default is 1x".to_owned(), range, ticks }
}

/// A scale of errors with a tick at each decade and one at 0, and the position of 0.
fn error_scale(report: &Report, errors: impl Iterator<Item = f64>) -> (Scale, f64) {
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
    let range = [zero - 0.4, most + 0.3];
    let label = format!("error: {}{}", report.measure.label(), report.region.note());
    (Scale { label, range, ticks }, zero)
}

/// The smallest and the largest; 0 and 1 if there are none.
fn bounds(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let all = places.fold(None, |all: Option<[f64; 2]>, place| {
        Some(all.map_or([place; 2], |[a, b]| [a.min(place), b.max(place)]))
    });
    all.unwrap_or([0.0, 1.0])
}
