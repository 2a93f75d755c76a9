//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod attributes;
mod bins;
mod changes;
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
mod watch;

pub use changes::{Cause, Change, Changes};
pub use plan::{FramePlan, Skipped};
pub use renderer::{GivenUp, Hit, Renderer};
pub use stages::Stages;
