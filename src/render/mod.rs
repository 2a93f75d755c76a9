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
pub mod plan;
pub mod real;
pub mod region;
mod renderer;
mod setup;
mod shines;
mod single;
mod small;
mod stages;
mod surface;
mod texels;
mod texture;
mod tile;
mod vertices;
mod watch;
mod ways;
mod whole;

pub use changes::{Cause, Change, Changes};
pub use plan::{Class, Effect, EffectUse, FramePlan, State};
pub use renderer::{GivenUp, Hit, Renderer};
pub use stages::Stages;
