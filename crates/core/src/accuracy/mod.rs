//! How exactly a picture is drawn: the axes of accuracy, their choices, and named presets.

mod axes;
mod presets;
mod settings;
mod shot;

pub use axes::{AXES, Axis, AxisKind, Choice, uncapitalized};
pub use presets::{ACCURACY_PRESETS, AccuracyPreset, Points};
pub use settings::*;
pub use shot::Shot;
