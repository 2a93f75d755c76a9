//! The axes of light: shading, arithmetic, powers, highlights.

use super::sense::{has_several_samples, if_any, is_lit, is_mirroring, is_there};
use super::{Axis, AxisKind, Choice, Lesson};
use crate::accuracy::{Arithmetic, LightAt, LightValues, SpecularForm, SpecularPower};

pub(super) const SHADING: Axis = Axis {
    key: "shading",
    label: "Shading",
    phrase: "{} shading",
    what: "Where light is evaluated",
    kind: AxisKind::Scored,
    choices: &[
        choice!("face" "Flat" light = LightAt::Face,
            "Light is evaluated once per polygon (flat).",
            "whole polygons, by as much as light changes across one"),
        choice!("vertex" "Gouraud" light = LightAt::Vertex,
            "Light is evaluated at vertices (Gouraud).",
            "highlights smaller than a polygon dim or vanish")
        .slower_because(
            "every visible vertex is lit, and here there are fewer pixels than vertices",
        ),
        choice!("pixel" "Phong" light = LightAt::Pixel,
            "Light is evaluated at each pixel (Phong).",
            "none with one sample; with several, highlights narrower than a pixel"),
        choice!("sample" "Per sample" light = LightAt::Sample,
            "Light is evaluated at every sample: as slow as one picture per sample.",
            "none",
            |_, _| Ok(()), has_several_samples),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "no visible surface is lit"),
    lesson: Lesson {
        title: "Why Gouraud misses a highlight",
        what: "Light can be computed once per polygon, per vertex, per pixel, or per sample of a \
            pixel.",
        coarse: "Between vertices, colours are only interpolated: a highlight inside a polygon is \
            missed, and one at a vertex is smeared along the edges.",
        shows: "On the bright spot in the middle of the cushion, where there is no vertex: the \
            line of the comparison cuts it in half.",
        scene: "highlight",
        choice: Some("vertex"),
    },
};

pub(super) const ARITHMETIC: Axis = Axis {
    key: "arithmetic",
    label: "Light arithmetic",
    phrase: "light in {}",
    what: "The precision of lighting",
    kind: AxisKind::Scored,
    choices: &[
        choice!("f32" "32 bits" arithmetic = Arithmetic::F32,
            "Light in 32-bit numbers, sixteen at once.",
            "0.008 of a byte step, before rounding"),
        choice!("f64" "64 bits" arithmetic = Arithmetic::F64,
            "Light in 64-bit numbers: the reference, slow.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "no visible surface is lit"),
    lesson: Lesson {
        title: "What 64 bits add to light",
        what: "Every number is rounded when it is stored: 32 bits keep 7 digits, 64 bits 16.",
        coarse: "The lost digits are almost never visible. They are if a large distance swallows \
            the digits of a small one: 500,000 units from the camera, positions are only known to \
            1/32 of a unit.",
        shows: "On a plate seen through a telescope, one unit below a lamp: its light falls into \
            stripes.",
        scene: "telescope",
        choice: None,
    },
};

pub(super) const POWER: Axis = Axis {
    key: "power",
    label: "Specular power",
    phrase: "specular power by {}",
    what: "How the power of a highlight is computed",
    kind: AxisKind::Scored,
    choices: &[
        choice!("schlick" "Schlick" power = SpecularPower::Schlick,
            "Schlick's approximation x / (n - n x + x), which needs no power.",
            "51 byte steps at Ns 76.8: the curve has another shape")
        .slower_because("its curve falls off so slowly that more pixels have a highlight"),
        choice!("polynomial" "Polynomial" power = SpecularPower::Polynomial,
            "Repeated squaring for whole exponents up to 64, a polynomial for others: sixteen at \
                once.",
            "0.001 of a byte step"),
        choice!("library" "libm" power = SpecularPower::Library,
            "The power function of libm, one at a time: the reference.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_mirroring, "no visible surface has a highlight"),
    lesson: Lesson {
        title: "Why quick powers widen a highlight",
        what: "A highlight is a cosine raised to a power. No processor has an instruction for \
            that, so it is computed by a formula.",
        coarse: "Schlick's approximation needs one division, but gives a highlight that fades out \
            more slowly.",
        shows: "On the bright spot of the ball: compare Schlick with Polynomial.",
        scene: "ball",
        choice: None,
    },
};

pub(super) const SPECULAR: Axis = Axis {
    key: "specular",
    label: "Specular form",
    phrase: "highlights by {}",
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
    sense: |scene, view| if_any(scene, view, is_mirroring, "no visible surface has a highlight"),
    lesson: Lesson {
        title: "Two shapes of a highlight: R.V and N.H",
        what: "A highlight can be measured by the angle from the mirrored light to the eye (R.V), \
            or from the normal to the half-way vector between light and eye (N.H).",
        coarse: "Neither is an error of the other: with the same exponent N.H is about twice as \
            wide, and it stretches where light grazes. The exact picture here uses R.V.",
        shows: "On the rim of a shiny ball lit from behind, and in the size of every highlight.",
        scene: "ball",
        choice: Some("half-vector"),
    },
};

pub(super) const VALUES: Axis = Axis {
    key: "values",
    label: "Light values",
    phrase: "light in {} values",
    what: "The colour space in which light is computed",
    kind: AxisKind::Model,
    choices: &[
        choice!("stored" "Stored" light_values = LightValues::Stored,
            "Colours are used as stored, like the ancestors did.",
            "a model, not scored"),
        choice!("linear" "Linear" light_values = LightValues::Linear,
            "Colours are decoded from sRGB, light is added in linear values, pictures are encoded.",
            "a model, not scored"),
    ],
    sense: |scene, view| if_any(scene, view, is_there, "no object is visible"),
    lesson: Lesson {
        title: "Half of the light is not half of the byte",
        what: "A byte of a picture is not an amount of light: sRGB gives dark colours more bytes, \
            as the eye does. Light adds up in linear values only.",
        coarse: "Neither is an error of the other here: colours used as stored are the ancestors' \
            look, with soft shading that darkens early. In linear values the middle between black \
            and white is the byte 188.",
        shows: "On the ball's shading from the lit to the dark side, and in the width of the \
            highlight.",
        scene: "ball",
        choice: Some("linear"),
    },
};
