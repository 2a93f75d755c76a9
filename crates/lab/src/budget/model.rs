//! Predicts combinations of choices: the ratios of their times multiply, and their errors add up.
//!
//! The best combinations are found axis by axis. After each axis, only the front remains: no
//! prediction that another one beats in both time and error. If the model held exactly, the front
//! would be that of all combinations.

use marraztu_core::accuracy::{Choice, Settings};

/// The most predictions that remain after an axis.
const MOST: usize = 128;

/// A choice that differs from the base in one axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) choice: &'static Choice,
    /// The ratio of its time to that of the base.
    pub(crate) time: f64,
    /// What it adds to the error of the base.
    pub(crate) error: f64,
}

/// Settings with their predicted time and error.
pub(crate) type Prediction = (Settings, [f64; 2]);

/// Returns the front of all combinations of steps, at most one for each axis.
pub(crate) fn predictions(base: Prediction, axes: &[Vec<Step>]) -> Vec<Prediction> {
    let mut all = vec![base];
    for steps in axes {
        let grown = all.iter().flat_map(|(settings, [time, error])| {
            let with = move |step: &Step| {
                let error = (error + step.error).max(0.0);
                (step.choice.of(settings), [time * step.time, error])
            };
            steps.iter().map(with)
        });
        let grown: Vec<Prediction> = grown.collect();
        all.extend(grown);
        all.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let mut best = f64::INFINITY;
        all.retain(|(_, [_, error])| {
            let is_better = *error < best;
            best = best.min(*error);
            is_better
        });
        thin(&mut all);
    }
    all
}

/// Drops predictions evenly, but neither the fastest nor the most exact.
fn thin(all: &mut Vec<Prediction>) {
    if all.len() > MOST {
        let last = all.len() - 1;
        *all = (0..MOST).map(|i| all[i * last / (MOST - 1)]).collect();
    }
}
