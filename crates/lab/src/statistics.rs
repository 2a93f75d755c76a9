//! Medians, quartiles and other quantiles of a few measurements.
//!
//! Quantiles are of type 7 in Hyndman and Fan, "Sample Quantiles in Statistical Packages", 1996:
//! linear interpolation between the two neighbours of (n - 1) p.

use serde::{Deserialize, Serialize};

/// The quartiles of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quartiles {
    /// A quarter of the numbers is smaller.
    pub lower: f64,
    /// Half of the numbers is smaller.
    pub median: f64,
    /// A quarter of the numbers is larger.
    pub upper: f64,
}

impl Quartiles {
    /// Returns the quartiles of numbers without NaN; `None` for an empty slice.
    pub fn of(numbers: &[f64]) -> Option<Self> {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f64::total_cmp);
        let quantile = |p: f64| quantile(&sorted, p);
        Some(Self { lower: quantile(0.25)?, median: quantile(0.5)?, upper: quantile(0.75)? })
    }

    /// Returns half the interquartile range (IQR).
    pub fn spread(&self) -> f64 {
        (self.upper - self.lower) / 2.0
    }
}

/// Returns the median of numbers without NaN; `None` for an empty slice.
pub fn median(numbers: &[f64]) -> Option<f64> {
    Quartiles::of(numbers).map(|quartiles| quartiles.median)
}

/// Returns a quantile of numbers without NaN; `None` without numbers.
pub fn quantile_of(mut numbers: Vec<f64>, p: f64) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    quantile(&numbers, p)
}

/// Returns the quantile of sorted numbers.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "few numbers"
)]
fn quantile(sorted: &[f64], p: f64) -> Option<f64> {
    let place = (sorted.len().checked_sub(1)? as f64) * p;
    let (below, part) = (place as usize, place.fract());
    let upper = sorted.get(below + 1).unwrap_or(&sorted[below]);
    Some(sorted[below] + (upper - sorted[below]) * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `quantile(c(9, 1, 4, 2), c(.25, .5, .75))` in R: 1.75, 3, 5.25.
    #[test]
    fn quartiles_match_r() {
        let quartiles = Quartiles::of(&[9.0, 1.0, 4.0, 2.0]).unwrap();
        assert_eq!(quartiles, Quartiles { lower: 1.75, median: 3.0, upper: 5.25 });
        let one = Quartiles::of(&[7.0]).unwrap();
        assert_eq!(one, Quartiles { lower: 7.0, median: 7.0, upper: 7.0 });
        assert_eq!(Quartiles::of(&[]), None);
        assert_eq!((median(&[9.0, 1.0, 4.0, 2.0]), quartiles.spread()), (Some(3.0), 1.75));
    }
}
