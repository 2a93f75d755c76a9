//! The space of accuracy: what settings choose, and what is known of each choice.

mod axes;
mod presets;
mod settings;
mod shot;

pub use axes::{AXES, Axis, AxisKind, Choice, Lesson};
pub use presets::{ACCURACY_PRESETS, AccuracyPreset};
pub use settings::{
    Arithmetic, Coverage, DepthFormat, Filter, Interpolation, LeaveOut, LightAt, NormalMatrix,
    Normalising, Rounding, Samples, Settings, SpecularForm, SpecularPower, Subpixels,
    VertexArithmetic,
};
pub use shot::Shot;
