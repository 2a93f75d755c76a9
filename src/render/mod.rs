//! From a scene to a picture.
//!
//! ```text
//! Shot  ->  FramePlan  ->  Renderer  ->  Picture
//! ```
//!
//! The rooms are floors: each uses itself and those before it in this list.
//!
//! * [`simd`]: the numbers that light is computed in, eight or sixteen at a time.
//! * `texture`: colours of textures at a position, and their mip maps.
//! * [`lights`]: one file and one table row for each kind of light; the Phong terms.
//! * `frame`: what a frame draws, as plain data.
//! * [`screen`]: clipping, snapping, coverage, sample positions and tiles.
//! * [`plan`]: decides what a frame draws before any pixel is touched, and says why.
//! * `reference`: the fill algorithm of ancestor A, as a whole.
//! * `raster`: vertices to the screen, triangles and lines into the bins of tiles, and from there
//!   to the visibility buffer.
//! * `shadow`: rays from lit points to lights, and what stands between.
//! * `shading`: the colours of what is visible, and their bytes in the picture.
//! * `tile_layers`: what the pixels of a tile show.
//! * `renderer`, `damage`, `count`, `unseen`, `exposure`, `without_ground`: draw plans, and answer
//!   questions about what was drawn.

mod count;
mod damage;
mod exposure;
mod frame;
pub mod lights;
pub mod plan;
mod raster;
mod reference;
mod renderer;
pub mod screen;
mod shading;
mod shadow;
pub mod simd;
mod texture;
mod tile_layers;
mod timings;
mod unseen;
mod without_ground;

pub use damage::{Change, Damage, DamageCause};
pub use exposure::fitted_exposure;
pub use frame::FramePlan;
pub use plan::{Class, Effect, EffectState, EffectUse, explain_frame, plan_everything, plan_frame};
pub use renderer::{Cancelled, Hit, Renderer};
pub use shading::pixel_color::{LightRay, Part, PixelColor, SurfacePoint, Term};
pub use shadow::rays::RayCount;
pub use timings::Timings;
pub use unseen::{Unseen, unseen};
pub use without_ground::without_ground;
