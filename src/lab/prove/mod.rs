//! What is claimed of the program, put to the proof in large numbers.
//!
//! A proof makes cases and checks each of them against an oracle that shares no code with what it
//! judges. Cases come in lots, and a lot's number alone says what is in it: a counterexample is named
//! by its lot, and found again by it. The tests look at some lots of each proof in every run;
//! `marraztu prove` at as many as one likes.

pub mod dice;
pub mod double_double;
pub mod exact;
mod fans;
mod far;
mod hostile;
pub mod pictures;
pub mod plan;
mod presses;
mod scenes;
mod sizes;
pub mod stage;
mod undo;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;

/// A claim, with what makes cases of it and checks them.
#[derive(Debug)]
pub struct Proof {
    /// What the command line calls it.
    pub name: &'static str,
    /// What is claimed of every case.
    pub claim: &'static str,
    /// What a case is.
    pub unit: &'static str,
    /// How many cases a lot has.
    pub lot: u64,
    /// How many cases the tests look at in every run.
    pub tested: u64,
    /// How many cases are looked at unless it is said otherwise.
    pub whole: u64,
    /// Looks at the cases of a lot.
    pub check: fn(u64) -> Result<Tally, String>,
}

/// Every proof.
pub static PROOFS: &[Proof] = &[
    fans::PROOF,
    far::PROOF,
    scenes::PROOF,
    presses::PROOF,
    undo::PROOF,
    sizes::PROOF,
    plan::PLAN,
    plan::FAINT,
    plan::ABSENT,
];

/// What was seen in the cases of a proof.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// How often each thing was met.
    pub counts: BTreeMap<&'static str, u64>,
    /// The largest error of each kind.
    pub worst: BTreeMap<&'static str, f64>,
}

impl Tally {
    /// Counts `more` of something.
    pub fn count(&mut self, what: &'static str, more: u64) {
        *self.counts.entry(what).or_default() += more;
    }

    /// Remembers an error where it is the largest of its kind; one that is no number is.
    pub fn error(&mut self, what: &'static str, size: f64) {
        let worst = self.worst.entry(what).or_default();
        *worst = if size.is_nan() { size } else { worst.max(size) };
    }

    /// What was seen here and there.
    #[must_use]
    pub fn and(mut self, other: &Self) -> Self {
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

/// A lot in which a claim does not hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("lot {lot}: {what}")]
pub struct Counterexample {
    /// Its number.
    pub lot: u64,
    /// What was seen in it.
    pub what: String,
}

impl Proof {
    /// The proof of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        PROOFS.iter().find(|proof| proof.name == name)
    }

    /// Looks at some lots, on all threads. `looked_at` is told of each when it is done.
    ///
    /// # Errors
    /// With a lot in which the claim does not hold, or in which something panics.
    pub fn run(
        &self,
        lots: std::ops::Range<u64>,
        looked_at: &(dyn Fn(u64) + Sync),
    ) -> Result<Tally, Counterexample> {
        let one = |lot: u64| {
            let checked = catch_unwind(AssertUnwindSafe(|| (self.check)(lot)));
            looked_at(lot);
            let checked = checked.unwrap_or_else(|_panic| Err("it panics".to_owned()));
            checked.map_err(|what| Counterexample { lot, what })
        };
        let join = |a: Tally, b: Tally| Ok(a.and(&b));
        lots.into_par_iter().map(one).try_reduce(Tally::default, join)
    }

    /// How many lots have so many cases.
    #[must_use]
    pub const fn lots(&self, cases: u64) -> u64 {
        cases.div_ceil(self.lot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static EVEN: Proof = Proof {
        name: "even",
        claim: "no lot is the seventh",
        unit: "numbers",
        lot: 10,
        tested: 10,
        whole: 100,
        check: |lot| {
            assert_ne!(lot, 9, "this is seen as a counterexample");
            let mut tally = Tally::default();
            tally.count("numbers", 10);
            tally.error("error", 0.5);
            if lot == 7 { Err("this is the seventh".to_owned()) } else { Ok(tally) }
        },
    };

    #[test]
    fn a_counterexample_is_named_by_its_lot_and_a_panic_is_one() {
        let seen = EVEN.run(0..7, &|_| {}).unwrap();
        assert_eq!((seen.counts["numbers"], seen.worst["error"]), (70, 0.5));
        assert_eq!(EVEN.run(0..8, &|_| {}).unwrap_err().lot, 7);
        assert_eq!(EVEN.run(8..10, &|_| {}).unwrap_err().lot, 9);
        assert_eq!((EVEN.lots(1), EVEN.lots(20), EVEN.lots(21)), (1, 2, 3));
    }

    #[test]
    fn names_are_given_once() {
        for (i, proof) in PROOFS.iter().enumerate() {
            assert!(PROOFS[..i].iter().all(|other| other.name != proof.name), "{}", proof.name);
        }
    }
}
