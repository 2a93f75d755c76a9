//! Lights models that come without a scene.
//!
//! These are the lights of the first scene, with positions and attenuation scaled to the size of
//! the models. Their brightness is balanced to the models' materials: for any normal, ambient plus
//! diffuse light stays below white, so only highlights can reach white.
//!
//! ```text
//! s = distance of the camera that frames the models / 400          (the first camera's distance)
//! I = f (Ka Ia + Kd D) <= 0.97
//! D = max over points p and sets of lights S of |sum over S of I_l(p) L_l(p)|
//! ```
//!
//! The diffuse light at a normal N is the sum of the positive N.L. This is N times the sum of some
//! of the lights, so D is an upper bound for every N.

use glam::DVec3;

use super::items::{change_light, put_light};
use super::set_transform::unlocked;
use super::{Change, Refusal, framing};
use crate::base::Shared;
use crate::base::color::Color;
use crate::scene::{
    AnchorMut, Attenuation, Command, HALF_APERTURE, ItemId, Light, LightId, LightKind, LightOrigin,
    Object, ObjectId, Panorama, Scene, SkyPanorama, SpotOwner, Tracked, View,
};

/// The distance of the first scene's camera, for which the first scene's lights are made.
const FIRST_DISTANCE: f64 = 400.0;

/// The position of the first scene's bulb, relative to the centre.
const BULB: DVec3 = DVec3::new(0.0, 0.0, -200.0);

/// The direction towards the sun: to the left of the front and up.
const KEY_FROM: DVec3 = DVec3::new(-0.25, 0.75, 0.612_372_435_695_794_5);

/// The largest ambient plus diffuse light, as a fraction of white.
const BRIGHTEST: f64 = 0.97;

/// The largest number of lights that are balanced; the sum of further lights is overestimated, as
/// if they shone from one direction.
const MOST_SUBSETS: usize = 8;

/// Places and balances the first scene's lights for the models that the scene's camera frames.
///
/// The bulb and the spot of the selected object are switched off, since the bulb would be in the
/// picture and the spot inside a model. The camera's spot is opened until its edge disappears.
///
/// # Errors
/// If there is nothing to light.
pub fn models(scene: &Scene, view: &View) -> Change {
    let ids: Vec<ObjectId> = scene.objects.ids().collect();
    let sphere = framing::sphere(scene, view, &ids).ok_or(Refusal::NothingToFrame)?;
    let (centre, radius) = (sphere.centre, if sphere.radius > 0.0 { sphere.radius } else { 1.0 });
    let scale =
        framing::models_distance(&scene.selected_camera(view).lens, radius) / FIRST_DISTANCE;
    let mut lit = scene.clone();
    let mut commands = Vec::new();
    let mut change = |lit: &mut Scene, change: &dyn Fn(&mut Light)| {
        for (id, _) in scene.lights.iter() {
            let command = change_light(lit, id, change)?;
            command.clone().apply(lit)?;
            commands.push(command);
        }
        Ok::<(), Refusal>(())
    };
    change(&mut lit, &|light| place(light, centre, scale))?;
    let factor = balance(&lit, view, centre, radius);
    change(&mut lit, &|light| light.color = dimmed(light.color, factor))?;
    Ok(Command::Batch(commands))
}

/// The colours of a studio: the sky, the ground below it, and a warm lamp, which is a sun of this
/// angular diameter in degrees.
const STUDIO_SKY: Color = Color([200, 210, 226]);
const STUDIO_GROUND: Color = Color([158, 149, 140]);
const STUDIO_LAMP: Color = Color([255, 247, 232]);
const STUDIO_LAMP_ANGLE: f64 = 14.0;

/// Replaces all lights by those of a studio: a sky with occlusion, and a large lamp to the left of
/// the front with soft shadows, balanced to the materials of everything that is there.
///
/// # Errors
/// If there is nothing to light.
pub fn studio(scene: &Scene, view: &View) -> Change {
    let ids: Vec<ObjectId> = scene.objects.ids().collect();
    let sphere = framing::sphere(scene, view, &ids).ok_or(Refusal::NothingToFrame)?;
    let mut lit = scene.clone();
    let mut commands = Vec::new();
    let mut apply = |lit: &mut Scene, command: Command| {
        command.clone().apply(lit)?;
        commands.push(command);
        Ok::<(), Refusal>(())
    };
    for id in scene.lights.ids() {
        apply(&mut lit, Command::Remove(ItemId::Light(id)))?;
    }
    let sky = LightKind::Sky { ground: STUDIO_GROUND, panorama: None };
    let lamp = LightKind::Sun { direction: Tracked::new(-KEY_FROM) };
    for (name, kind, color, size) in
        [("sky", sky, STUDIO_SKY, 0.0), ("lamp", lamp, STUDIO_LAMP, STUDIO_LAMP_ANGLE)]
    {
        let light = Light { color, shadows: true, size, ..Light::new(name, 0, kind) };
        let command = put_light(&lit, light)?;
        apply(&mut lit, command)?;
    }
    let factor = balance(&lit, view, sphere.centre, sphere.radius);
    let ids: Vec<LightId> = lit.lights.ids().collect();
    for id in ids {
        let dim = |light: &mut Light| {
            light.color = dimmed(light.color, factor);
            if let LightKind::Sky { ground, .. } = &mut light.kind {
                *ground = dimmed(*ground, factor);
            }
        };
        let command = change_light(&lit, id, dim)?;
        apply(&mut lit, command)?;
    }
    Ok(Command::Batch(commands))
}

/// Lights the scene with a panorama, which is also the background: a sky gets it and is switched
/// on, the selected one, else one that is on, else the first. Without a sky, the panorama replaces
/// all lights.
///
/// # Errors
/// If a light that would change is locked.
pub fn panorama(scene: &Scene, view: &View, panorama: Shared<Panorama>) -> Change {
    let is_sky = |light: &Light| matches!(light.kind, LightKind::Sky { .. });
    let skies = || scene.lights.iter().filter(|(_, light)| is_sky(light));
    let selected = skies().find(|(id, _)| view.light == Some(*id));
    let Some((id, _)) =
        selected.or_else(|| skies().find(|(_, it)| it.on)).or_else(|| skies().next())
    else {
        return panorama_alone(scene, panorama);
    };
    unlocked(scene, ItemId::Light(id))?;
    change_light(scene, id, |light| {
        light.on = true;
        if let LightKind::Sky { panorama: own, .. } = &mut light.kind {
            let turn = own.as_ref().map_or(0.0, |own| own.turn);
            // The colour of a plain sky is not meant for a picture of one.
            if own.is_none() {
                light.color = Color::WHITE;
            }
            *own = Some(SkyPanorama { panorama, turn, is_shown: true });
        }
    })
}

/// Replaces all lights by a sky with a panorama and occlusion, which is also the background.
///
/// # Errors
/// If a light is locked.
pub fn panorama_alone(scene: &Scene, panorama: Shared<Panorama>) -> Change {
    let (mut lit, mut commands) = (scene.clone(), Vec::new());
    for id in scene.lights.ids() {
        unlocked(scene, ItemId::Light(id))?;
        let command = Command::Remove(ItemId::Light(id));
        command.clone().apply(&mut lit)?;
        commands.push(command);
    }
    let panorama = Some(SkyPanorama { panorama, turn: 0.0, is_shown: true });
    let kind = LightKind::Sky { ground: Color::BLACK, panorama };
    commands.push(put_light(&lit, Light { shadows: true, ..Light::new("sky", 0, kind) })?);
    Ok(Command::Batch(commands))
}

/// Places a light of the first scene for models that are `scale` times as large.
fn place(light: &mut Light, centre: DVec3, scale: f64) {
    // Attenuation depends on the distance, so it is scaled, too.
    let Attenuation { constant, linear, quadratic } = light.attenuation;
    let scaled =
        Attenuation { constant, linear: linear / scale, quadratic: quadratic / (scale * scale) };
    if scaled.is_valid() {
        light.attenuation = scaled;
    }
    match light.kind.anchor_mut() {
        AnchorMut::Direction(direction) => *direction = Tracked::new(-KEY_FROM),
        AnchorMut::Position(position) => {
            *position = Tracked::new(centre + BULB * scale);
            light.on = false;
        }
        AnchorMut::Owner(SpotOwner::SelectedObject) => light.on = false,
        AnchorMut::Everywhere | AnchorMut::Owner(_) => {}
    }
    // The cone of the camera's spot contains framed models. At close range, its edge would be a
    // hard circle in the picture.
    if let Some(half_aperture) = (HALF_APERTURE.get_mut)(&mut light.kind) {
        *half_aperture = HALF_APERTURE.largest;
    }
}

/// Returns the factor of all lights with which every surface in the sphere is at most as bright as
/// [`BRIGHTEST`]; at most 1.
fn balance(scene: &Scene, view: &View, centre: DVec3, radius: f64) -> f64 {
    let ambient: f64 = scene
        .lights
        .iter()
        .filter(|(_, light)| light.on && light.kind == LightKind::Ambient)
        .map(|(_, light)| strength(light))
        .fold(0.0, f64::max);
    let skies = scene
        .lights
        .iter()
        .map(|(_, light)| light)
        .filter(|light| light.on && matches!(light.kind, LightKind::Sky { .. }));
    let diffuse = most_diffuse(scene, view, centre, radius) + skies.map(strength).sum::<f64>();
    let brightest = scene
        .objects
        .iter()
        .flat_map(|(_, object)| coefficients(object))
        .map(|[ka, kd]| ka * ambient + kd * diffuse)
        .fold(0.0, f64::max);
    if brightest > BRIGHTEST { BRIGHTEST / brightest } else { 1.0 }
}

/// Returns Ka and Kd of each part and channel of an object.
fn coefficients(object: &Object) -> impl Iterator<Item = [f64; 2]> {
    let parts = u32::try_from(object.model.mesh.parts().len().max(1)).unwrap_or(u32::MAX);
    (0..parts).flat_map(|part| {
        let material = object.part_look(part).material;
        (0..3).map(move |channel| [material.ambient[channel], material.diffuse[channel]])
    })
}

/// Returns the largest length of any sum of lights at a point of the sphere.
fn most_diffuse(scene: &Scene, view: &View, centre: DVec3, radius: f64) -> f64 {
    let lights: Vec<(&Light, LightOrigin)> = scene
        .lights
        .iter()
        .filter(|(_, light)| light.on)
        .filter_map(|(_, light)| Some((light, scene.light_origin(view, &light.kind)?)))
        .collect();
    // Lists that all points share, since there are thousands.
    let (mut reaching, mut sums) = (Vec::new(), Vec::new());
    let mut at = |p: DVec3| {
        reaching.clear();
        reaching.extend(lights.iter().filter_map(|(light, origin)| light_at(light, origin, p)));
        // All subsets of the first lights are tried. For the others, the sum of lengths is a bound.
        let (few, others) = reaching.split_at(reaching.len().min(MOST_SUBSETS));
        sums.clear();
        sums.push(DVec3::ZERO);
        for light in few {
            // The subsets with this light are those without it, and the light.
            for set in 0..sums.len() {
                sums.push(sums[set] + *light);
            }
        }
        let most = sums.iter().map(|sum| sum.length_squared()).fold(0.0, f64::max).sqrt();
        most + others.iter().map(|light| light.length()).sum::<f64>()
    };
    // Sample a lattice through the sphere. The change between its points is within the margin to
    // white.
    let lattice = |i: i32| f64::from(i) / 8.0;
    let mut most: f64 = 0.0;
    for (x, y, z) in
        (-8..=8).flat_map(|x| (-8..=8).flat_map(move |y| (-8..=8).map(move |z| (x, y, z))))
    {
        let p = DVec3::new(lattice(x), lattice(y), lattice(z));
        // Points outside move to the surface of the sphere, where lights are nearest.
        let p = if p.length() > 1.0 { p / p.length() } else { p };
        most = most.max(at(centre + p * radius));
    }
    most
}

/// Returns the light that arrives at `p`: the direction to the light times its strength. `None` for
/// light without direction.
fn light_at(light: &Light, origin: &LightOrigin, p: DVec3) -> Option<DVec3> {
    let LightOrigin { position, direction } = *origin;
    // On its axis, a spot is as bright as a bulb.
    let Some(position) = position else {
        return direction.map(|direction| -direction * strength(light));
    };
    let to = position - p;
    let d = to.length();
    let Attenuation { constant, linear, quadratic } = light.attenuation;
    (d > 0.0).then(|| to / d * strength(light) / (constant + linear * d + quadratic * d * d))
}

/// Returns the brightest channel of a light, 0 to 1.
fn strength(light: &Light) -> f64 {
    f64::from(light.color.0.into_iter().max().unwrap_or(0)) / 255.0
}

/// Multiplies a colour by a factor of at most 1, rounding down.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a byte times a factor of 0 to 1"
)]
fn dimmed(Color(channels): Color, factor: f64) -> Color {
    Color(channels.map(|channel| libm::floor(f64::from(channel) * factor) as u8))
}
