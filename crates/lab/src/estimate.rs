//! Figures with their uncertainty.

use serde::{Deserialize, Serialize};

use super::statistics::quantile_of;
use marraztu_core::base::rng::Rng;

/// A figure, and the interval that contains the true value with a probability of 95%.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The most likely value.
    pub value: f64,
    /// The ends of the interval.
    pub interval: [f64; 2],
}

/// The quantile of times that stands for an undisturbed picture: other programs can only make a
/// picture slower.
pub(crate) const UNDISTURBED: f64 = 0.2;

/// The resamples of a bootstrap.
pub(crate) const RESAMPLES: usize = 400;

impl Estimate {
    /// A figure that is known.
    pub const fn exact(value: f64) -> Self {
        Self { value, interval: [value; 2] }
    }

    /// Returns half the width of the interval.
    pub fn half_width(&self) -> f64 {
        let [lower, upper] = self.interval;
        (upper - lower) / 2.0
    }

    /// Returns whether the ends of the interval differ from the value by at most a part of it.
    pub fn is_within(&self, part: f64) -> bool {
        let [lower, upper] = self.interval;
        lower >= self.value * (1.0 - part) && upper <= self.value * (1.0 + part)
    }

    /// Returns whether the intervals of two figures overlap: they may be equal.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.interval[0] <= other.interval[1] && other.interval[0] <= self.interval[1]
    }

    /// Applies an increasing function to the value and to the ends of the interval.
    #[must_use]
    pub fn map(self, increasing: impl Fn(f64) -> f64) -> Self {
        let interval = self.interval.map(&increasing);
        Self { value: increasing(self.value), interval }
    }

    /// Estimates the time of an undisturbed picture from the times of some pictures; `None` without
    /// any. One time is no evidence: the interval is wide.
    pub fn of_times(times: &[f64]) -> Option<Self> {
        let value = quantile_of(times.to_vec(), UNDISTURBED)?;
        if times.len() == 1 {
            return Some(Self { value, interval: [value / 2.0, value * 2.0] });
        }
        // A fixed seed: the same times always give the same interval.
        let mut rng = Rng::new(1);
        let mut resampled = Vec::with_capacity(RESAMPLES);
        for _ in 0..RESAMPLES {
            let some = times.iter().map(|_| times[rng.index(times.len())]).collect();
            resampled.extend(quantile_of(some, UNDISTURBED));
        }
        let [lower, upper] = [0.025, 0.975].map(|p| quantile_of(resampled.clone(), p));
        Some(Self { value, interval: [lower?.min(value), upper?.max(value)] })
    }
}
