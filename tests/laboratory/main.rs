//! The laboratory: whether its times and errors are true.
//!
//! Catches: a slowdown or an error that is attributed to the wrong axis, or on none; an axis that
//! the scene file or the command line does not know; a table, a plot or a file of results that
//! lacks a choice.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod bench;
mod lessons;
mod planted;
mod program;
mod promise;
#[path = "../random_scenes/mod.rs"]
mod random_scenes;
mod suite;
mod told;
mod words;
