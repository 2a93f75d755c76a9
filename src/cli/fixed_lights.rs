//! Views of a scene under lights that stay, for data sets.
//!
//! NeRF and Gaussian splatting explain all views by one light. The lights and the exposure of
//! models are therefore those of the default view, and a spot that a camera holds stays where the
//! camera of the scene is.

use marraztu_core::scene::{
    Aim as Place, Anchor, AnchorMut, Command, Item, Light, LightOrigin, Scene, SpotOwner, Tracked,
    View,
};

use super::arguments::{Exposure, Seeing};
use super::failure::Failure;
use super::render::{Aim, look};
use super::stage::Stage;

/// Applies the options for the view like [`look`], with the lights and the exposure of the default
/// view.
pub(super) fn look_with_fixed_lights(
    stage: &mut Stage,
    seeing: &Seeing,
    aim: &Aim,
) -> Result<(), Failure> {
    let mut lit = stage.clone();
    look(&mut lit, &Seeing { camera: None, from: None, ..seeing.clone() }, &Aim::Options)?;
    let exposure = seeing.exposure.map(|_| Exposure::Stops(lit.view.exposure));
    look(stage, &Seeing { exposure, ..seeing.clone() }, aim)?;
    for (id, light) in lit.scene.lights.iter() {
        let light = fixed(&lit.scene, &lit.view, light);
        stage.change(Command::Replace(Item::Light(id, Box::new(light))))?;
    }
    Ok(())
}

/// Returns a light that does not move with the selected camera.
fn fixed(scene: &Scene, view: &View, light: &Light) -> Light {
    let follows = match light.kind.anchor() {
        Anchor::Owner(SpotOwner::SelectedCamera) => true,
        Anchor::Owner(SpotOwner::Camera(id)) => *id == view.camera,
        Anchor::Owner(_) | Anchor::Everywhere | Anchor::Direction(_) | Anchor::Position(_) => false,
    };
    let mut light = light.clone();
    let origin = scene.light_origin(view, &light.kind);
    if let Some(LightOrigin { position: Some(position), direction: Some(direction) }) = origin
        && let AnchorMut::Owner(owner) = light.kind.anchor_mut()
        && follows
    {
        *owner = SpotOwner::Fixed(Tracked::new(Place { position, direction }));
    }
    light
}
