//! Renders pictures with a transparent background, for compositing.
//!
//! The scene is drawn over black and over white. If a is the covered share of a pixel and C its
//! colour, the two results are a C and a C + (1 - a), and their difference is the visible share of
//! the background. Every effect that covers a pixel partly is therefore exact: samples, lines,
//! transparency. If light is computed in linear values, colours are mixed linearly, so both results
//! are decoded first. Only a picture at half resolution is enlarged in stored values all the same,
//! so its edges in linear light are exact over black and white alone. Porter and Duff, "Compositing
//! Digital Images", SIGGRAPH 1984.

use super::frame::FramePlan;
use super::frame::variants::Decoding;
use super::plan::plan_frame;
use super::renderer::{Cancelled, Renderer};
use marraztu_core::accuracy::Shot;
use marraztu_core::base::color::{Color, byte, encoded, linear_factors};
use marraztu_core::base::image::Picture;

/// Renders a picture with a transparent background; colours are not premultiplied.
///
/// # Panics
/// Never: it cannot be cancelled.
pub fn without_ground(renderer: &mut Renderer, shot: &Shot) -> Picture {
    without_ground_while(renderer, shot, &|| true).expect("it is always wanted")
}

/// Works like [`without_ground`].
///
/// # Errors
/// See [`Renderer::redraw`].
pub fn without_ground_while(
    renderer: &mut Renderer,
    shot: &Shot,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Picture, Cancelled> {
    let [black, white] = over_black_and_white(shot);
    let mut picture = renderer.render_while(&black, wanted)?.clone();
    uncover(&mut picture, renderer.render_while(&white, wanted)?, black.variants.decoding());
    Ok(picture)
}

/// Plans a picture over black and over white.
pub(crate) fn over_black_and_white(shot: &Shot) -> [FramePlan; 2] {
    [Color::BLACK, Color::WHITE].map(|ground| {
        let mut shot = shot.clone();
        shot.scene.background = ground;
        shot.scene.hide_panoramas();
        plan_frame(&shot)
    })
}

/// Removes the background of a picture over black, by the same picture over white. `decoding` gives
/// the values in which colours were mixed.
pub(crate) fn uncover(black: &mut Picture, white: &Picture, decoding: Decoding) {
    let covered = match decoding {
        Decoding::Stored => covered,
        Decoding::Linear => covered_in_linear_light,
    };
    for (pixel, white) in black.pixels_mut().iter_mut().zip(white.pixels()) {
        *pixel = covered(*pixel, *white);
    }
}

/// Converts a pixel over black and over white to colour and alpha.
#[expect(clippy::cast_possible_truncation, reason = "at most 255")]
fn covered(black: [u8; 4], white: [u8; 4]) -> [u8; 4] {
    let seen = |i: usize| u32::from(white[i].saturating_sub(black[i]));
    // The background is grey: its three channels are equal except for rounding.
    let ground = (seen(0) + seen(1) + seen(2) + 1) / 3;
    let share = 255 - ground.min(255);
    // Without coverage, the colour is undefined.
    if share == 0 {
        return [0; 4];
    }
    // Over black, colours are multiplied by the share; dividing by it rounds to the nearest.
    let color = |i: usize| ((u32::from(black[i]) * 255 + share / 2) / share).min(255) as u8;
    [color(0), color(1), color(2), share as u8]
}

/// Works like [`covered`], with colours that were mixed in linear light. Alpha is linear.
fn covered_in_linear_light(black: [u8; 4], white: [u8; 4]) -> [u8; 4] {
    // Most pixels are covered fully: decoding and encoding keep every byte.
    if black == white {
        return black;
    }
    let light = |pixel: [u8; 4], i: usize| linear_factors()[usize::from(pixel[i])];
    let seen = |i: usize| (light(white, i) - light(black, i)).max(0.0);
    let share = 1.0 - (seen(0) + seen(1) + seen(2)) / 3.0;
    let alpha = byte(share);
    if alpha == 0 {
        return [0; 4];
    }
    let color = |i: usize| byte(encoded(light(black, i) / share));
    [color(0), color(1), color(2), alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_split_into_colour_and_share() {
        assert_eq!(covered([10, 20, 30, 255], [10, 20, 30, 255]), [10, 20, 30, 255]);
        assert_eq!(covered([0, 0, 0, 255], [255, 255, 255, 255]), [0; 4]);
        assert_eq!(covered([50, 100, 0, 255], [178, 228, 128, 255]), [100, 201, 0, 127]);
    }

    /// Half of white light is 188: see the tests of [`encoded`].
    #[test]
    fn a_pixel_mixed_in_linear_light_is_split_in_linear_light() {
        let [pane, empty] = [([188, 0, 0, 255], [255, 188, 188, 255]), ([0, 0, 0, 255], [255; 4])];
        assert_eq!(covered_in_linear_light(pane.0, pane.1), [255, 0, 0, 127]);
        assert_eq!(covered_in_linear_light(empty.0, empty.1), [0; 4]);
        let opaque = [10, 20, 30, 255];
        assert_eq!(covered_in_linear_light(opaque, opaque), opaque);
    }
}
