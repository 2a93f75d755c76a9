//! The cases in which programs of this kind go wrong. Each says which breakage it catches.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

#[path = "../common/plates.rs"]
mod common;

mod camera_and_undo;
