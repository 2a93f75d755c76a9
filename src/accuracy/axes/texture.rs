//! The axis of texture filters.

use super::sense::{if_any, is_textured};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::Filter;

pub(super) const FILTER: Axis = Axis {
    key: "filter",
    label: "Texture filter",
    phrase: "{} texture filter",
    what: "How a texture is filtered between its texels",
    kind: AxisKind::Scored,
    choices: &[
        choice!("nearest" "Nearest" filter = Filter::Nearest,
            "The nearest texel.",
            "up to the difference between neighbouring texels"),
        choice!("bilinear" "Bilinear" filter = Filter::Bilinear,
            "A weighted mean of the four nearest texels.",
            "from afar, up to the difference between the texels that a pixel covers"),
        choice!("trilinear" "Trilinear" filter = Filter::Trilinear,
            "A mean of the texels that a pixel covers, from mipmaps.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_textured, "nothing that is shown has a texture"),
    lesson: Lesson {
        title: "Why textures fall into blocks",
        what: "A texture is a grid of colours, and pixels seldom fall on the centre of a texel: \
            the nearest one is taken, or the four around are interpolated.",
        coarse: "With the nearest texel alone, a texture seen from near falls into blocks whose \
            edges jump as the view moves. From afar, without mipmaps, a pixel takes one texel of \
            many and glitters.",
        shows: "Look at a texture from so near that a texel covers many pixels, then from so far \
            that a pixel covers many texels.",
        scene: "plate",
        choice: None,
    },
};
