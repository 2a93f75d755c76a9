//! From a scene to a picture: plan, geometry, bins, tiles, stages.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```

mod plan;
mod renderer;

pub use plan::FramePlan;
pub use renderer::{Hit, Renderer};
