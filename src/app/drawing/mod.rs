//! The thread that draws the pictures of the viewport, and how exactly it draws while the user
//! waits.

pub(crate) mod adaptive_quality;
pub(crate) mod border;
pub(crate) mod snapshot;
pub(crate) mod viewport_renderer;
pub(crate) mod worker;
