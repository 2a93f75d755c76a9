//! The axis of transparency.

use super::sense::{if_any, is_transparent};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::Transparency;

pub(super) const TRANSPARENCY: Axis = Axis {
    key: "transparency",
    label: "Transparency",
    phrase: "transparency ({})",
    what: "How transparent surfaces are laid over each other",
    kind: AxisKind::Scored,
    choices: &[
        choice!("threshold" "Threshold" transparency = Transparency::Threshold,
            "What is less than half opaque is not drawn, everything else is opaque.",
            "all of what is seen through a surface, or all of the surface"),
        choice!("weighted" "Weighted mean" transparency = Transparency::Weighted,
            "A mean of all layers, weighted by opacity and nearness (McGuire and Bavoil, 2013).",
            "none for one layer; with more, up to the difference between their colours")
        .slower_because("all layers of a pixel are listed for it, too, and each is weighted"),
        choice!("objects" "By object" transparency = Transparency::Objects,
            "Object by object, the farthest first, and in each triangle by triangle.",
            "where objects cut through each other, or one is in front of itself, the wrong order")
        .slower_because("all layers of a pixel are listed and sorted for it, too"),
        choice!("exact" "By pixel" transparency = Transparency::Exact,
            "Pixel by pixel, the farthest first.",
            "none"),
    ],
    sense: |scene, view| {
        if_any(scene, view, is_transparent, "nothing that is shown is transparent")
    },
    lesson: Lesson {
        title: "Why glass comes out in the wrong order",
        what: "What is seen through a surface has to be drawn before it. At each pixel that is \
            another order, and two panes that cut through each other change places.",
        coarse: "Object by object, a pane is wholly before or wholly behind another. A weighted \
            mean has no order at all. A threshold knows no glass.",
        shows: "On two panes that cut through each other before a tiled wall: by object, the line \
            where they meet is missing.",
        scene: "panes",
        choice: Some("objects"),
    },
};
