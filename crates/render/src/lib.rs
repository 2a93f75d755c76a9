//! From a scene to a picture, drawn by the CPU alone.
//!
//! ```text
//! Shot  ->  FramePlan  ->  Renderer  ->  Picture
//! ```
//!
//! A red ball in the light of one sun:
//!
//! ```
//! use marraztu_core::accuracy::{Settings, Shot};
//! use marraztu_core::base::image::Size;
//! use marraztu_core::edit::{Gesture, History, shapes};
//! use marraztu_core::scene::{
//!     Camera, Command, Item, Lens, Light, LightId, MaterialChoice, Pose, PresetId, Scene, Shape,
//!     Tracked,
//! };
//! use marraztu_render::{Renderer, plan_frame};
//!
//! let mut scene = Scene::with_camera(Camera {
//!     name: "camera 1".to_owned(),
//!     visible: true,
//!     model: Shape::Cube.model(),
//!     material: MaterialChoice::Preset(PresetId::OBSIDIAN),
//!     pose: Tracked::new(Pose::facing_minus_z(glam::DVec3::new(0.0, 0.0, 200.0))),
//!     lens: Lens::default(),
//! });
//! let [_, sun, ..] = Light::five();
//! let sun = Command::Insert { at: 0, item: Item::Light(LightId(1), Box::new(sun)) };
//! let ball = shapes::insert(&scene, &scene.first_view(), Shape::Sphere);
//! for command in [sun, ball] {
//!     History::new().perform(&mut scene, command, Gesture::Whole, "build")?;
//! }
//!
//! let size = Size::new(64, 48);
//! let plan = plan_frame(&Shot::new(&scene, &scene.first_view(), &Settings::default(), size));
//! let mut renderer = Renderer::default();
//! let picture = renderer.render(&plan);
//! assert_eq!(picture.pixel(0, 0), scene.background.opaque());
//! // The ball rests on the ground, at the height of the eye.
//! assert_ne!(picture.pixel(32, 19), scene.background.opaque());
//! # Ok::<(), marraztu_core::scene::CommandError>(())
//! ```
//!
//! Modules use those before them in the table of `ARCHITECTURE.md`, which tells what each is for;
//! `tests/rooms.rs` enforces that.

pub mod accel;
mod ancestors;
mod bands;
mod cancellation;
mod count;
mod damage;
mod exposure;
mod frame;
mod layers;
mod lights;
mod picture_camera;
pub mod plan;
mod raster;
mod rays;
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
mod work_stealing;

pub use bands::Bands;
pub use damage::{Change, Damage, DamageCause};
pub use exposure::fitted_exposure;
pub use frame::FramePlan;
pub use frame::program::PathPixels;
pub use layers::{
    Layer, LayerNames, LayerSet, LayerType, LayerValues, Layers, NamedObject, NamedPart,
    NormalSpace,
};
pub use picture_camera::{AxesConvention, PictureCamera};
pub use plan::{Effect, EffectState, EffectUse, explain_frame, plan_everything, plan_frame};
pub use renderer::picking::Hit;
pub use renderer::{Cancelled, Renderer};
pub use shading::pixel_color::{LightRay, Part, PixelColor, SurfacePoint, Term};
pub use shadow::rays::RayCount;
pub use timings::Timings;
pub use unseen::{Unseen, unseen};
pub use without_ground::{without_ground, without_ground_while};
