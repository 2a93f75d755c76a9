//! Pictures without their ground, for laying over others.
//!
//! The scene is drawn over black and over white. With a the share of a pixel that is covered and C
//! its colour, the two are a C and a C + (1 - a): their difference is what of the ground is seen.
//! So every effect that covers a pixel in part is right, whatever it is: samples, lines,
//! transparency. Porter and Duff, "Compositing Digital Images", SIGGRAPH 1984.

use super::Renderer;
use super::plan::plan_frame;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::{Command, CommandError};

/// Draws a picture whose ground is transparent; not premultiplied.
///
/// # Errors
/// Never: a scene takes every background.
pub fn without_ground(renderer: &mut Renderer, shot: &Shot) -> Result<Picture, CommandError> {
    let mut over = |ground: Color| -> Result<Picture, CommandError> {
        let mut shot = shot.clone();
        Command::Background(ground).apply(&mut shot.scene)?;
        Ok(renderer.render(&plan_frame(&shot)).clone())
    };
    let black = over(Color::BLACK)?;
    let white = over(Color::WHITE)?;
    let mut picture = black.clone();
    for (pixel, white) in picture.pixels_mut().iter_mut().zip(white.pixels()) {
        *pixel = covered(*pixel, *white);
    }
    Ok(picture)
}

/// A pixel over black and over white as colour and share.
#[expect(clippy::cast_possible_truncation, reason = "at most 255")]
fn covered(black: [u8; 4], white: [u8; 4]) -> [u8; 4] {
    let seen = |i: usize| u32::from(white[i].saturating_sub(black[i]));
    // The ground is grey: its three channels tell the same but for rounding.
    let ground = (seen(0) + seen(1) + seen(2) + 1) / 3;
    let share = 255 - ground.min(255);
    if share == 0 {
        return [0; 4];
    }
    let color = |i: usize| ((u32::from(black[i]) * 255 + share / 2) / share).min(255) as u8;
    [color(0), color(1), color(2), share as u8]
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
}
