//! The axes of textures and bumps.

use super::sense::{has_bumps, if_any, is_textured};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::{BumpFilter, Filter, Tangents};

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
    sense: |scene, view| if_any(scene, view, is_textured, "no visible surface has a texture"),
    lesson: Lesson {
        title: "Why textures fall into blocks",
        what: "A texture is a grid of colours, and pixels seldom fall on the centre of a texel: \
            the nearest one is taken, or the four around are interpolated.",
        coarse: "With only the nearest texel, a texture breaks into blocks when seen up close, \
            and their edges jump as the view moves. From afar, without mipmaps, a pixel takes one \
            texel of many and glitters.",
        shows: "Look at a texture from close up, so that a texel covers many pixels, then from \
            far away, so that a pixel covers many texels.",
        scene: "plate",
        choice: None,
    },
};

pub(super) const BUMPS: Axis = Axis {
    key: "bumps",
    label: "Bump filter",
    phrase: "{} bump filter",
    what: "How height and normal maps are filtered",
    kind: AxisKind::Scored,
    choices: &[
        choice!("nearest" "Nearest" bump_filter = BumpFilter::Nearest,
            "The nearest texel: one height or normal per texel.",
            "up to the difference between neighbouring texels"),
        choice!("trilinear" "Trilinear" bump_filter = BumpFilter::Trilinear,
            "A mean of the texels that a pixel covers, from mipmaps.",
            "from afar, the roughness that is lost in the mean"),
    ],
    sense: |scene, view| if_any(scene, view, has_bumps, "no visible surface has bumps"),
    lesson: Lesson {
        title: "Why bumps glitter from afar",
        what: "A bump map is read like a texture, but changes the direction of normals: a small \
            difference between texels can switch a highlight on.",
        coarse: "With the nearest texel, bumps fall into facets from near. From afar a pixel \
            takes one slope of many, and glitters as the view moves.",
        shows: "On the flanks of the dimples, and where the grooves are finer than a pixel.",
        scene: "dimples",
        choice: None,
    },
};

pub(super) const TANGENTS: Axis = Axis {
    key: "tangents",
    label: "Tangents",
    phrase: "tangents at each {}",
    what: "How tangents for bumps are computed",
    kind: AxisKind::Model,
    choices: &[
        choice!("pixel" "Pixel" tangents = Tangents::Pixel,
            "The gradients of the texture coordinates on the triangle, at each pixel.",
            "a model, not scored"),
        choice!("vertex" "Vertex" tangents = Tangents::Vertex,
            "MikkTSpace at vertices, interpolated: the convention of normal maps.",
            "a model, not scored"),
    ],
    sense: |scene, view| if_any(scene, view, has_bumps, "no visible surface has bumps"),
    lesson: Lesson {
        title: "Which tangents a bump follows",
        what: "A bump leans along the texture's axes, which have a direction on each triangle. \
            MikkTSpace averages it at vertices and interpolates; without that, each triangle \
            uses its own.",
        coarse: "Neither is an error of the other: a normal map is right with the tangents that \
            it was made for. With tangents per triangle, bumps may kink along the edges of a \
            coarse mesh.",
        shows: "Along the edges of the polygons near the poles of the ball.",
        scene: "dimples",
        choice: Some("pixel"),
    },
};
