//! The axes of textures and bumps.

use super::sense::{has_bumps, if_any, is_textured};
use super::{Axis, AxisKind, Choice};
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
            "A mean of the texels that a pixel covers, from mipmaps. Blurs surfaces seen edge-on.",
            "on a surface seen edge-on, up to the difference between the texels of a square as \
             wide as the pixel's longer side on it"),
        choice!("anisotropic" "Anisotropic" filter = Filter::Anisotropic,
            "Up to 16 trilinear samples along the longer side of the pixel on the texture.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_textured, "no visible surface has a texture"),
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
};
