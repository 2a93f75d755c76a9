//! Medians and quartiles of a few measurements, with confidence intervals of the median.
//!
//! Quantiles are of type 7 in Hyndman and Fan, "Sample Quantiles in Statistical Packages", 1996:
//! linear interpolation between the two neighbours of (n - 1) p.

use serde::Serialize;

/// The quartiles of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    #[must_use]
    pub fn of(numbers: &[f64]) -> Option<Self> {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f64::total_cmp);
        let quantile = |p: f64| quantile(&sorted, p);
        Some(Self { lower: quantile(0.25)?, median: quantile(0.5)?, upper: quantile(0.75)? })
    }

    /// Returns half the interquartile range (IQR).
    #[must_use]
    pub fn spread(&self) -> f64 {
        (self.upper - self.lower) / 2.0
    }
}

/// Returns the median of numbers without NaN; `None` for an empty slice.
#[must_use]
pub fn median(numbers: &[f64]) -> Option<f64> {
    Quartiles::of(numbers).map(|quartiles| quartiles.median)
}

/// Returns a confidence interval of the median, from the k-th smallest to the k-th largest number.
/// k is the largest for which the interval contains the true median with a probability of at least
/// `confidence`. With too few numbers (or more than a thousand), the interval spans all of them.
/// `None` for an empty slice.
///
/// For any distribution, each of n independent numbers is below the true median with a probability
/// of one half. The median is therefore outside the interval with a probability of 2 sum (i < k)
/// C(n, i) / 2^n: the interval contains the medians that a sign test does not reject. David and
/// Nagaraja, "Order Statistics", 2003, section 7.1.
#[must_use]
pub fn median_interval(numbers: &[f64], confidence: f64) -> Option<[f64; 2]> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let n = i32::try_from(sorted.len()).unwrap_or(i32::MAX);
    // C(n, i) / 2^n, and twice its sum up to this i.
    let mut chance = libm::ldexp(1.0, -n);
    let (mut outside, mut cut) = (2.0 * chance, 0);
    // Widen the cut on both sides while the confidence holds; above 1000, 2^-n underflows.
    for i in 1..if n > 1000 { 0 } else { (n + 1) / 2 } {
        chance *= f64::from(n + 1 - i) / f64::from(i);
        outside += 2.0 * chance;
        if 1.0 - outside < confidence {
            break;
        }
        cut += 1;
    }
    Some([sorted[cut], sorted[last - cut]])
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

    /// `qbinom(0.025, n, 0.5)` in R is the k of a 95% interval: 1 for n = 6 and 7, 2 for 11, 4 for
    /// 15, 10 for 31.
    #[test]
    fn the_interval_of_a_median_is_that_of_the_sign_test() {
        let interval = |n: i32| {
            let numbers: Vec<f64> = (1..=n).rev().map(f64::from).collect();
            median_interval(&numbers, 0.95)
        };
        for (n, k) in [(1, 1), (2, 1), (6, 1), (7, 1), (8, 1), (9, 2), (11, 2), (15, 4), (31, 10)] {
            let expected = [k, n + 1 - k].map(f64::from);
            assert_eq!(interval(n), Some(expected), "{n}");
        }
        assert_eq!(interval(2000), Some([1.0, 2000.0]));
        assert_eq!(median_interval(&[], 0.95), None);
    }

    /// Draws ten thousand samples with a true median of 1: at most the promised fraction of the
    /// intervals misses it.
    #[test]
    fn the_interval_holds_the_true_median_as_often_as_is_said() {
        let mut rng = marraztu_core::base::rng::Rng::new(7);
        for n in [7, 11, 31] {
            let misses = (0..10_000).filter(|_| {
                // Skewed like times: disturbances only make them longer.
                let numbers: Vec<f64> =
                    (0..n).map(|_| libm::exp(3.0 * rng.real(-1.0, 1.0))).collect();
                let [low, high] = median_interval(&numbers, 0.95).unwrap();
                low > 1.0 || high < 1.0
            });
            let misses = misses.count();
            assert!(misses < 520, "{misses} of 10,000 with {n}");
        }
    }
}
