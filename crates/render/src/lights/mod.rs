//! The table of light kinds.
//!
//! Each kind of light is one file in this folder and one row of [`LIGHT_SHADERS`]. Its shader
//! decides when a scene needs it, and computes the reflected light once, generically over
//! [`Real`](super::simd::Real). The row holds the compiled variants. A frame pays only for the
//! lights that it has.
//!
//! Light is computed in view space, for a batch of positions at a time: of pixels, vertices or
//! faces.

mod ambient;
mod batch;
mod bulb;
mod phong;
pub(crate) mod region;
mod shader;
mod spot;
mod sun;
mod together;

pub use batch::{Batch, Reflected, Sample};
pub(crate) use batch::{Rows, columns, load, set, store, turned};
pub use phong::{
    Form, HalfVector, Highlight, LightTerm, Nothing, PhongMaterial, Reflection, ViewLight,
};
pub use region::Region;
pub use shader::{Light, LightRow, LightShader, Variant, Which};
pub(crate) use together::Together;

use marraztu_core::scene::LightKind;

/// The row of ambient light.
pub static AMBIENT: LightRow = LightRow::of::<ambient::Ambient>();
/// The row of the sun.
pub static SUN: LightRow = LightRow::of::<sun::Sun>();
/// The row of bulbs.
pub static BULB: LightRow = LightRow::of::<bulb::Bulb>();
/// The row of spots.
pub static SPOT: LightRow = LightRow::of::<spot::Spot>();

/// Every kind of light.
pub static LIGHT_SHADERS: &[&LightRow] = &[&AMBIENT, &SUN, &BULB, &SPOT];

/// Returns the row of a light.
#[must_use]
pub const fn row_of(kind: &LightKind) -> &'static LightRow {
    match kind {
        LightKind::Ambient => &AMBIENT,
        LightKind::Sun { .. } => &SUN,
        LightKind::Bulb { .. } => &BULB,
        LightKind::Spot { .. } => &SPOT,
    }
}

#[cfg(test)]
mod tests;
