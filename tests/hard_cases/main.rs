//! The hard cases, numbered: inputs at which renderers and editors commonly fail. Each case also
//! measures a naive program.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]
#![expect(clippy::print_stdout, reason = "what was measured is shown")]
#![allow(clippy::cast_possible_truncation, reason = "small numbers, and roundings that are meant")]
#![allow(clippy::cast_precision_loss, reason = "small numbers, and roundings that are meant")]
#![allow(clippy::cast_sign_loss, reason = "small numbers")]

#[path = "../proofs/claims/mod.rs"]
mod claims;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/plates.rs"]
mod plates;

mod cases;
mod figures;
mod judges;
mod oracle;

mod camera;
mod clipping;
mod color;
mod coverage;
mod depth;
mod files_and_scale;
mod geometry;
mod interpolation;
mod light;
mod shadow_maps;
mod shadows;
mod surfaces;
mod textures;
mod transparency;
mod undo;

use marraztu_core::accuracy::Filter;

/// Every texture filter.
const FILTERS: [Filter; 4] =
    [Filter::Nearest, Filter::Bilinear, Filter::Trilinear, Filter::Anisotropic];
