//! The laboratory reports true times and errors.
//!
//! Catches: a slowdown or an error attributed to the wrong axis or to none; an axis unknown to
//! scene files or the command line; a table, a plot or a file of results without one of the
//! choices.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod bench;
mod budget;
mod lacking;
mod lessons;
mod planted;
mod program;
mod promise;
#[path = "../random_scenes/mod.rs"]
mod random_scenes;
mod suite;
mod told;
mod words;
