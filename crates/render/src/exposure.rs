//! Fits the exposure to a picture.
//!
//! Light is linear in the exposure until a channel is clamped at white. The picture is therefore
//! darkened until its brightest surfaces are below white. One multiplication then gives the
//! exposure that brings them just below it.

use super::{Renderer, without_ground};
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::scene::View;

/// The share of a picture's surface that may be clamped: highlights are meant to be white.
const CLAMPED: f64 = 0.01;

/// The target brightness of the brightest surfaces, in steps of a byte.
const JUST_BELOW_WHITE: f64 = 250.0;

/// Returns the exposure, in stops, at which all but the brightest hundredth of the visible surfaces
/// is below white. If nothing is lit, it is the view's exposure.
#[must_use]
pub fn fitted_exposure(shot: &Shot) -> f64 {
    let mut renderer = Renderer::default();
    let mut stops = 0.0;
    // Ten steps of two stops cover all exposures.
    for _ in 0..10 {
        let view = View { exposure: stops, ..shot.view.clone() };
        let shot = Shot { view, settings: Settings::default(), ..shot.clone() };
        let Some(brightest) = brightest(&mut renderer, &shot) else { return shot.view.exposure };
        if brightest >= 255.0 {
            stops -= 2.0;
        } else if brightest < 16.0 && stops >= 0.0 {
            // A measurement in a few steps of a byte would be too coarse.
            stops += 2.0;
        } else {
            stops += (JUST_BELOW_WHITE / brightest).log2();
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
    // Only fully covered pixels count: edges are mixed with the background.
    let shown = picture.pixels().iter().filter(|pixel| pixel[3] == 255);
    let mut bright: Vec<u8> = shown.map(|[r, g, b, _]| *r.max(g).max(b)).collect();
    bright.sort_unstable_by(|a, b| b.cmp(a));
    let skipped = (bright.len() as f64 * CLAMPED) as usize;
    bright.get(skipped).map(|byte| f64::from(*byte))
}
