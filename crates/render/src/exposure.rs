//! Fits the exposure to a picture.
//!
//! Light is linear in the exposure until a channel is clamped at white. The picture is therefore
//! darkened until its brightest surfaces are below white. One multiplication then gives the
//! exposure that brings them just below it. Lines and marks are left out, because they are not lit.

use super::layers::surfaces_alone;
use super::renderer::Renderer;
use super::without_ground::without_ground;
use marraztu_core::accuracy::{LightValues, Settings, Shot};
use marraztu_core::base::color::linear;
use marraztu_core::scene::View;

/// The share of a picture's surface that may be clamped: highlights are meant to be white.
const CLAMPED: f64 = 0.01;

/// The least alpha of a pixel that counts. A smaller one leaves its colour too few digits.
const LEAST_ALPHA: u8 = 16;

/// The target brightness of the brightest surfaces, in steps of a byte.
const JUST_BELOW_WHITE: f64 = 250.0;

/// Returns the exposure, in stops, at which all but the brightest hundredth of the visible surfaces
/// is below white, with light computed in the values of the shot's settings. If nothing is lit, it
/// is the view's exposure.
#[must_use]
pub fn fitted_exposure(shot: &Shot) -> f64 {
    let mut renderer = Renderer::default();
    let mut stops = 0.0;
    let light_values = shot.settings.light_values;
    let settings = Settings { light_values, ..Settings::default() };
    // The light that a byte represents, up to a factor.
    let light = |byte: f64| match light_values {
        LightValues::Stored => byte,
        LightValues::Linear => linear(byte / 255.0),
    };
    // Back faces have one colour, lit or not.
    let view = View { back_faces: false, ..surfaces_alone(&shot.view) };
    let mut trial = Shot { view, settings, ..shot.clone() };
    // Ten steps of two stops cover all exposures.
    for _ in 0..10 {
        trial.view.exposure = stops;
        let Some(brightest) = brightest(&mut renderer, &trial) else { return shot.view.exposure };
        if brightest >= 255.0 {
            stops -= 2.0;
        } else if brightest < 16.0 && stops >= 0.0 {
            // A measurement in a few steps of a byte would be too coarse.
            stops += 2.0;
        } else {
            stops += (light(JUST_BELOW_WHITE) / light(brightest)).log2();
            // A hundredth of a stop is about a step of a byte.
            let stops = (stops * 100.0).floor() / 100.0;
            return stops.clamp(-View::MOST_EXPOSURE, View::MOST_EXPOSURE);
        }
    }
    // Unlit surfaces look the same at any exposure.
    shot.view.exposure
}

/// Measures the brightness of the brightest surfaces after the share that may be clamped. `None` if
/// there is no surface.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a share of the pixels"
)]
fn brightest(renderer: &mut Renderer, shot: &Shot) -> Option<f64> {
    let picture = without_ground(renderer, shot);
    // Transparent surfaces count with their own colour, without the background behind them.
    let shown = picture.pixels().iter().filter(|pixel| pixel[3] >= LEAST_ALPHA);
    let mut bright: Vec<u8> = shown.map(|[r, g, b, _]| *r.max(g).max(b)).collect();
    bright.sort_unstable_by(|a, b| b.cmp(a));
    let skipped = (bright.len() as f64 * CLAMPED) as usize;
    bright.get(skipped).map(|byte| f64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan_frame;
    use glam::{DMat4, DVec3};
    use marraztu_core::base::Shared;
    use marraztu_core::base::image::Size;
    use marraztu_core::scene::{
        Camera, CameraId, Light, LightId, LightKind, List, Material, MaterialChoice, Mesh,
        MeshSource, Model, Object, ObjectId, Scene, SourceCorner, Tracked,
    };

    /// A grey square that fills the view of a camera 400 units away, with a bulb in front of it.
    fn grey_wall() -> (Scene, View) {
        let mesh = Mesh::new(MeshSource {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            ..MeshSource::of_polygons([0, 1, 2, 3].map(SourceCorner::bare), vec![4])
        });
        let model = Shared::new(Model::of_mesh("wall", mesh.unwrap()));
        let grey = MaterialChoice::Own(Material::matte([0.25; 3], [0.0; 3]));
        let eye = DVec3::new(0.0, 0.0, 400.0);
        let mut scene = Scene::with_camera(Camera::new("camera", model.clone(), grey.clone(), eye));
        let placement = Tracked::new(DMat4::from_scale(DVec3::splat(900.0)));
        let wall = Object { placement, ..Object::new(model, grey) };
        scene.objects = List::from_iter([(ObjectId(10), wall)]);
        let [ambient, _, mut bulb, ..] = Light::five();
        if let LightKind::Bulb { position, .. } = &mut bulb.kind {
            *position = Tracked::new(DVec3::new(0.0, 0.0, 200.0));
        }
        scene.lights = List::from_iter([(LightId(1), ambient), (LightId(2), bulb)]);
        let view = View { camera: CameraId(0), ..scene.first_view() };
        (scene, view)
    }

    #[test]
    fn the_brightest_surface_is_just_below_white_in_stored_values_and_in_linear_light() {
        let (scene, view) = grey_wall();
        for light_values in [LightValues::Stored, LightValues::Linear] {
            for marks in [false, true] {
                let settings = Settings { light_values, ..Settings::default() };
                let view = View { marks, face_normals: marks, ..view.clone() };
                let shot = Shot::new(&scene, &view, &settings, Size::new(32, 32));
                let view = View { exposure: fitted_exposure(&shot), ..view };
                let shot = Shot { view, ..shot };
                let shown = Renderer::default().render(&plan_frame(&shot)).pixel(2, 2)[0];
                assert!((244..255).contains(&shown), "{light_values:?} {marks}: {shown}");
            }
        }
    }

    #[test]
    fn glass_is_fitted_like_an_opaque_surface() {
        let (mut scene, view) = grey_wall();
        let view = View { marks: false, ..view };
        let mut fitted = |opacity: f64| {
            let wall = scene.objects.get(ObjectId(10)).unwrap();
            let wall = Object { opacity, ..wall.clone() };
            scene.objects = List::from_iter([(ObjectId(10), wall)]);
            fitted_exposure(&Shot::new(&scene, &view, &Settings::default(), Size::new(32, 32)))
        };
        let opaque = fitted(1.0);
        assert!(opaque.abs() > 0.1, "{opaque}");
        for opacity in [0.99, 0.5, 0.1] {
            let glass = fitted(opacity);
            assert!((glass - opaque).abs() < 0.08, "{opacity}: {glass}, opaque {opaque}");
        }
    }

    #[test]
    fn without_surfaces_the_exposure_of_the_view_stays() {
        let (mut scene, view) = grey_wall();
        scene.objects = List::default();
        let view = View { exposure: 1.5, object: None, marks: false, ..view };
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(32, 32));
        assert_eq!(fitted_exposure(&shot).to_bits(), 1.5_f64.to_bits());
    }
}
