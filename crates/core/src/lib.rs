//! Scenes of models, settings of accuracy, and the commands that change a scene.
//!
//! This crate is plain data and the rules for it. It draws nothing, reads no files and knows of no
//! windows. Its modules use those before them in this list:
//!
//! * [`base`]: conventions of the mathematics, colours, pictures in memory, parallel work.
//! * [`scene`]: objects, cameras, lights, materials, the view, and [`scene::Command`].
//! * [`accuracy`]: the axes along which pictures can be more or less exact, and settings on them.
//! * [`edit`]: decides which command a key or a drag means, and keeps the undo stack.
//!
//! Only [`edit::History`] changes a scene, so every change can be undone:
//!
//! ```
//! use marraztu_core::edit::{Gesture, History, shapes};
//! use marraztu_core::scene::{Camera, Lens, MaterialChoice, Pose, PresetId, Scene, Shape, Tracked};
//!
//! let camera = Camera {
//!     name: "camera 1".to_owned(),
//!     visible: true,
//!     model: Shape::Cube.model(),
//!     material: MaterialChoice::Preset(PresetId::OBSIDIAN),
//!     pose: Tracked::new(Pose::facing_minus_z(glam::DVec3::new(0.0, 0.0, 5.0))),
//!     lens: Lens::default(),
//! };
//! let mut scene = Scene::with_camera(camera);
//! let mut history = History::new();
//!
//! let command = shapes::insert(&scene, &scene.first_view(), Shape::Torus);
//! history.perform(&mut scene, command, Gesture::Whole, "Add torus")?;
//! assert_eq!(scene.objects.len(), 1);
//!
//! assert_eq!(history.undo(&mut scene).as_deref(), Some("Add torus"));
//! assert_eq!(scene.objects.len(), 0);
//! # Ok::<(), marraztu_core::scene::CommandError>(())
//! ```

pub mod accuracy;
pub mod base;
pub mod edit;
pub mod scene;
