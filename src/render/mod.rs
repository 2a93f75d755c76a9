//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod attributes;
mod bins;
mod clip;
mod corners;
pub mod coverage;
pub mod effects;
mod frame;
mod gather;
mod light;
mod lines;
mod marks;
pub mod plan;
pub mod real;
pub mod region;
mod renderer;
mod setup;
mod surface;
mod texture;
mod tile;
mod vertices;

pub use plan::{Class, Effect, EffectUse, FramePlan, State};
pub use renderer::{Hit, Renderer};
