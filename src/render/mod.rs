//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod bins;
mod changes;
mod clip;
pub mod coverage;
mod edges;
pub mod effects;
mod faces;
mod facing;
mod frame;
mod hits;
mod interpolate;
mod items;
mod large;
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
