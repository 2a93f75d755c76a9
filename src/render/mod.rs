//! From a scene to a picture.
//!
//! ```text
//! Scene, View, Settings, Size  ->  FramePlan  ->  Renderer  ->  Picture
//! ```
//!
//! A frame goes through the rooms in this order:
//!
//! ```text
//! plan  ->  geometry  ->  visibility  ->  shading
//! ```
//!
//! * [`plan`]: what is there to draw, and which effects have a part in it, before any pixel.
//! * [`geometry`]: vertices to the screen, triangles and lines into the bins of tiles.
//! * `visibility`: what is seen at each pixel of a tile.
//! * `shading`: the colours of what is seen, and the tile in the picture.
//! * [`effects`]: the light that shading adds up, effect by effect.
//! * [`numbers`]: what light is computed in, one number or sixteen at a time.
//! * `ways`: other ways of drawing, beside those that nearly every picture is drawn in.
//!
//! The [`Renderer`] leads a frame through them; [`Changes`] say which tiles another plan leaves as they
//! are.

mod changes;
pub mod effects;
pub mod geometry;
mod marks;
pub mod numbers;
pub mod plan;
pub mod region;
mod renderer;
mod shading;
mod shares;
mod stages;
mod unseen;
mod visibility;
mod watch;
mod ways;

pub use changes::{Cause, Change, Changes};
pub use plan::{Class, Effect, EffectUse, FramePlan, State};
pub use renderer::{GivenUp, Hit, Renderer};
pub use stages::Stages;
pub use unseen::{Unseen, unseen};
