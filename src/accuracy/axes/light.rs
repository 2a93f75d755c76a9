//! Axes of light.

use super::sense::{has_even_power, has_several_samples, if_any, is_lit, is_mirroring};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::{Arithmetic, LeaveOut, LightAt, Normalising, SpecularForm, SpecularPower};

pub(super) const SHADING: Axis = Axis {
    name: "shading",
    key: "shading",
    label: "Shading",
    what: "Where light is evaluated",
    kind: AxisKind::Scored,
    choices: &[
        choice!("face" "Flat" light = LightAt::Face,
            "Light is evaluated once a polygon (flat).",
            "whole polygons, by as much as light changes across one"),
        choice!("vertex" "Gouraud" light = LightAt::Vertex,
            "Light is evaluated at vertices (Gouraud).",
            "highlights smaller than a polygon dim or vanish"),
        choice!("pixel" "Phong" light = LightAt::Pixel,
            "Light is evaluated at each pixel (Phong).",
            "none with one sample; with several, highlights narrower than a pixel"),
        choice!("sample" "Per sample" light = LightAt::Sample,
            "Light is evaluated in each place of a pixel that is looked at: a picture for each.",
            "none",
            |_, _| Ok(()), has_several_samples),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
    lesson: Lesson {
        title: "Why Gouraud misses a highlight",
        what: "Light can be worked out once a polygon, once a corner, once a pixel, or in each place \
            of a pixel that is looked at.",
        coarse: "Between corners colours are only mixed, so a highlight that falls inside a \
            polygon is missed, and one on a corner is smeared along its edges.",
        shows: "On the bright spot in the middle of the cushion, which no corner sees: the line of \
            the comparison cuts it in half.",
        scene: "highlight",
        choice: Some("vertex"),
    },
};

pub(super) const ARITHMETIC: Axis = Axis {
    name: "arithmetic of light",
    key: "arithmetic",
    label: "Arithmetic",
    what: "The numbers that light is computed in",
    kind: AxisKind::Scored,
    choices: &[
        choice!("f32" "32 bits" arithmetic = Arithmetic::F32,
            "Light in 32-bit numbers, sixteen at once.",
            "0.008 of a byte step, before rounding"),
        choice!("f64" "64 bits" arithmetic = Arithmetic::F64,
            "Light in 64-bit numbers: the reference, slow.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
    lesson: Lesson {
        title: "What 64 bits add to light",
        what: "Every number is rounded when it is stored: 32 bits keep 7 digits, 64 bits 16.",
        coarse: "The digits that are lost almost never reach the eye: a byte changes only \
            where the exact value lies next to the border between two steps.",
        shows: "Nowhere without help: look at the picture of the error, amplified 256 times.",
        scene: "ball",
        choice: None,
    },
};

pub(super) const POWER: Axis = Axis {
    name: "specular power",
    key: "power",
    label: "Power",
    what: "How the power of a highlight is taken",
    kind: AxisKind::Scored,
    choices: &[
        choice!("schlick" "Schlick" power = SpecularPower::Schlick,
            "Schlick's curve x / (n - n x + x): a model of its own, without any power.",
            "51 byte steps at Ns 76.8: it is another curve"),
        choice!("table-256" "256" power = SpecularPower::Table256,
            "The nearest of 256 powers in a table.",
            "35 byte steps at Ns 76.8"),
        choice!("table-1024" "1024" power = SpecularPower::Table1024,
            "A line between two of 1024 powers in a table.",
            "0.17 of a byte step at Ns 76.8"),
        choice!("polynomial" "Own" power = SpecularPower::Polynomial,
            "Whole exponents to 64 by squaring, others by a polynomial: sixteen at once.",
            "0.001 of a byte step"),
        choice!("squaring" "2^k" power = SpecularPower::Squaring,
            "Exponents that are a power of two by squaring alone.",
            "rounding alone; other exponents as Own",
            |scene, view| if_any(scene, view, has_even_power,
                "no exponent that is shown is a power of two")),
        choice!("library" "libm" power = SpecularPower::Library,
            "The power of the library libm, one at a time: the reference.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_mirroring, "nothing that is shown mirrors light"),
    lesson: Lesson {
        title: "Why quick powers leave rings",
        what: "A highlight is a cosine taken to a power, and no processor has an instruction for \
            that: it is computed, or looked up.",
        coarse: "A table of 256 has steps where the power is steep, which show as rings; Schlick's \
            curve has no power in it and a wider foot.",
        shows: "On the bright spot of the ball: compare 256 and Own, then Schlick.",
        scene: "ball",
        choice: None,
    },
};

pub(super) const NORMALISING: Axis = Axis {
    name: "normalisation",
    key: "normalising",
    label: "Normalisation",
    what: "How vectors are brought to length 1",
    kind: AxisKind::Scored,
    choices: &[
        choice!("rsqrt" "rsqrt" normalising = Normalising::Rsqrt,
            "By the processor's estimate of one by the root. Differs between CPUs.",
            "8 byte steps at Ns 76.8 with AVX2; another number on another CPU"),
        choice!("newton" "rsqrt + Newton step" normalising = Normalising::Newton,
            "By the estimate and one step of Newton's. Differs between CPUs.",
            "0.01 of a byte step at Ns 76.8"),
        choice!("root" "1/sqrt" normalising = Normalising::Root,
            "By one by the root, as exact as the numbers of light are.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
    lesson: Lesson {
        title: "Why quick roots make highlights grainy",
        what: "Directions are brought to length 1 by one by a root; processors have a quick \
            instruction that knows 11 or 14 of its digits.",
        coarse: "With the instruction alone vectors are a little too long or too short, and a \
            power makes much of that: highlights get grainy, on each make of CPU in its own way.",
        shows: "On the bright spot of the ball, in the picture of the error, amplified 16 times.",
        scene: "ball",
        choice: None,
    },
};

pub(super) const FAINT: Axis = Axis {
    name: "faint light",
    key: "faint",
    label: "Faint light",
    what: "What becomes of light too faint to matter",
    kind: AxisKind::Scored,
    choices: &[
        choice!("left-out" "Left out" leave_out = LeaveOut::HalfStep,
            "Light that together adds less than half a step of a byte is not evaluated.",
            "one byte step at the most"),
        choice!("kept" "Kept" leave_out = LeaveOut::Unseen,
            "Only what changes no bit of the picture is left out.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
    lesson: Lesson {
        title: "What becomes of light too faint to see",
        what: "A lamp that is far off, or a highlight at its rim, may add less light than a byte \
            can tell.",
        coarse: "What is left out together adds less than half a step, so that a byte may be \
            rounded the other way: one step at the most.",
        shows: "Nowhere without help: look at the picture of the error, amplified 256 times, where \
            highlights fade out.",
        scene: "ball",
        choice: None,
    },
};

pub(super) const SPECULAR: Axis = Axis {
    name: "specular form",
    key: "specular",
    label: "Highlight",
    what: "The form of the highlight",
    kind: AxisKind::Model,
    choices: &[
        choice!("reflection" "R.V" specular = SpecularForm::Reflection,
            "Phong's highlight: (R.V)^Ns.",
            "a model, not scored"),
        choice!("half-vector" "N.H" specular = SpecularForm::HalfVector,
            "Blinn's highlight: (N.H)^Ns.",
            "a model, not scored"),
    ],
    sense: |scene, view| if_any(scene, view, is_mirroring, "nothing that is shown mirrors light"),
    lesson: Lesson {
        title: "Two shapes of a highlight: R.V and N.H",
        what: "A highlight can be measured from the mirrored light to the eye (R.V), or from \
            the normal to the half-way between light and eye (N.H).",
        coarse: "Neither is an error of the other: with the same exponent N.H is about twice \
            as wide, and it stretches where light grazes.",
        shows: "On the rim of a shiny ball lit from behind, and in the size of every highlight.",
        scene: "ball",
        choice: None,
    },
};
