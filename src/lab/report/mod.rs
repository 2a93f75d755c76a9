//! What a sweep found, told as a table, as data and as a plot.

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

/// What is told, and of what.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What was drawn: "teapot.obj".
    pub scene: String,
    /// The command that measures it again.
    pub command: String,
    /// What stands for an error in the plot, the front and the budgets.
    pub measure: Measure,
    /// What the user can bear.
    pub budgets: Budgets,
    /// What was found.
    #[serde(flatten)]
    pub findings: Findings,
}

/// What the user can bear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Budgets {
    /// The largest error, in the unit of the report's measure.
    pub error: Option<f64>,
    /// The longest time of a picture, in milliseconds.
    pub ms: Option<f64>,
}

impl Report {
    /// The rows of the table. Presets were measured first and last, and stand together.
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

    /// Whether the error of a point says all that it is off by. Where it shows other triangles at more
    /// pixels than the default does, all errors but that of FLIP pass over these.
    #[must_use]
    pub fn is_scored(&self, point: usize) -> bool {
        let points = &self.findings.points;
        let passed_over = match points[point].against {
            Against::Default => points[0].error.coverage,
            Against::Apart | Against::Model => 0,
        };
        self.measure == Measure::Flip || points[point].error.coverage <= passed_over
    }

    /// The points that can stand in for one another, with their places among all.
    fn scored(&self, against: Against) -> (Vec<usize>, Vec<Point>) {
        let all = self.points().into_iter().enumerate();
        let is_one = |i: usize| self.findings.points[i].against == against && self.is_scored(i);
        all.filter(|(i, _)| is_one(*i)).unzip()
    }

    /// The places of the points that are worth choosing of those that are judged against the same picture,
    /// the fastest first.
    fn front_of(&self, against: Against) -> Vec<usize> {
        let (places, points) = self.scored(against);
        front(&points).into_iter().map(|i| places[i]).collect()
    }

    /// The places of the points that are worth choosing, the fastest first.
    #[must_use]
    pub fn front(&self) -> Vec<usize> {
        self.front_of(Against::Default)
    }

    /// The same of those that are judged against the most samples, each lit.
    #[must_use]
    pub fn front_apart(&self) -> Vec<usize> {
        self.front_of(Against::Apart)
    }

    /// The places of both.
    #[must_use]
    pub fn fronts(&self) -> Vec<usize> {
        [self.front(), self.front_apart()].concat()
    }

    /// The fastest point whose error is at most the budget's; `None` where there is no such budget.
    #[must_use]
    pub fn fastest(&self) -> Option<Option<usize>> {
        let (places, points) = self.scored(Against::Default);
        self.budgets.error.map(|most| fastest_within(&points, most).map(|i| places[i]))
    }

    /// The most exact point within the budget of time; `None` where there is no such budget.
    #[must_use]
    pub fn most_exact(&self) -> Option<Option<usize>> {
        let (places, points) = self.scored(Against::Default);
        self.budgets.ms.map(|most| most_exact_within(&points, most).map(|i| places[i]))
    }

    /// The place of the point that the picture is drawn with now.
    #[must_use]
    pub fn current(&self) -> Option<usize> {
        self.findings.points.iter().position(|point| point.settings == self.findings.current)
    }

    /// All of it as JSON.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is plain data")
    }

    /// What the budgets come to, a sentence each.
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

    /// What a point stands for, where it has several rows: a preset before a choice of an axis, that
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
