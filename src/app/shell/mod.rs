//! The shells: the layer between the editor and the system. The editor does not depend on them.
//!
//! ```text
//! desktop    windows of a desktop, painted with OpenGL or on the CPU
//! canvas     an array of pixels, which a page of a browser shows
//! ```

mod canvas;
#[cfg(feature = "desktop")]
mod desktop;

pub use canvas::{CanvasShell, Painted};
#[cfg(feature = "desktop")]
pub use desktop::{Shell, StartError};
#[cfg(feature = "desktop")]
pub(crate) use desktop::{find_display, run};

/// The longest side of a texture where the CPU paints: windows and pictures are smaller.
const LONGEST_SIDE: usize = 1 << 14;
