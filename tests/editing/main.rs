//! Editing a scene: the commands behind keys, mouse and panels.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

#[path = "../common/plates.rs"]
mod common;

mod aiming;
mod amounts;
mod arranging;
mod desk;
mod framing;
mod items;
mod navigation;
mod placement;
mod selecting;
mod several;
mod shapes;
mod transforming;
