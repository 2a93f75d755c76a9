//! Axes of pixels.

use super::sense::{if_any, if_any_object, is_any, is_lit};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::{DepthFormat, Rounding};

pub(super) const DEPTH: Axis = Axis {
    name: "depth",
    key: "depth",
    label: "Depth",
    what: "How depths are kept",
    kind: AxisKind::Scored,
    choices: &[
        choice!("bits-16" "16 bits" depth = DepthFormat::Bits16,
            "Whole numbers of 16 bits, one pixel after the other.",
            "15.3 units at z 1000, between near 1 and far 2000"),
        choice!("bits-24" "24 bits" depth = DepthFormat::Bits24,
            "Whole numbers of 24 bits, one pixel after the other.",
            "0.060 units at z 1000"),
        choice!("f32" "32 bits" depth = DepthFormat::F32,
            "32-bit numbers with 0 at the near plane, one pixel after the other.",
            "0.060 units at z 1000: the fine steps are where nothing is"),
        choice!("f32-reversed" "Reversed depth" depth = DepthFormat::F32Reversed,
            "32-bit numbers with 0 at the far plane.",
            "0.000058 units at z 1000"),
    ],
    sense: |scene, view| if_any_object(scene, view, is_any, "nothing is shown"),
    lesson: Lesson {
        title: "Why surfaces show through each other",
        what: "Which surface is in front is decided by a depth that is kept for every pixel, and \
            perspective leaves few of its steps for what is far.",
        coarse: "Where two surfaces are nearer to each other than a step, one shows through the other in \
            stripes that crawl as the view moves.",
        shows: "On two plates that lean against each other 1000 away: with 16 bits where they meet is \
            anybody's guess.",
        scene: "fence",
        choice: None,
    },
};

pub(super) const ROUNDING: Axis = Axis {
    name: "rounding",
    key: "rounding",
    label: "Rounding",
    what: "How colours become bytes",
    kind: AxisKind::Scored,
    choices: &[
        choice!("truncated" "Truncate" rounding = Rounding::Truncated,
            "What is behind the point is cut off, as ancestor A did.",
            "one byte step; half a step too dark on average"),
        choice!("dithered" "Dither" rounding = Rounding::Dithered,
            "Up or down by Bayer's pattern of 8 x 8 pixels.",
            "one byte step; none on average"),
        choice!("nearest" "Nearest" rounding = Rounding::Nearest,
            "To the nearest byte.",
            "half a step, which no byte can better"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
    lesson: Lesson {
        title: "Why dim walls fall into bands",
        what: "A colour has many digits and a byte has 256 steps: what is between two steps is cut off, \
            rounded, or shared out among neighbours by a pattern.",
        coarse: "Truncated, every colour is half a step too dark; without a pattern a slow change falls \
            into bands.",
        shows: "On a wall in dim light: bands with Nearest, none with Dither when it is looked at from \
            afar.",
        scene: "dusk",
        choice: None,
    },
};
