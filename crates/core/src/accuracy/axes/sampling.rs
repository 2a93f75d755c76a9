//! The axis of samples per pixel.

use super::sense::{if_any, is_there};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::Samples;

pub(super) const SAMPLES: Axis = Axis {
    key: "samples",
    label: "Samples per pixel",
    phrase: "{} samples per pixel",
    what: "Samples per pixel",
    kind: AxisKind::ScoredApart,
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
    ],
    sense: |scene, view| if_any(scene, view, is_there, "no object is visible"),
    lesson: Lesson {
        title: "Why edges are staircases",
        what: "A pixel is a small square, and an edge may run through it. It can show what its \
            centre sees, or the mean of several samples.",
        coarse: "With one sample, an edge becomes a staircase that crawls as the view moves, and \
            anything narrower than a pixel breaks into dots.",
        shows: "On every outline, most clearly if it is almost horizontal or vertical and the \
            colours on its two sides differ.",
        scene: "ball",
        choice: None,
    },
};
