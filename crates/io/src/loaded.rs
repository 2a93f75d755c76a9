//! Loaded models, and how options place them.

use rayon::prelude::*;

use super::findings::Finding;
use marraztu_core::scene::{LoadOptions, Model, Scale, UpAxis, Winding};

/// A model with the findings from its files.
#[derive(Debug)]
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// Everything that was repaired, left out or odd.
    pub findings: Vec<Finding>,
}

/// Returns the options that change positions and normals.
pub(super) const fn placement(options: &LoadOptions) -> (UpAxis, Scale, Winding) {
    (options.up, options.scale, options.winding)
}

/// Rotates and scales the positions and normals of a file as requested.
pub(super) fn place(positions: &mut [[f64; 3]], normals: &mut [[f32; 3]], options: &LoadOptions) {
    let LoadOptions { up, scale, .. } = options;
    let turned = options.winding == Winding::Turned;
    positions.par_iter_mut().for_each(|row| *row = up.upright(*row).map(|x| x * scale.get()));
    let normal = |row: [f32; 3]| up.upright(row.map(|x| if turned { -x } else { x }));
    normals.par_iter_mut().for_each(|row| *row = normal(*row));
}
