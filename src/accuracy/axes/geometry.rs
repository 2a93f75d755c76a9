//! Axes of where things are and how they are turned.

use super::sense::{if_any_object, is_any, is_stretched};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::{Coverage, Interpolation, NormalMatrix, Subpixels, VertexArithmetic};
use crate::scene::{Projection, Scene, View};

/// Whether something is shown.
fn anything(scene: &Scene, view: &View) -> Result<(), &'static str> {
    if_any_object(scene, view, is_any, "nothing is shown")
}

pub(super) const VERTICES: Axis = Axis {
    name: "arithmetic of vertices",
    key: "vertices",
    label: "Vertices",
    what: "The numbers that vertices are placed in",
    kind: AxisKind::Scored,
    choices: &[
        choice!("f32" "32 bits" vertices = VertexArithmetic::F32,
            "Matrices and vertices in 32-bit numbers.",
            "up to 2.5 pixels where the camera is 100,000 from the origin"),
        choice!("f32-composed-in-f64" "Mixed" vertices = VertexArithmetic::F32ComposedInF64,
            "Matrices are multiplied in 64-bit numbers, vertices by them in 32.",
            "0.00014 of a pixel, which snaps one corner of fifty elsewhere"),
        choice!("f64" "64 bits" vertices = VertexArithmetic::F64,
            "Matrices and vertices in 64-bit numbers.",
            "none"),
    ],
    sense: anything,
    lesson: Lesson {
        title: "Why scenes far from the origin tremble",
        what: "A place far from the origin uses its digits up for being far; what is left of them says \
            where in the picture it is.",
        coarse: "In 32 bits the way from the camera is the difference of two numbers with few digits left, \
            so far from the origin things stand beside their places and tremble as the view moves.",
        shows: "On a ball that lies 5,000,000 from the origin, as does the camera: compare 32 bits and 64, \
            then move.",
        scene: "far",
        choice: None,
    },
};

pub(super) const SUBPIXELS: Axis = Axis {
    name: "subpixel bits",
    key: "subpixels",
    label: "Subpixels",
    what: "Which parts of a pixel corners are snapped to",
    kind: AxisKind::Scored,
    choices: &[
        choice!("bits-0" "0" subpixels = Subpixels::Bits0,
            "Corners lie on whole pixels.",
            "12 of 100 pixels of small triangles show another one"),
        choice!("bits-4" "4" subpixels = Subpixels::Bits4,
            "Corners lie on sixteenths of a pixel.",
            "0.85 of 100 pixels"),
        choice!("bits-8" "8" subpixels = Subpixels::Bits8,
            "Corners lie on 1/256 of a pixel.",
            "0.052 of 100 pixels"),
        choice!("bits-12" "12" subpixels = Subpixels::Bits12,
            "Corners lie on 1/4096 of a pixel. Drawn one pixel after the other, so its time says nothing.",
            "0.003 of 100 pixels"),
    ],
    sense: anything,
    lesson: Lesson {
        title: "Why thin spokes break into steps",
        what: "Which pixels a triangle covers is settled in whole numbers, so its corners are first put \
            on a grid of parts of a pixel.",
        coarse: "On a coarse grid small triangles change their shape, thin ones vanish, and things that \
            move slowly jump from pixel to pixel.",
        shows: "On the thin spokes of the wheel: with 0 bits they break into steps.",
        scene: "wheel",
        choice: None,
    },
};

pub(super) const COVERAGE: Axis = Axis {
    name: "coverage",
    key: "coverage",
    label: "Coverage",
    what: "Which pixels a triangle covers",
    kind: AxisKind::Scored,
    choices: &[
        choice!("points" "Points" coverage = Coverage::Points,
            "Ancestor A's way: points every 0.1 unit of the observer's space, each drawn by itself.",
            "holes nearer than 97; 17 writes a pixel at distance 400, 100 at 966"),
        choice!("scan-lines" "Scan lines" coverage = Coverage::ScanLines,
            "Ancestor B's way: rows between edges that are rounded to whole pixels.",
            "outlines a pixel too wide, and every seam written twice"),
        choice!("f32-edges" "32 bits" coverage = Coverage::F32Edges,
            "Edge functions of 32-bit numbers, one pixel after the other.",
            "centres on an edge are covered twice, or by rounding not at all"),
        choice!("exact" "Exact" coverage = Coverage::Exact,
            "Edge functions of whole numbers, by the rule of Direct3D and Vulkan.",
            "none but the snapping of corners"),
    ],
    sense: anything,
    lesson: Lesson {
        title: "Why points leave holes",
        what: "A triangle covers the pixels whose centres lie inside, and of a centre on the edge of two \
            triangles exactly one has to have it.",
        coarse: "Points leave holes where they are seen from near and cost a hundred writes a pixel from \
            afar; rounded rows make everything a little too large.",
        shows: "On the ball that is close to the eye: choose Points and look through it.",
        scene: "near",
        choice: None,
    },
};

pub(super) const INTERPOLATION: Axis = Axis {
    name: "interpolation",
    key: "interpolation",
    label: "Interpolation",
    what: "How what corners carry gets to pixels",
    kind: AxisKind::Scored,
    choices: &[
        choice!("affine" "Affine" interpolation = Interpolation::Affine,
            "Evenly on the screen, as ancestor B did: one pixel after the other.",
            "557 texels on a wall from z 2.2 to 100"),
        choice!("every-sixteen" "Every 16" interpolation = Interpolation::EverySixteen,
            "With perspective at every sixteenth pixel of a row, evenly between: as games of 1996 did.",
            "33 texels on the same wall"),
        choice!("perspective" "Exact" interpolation = Interpolation::Perspective,
            "With perspective at every pixel.",
            "none"),
    ],
    sense: |scene, view| {
        anything(scene, view)?;
        match view.projection {
            Projection::Perspective => Ok(()),
            Projection::Orthographic => Err("parallel projection has no perspective"),
        }
    },
    lesson: Lesson {
        title: "Why textures bend and swim",
        what: "A step to the next pixel is a longer way on a surface that is farther off, so what corners \
            carry has to be divided by their distance before it is mixed.",
        coarse: "Mixed evenly, a texture bends along the diagonal of every square and swims when the view \
            moves.",
        shows: "On a long floor that is laid with pictures: compare Affine and Exact.",
        scene: "floor",
        choice: None,
    },
};

pub(super) const STRETCHED: Axis = Axis {
    name: "normal transform",
    key: "stretched",
    label: "Normal transform",
    what: "How the normals of a stretched object are placed",
    kind: AxisKind::Scored,
    choices: &[
        choice!("as-it-is" "As it is" stretched = NormalMatrix::AsItIs,
            "By the matrix that places the object: history.",
            "up to 79 degrees where an object is stretched 1 to 10"),
        choice!("cofactor" "Cofactor" stretched = NormalMatrix::Cofactor,
            "By the cofactors of that matrix, which keep normals across the surface.",
            "none"),
    ],
    sense: |scene, view| {
        if_any_object(scene, view, is_stretched, "nothing that is shown is stretched")
    },
    lesson: Lesson {
        title: "Why stretched things are lit wrongly",
        what: "A normal stands across its surface, and a stretched surface leans the other way than a \
            stretched arrow would: normals need a matrix of their own.",
        coarse: "Tracked by the object's own matrix, normals lean with the stretch, and light falls on \
            a flat thing as if it were long.",
        shows: "On a ball that is pressed flat: compare its upper side with As it is and with Cofactor.",
        scene: "pressed",
        choice: None,
    },
};
