//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod bins;
mod clip;
pub mod coverage;
pub mod effects;
mod faces;
mod frame;
mod interpolate;
mod items;
mod light;
mod lines;
mod marks;
mod painter;
mod pick;
mod plan;
pub mod real;
mod renderer;
mod setup;
mod single;
mod surface;
mod texture;
mod tile;
mod vertices;

pub use plan::{FramePlan, Skipped};
pub use renderer::{Hit, Renderer, Stages};
