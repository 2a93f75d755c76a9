//! Estimates sums over the parts of a picture from a few parts (stratified sampling).
//!
//! Parts are sorted by a size that is known for all of them and predicts their figures, and divided
//! into strata with equal sums of the sizes. Parts are drawn at random within a stratum, without
//! replacement, and the next one comes from the stratum that adds most to the uncertainty (Neyman's
//! allocation). Sums over strata and their variances are those of Cochran, "Sampling Techniques",
//! 1977, chapter 5; the interval uses Student's t with Satterthwaite's degrees of freedom, section
//! 5.4, on a logarithmic scale, since sums of squares are skewed.

use std::collections::BTreeMap;

use super::estimate::Estimate;
use marraztu_core::base::rng::Rng;

/// The most strata.
const STRATA: usize = 10;

/// The parts of each stratum that are drawn first.
const FIRST: usize = 3;

/// The part of the sizes that all parts share: a part of size 0 may have figures, too.
const SHARED: f64 = 0.2;

/// Measuring ends once an interval is narrow, and so more often if a variance is underestimated:
/// intervals are wider by this factor. A test counts how often they hold.
const WIDER: f64 = 1.6;

/// Parts in strata, and the figures of the parts that were drawn.
#[derive(Debug)]
pub(crate) struct Strata {
    strata: Vec<Stratum>,
    /// The figures of each part that was drawn.
    known: BTreeMap<usize, Vec<f64>>,
}

/// Parts of similar size.
#[derive(Debug)]
struct Stratum {
    /// The parts in random order: the first ones are drawn.
    parts: Vec<usize>,
    drawn: usize,
}

/// The mean and the variance of a figure in a stratum.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: f64,
    drawn: f64,
    mean: f64,
    variance: f64,
}

impl Strata {
    /// Divides parts by their sizes. The same seed always draws the same parts.
    pub(crate) fn new(sizes: &[f64], seed: u64) -> Self {
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
        let (sum, count) = (sizes.iter().sum::<f64>(), sizes.len().max(1) as f64);
        let shared = if sum > 0.0 { SHARED } else { 1.0 };
        let share = |part: &usize| {
            shared / count + if sum > 0.0 { (1.0 - shared) * sizes[*part] / sum } else { 0.0 }
        };
        let (mut strata, mut up_to): (Vec<Stratum>, f64) = (Vec::new(), 0.0);
        let mut begun = usize::MAX;
        for part in order {
            let place = stratum_at(up_to);
            up_to += share(&part);
            // A stratum with few parts grows into the next one.
            let is_full = strata.last().is_none_or(|it| it.parts.len() >= FIRST && place != begun);
            if is_full {
                strata.push(Stratum { parts: Vec::new(), drawn: 0 });
                begun = place;
            }
            strata.last_mut().expect("just pushed").parts.push(part);
        }
        let mut rng = Rng::new(seed);
        for stratum in &mut strata {
            shuffle(&mut stratum.parts, &mut rng);
        }
        Self { strata, known: BTreeMap::new() }
    }

    /// Returns the next part to draw; `None` if all were drawn.
    pub(crate) fn next(&self) -> Option<usize> {
        let open = || self.strata.iter().enumerate().filter(|(_, it)| it.drawn < it.parts.len());
        let first = open().find(|(_, stratum)| stratum.drawn < FIRST);
        let (_, next) = first.or_else(|| {
            let gains = self.gains();
            open().max_by(|(i, a), (j, b)| {
                // Without a known difference, the least explored stratum is next.
                let explored = |it: &Stratum| it.parts.len() as f64 / it.drawn as f64;
                gains[*i].total_cmp(&gains[*j]).then(explored(a).total_cmp(&explored(b)))
            })
        })?;
        Some(next.parts[next.drawn])
    }

    /// Notes the figures of the part that [`Self::next`] returned.
    pub(crate) fn note(&mut self, part: usize, figures: Vec<f64>) {
        let is_next = |it: &&mut Stratum| it.parts.get(it.drawn) == Some(&part);
        if let Some(stratum) = self.strata.iter_mut().find(is_next) {
            stratum.drawn += 1;
            self.known.insert(part, figures);
        }
    }

    /// Returns whether each stratum has been drawn from.
    pub(crate) fn is_begun(&self) -> bool {
        self.strata.iter().all(|it| it.drawn >= FIRST.min(it.parts.len()))
    }

    /// Returns the figures of the parts that were drawn.
    pub(crate) fn known(&self) -> impl Iterator<Item = &[f64]> {
        self.known.values().map(Vec::as_slice)
    }

    /// Estimates the sum of a figure over all parts.
    pub(crate) fn sum(&self, figure: usize) -> Estimate {
        self.sum_of(&|part| self.known[&part][figure])
    }

    /// Estimates the sum of a figure over all parts. `of` returns it for each part that was drawn.
    pub(crate) fn sum_of(&self, of: &dyn Fn(usize) -> f64) -> Estimate {
        let all = self.moments(of);
        let value: f64 = all.iter().map(|it| it.count * it.mean).sum();
        let variance: f64 = all.iter().map(Moments::variance_of_sum).sum();
        if value <= 0.0 || variance <= 0.0 {
            return Estimate::exact(value);
        }
        let fourth = |it: &Moments| {
            let variance = it.variance_of_sum();
            variance * variance / (it.drawn - 1.0).max(1.0)
        };
        let freedom = variance * variance / all.iter().map(fourth).sum::<f64>();
        let width = WIDER * student(freedom) * libm::sqrt(variance) / value;
        let factor = libm::exp(width.min(20.0));
        // The sum is at least that of the parts that were drawn.
        let drawn: f64 = all.iter().map(|it| it.drawn * it.mean).sum();
        Estimate { value, interval: [(value / factor).max(drawn), value * factor] }
    }

    /// Returns the reduction of the relative variance, over all figures, by one more part of each
    /// stratum.
    fn gains(&self) -> Vec<f64> {
        let figures = self.known().next().map_or(0, <[f64]>::len);
        let mut gains = vec![0.0; self.strata.len()];
        for figure in 0..figures {
            let all = self.moments(&|part| self.known[&part][figure]);
            let value: f64 = all.iter().map(|it| it.count * it.mean).sum();
            if value > 0.0 {
                for (gain, it) in gains.iter_mut().zip(&all) {
                    let less = 1.0 / it.drawn - 1.0 / (it.drawn + 1.0);
                    *gain += it.count * it.count * it.variance * less / (value * value);
                }
            }
        }
        gains
    }

    /// Returns the moments of a figure in each stratum.
    fn moments(&self, figure: &dyn Fn(usize) -> f64) -> Vec<Moments> {
        let of = |stratum: &Stratum| {
            let drawn = &stratum.parts[..stratum.drawn];
            let values = || drawn.iter().map(|part| figure(*part));
            let number = drawn.len() as f64;
            let mean = values().sum::<f64>() / number.max(1.0);
            let squares = values().map(|value| (value - mean) * (value - mean)).sum::<f64>();
            let variance = squares / (number - 1.0).max(1.0);
            Moments { count: stratum.parts.len() as f64, drawn: number, mean, variance }
        };
        let mut all: Vec<Moments> = self.strata.iter().map(of).collect();
        // Parts that were not drawn may be like those of the next larger stratum.
        for i in (0..all.len()).rev() {
            let next = all.get(i + 1).map_or(2.0 * all[i].mean, |next| next.mean);
            let rise = (next - all[i].mean).max(0.0);
            let it = &mut all[i];
            it.variance = it.variance.max(rise * rise / (it.drawn + 1.0));
        }
        all
    }
}

impl Moments {
    /// The variance of the estimated sum: none is left if all parts were drawn.
    fn variance_of_sum(&self) -> f64 {
        let left = 1.0 - self.drawn / self.count;
        self.count * self.count * left * self.variance / self.drawn.max(1.0)
    }
}

/// Returns the stratum at a share of the sizes.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few strata")]
fn stratum_at(share: f64) -> usize {
    ((share * STRATA as f64) as usize).min(STRATA - 1)
}

fn shuffle(parts: &mut [usize], rng: &mut Rng) {
    for i in (1..parts.len()).rev() {
        parts.swap(i, rng.index(i + 1));
    }
}

/// Returns the quantile of Student's t that leaves 2.5% above it, by the expansion of Cornish and
/// Fisher (Abramowitz and Stegun, 26.7.5).
fn student(freedom: f64) -> f64 {
    const Z: f64 = 1.959_963_985;
    let f = freedom.max(2.0);
    let (z3, z5, z7) = (Z.powi(3), Z.powi(5), Z.powi(7));
    Z + (z3 + Z) / (4.0 * f)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * Z) / (96.0 * f * f)
        + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * Z) / (384.0 * f * f * f)
}
