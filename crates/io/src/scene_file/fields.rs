//! Shared parts of scene files: default values, checks, and runs of numbers.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

pub(super) fn yes() -> bool {
    true
}

pub(super) fn white() -> [u8; 3] {
    [255; 3]
}

/// Checks that all numbers are finite. Fails with the reason if one is infinite or NaN.
pub(super) fn finite(what: &str, numbers: &[f64]) -> Result<(), String> {
    if numbers.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(format!("{what} has a number that is infinite or NaN"))
    }
}

/// Numbers as ranges, such as `0-7 9 12-20`: a hundred thousand numbers should not take as many
/// lines.
///
/// They stay ranges until an upper limit for them is known. The ranges ascend and do not overlap,
/// so a lookup takes logarithmic time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub(super) struct Numbers(Vec<(u32, u32)>);

impl Numbers {
    pub(super) fn of(numbers: &BTreeSet<u32>) -> Self {
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for &number in numbers {
            match runs.last_mut() {
                Some((_, last)) if last.checked_add(1) == Some(number) => *last = number,
                _ => runs.push((number, number)),
            }
        }
        Self(runs)
    }

    /// Returns whether the ranges contain a number.
    pub(super) fn has(&self, number: u32) -> bool {
        let after = self.0.partition_point(|(_, last)| *last < number);
        self.0.get(after).is_some_and(|(first, _)| *first <= number)
    }

    /// Returns all numbers below `count`.
    pub(super) fn below(&self, count: usize) -> BTreeSet<u32> {
        let end = u32::try_from(count).unwrap_or(u32::MAX);
        self.ascending().take_while(|number| *number < end).collect()
    }

    /// Returns the `most` smallest numbers.
    pub(super) fn smallest(&self, most: usize) -> BTreeSet<u32> {
        self.ascending().take(most).collect()
    }

    /// Iterates over the numbers in order.
    fn ascending(&self) -> impl Iterator<Item = u32> {
        self.0.iter().flat_map(|(first, last)| *first..=*last)
    }
}

/// Sorts ranges and merges the ones that overlap. A range that ends before it begins is empty.
fn merged(mut runs: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
    runs.retain(|(first, last)| first <= last);
    runs.sort_unstable();
    runs.dedup_by(|(first, last), (_, end)| {
        let overlaps = *first <= *end;
        if overlaps {
            *end = (*end).max(*last);
        }
        overlaps
    });
    runs
}

impl From<Numbers> for String {
    fn from(numbers: Numbers) -> Self {
        let text = |(first, last): &(u32, u32)| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        numbers.0.iter().map(text).collect::<Vec<_>>().join(" ")
    }
}

impl TryFrom<String> for Numbers {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let run = |word: &str| {
            let (first, last) = word.split_once('-').unwrap_or((word, word));
            let number = |text: &str| {
                text.parse::<u32>().map_err(|error| format!("\"{word}\" is not a number: {error}"))
            };
            Ok((number(first)?, number(last)?))
        };
        text.split_whitespace()
            .map(run)
            .collect::<Result<_, String>>()
            .map(|runs| Self(merged(runs)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_runs_and_come_back() {
        let all: BTreeSet<u32> = [0, 1, 2, 5, 7, 8, 4000].into();
        let numbers = Numbers::of(&all);
        let text = String::from(numbers.clone());
        assert_eq!(text, "0-2 5 7-8 4000");
        assert_eq!(Numbers::try_from(text), Ok(numbers.clone()));
        assert_eq!(numbers.below(4001), all);
        assert_eq!(numbers.below(8), [0, 1, 2, 5, 7].into());
        assert_eq!(numbers.smallest(4), [0, 1, 2, 5].into());
        assert!(Numbers::try_from("three".to_owned()).is_err());
    }

    #[test]
    fn numbers_are_found_in_ranges_of_any_order() {
        let numbers = Numbers::try_from("7 20-29 3-5 25-40 4 9-8".to_owned()).unwrap();
        let found: Vec<u32> = (0..50).filter(|number| numbers.has(*number)).collect();
        assert_eq!(found, [vec![3, 4, 5, 7], (20..41).collect()].concat());
        assert_eq!(String::from(numbers), "3-5 7 20-40");
    }

    #[test]
    fn numbers_that_no_model_has_cost_nothing() {
        let text = "0-4294967295 ".repeat(10_000) + "5-2 4294967295";
        let numbers = Numbers::try_from(text).unwrap();
        assert_eq!(numbers.below(3), [0, 1, 2].into());
        assert_eq!(numbers.below(0), BTreeSet::new());
        assert_eq!(numbers.smallest(3), [0, 1, 2].into());
    }
}
