//! Lays out the plots of a report, for the window and for files: small multiples with one panel per
//! axis, and an overview of the front.
//!
//! All panels share the same scales: time relative to the default from left to right, error from
//! the bottom up. Both are logarithmic, since choices differ by factors. An error of 0 has no
//! logarithm: it gets a separate line one decade below the smallest positive error.

use super::{Report, brief};
use crate::sweep::Row;
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Settings};

/// A choice in a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelMark {
    /// The index of the report's point.
    pub point: usize,
    /// The settings to choose for it.
    pub chosen: Settings,
    /// The position on the scales.
    pub at: [f64; 2],
    /// The confidence interval of the time on the `x` scale.
    pub noise: [f64; 2],
    /// The name.
    pub label: String,
    /// Whether it is the default.
    pub is_default: bool,
    /// Whether it is the current setting.
    pub current: bool,
}

/// A plot of the choices of an axis, or of the front.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The axis; `None` for the overview.
    pub axis: Option<&'static Axis>,
    /// The title.
    pub title: String,
    /// A line on its contents.
    pub note: &'static str,
    /// The choices from coarse to exact, or those of the overview from fast to slow.
    pub marks: Vec<PanelMark>,
}

/// One scale of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The label.
    pub label: String,
    /// The first and the last value.
    pub range: [f64; 2],
    /// The positions and labels of its ticks.
    pub ticks: Vec<(f64, String)>,
}

/// The plots of a report.
#[derive(Clone, Debug)]
pub struct Panels {
    /// Time, from left to right.
    pub x: Scale,
    /// Error, from the bottom up.
    pub y: Scale,
    /// The position of an error of 0.
    pub zero: f64,
    /// The interval of `x` within the noise of the default against itself.
    pub noise: [f64; 2],
    /// The default and the front, by the error against 256 samples per pixel.
    pub overview: Panel,
    /// A panel for each measured axis.
    pub axes: Vec<Panel>,
}

impl Panels {
    /// Lays out the plots of a report.
    pub fn new(report: &Report) -> Self {
        let findings = &report.findings;
        let floor = findings.floor;
        let noise = [1.0 - floor, 1.0 + floor].map(|part| libm::log10(part.max(0.01)));
        let points = report.points();
        let of_axes = || AXES.iter().flat_map(|axis| findings.rows_of(axis));
        let overview = report.overview();
        let time = |point: usize| libm::log10(ratio(report, point));
        // One scale for all panels makes them comparable.
        let shown = of_axes().map(|row| row.point).chain(overview.iter().copied());
        // Large noise should not widen the scale.
        let near = noise.map(|x| x.clamp(-0.2, 0.2));
        let x = time_scale(shown.map(time).chain(near));
        let errors = of_axes().map(|row| report.error(row));
        let errors = errors.chain(overview.iter().map(|point| points[*point].error));
        let (y, zero) = error_scale(report, errors);
        let mark = |point: usize, chosen: Settings, error: f64, label: String| PanelMark {
            point,
            chosen,
            at: [time(point), if error > 0.0 { libm::log10(error) } else { zero }],
            noise: findings.noise_of(point).map(|ratio| libm::log10(ratio.max(1e-3))),
            label,
            is_default: point == 0,
            current: chosen == findings.current,
        };
        let of_row = |row: &Row| mark(row.point, row.chosen, report.error(row), row.name.clone());
        let panel = |axis: &'static Axis| Panel {
            axis: Some(axis),
            title: axis.label.to_owned(),
            note: match axis.kind {
                AxisKind::Scored => "",
                AxisKind::Model => "a model, not scored",
            },
            marks: findings.rows_of(axis).map(of_row).collect(),
        };
        let named = |i: &usize| {
            mark(*i, report.chosen(*i), points[*i].error, findings.points[*i].name.clone())
        };
        Self {
            overview: Panel {
                axis: None,
                title: "Overview".to_owned(),
                note: "nothing measured is both faster and nearer to the ideal",
                marks: overview.iter().map(named).collect(),
            },
            axes: AXES.iter().map(panel).filter(|panel| !panel.marks.is_empty()).collect(),
            x,
            y,
            zero,
            noise,
        }
    }

    /// Returns the panel of an axis, or the overview if the axis was not measured.
    pub fn of(&self, key: Option<&str>) -> &Panel {
        let is_it = |panel: &&Panel| panel.axis.map(|axis| axis.key) == key;
        self.axes.iter().find(is_it).unwrap_or(&self.overview)
    }
}

/// Returns the time of a point relative to the default.
fn ratio(report: &Report, point: usize) -> f64 {
    if point == 0 { 1.0 } else { report.findings.points[point].ratio.quartiles.median.max(1e-3) }
}

/// Makes a scale of ratios with ticks at 1, 2 and 5 of each decade; more on a short scale, and
/// fewer on a long one.
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
    if ticks.len() > 8 {
        ticks = at(&[1.0]);
    } else if ticks.len() < 3 {
        ticks = at(&[0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0]);
    }
    Scale { label: "time, the default is 1x".to_owned(), range, ticks }
}

/// Makes a scale of errors with a tick at each decade and one at 0; also returns the position of 0.
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

/// Returns the smallest and the largest value, or 0 and 1 without values.
fn bounds(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let all = places.fold(None, |all: Option<[f64; 2]>, place| {
        Some(all.map_or([place; 2], |[a, b]| [a.min(place), b.max(place)]))
    });
    all.unwrap_or([0.0, 1.0])
}
