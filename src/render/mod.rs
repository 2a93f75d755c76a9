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
mod edges;
pub mod effects;
mod facing;
mod frame;
mod gather;
mod hits;
mod large;
mod light;
mod lines;
mod marks;
mod plan;
pub mod real;
mod renderer;
mod setup;
mod small;
mod stages;
mod surface;
mod texture;
mod tile;
mod vertices;

pub use plan::{FramePlan, Skipped};
pub use renderer::{Hit, Renderer};
pub use stages::Stages;
