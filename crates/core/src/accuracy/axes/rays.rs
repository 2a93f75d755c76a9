//! The axis of rays: how often they are mirrored or refracted.

use super::sense::{asks_for_rays, if_any};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::Bounces;

pub(super) const BOUNCES: Axis = Axis {
    key: "bounces",
    label: "Bounces",
    phrase: "{} bounces",
    what: "How often a ray is mirrored or refracted",
    kind: AxisKind::Scored,
    choices: &[
        choice!("0" "0" bounces = Bounces::None,
            "Never: mirrors are dull, and glass is black.",
            "everything that mirrors and glass show"),
        choice!("1" "1" bounces = Bounces::One,
            "Once: a mirror shows other mirrors dull, and a glass body shows its own inside.",
            "what is seen through glass, and mirrors in mirrors"),
        choice!("2" "2" bounces = Bounces::Two,
            "Twice: enough to see through one glass body.",
            "mirrors in mirrors in mirrors, and glass behind glass"),
        choice!("4" "4" bounces = Bounces::Four,
            "Four times (Whitted, 1980).",
            "light that is mirrored inside of glass, and rows of mirrors"),
        choice!("8" "8" bounces = Bounces::Eight,
            "Eight times.",
            "what is mirrored more often"),
    ],
    sense: |scene, view| {
        if_any(scene, view, asks_for_rays, "no visible surface mirrors or refracts")
    },
};
