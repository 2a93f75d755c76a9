//! The axes of samples: how many a pixel has, and how many pixels are drawn.

use super::sense::{if_any, is_there};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::{Resolution, Samples};

pub(super) const SAMPLES: Axis = Axis {
    key: "samples",
    label: "Samples per pixel",
    phrase: "{} samples per pixel",
    what: "Samples per pixel",
    kind: AxisKind::Scored,
    choices: &[
        choice!("1" "1" samples = Samples::One,
            "One sample, at the pixel's centre.",
            "on edges, about a quarter of the difference between the two sides"),
        choice!("4" "4" samples = Samples::Four,
            "The mean of four samples per pixel.",
            "on edges, about a tenth of the difference between the two sides"),
        choice!("16" "16" samples = Samples::Sixteen,
            "The mean of sixteen samples per pixel.",
            "on edges, about a thirtieth of the difference between the two sides"),
        choice!("64" "64" samples = Samples::SixtyFour,
            "The mean of sixty-four samples per pixel: slow.",
            "on edges, about a hundredth of the difference between the two sides"),
        choice!("256" "256" samples = Samples::TwoFiftySix,
            "The mean of 256 samples per pixel: very slow.",
            "none: the ideal"),
    ],
    sense: |scene, view| if_any(scene, view, is_there, "no object is visible"),
};

pub(super) const RESOLUTION: Axis = Axis {
    key: "resolution",
    label: "Resolution",
    phrase: "{} resolution",
    what: "The part of the pixels that is drawn",
    kind: AxisKind::Scored,
    choices: &[
        choice!("half" "Half" resolution = Resolution::Half,
            "Draws half of the width and height, and enlarges it with bilinear interpolation.",
            "on edges and in textures, up to the difference between neighbouring pixels"),
        choice!("full" "Full" resolution = Resolution::Full,
            "Draws every pixel.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_there, "no object is visible"),
};
