//! Reports the results of a sweep as a table, as data and as a plot.

mod chart;
mod plot;
mod table;

use serde::Serialize;

pub use self::chart::{Chart, Mark, MarkKind, Scale};
pub use self::plot::{PlotError, png, svg};
pub use self::table::{brief, csv, heading, tabs, text};
use super::candidates::Group;
use super::error::Measure;
use super::front::{Point, fastest_within, front, most_exact_within};
use super::sweep::{Against, Findings, Row};

/// The results of a sweep, with how they are to be reported.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The name of what was drawn: "teapot.obj".
    pub scene: String,
    /// The command that measures it again.
    pub command: String,
    /// The error metric of the plot, the front and the budgets.
    pub measure: Measure,
    /// The limits that the user has set.
    pub budgets: Budgets,
    /// The results.
    #[serde(flatten)]
    pub findings: Findings,
}

/// The limits that the user has set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Budgets {
    /// The largest error, in the unit of the report's metric.
    pub error: Option<f64>,
    /// The longest time of a picture in milliseconds.
    pub ms: Option<f64>,
}

impl Report {
    /// The rows of the table. Presets are measured first and last, but listed together.
    #[must_use]
    pub fn rows(&self) -> Vec<&Row> {
        let mut rows: Vec<&Row> = self.findings.rows.iter().collect();
        rows.sort_by_key(|row| row.group != Group::Preset);
        rows
    }

    /// The points as time and error.
    #[must_use]
    pub fn points(&self) -> Vec<Point> {
        let points = self.findings.points.iter();
        points.map(|p| Point { time: p.ms, error: self.measure.of(&p.error) }).collect()
    }

    /// Whether the metric covers the whole error of a point. All metrics but FLIP ignore pixels
    /// whose coverage differs, so a point with more of these than the default is not scored.
    #[must_use]
    pub fn is_scored(&self, point: usize) -> bool {
        let points = &self.findings.points;
        let passed_over = match points[point].against {
            Against::Default => points[0].error.coverage,
            Against::Apart | Against::Model => 0,
        };
        self.measure == Measure::Flip || points[point].error.coverage <= passed_over
    }

    /// The points that can be compared with one another, with their indices.
    fn scored(&self, against: Against) -> (Vec<usize>, Vec<Point>) {
        let all = self.points().into_iter().enumerate();
        let is_one = |i: usize| self.findings.points[i].against == against && self.is_scored(i);
        all.filter(|(i, _)| is_one(*i)).unzip()
    }

    /// The indices of the front of the points with the same judge, the fastest first.
    fn front_of(&self, against: Against) -> Vec<usize> {
        let (places, points) = self.scored(against);
        front(&points).into_iter().map(|i| places[i]).collect()
    }

    /// The indices of the points on the front, the fastest first.
    #[must_use]
    pub fn front(&self) -> Vec<usize> {
        self.front_of(Against::Default)
    }

    /// The same for the points that are judged against the most samples, each lit.
    #[must_use]
    pub fn front_apart(&self) -> Vec<usize> {
        self.front_of(Against::Apart)
    }

    /// The indices of both.
    #[must_use]
    pub fn fronts(&self) -> Vec<usize> {
        [self.front(), self.front_apart()].concat()
    }

    /// The fastest point whose error is within the budget; `None` without such a budget.
    #[must_use]
    pub fn fastest(&self) -> Option<Option<usize>> {
        let (places, points) = self.scored(Against::Default);
        self.budgets.error.map(|most| fastest_within(&points, most).map(|i| places[i]))
    }

    /// The most exact point within the budget of time; `None` without such a budget.
    #[must_use]
    pub fn most_exact(&self) -> Option<Option<usize>> {
        let (places, points) = self.scored(Against::Default);
        self.budgets.ms.map(|most| most_exact_within(&points, most).map(|i| places[i]))
    }

    /// The index of the point that the picture is drawn with now.
    #[must_use]
    pub fn current(&self) -> Option<usize> {
        self.findings.points.iter().position(|point| point.settings == self.findings.current)
    }

    /// The report as JSON.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is plain data")
    }

    /// The answer to each budget, as a sentence.
    #[must_use]
    pub fn answers(&self) -> Vec<String> {
        let named = |found: Option<usize>| match found {
            Some(i) => {
                let point = &self.findings.points[i];
                let error = brief(self.measure.of(&point.error));
                format!("{}: {} ms, {error}", point.name, brief(point.ms))
            }
            None => "none that was measured".to_owned(),
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

    /// The kind of a point. Of several rows, a preset counts before a choice of an axis, and that
    /// before a combination.
    fn kind(&self, point: usize) -> MarkKind {
        let rows = || self.findings.rows.iter().filter(|row| row.point == point);
        let against = self.findings.points[point].against;
        if point == 0 {
            MarkKind::Default
        } else if against == Against::Model {
            MarkKind::Model
        } else if against == Against::Apart {
            MarkKind::Apart
        } else if rows().any(|row| row.group == Group::Preset) {
            MarkKind::Preset
        } else if rows().any(|row| matches!(row.group, Group::Axis(_))) {
            MarkKind::Axis
        } else {
            MarkKind::Combination
        }
    }
}
