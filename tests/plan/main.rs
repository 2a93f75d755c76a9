//! What a frame leaves out: that reports of it are true. That it changes nothing is proved in
//! `tests/proofs`, and that each of its rules is needed in `tests/breakages`.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod command;
mod list;
#[path = "../random_scenes/mod.rs"]
mod random_scenes;
