//! Controls that panels are made of. They do not depend on the edited scene.

pub(crate) mod color_picker;
pub(crate) mod controls;
pub(crate) mod expression;
pub mod gestures;
pub(crate) mod icons;
pub(crate) mod mixed;
pub(crate) mod number;
pub(crate) mod plate;
pub(crate) mod regions;
pub(crate) mod spheres;
pub(crate) mod text;
pub(crate) mod tooltips;
