//! In how many places of a pixel it is asked what is seen.

use super::sense::{if_any, is_there};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::Samples;

pub(super) const SAMPLES: Axis = Axis {
    name: "samples a pixel",
    key: "samples",
    label: "Samples",
    what: "In how many places of a pixel it is asked what is seen",
    kind: AxisKind::ScoredApart,
    choices: &[
        choice!("1" "1" samples = Samples::One,
            "A pixel shows what its middle shows.",
            "on edges, about a quarter of the difference between both sides"),
        choice!("4" "4" samples = Samples::Four,
            "A pixel is the mean of what four places of it show.",
            "on edges, about a tenth of the difference between both sides"),
        choice!("16" "16" samples = Samples::Sixteen,
            "A pixel is the mean of what sixteen places of it show.",
            "on edges, about a thirtieth of the difference between both sides"),
        choice!("64" "64" samples = Samples::SixtyFour,
            "A pixel is the mean of what sixty-four places of it show: the reference, slow.",
            "on edges, about a hundredth of the difference between both sides"),
    ],
    sense: |scene, view| if_any(scene, view, is_there, "nothing is shown"),
    lesson: Lesson {
        title: "Why edges are staircases",
        what: "A pixel is a small square, and an edge may run through it: it can show what is seen in \
            its middle, or the mean of what is seen in several places of it.",
        coarse: "With the middle alone an edge becomes a staircase that crawls when the view moves, \
            and what is narrower than a pixel breaks into dots.",
        shows: "On every outline, most where it is almost level or almost upright, and where the \
            colours on both sides differ.",
        scene: "ball",
        choice: None,
    },
};
