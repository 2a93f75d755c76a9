//! The axes of light: shading, arithmetic, highlights.

use super::sense::{has_several_samples, if_any, is_lit, is_mirroring, is_there};
use super::{Axis, AxisKind, Choice};
use crate::accuracy::{Arithmetic, LightAt, LightValues, SpecularForm};

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
            "Light in 64-bit numbers, with the power function of libm: the reference, slow.",
            "none"),
    ],
    sense: |scene, view| if_any(scene, view, is_lit, "no visible surface is lit"),
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
};
