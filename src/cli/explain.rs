//! `marraztu explain`: explains the surface at a pixel and the terms of its colour.

use clap::Args;
use marraztu_core::accuracy::{Samples, Settings};
use marraztu_lab::pixel;
use marraztu_render::{Renderer, plan_frame};

use super::arguments::PictureArguments;
use super::failure::Failure;
use super::render;
use super::talk::print;
use super::values::{Pixel, pixel as parse_pixel};

/// A picture, and the pixel to explain.
#[derive(Debug, Args)]
#[command(after_help = "\
Takes the files and options of `render`. Lists the surface of the pixel, its vectors, and the
ambient, diffuse and specular terms of each light in byte steps. Their sum, clamped and rounded, is
the byte of the picture. With several samples per pixel, explains the light at the pixel's centre.
At half the resolution, explains the drawn pixel; enlarging it adds the mean with its neighbours.

Examples:
  marraztu explain --at 400,300
  marraztu explain teapot.obj --size 200x200 --at 90,110 --shading vertex")]
pub(crate) struct Explain {
    #[command(flatten)]
    pub(super) picture: PictureArguments,

    /// The column and the row of the pixel, from the upper left
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    at: Pixel,
}

/// Explains the pixel given in the arguments.
pub(crate) fn explain(arguments: &Explain) -> Result<(), Failure> {
    let stage = render::stage(&arguments.picture)?;
    let shot = stage.shot(arguments.picture.size);
    let shot = shot.with(Settings { samples: Samples::One, ..shot.settings });
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&shot));
    let Pixel([x, y]) = arguments.at;
    let Some(explained) = renderer.explain(x, y) else {
        return Err(Failure::Absent(format!("pixel {x},{y} is outside the picture")));
    };
    let text = pixel::lines(&shot.scene, &explained).join("\n") + "\n";
    print(&text)
}
