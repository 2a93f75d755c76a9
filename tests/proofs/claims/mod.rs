//! The program's guarantees, each checked on randomly generated cases.
//!
//! A proof generates cases and checks each against an oracle that shares no code with the tested
//! part. Cases come in batches, and the batch number alone determines its cases, so a
//! counterexample is named by its batch and can be reproduced.

#![allow(dead_code, reason = "the hard cases use a part of it")]

mod absent;
pub(crate) mod choices;
pub(crate) mod double_double;
pub(crate) mod exact;
mod fans;
mod far;
mod hostile;
pub(crate) mod instructions;
mod plan;
mod presets;
mod presses;
#[path = "../../random_scenes/mod.rs"]
mod random_scenes;
mod scenes;
mod sizes;
mod undo;

use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;

/// A claim, with the code that generates and checks its cases.
#[derive(Debug)]
pub(crate) struct Proof {
    /// Its name on the command line.
    pub(crate) name: &'static str,
    /// The claim about every case.
    pub(crate) claim: &'static str,
    /// The unit of its cases.
    pub(crate) unit: &'static str,
    /// The number of cases in a batch.
    pub(crate) batch: u64,
    /// The number of cases that every run of the tests checks.
    pub(crate) quick: u64,
    /// The number of cases that `docs/stability.md` reports.
    pub(crate) whole: u64,
    /// The least number of events per thousand cases, which keeps the check from being vacuous.
    pub(crate) shows: &'static [(&'static str, u64)],
    /// Batches that once contradicted the claim, or that alone notice a breakage.
    pub(crate) regressions: &'static [u64],
    /// Checks the cases of a batch.
    pub(crate) check: fn(u64) -> Result<Tally, String>,
}

/// Every proof.
pub(crate) static PROOFS: &[Proof] = &[
    fans::PROOF,
    far::PROOF,
    scenes::PROOF,
    presses::PROOF,
    undo::PROOF,
    sizes::PROOF,
    plan::PLAN,
    presets::PROOF,
    absent::PROOF,
];

/// The counts and errors that a proof has collected.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tally {
    /// The number of occurrences of each event.
    pub(crate) counts: BTreeMap<&'static str, u64>,
    /// The largest error of each kind.
    pub(crate) worst: BTreeMap<&'static str, f64>,
}

impl Tally {
    /// Counts `more` of something.
    pub(crate) fn count(&mut self, what: &'static str, more: u64) {
        *self.counts.entry(what).or_default() += more;
    }

    /// Keeps an error if it is the largest of its kind. NaN counts as larger than any number.
    pub(crate) fn error(&mut self, what: &'static str, size: f64) {
        let worst = self.worst.entry(what).or_default();
        *worst = if size.is_nan() { size } else { worst.max(size) };
    }

    /// Merges two tallies.
    #[must_use]
    pub(crate) fn and(mut self, other: &Self) -> Self {
        for (what, more) in &other.counts {
            self.count(what, *more);
        }
        for (what, size) in &other.worst {
            self.error(what, *size);
        }
        self
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let counts = self.counts.iter().map(|(what, count)| format!("{what} {count}"));
        let worst = self.worst.iter().map(|(what, size)| format!("{what} at most {size:.3e}"));
        write!(f, "{}", counts.chain(worst).collect::<Vec<_>>().join(", "))
    }
}

/// A batch that contradicts a claim.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("batch {batch}: {what}")]
pub(crate) struct Counterexample {
    /// The number of the batch.
    pub(crate) batch: u64,
    /// The failure.
    pub(crate) what: String,
}

impl Proof {
    /// Finds a proof by name.
    #[must_use]
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        PROOFS.iter().find(|proof| proof.name == name)
    }

    /// Checks batches on all threads, and calls `checked` after each.
    ///
    /// # Errors
    /// A batch that contradicts the claim or panics.
    pub(crate) fn run(
        &self,
        batches: Range<u64>,
        checked: &(dyn Fn(u64) + Sync),
    ) -> Result<Tally, Counterexample> {
        let one = |batch: u64| {
            let result = catch_unwind(AssertUnwindSafe(|| (self.check)(batch)));
            checked(batch);
            let result = result.unwrap_or_else(|_panic| Err("it panics".to_owned()));
            result.map_err(|what| Counterexample { batch, what })
        };
        let join = |a: Tally, b: Tally| Ok(a.and(&b));
        batches.into_par_iter().map(one).try_reduce(Tally::default, join)
    }

    /// The number of batches that contain this many cases.
    #[must_use]
    pub(crate) const fn batches(&self, cases: u64) -> u64 {
        cases.div_ceil(self.batch)
    }

    /// Names an event that occurred too rarely.
    pub(crate) fn missing(&self, tally: &Tally, cases: u64) -> Option<String> {
        let missing = self.shows.iter().find(|(what, per_thousand)| {
            tally.counts.get(what).copied().unwrap_or_default() < per_thousand * (cases / 1000)
        });
        missing
            .map(|(what, least)| format!("fewer than {least} {what} in a thousand {}", self.unit))
    }
}
