//! Axes of textures.

use super::sense::{if_any, is_textured};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::Filter;

pub(super) const FILTER: Axis = Axis {
    name: "texture filter",
    key: "filter",
    label: "Textures",
    what: "What a texture gives between its texels",
    kind: AxisKind::Scored,
    choices: &[
        choice!("nearest" "Nearest" filter = Filter::Nearest,
            "The texel that a place falls into.",
            "as much as neighbouring texels differ"),
        choice!("bilinear" "Bilinear" filter = Filter::Bilinear,
            "A mean of the four texels around a place.",
            "from afar as much as the texels that a pixel covers differ"),
        choice!("trilinear" "Trilinear" filter = Filter::Trilinear,
            "A mean of the texels that a pixel covers, from pictures of half the size, a quarter, and so on.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_textured, "nothing that is shown has a texture"),
    lesson: Lesson {
        title: "Why textures fall into blocks",
        what: "A texture is a grid of colours, and pixels seldom fall on the middle of a \
            texel: the nearest one is taken, or the four around are mixed.",
        coarse: "With the nearest texel alone a picture that is seen from near falls into \
            blocks, and its edges jump as the view moves; from afar, with neither, pixels take \
            one texel of many and glitter.",
        shows: "Look at a texture from so near that a texel covers many pixels, then from so far that a \
            pixel covers many texels.",
        scene: "plate",
        choice: None,
    },
};
