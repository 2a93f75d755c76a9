//! The reports on effects that a frame leaves out are true. `tests/proofs` shows that leaving them
//! out changes no pixel, and `tests/breakages` that each rule is needed.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod command;
mod list;
#[path = "../random_scenes/mod.rs"]
mod random_scenes;
