//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod bins;
pub mod coverage;
pub mod effects;
mod geometry;
mod light;
mod lines;
mod marks;
mod plan;
pub mod real;
mod renderer;
mod surface;
mod texture;
mod tile;

pub use plan::{FramePlan, Skipped};
pub use renderer::{Hit, Renderer};
