//! An editor for 3D scenes of `.obj` models whose pictures are drawn by the CPU alone.
//!
//! This crate is the program: [`app`] is the window, [`plots`] draws the laboratory's plots as SVG
//! and PNG, [`picture_file`] draws into files, [`directions`] names views of models, and the binary
//! adds the command line. The libraries under `crates` do the work, and know neither of windows nor
//! of arguments:
//!
//! ```text
//! marraztu_core  <  { marraztu_io, marraztu_render }  <  marraztu_lab  <  marraztu
//! ```
//!
//! * [`marraztu_core`]: scenes, settings of accuracy, and the commands that change a scene.
//! * [`marraztu_io`]: models, textures, scene files and pictures, to and from the disk.
//! * [`marraztu_render`]: from a scene to a picture: plan, geometry, visibility, shading.
//! * [`marraztu_lab`]: what drawing costs in time, and what accuracy costs.

#[cfg(feature = "app")]
pub mod app;
pub mod directions;
pub mod picture_file;
#[cfg(all(feature = "cli", not(target_family = "wasm")))]
pub mod plots;
