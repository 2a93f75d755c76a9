//! Scenes, accuracy settings, and the commands that change a scene.
//!
//! This crate holds plain data and the rules for it. It does not draw, read files or open windows.
//! Each module uses only the modules before it in this list:
//!
//! * [`base`]: mathematical conventions, colours, pictures in memory, parallel work.
//! * [`scene`]: objects, cameras, lights, materials, the view, and [`scene::Command`].
//! * [`accuracy`]: the axes between exact and fast, and settings with a choice for each axis.
//! * [`edit`]: turns keys and drags into commands, and keeps the undo stack.
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
