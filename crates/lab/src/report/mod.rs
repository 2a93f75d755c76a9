//! Reports the results of a sweep in words, as a table, as data, and as panels for plots.

mod labels;
mod panels;
mod table;
mod verdict;

use serde::{Deserialize, Serialize};

pub use self::labels::{TextBox, place};
pub use self::panels::{Panel, PanelMark, Panels, Scale};
pub use self::table::{brief, csv, heading, left_out_in_words, markdown, quoted, tabs, text};
pub use self::verdict::capitalized;
use super::candidates::Group;
use super::error::{Error, Measure, Region};
use super::front::{Point, fastest_within, front, most_exact_within};
use super::sweep::{Findings, Measured, Row, Verdict};
use marraztu_core::accuracy::Settings;

/// The results of a sweep, with the options of the report.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// The name of the scene, such as "teapot.obj".
    pub scene: String,
    /// The command that repeats the measurement.
    pub command: String,
    /// The error metric of the plots, the front and the budgets.
    pub measure: Measure,
    /// The pixels that the metric covers.
    pub region: Region,
    /// The user's limits.
    pub budgets: Budgets,
    /// The results.
    #[serde(flatten)]
    pub findings: Findings,
}

/// The user's limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Budgets {
    /// The largest error, in the unit of the report's metric.
    pub error: Option<f64>,
    /// The longest time of a picture in milliseconds.
    pub ms: Option<f64>,
}

/// The fraction of the error that a slower choice must remove for a place on the front.
const LEAST_CUT: f64 = 0.02;

/// The most names in the overview.
const NAMES: usize = 10;

impl Report {
    /// Returns the rows of the table. Presets are measured first and last, but listed together.
    pub fn rows(&self) -> Vec<&Row> {
        let mut rows: Vec<&Row> = self.findings.rows.iter().collect();
        rows.sort_by_key(|row| row.group != Group::Preset);
        rows
    }

    /// Returns the error of a row against its own reference.
    pub fn error(&self, row: &Row) -> f64 {
        self.measure.of(&row.error, self.region)
    }

    /// Returns the points as time and error against the ideal. The error of another model is NaN:
    /// it is not comparable.
    pub fn points(&self) -> Vec<Point> {
        let error = |p: &Measured| {
            p.ideal.as_ref().map_or(f64::NAN, |error| self.measure.of(error, self.region))
        };
        self.findings.points.iter().map(|p| Point { time: p.ms, error: error(p) }).collect()
    }

    /// Returns the points that share the common reference, with their indices. Pictures that lack
    /// surfaces are left out, except the default's: their times are no gain.
    fn comparable(&self) -> (Vec<usize>, Vec<Point>) {
        let all = self.points().into_iter().enumerate();
        let is_whole = |i: usize, error: Error| i == 0 || !error.is_incomplete();
        all.filter(|(i, _)| self.findings.points[*i].ideal.is_some_and(|error| is_whole(*i, error)))
            .unzip()
    }

    /// Returns the front for a minimum cut of the error. A point within the noise gets the time of
    /// the default, and the default represents all points that are as fast and as exact.
    fn front_by(&self, least: f64) -> Vec<usize> {
        // Within the noise, times are equal: noise must not decide who is on the front.
        let (places, mut points) = self.comparable();
        let Some(default) = points.first().copied() else { return Vec::new() };
        for (place, point) in places.iter().zip(&mut points) {
            if self.findings.points[*place].verdict == Verdict::Alike {
                point.time = default.time;
                if point.error > default.error * (1.0 - least) {
                    point.error = point.error.max(default.error);
                }
            }
        }
        front(&points, least).into_iter().map(|i| places[i]).collect()
    }

    /// Returns the indices of the points on the front, the fastest first.
    pub fn front(&self) -> Vec<usize> {
        self.front_by(LEAST_CUT)
    }

    /// Returns the default and the front, at most ten points, the fastest first. If there are more,
    /// the ones with the largest cuts of the error remain.
    pub fn overview(&self) -> Vec<usize> {
        let mut least = LEAST_CUT;
        loop {
            let mut found = self.front_by(least);
            if !found.contains(&0) && !self.findings.points.is_empty() {
                found.push(0);
                let ms = |i: &usize| self.findings.points[*i].ms;
                found.sort_by(|a, b| ms(a).total_cmp(&ms(b)));
            }
            if found.len() <= NAMES || least > 0.9 {
                found.truncate(NAMES);
                return found;
            }
            least *= 1.3;
        }
    }

    /// Returns the fastest point within the error budget; `None` without such a budget.
    pub fn fastest(&self) -> Option<Option<usize>> {
        let (places, points) = self.comparable();
        self.budgets.error.map(|most| fastest_within(&points, most).map(|i| places[i]))
    }

    /// Returns the most exact point within the time budget; `None` without such a budget.
    pub fn most_exact(&self) -> Option<Option<usize>> {
        let (places, points) = self.comparable();
        self.budgets.ms.map(|most| most_exact_within(&points, most).map(|i| places[i]))
    }

    /// Returns whether a row shows the current settings, moving or at rest.
    pub fn is_current(&self, row: &Row) -> bool {
        row.chosen == self.findings.current
    }

    /// Returns the settings to choose for the picture of a point.
    pub fn chosen(&self, point: usize) -> Settings {
        let rows = &self.findings.rows;
        let named = rows.iter().find(|row| row.point == point);
        named.map_or(self.findings.points[point].settings, |row| row.chosen)
    }

    /// Formats the report as JSON.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is plain data")
    }

    /// Returns the answer to each budget, as a sentence.
    pub fn answers(&self) -> Vec<String> {
        let points = self.points();
        let named = |found: Option<usize>| match found {
            Some(i) => {
                let (name, Point { time, error }) = (&self.findings.points[i].name, points[i]);
                format!("{name}: {} ms, {}", brief(time), brief(error))
            }
            None => "no measured choice".to_owned(),
        };
        let label = self.measure.label();
        let fastest = self.budgets.error.zip(self.fastest()).map(|(most, found)| {
            format!("the fastest with {label} at most {}: {}", brief(most), named(found))
        });
        let exact = self.budgets.ms.zip(self.most_exact()).map(|(most, found)| {
            format!("the most exact within {} ms: {}", brief(most), named(found))
        });
        fastest.into_iter().chain(exact).collect()
    }
}
