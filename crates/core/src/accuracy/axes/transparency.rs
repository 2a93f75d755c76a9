//! The axis of transparency.

use super::sense::{if_any, is_transparent};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::Transparency;

pub(super) const TRANSPARENCY: Axis = Axis {
    key: "transparency",
    label: "Transparency",
    phrase: "transparency ({})",
    what: "How transparent surfaces are blended",
    kind: AxisKind::Scored,
    choices: &[
        choice!("threshold" "Threshold" transparency = Transparency::Threshold,
            "Surfaces that are less than half opaque are not drawn, others are opaque.",
            "everything behind a surface, or the whole surface, is missing"),
        choice!("objects" "By object" transparency = Transparency::Objects,
            "Object by object, the farthest first; each object triangle by triangle.",
            "the wrong order if objects intersect, or if one overlaps itself")
        .slower_because("it also lists and sorts all layers of a pixel"),
        choice!("exact" "By pixel" transparency = Transparency::Exact,
            "Pixel by pixel, the farthest first.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_transparent, "no visible surface is transparent"),
};
