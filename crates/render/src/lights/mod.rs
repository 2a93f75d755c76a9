//! The table of light kinds.
//!
//! Each kind of light is one file in this folder and a line in each item of this one. Its shader
//! decides when a scene needs it, and computes the reflected light once, generically over
//! [`Real`](super::simd::Real). One kernel adds all lights ([`sum`]). A frame pays only for the
//! lights that it has.
//!
//! Light is computed in view space, for a batch of positions at a time: of pixels, vertices or
//! faces.

mod ambient;
mod batch;
mod bulb;
mod panorama;
mod phong;
pub(crate) mod region;
mod shader;
mod sky;
mod spot;
mod sum;
mod sun;

pub(crate) use batch::{Batch, Rows, Sample, columns, load, set, store, turned};
pub(crate) use phong::{Form, Irradiance, LightTerm, PhongMaterial, ViewLight};
pub(crate) use region::Region;
pub(crate) use shader::LightRow;
pub(crate) use sum::{add_light, set_lights};

use self::batch::Reflected;
use self::shader::LightShader;
use crate::simd::Lanes;
use marraztu_core::scene::LightKind;

/// The shader of a kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    /// Ambient light.
    Ambient,
    /// The sky.
    Sky,
    /// A sky with a panorama.
    Panorama,
    /// A sun.
    Sun,
    /// A bulb.
    Bulb,
    /// A spot.
    Spot,
}

/// The row of ambient light.
pub(crate) static AMBIENT: LightRow = LightRow::of::<ambient::Ambient>();
/// The row of the sky.
pub(crate) static SKY: LightRow = LightRow::of::<sky::Sky>();
/// The row of a sky with a panorama.
pub(crate) static PANORAMA: LightRow = LightRow::of::<panorama::Panorama>();
/// The row of the sun.
pub(crate) static SUN: LightRow = LightRow::of::<sun::Sun>();
/// The row of bulbs.
pub(crate) static BULB: LightRow = LightRow::of::<bulb::Bulb>();
/// The row of spots.
pub(crate) static SPOT: LightRow = LightRow::of::<spot::Spot>();

/// Returns the row of a light.
pub(crate) const fn row_of(kind: &LightKind) -> &'static LightRow {
    match kind {
        LightKind::Ambient => &AMBIENT,
        LightKind::Sky { panorama: Some(_), .. } => &PANORAMA,
        LightKind::Sky { .. } => &SKY,
        LightKind::Sun { .. } => &SUN,
        LightKind::Bulb { .. } => &BULB,
        LightKind::Spot { .. } => &SPOT,
    }
}

/// Computes the light of one light. Its kind is matched for each vector of lanes, where the branch
/// is well predicted.
#[inline(always)]
fn reflected<M: Lanes>(
    lanes: M,
    sample: Sample<M::R>,
    term: &LightTerm<M::Number>,
) -> Option<Reflected<M::R>> {
    match term.which {
        Which::Ambient => ambient::Ambient::shade(lanes, sample, term),
        Which::Sky => sky::Sky::shade(lanes, sample, term),
        Which::Panorama => panorama::Panorama::shade(lanes, sample, term),
        Which::Sun => sun::Sun::shade(lanes, sample, term),
        Which::Bulb => bulb::Bulb::shade(lanes, sample, term),
        Which::Spot => spot::Spot::shade(lanes, sample, term),
    }
}

#[cfg(test)]
mod tests;
