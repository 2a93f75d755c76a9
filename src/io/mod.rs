//! Models, textures, scene files and pictures, to and from the disk.
//!
//! What is read was written by others: nothing in it may stop the program. A file is either refused
//! with one reason, or loaded with a list of what was mended in it.

mod assets;
mod error;
mod findings;
mod locate;
mod mtl;
mod obj;
mod progress;
mod texture;

pub use assets::{cam_model, default_scene, own_model};
pub use error::LoadError;
pub use findings::{Finding, FindingKind};
pub use obj::{Loaded, load, parse};
pub use progress::{Cancelled, Progress};
pub use texture::{load_picture, load_texture};
