//! The axes of shadows: how shadows are computed, and where shadow rays start.

use super::{Axis, AxisKind, Choice};
use crate::accuracy::{LightSamples, Settings, ShadowMethod, Terminator};
use crate::scene::{Fill, Scene, View};

/// Whether a light casts shadows in this view; else the reason.
fn are_cast(scene: &Scene, view: &View) -> Result<(), &'static str> {
    let casts = |light: &crate::scene::Light| light.on && light.shadows;
    if view.fill != Fill::Filled {
        return Err("edges cast no shadows");
    }
    if scene.lights.iter().any(|(_, light)| casts(light) && light.can_cast_shadows()) {
        Ok(())
    } else {
        Err("no light casts shadows")
    }
}

/// Why a shadow map may take longer than rays: pictures are measured as if after a change.
const DRAWN_AGAIN: &str =
    "each measured picture draws the maps of all lights, as after a move of a light or an object";

pub(super) const SHADOW_METHOD: Axis = Axis {
    key: "shadow-method",
    label: "Shadow method",
    phrase: "shadows ({})",
    what: "How shadows are computed",
    kind: AxisKind::Scored,
    choices: &[
        choice!("map-512" "Map 512" shadow_method = ShadowMethod::Map512,
            "A shadow map of 512 x 512 texels with a slope-scaled bias (Williams, 1978).",
            "stair steps of a texel along shadows, and light leaks under objects on the ground")
        .slower_because(DRAWN_AGAIN),
        choice!("map-2048" "Map 2048" shadow_method = ShadowMethod::Map2048,
            "A shadow map of 2048 x 2048 texels.",
            "steps a quarter as large")
        .slower_because(DRAWN_AGAIN),
        choice!("map-2048-pcf" "Map 2048 PCF" shadow_method = ShadowMethod::Map2048Pcf,
            "The same, averaged over 3 x 3 texels (Reeves, Salesin and Cook, 1987).",
            "borders blurred over three texels")
        .slower_because(DRAWN_AGAIN),
        choice!("exact" "Exact" shadow_method = ShadowMethod::Exact,
            "Rays against all triangles, in exact arithmetic, without a bias.",
            "none"),
    ],
    sense: are_cast,
};

/// Whether a light casts soft shadows in this view; else the reason.
fn are_soft(scene: &Scene, view: &View) -> Result<(), &'static str> {
    are_cast(scene, view)?;
    let soft = |light: &crate::scene::Light| light.on && light.is_soft();
    if scene.lights.iter().any(|(_, light)| soft(light)) {
        Ok(())
    } else {
        Err("no light with shadows has an extent")
    }
}

/// Whether rays decide shadows.
fn by_rays(settings: &Settings) -> Result<(), &'static str> {
    match settings.shadow_method.map() {
        None => Ok(()),
        Some(_) => Err("shadow maps have hard shadows"),
    }
}

pub(super) const LIGHT_SAMPLES: Axis = Axis {
    key: "light-samples",
    label: "Light samples",
    phrase: "{} samples per light",
    what: "How many points of a large light each lit point sees",
    kind: AxisKind::Scored,
    choices: &[
        choice!("1" "1" light_samples = LightSamples::One,
            "Its centre: shadows are hard.",
            "every soft border", |_, _| Ok(()), by_rays),
        choice!("4" "4" light_samples = LightSamples::Four,
            "Four points, others at each lit point.",
            "coarse noise along soft borders", |_, _| Ok(()), by_rays),
        choice!("16" "16" light_samples = LightSamples::Sixteen,
            "Sixteen points; the first ones are those four.",
            "fine noise along soft borders", |_, _| Ok(()), by_rays),
        choice!("64" "64" light_samples = LightSamples::SixtyFour,
            "Sixty-four points.",
            "a few byte steps along soft borders", |_, _| Ok(()), by_rays),
        choice!("256" "256" light_samples = LightSamples::TwoFiftySix,
            "256 points.",
            "about a byte step", |_, _| Ok(()), by_rays),
    ],
    sense: are_soft,
};

pub(super) const TERMINATOR: Axis = Axis {
    key: "terminator",
    label: "Shadow terminator",
    phrase: "shadow terminator by {}",
    what: "Where shadow rays start on smooth surfaces",
    kind: AxisKind::Model,
    choices: &[
        choice!("triangles" "Triangles" terminator = Terminator::Triangles,
            "On the triangles: the geometry itself is in shadow.",
            "a model, not scored"),
        choice!("smooth" "Smooth" terminator = Terminator::Smooth,
            "On the curved surface that vertex normals suggest (Hanika, 2021).",
            "a model, not scored"),
    ],
    sense: are_cast,
};
