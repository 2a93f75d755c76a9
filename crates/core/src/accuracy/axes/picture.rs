//! The axes of values stored per pixel: depth and rounding.

use super::sense::{if_any, if_any_object, is_any, is_lit};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::{DepthFormat, Rounding};

pub(super) const DEPTH: Axis = Axis {
    key: "depth",
    label: "Depth",
    phrase: "depth in {}",
    what: "How depths are stored",
    kind: AxisKind::Scored,
    choices: &[
        choice!("bits-16" "16 bits" depth = DepthFormat::Bits16,
            "16-bit integers.",
            "15.3 units at z 1000, between near 1 and far 2000"),
        choice!("bits-24" "24 bits" depth = DepthFormat::Bits24,
            "24-bit integers.",
            "0.060 units at z 1000")
        .slower_because("depths are rounded to integers"),
        choice!("f32" "32 bits" depth = DepthFormat::F32,
            "32-bit floating point with 0 at the near plane.",
            "0.060 units at z 1000: the fine steps are all near the camera"),
        choice!("f32-reversed" "Reversed depth" depth = DepthFormat::F32Reversed,
            "32-bit floating point with 0 at the far plane.",
            "0.000058 units at z 1000"),
    ],
    sense: |scene, view| if_any_object(scene, view, is_any, "no object is visible"),
};

pub(super) const ROUNDING: Axis = Axis {
    key: "rounding",
    label: "Rounding",
    phrase: "rounding ({})",
    what: "How colours become bytes",
    kind: AxisKind::Scored,
    choices: &[
        choice!("truncated" "Truncate" rounding = Rounding::Truncated,
            "Rounds down, as ancestor A did.",
            "one byte step; half a step too dark on average"),
        choice!("dithered" "Dither" rounding = Rounding::Dithered,
            "Rounds up or down by Bayer's pattern of 8 x 8 pixels.",
            "one byte step; none on average"),
        choice!("nearest" "Nearest" rounding = Rounding::Nearest,
            "Rounds to the nearest byte.",
            "half a step, the smallest possible with bytes"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "no visible surface is lit"),
};
