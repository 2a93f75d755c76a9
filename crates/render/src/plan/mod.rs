//! Decides what a frame draws, and explains the decisions. No pixel is touched here.
//!
//! A [`FramePlan`] holds a snapshot of everything that drawing reads, transformed to view space.
//! Effects that the scene does not need are left out; [`explain_frame`] lists them with reasons.
//! Lights needed by some tiles only are culled tile by tile, after the depths of a tile are known
//! (`TilePlan`).

pub(crate) mod compile;
mod cover;
pub(crate) mod features;
mod helpers;
mod maps;
mod observer;
mod planner;
mod planning;
mod range;
mod rays;
mod rules;
mod shadows;
mod surfaces;
pub(crate) mod tile;
mod turning;
pub(crate) mod uses;
mod view_lights;

use std::collections::BTreeMap;

use self::compile::Compiler;
use self::observer::ObserverSpace;
use self::planning::{Planner, Planning};
use self::uses::Notes;
pub use self::uses::{Effect, EffectState, EffectUse, Thing};
use self::view_lights::view_lights;
use crate::frame::shadows::Shadows;
use crate::frame::variants::Variants;
use crate::frame::{Eye, FramePlan, Rules};
use crate::screen::coverage::SUBPIXELS;
use marraztu_core::accuracy::{
    Arithmetic, LightAt, LightValues, Resolution, Samples, Settings, Shot,
};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Projection, View};

/// Plans the picture of a shot.
#[must_use]
pub fn plan_frame(shot: &Shot) -> FramePlan {
    planned(Rules::Applied, Notes::default, shot).plan
}

/// Plans the same picture with everything the scene names, needed or not. Drawing it is slower;
/// [`plan_frame`] is tested against it.
#[must_use]
pub fn plan_everything(shot: &Shot) -> FramePlan {
    planned(Rules::Ignored, Notes::default, shot).plan
}

/// Plans a frame like [`plan_frame`], and explains for each effect of the scene whether the frame
/// uses it, and why not.
#[must_use]
pub fn explain_frame(shot: &Shot) -> (FramePlan, Vec<EffectUse>) {
    let Planning { plan, notes, .. } = planned(Rules::Applied, Notes::wanted, shot);
    let mut uses = notes.into_uses();
    let compiler = Compiler::new(&plan);
    let draws: BTreeMap<_, _> = plan.draws.iter().map(|draw| (draw.item, draw)).collect();
    for one in uses.iter_mut().filter(|one| one.effect == Effect::Surfaces && one.state.is_on()) {
        let Some(draw) = one.on.as_ref().and_then(|thing| draws.get(&thing.item)) else { continue };
        // Parts may have different paths; the first part speaks for all.
        if let Some(pipeline) = draw.part_pipelines.iter().flatten().next() {
            one.state = EffectState::On(compiler.in_words(draw, *pipeline).into());
        }
    }
    (plan, uses)
}

/// Plans in the selected arithmetic, or in f64 if the frame's numbers do not fit f32.
fn planned(rules: Rules, notes: fn() -> Notes, shot: &Shot) -> Planning {
    // Whether all distances fit f32 is only known once the frame is planned.
    let as_asked = planned_in(rules, notes(), shot);
    if shot.settings.arithmetic == Arithmetic::F64 || as_asked.plan.has_room() {
        return as_asked;
    }
    let settings = Settings { arithmetic: Arithmetic::F64, ..shot.settings };
    planned_in(rules, notes(), &shot.with(settings))
}

fn planned_in(rules: Rules, notes: Notes, shot: &Shot) -> Planning {
    let observer = ObserverSpace::new(shot);
    // Light per sample is light per pixel in a picture of each sample.
    let by_sample = shot.settings.light == LightAt::Sample;
    let light = if by_sample { LightAt::Pixel } else { shot.settings.light };
    let shot = &shot.with(Settings { light, ..shot.settings });
    let Shot { scene, view, settings, size } = shot;
    let plan = FramePlan {
        size: match settings.resolution {
            Resolution::Full => *size,
            // An odd size is rounded up, so the enlarged picture has no missing column or row.
            Resolution::Half => Size::new(size.width.div_ceil(2), size.height.div_ceil(2)),
        },
        viewport: observer.viewport,
        enlarged: (settings.resolution == Resolution::Half).then_some(*size),
        background: scene.background,
        eye: match view.projection {
            Projection::Perspective => Eye::Point,
            Projection::Orthographic => Eye::Parallel,
        },
        arithmetic: settings.arithmetic,
        light_at: settings.light,
        samples: settings.samples,
        lit_by_sample: by_sample && settings.samples != Samples::One,
        shift: [0; 2],
        sample: 0,
        spacing: match by_sample {
            // N samples per pixel are as dense as a square grid of this spacing.
            true => 1.0 / libm::sqrt(f64::from(settings.samples.count())),
            false => 1.0,
        },
        filter: settings.filter,
        transparency: settings.transparency,
        variants: Variants::of(settings),
        view_from_world: observer.view_from_world,
        clip_from_view: observer.clip_from_view,
        line_width: if view.wide_lines { 2 } else { 1 },
        stroke_width: stroke_width(view, settings.resolution),
        lights: Vec::new(),
        panoramas: Vec::new(),
        light_ids: Vec::new(),
        shadows: Shadows::default(),
        draws: Vec::new(),
        pipelines: Vec::new(),
        surroundings: None,
        rules,
    };
    let mut into = Planning::new(plan, notes);
    into.notes.add(|| {
        let state = match settings.light_values {
            LightValues::Linear => EffectState::On("colours decoded, pictures encoded".into()),
            LightValues::Stored => EffectState::left_out("colours are used as they are stored"),
        };
        EffectUse::new(Effect::LinearLight, None, state)
    });
    // Lights come first, because shadows and surfaces refer to their numbers.
    let shining = view_lights(&mut into, scene, view, &observer);
    let planner = Planner { shot, observer, shining, is_around: false };
    planner.add_shadows(&mut into);
    planner.add_objects(&mut into);
    if view.marks {
        planner.add_marks(&mut into);
    } else {
        let off = EffectState::left_out("switched off");
        into.notes.add(|| EffectUse::new(Effect::Marks, None, off));
    }
    planner.add_surroundings(&mut into);
    into
}

/// Returns the width of the lines of models in subpixels of the drawn picture: an even number, so
/// both halves are whole, and at least a pixel.
#[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
fn stroke_width(view: &View, resolution: Resolution) -> i32 {
    let wide = if view.wide_lines { 2.0 } else { 1.0 };
    let drawn = if resolution == Resolution::Half { 0.5 } else { 1.0 };
    let pixels = (view.line_width * wide * drawn).clamp(1.0, *View::LINE_WIDTHS.end());
    2 * (pixels * f64::from(SUBPIXELS / 2)).round() as i32
}
