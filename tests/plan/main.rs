//! What a frame does without: that it changes nothing, that each rule is needed to be right, and that
//! what is said of it is so.
//!
//! Catches: a rule that leaves out what is seen, a bound that does not hold, a frame that does other work
//! because of what it does not show. `marraztu prove` goes through more scenes than this.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod command;
mod list;
mod proofs;
