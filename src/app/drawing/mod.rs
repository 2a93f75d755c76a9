//! Drawing: the thread that draws the pictures of the viewport, and its adaptive quality.

pub(crate) mod adaptive_quality;
pub(crate) mod border;
pub(crate) mod dial;
pub(crate) mod images;
pub(crate) mod motion;
pub(crate) mod painted;
pub(crate) mod reduction;
pub(crate) mod refinement;
pub(crate) mod snapshot;
pub(crate) mod viewport_renderer;
pub(crate) mod worker;
