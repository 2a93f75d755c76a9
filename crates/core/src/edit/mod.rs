//! Decides which command makes a change of the scene, and keeps the history of changes.
//!
//! Everything here except [`History`] only decides: it reads a scene and a view, and returns a
//! [`Command`](crate::scene::Command), a view, or a [`Refusal`] for the status line. Only
//! [`History`] writes a scene.

pub mod aiming;
pub mod angles;
pub mod arrange;
pub mod copies;
pub mod framing;
mod free_place;
mod gesture;
pub mod gizmo;
mod history;
pub mod items;
pub mod lighting;
pub mod lights;
pub mod motion;
mod names;
pub mod navigation;
pub mod near_plane;
pub mod placement;
pub mod places;
pub mod presenting;
mod refusal;
mod selected;
pub mod selection;
mod set_transform;
pub mod several;
pub mod shapes;
pub mod steps;
mod surfaces;
pub mod transform;
pub mod turntable;
mod viewpoint;

pub use gesture::{Gesture, GesturePhase};
pub use history::History;
pub use refusal::{Change, Refusal};
pub use selected::Selected;
pub use viewpoint::Viewpoint;
