//! The axes of geometry: vertices, subpixels, coverage, interpolation, normals.

use super::sense::{if_any_object, is_any, is_stretched};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::{Coverage, Interpolation, NormalMatrix, Subpixels, VertexArithmetic};
use crate::scene::{Projection, Scene, View};

/// Checks that an object is visible.
fn anything(scene: &Scene, view: &View) -> Result<(), &'static str> {
    if_any_object(scene, view, is_any, "no object is visible")
}

pub(super) const VERTICES: Axis = Axis {
    key: "vertices",
    label: "Vertex arithmetic",
    phrase: "vertices in {}",
    what: "The precision of vertex transforms",
    kind: AxisKind::Scored,
    choices: &[
        choice!("f32" "32 bits" vertices = VertexArithmetic::F32,
            "32-bit numbers for matrices and vertices.",
            "up to 2.5 pixels if the camera is 100,000 from the origin"),
        choice!("f64" "64 bits" vertices = VertexArithmetic::F64,
            "64-bit numbers for matrices and vertices.",
            "none"),
    ],
    sense: anything,
};

pub(super) const SUBPIXELS: Axis = Axis {
    key: "subpixels",
    label: "Subpixel bits",
    phrase: "{} subpixel bits",
    what: "The fraction of a pixel that vertices are snapped to",
    kind: AxisKind::Scored,
    choices: &[
        choice!("bits-0" "0" subpixels = Subpixels::Bits0,
            "Snaps vertices to whole pixels.",
            "12% of the pixels of small triangles show another triangle")
        .slower_because(
            "on whole pixels, the box of every triangle with an area contains a sample and has to \
                be tested",
        ),
        choice!("bits-4" "4" subpixels = Subpixels::Bits4,
            "Snaps vertices to 1/16 pixel.",
            "0.85% of the pixels"),
        choice!("bits-8" "8" subpixels = Subpixels::Bits8,
            "Snaps vertices to 1/256 pixel.",
            "0.052% of the pixels"),
        choice!("bits-12" "12" subpixels = Subpixels::Bits12,
            "Snaps vertices to 1/4096 pixel; all but small triangles then need 64-bit numbers.",
            "0.003% of the pixels"),
    ],
    sense: anything,
};

pub(super) const COVERAGE: Axis = Axis {
    key: "coverage",
    label: "Coverage",
    phrase: "coverage by {}",
    what: "Which pixels a triangle covers",
    kind: AxisKind::Scored,
    choices: &[
        choice!("points" "Points" coverage = Coverage::Points,
            "Ancestor A's fill algorithm: points every 0.1 unit in camera space, each drawn \
                separately.",
            "holes nearer than 97 units; a floor under a level camera vanishes; 17 writes per \
                pixel at a distance of 400")
        .slower_because("most of its points fall on pixels that are already set"),
        choice!("scan-lines" "Scan lines" coverage = Coverage::ScanLines,
            "Ancestor B's fill algorithm: row by row, between edges rounded to whole pixels.",
            "outlines a pixel too wide; every seam is drawn twice")
        .slower_because("it fills each triangle row by row, as its author wrote it"),
        choice!("f32-edges" "32-bit edges" coverage = Coverage::F32Edges,
            "Edge functions in 32-bit floating point, without snapping of vertices.",
            "pixels whose centres lie on an edge are covered twice or, by rounding, not at all"),
        choice!("exact" "Exact" coverage = Coverage::Exact,
            "Edge functions in integers, by the rule of Direct3D and Vulkan.",
            "none except the snapping of vertices"),
    ],
    sense: anything,
};

pub(super) const INTERPOLATION: Axis = Axis {
    key: "interpolation",
    label: "Interpolation",
    phrase: "interpolation {}",
    what: "How vertex attributes are interpolated across a triangle",
    kind: AxisKind::Scored,
    choices: &[
        choice!("affine" "Affine" interpolation = Interpolation::Affine,
            "Linear on the screen, as in ancestor B: no division.",
            "557 texels on a wall from z 2.2 to 100"),
        choice!("perspective" "Perspective" interpolation = Interpolation::Perspective,
            "Perspective-correct at every pixel.",
            "none"),
    ],
    sense: |scene, view| {
        anything(scene, view)?;
        match view.projection {
            Projection::Perspective => Ok(()),
            Projection::Orthographic => Err("an orthographic projection has no perspective"),
        }
    },
};

pub(super) const STRETCHED: Axis = Axis {
    key: "stretched",
    label: "Normal transform",
    phrase: "normals transformed by the object's {}",
    what: "How the normals of a stretched object are transformed",
    kind: AxisKind::Scored,
    choices: &[
        choice!("as-it-is" "Own matrix" stretched = NormalMatrix::AsItIs,
            "By the object's own matrix, as ancestor A did.",
            "up to 79 degrees if an object is stretched tenfold"),
        choice!("cofactor" "Cofactor matrix" stretched = NormalMatrix::Cofactor,
            "By the cofactors of that matrix, which keep normals perpendicular to the surface.",
            "none"),
    ],
    sense: |scene, view| if_any_object(scene, view, is_stretched, "no visible object is stretched"),
};
