//! An editor for 3D scenes of `.obj` models whose pictures are drawn by the CPU alone.
//!
//! The folders are floors: a file uses its own floor and those below it, never one above
//! (`tests/floors` reads the sources and fails otherwise).
//!
//! ```text
//! base  <  scene  <  accuracy  <  { io, edit, render }  <  lab  <  app  <  cli
//! ```
//!
//! * [`base`]: the conventions of the mathematics, colours, pictures.
//! * [`scene`]: what there is to draw, how it is looked at, and the commands that change it.
//! * [`accuracy`]: the axes along which pictures can be more or less exact, and settings on them.
//! * [`io`]: models, textures, scene files and pictures, to and from the disk.
//! * [`edit`]: which command a key means, and the history of commands.
//! * [`render`]: from a scene to a picture: plan, geometry, visibility, shading.
//! * [`lab`]: what drawing costs in time, and what accuracy costs.
//! * [`app`]: the window. The only floor that knows of egui.
//!
//! A picture of the first scene:
//!
//! ```
//! use marraztu::accuracy::{Settings, Shot};
//! use marraztu::base::image::Size;
//! use marraztu::io;
//! use marraztu::render::{Renderer, plan_frame};
//!
//! let (scene, view) = io::default_scene();
//! let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(64, 48));
//! let mut renderer = Renderer::default();
//! let picture = renderer.render(&plan_frame(&shot));
//! assert_eq!(picture.size(), shot.size);
//! assert!(picture.pixels().iter().any(|pixel| *pixel != scene.background.opaque()));
//! ```

pub mod accuracy;
pub mod app;
pub mod base;
pub mod edit;
pub mod io;
pub mod lab;
pub mod render;
pub mod scene;
