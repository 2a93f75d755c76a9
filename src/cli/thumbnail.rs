//! `marraztu thumbnail`: a small picture for a file manager.
//!
//! A thumbnailer runs in a sandbox, on a copy of the file without its name and without the files
//! next to it. The content tells whether it is a model or a scene, and whether it is compressed.
//! A coarse picture is drawn first. If the fine one takes too long, the coarse one is written.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use clap::Args;
use marraztu_core::accuracy::{Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::threads;
use marraztu_io::{self as io, Input, PICTURE_FORMATS, Progress, Sources};
use marraztu_render::accel::Accelerated as _;
use marraztu_render::{Renderer, without_ground};

use super::arguments::{Reading, Seeing};
use super::failure::Failure;
use super::render::{Aim, look};
use super::stage::{Stage, Watch};

/// The time after which the coarse picture is written.
const LIMIT: Duration = Duration::from_secs(5);

/// The stack of the thread that draws.
const STACK: usize = 16 << 20;

/// The file, and the picture to write.
#[derive(Debug, Args)]
#[command(after_help = "\
Writes a PNG with a transparent background, whatever the name of OUT. The content of IN tells
whether it is a model or a scene; MTL files and textures are used if they are there. After 5
seconds, a coarser picture is written.

Examples:
  marraztu thumbnail --size 256 teapot.obj teapot-small.png")]
pub(crate) struct Thumbnail {
    /// The side of the picture in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 256)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=2048))]
    size: u16,
    /// A model or a scene
    #[arg(value_name = "IN")]
    file: PathBuf,
    /// The picture to write
    #[arg(value_name = "OUT")]
    out: PathBuf,
}

/// Draws the thumbnail.
pub(super) fn thumbnail(arguments: &Thumbnail) -> Result<(), Failure> {
    let end = Instant::now() + LIMIT;
    let (sender, pictures) = channel();
    let Thumbnail { file, out, size } = arguments;
    Sources::default().with([file]).spare(out)?;
    if out.is_file() {
        io::check_replaced(out)?;
    }
    let (files, side) = ([file.clone(), out.clone()], usize::from(*size));
    let draw = move || draw(&files, Size::new(side, side), &sender);
    let thread = Builder::new().name("thumbnail".to_owned()).stack_size(STACK);
    // Without a further thread, as in WebAssembly, both pictures are drawn before one is written.
    if threads::is_alone() || thread.spawn(draw.clone()).is_err() {
        draw();
    }
    drop(draw);
    // There is no limit for the coarse picture: late is better than none.
    let gone = || Failure::Absent("the picture could not be drawn".to_owned());
    let mut picture = pictures.recv().map_err(|_closed| gone())??;
    let left = end.saturating_duration_since(Instant::now());
    if let Ok(fine) = pictures.recv_timeout(left) {
        picture = fine?;
    }
    let content = PICTURE_FORMATS[0].encode(&picture).map_err(Failure::Absent)?;
    // A sandbox may allow to write the file, but not to create others next to it.
    io::save_encoded(&arguments.out, &content).or_else(|error| {
        std::fs::write(&arguments.out, &content).map_err(|_second| Failure::Save(error))
    })
}

/// Draws a coarse picture, and then a fine one.
fn draw([file, out]: &[PathBuf; 2], size: Size, pictures: &Sender<Result<Picture, Failure>>) {
    // A texture next to the model is an input, too.
    let staged = stage(file).and_then(|stage| {
        stage.sources(&[]).spare(out)?;
        Ok(stage)
    });
    let stage = match staged {
        Ok(stage) => stage,
        Err(failure) => {
            // The receiver waits for the first picture.
            let _ = pictures.send(Err(failure));
            return;
        }
    };
    let mut renderer = Renderer::default();
    for samples in [Samples::One, Samples::Four] {
        let settings = Settings { samples, ..stage.settings };
        let stage = Stage { settings, ..stage.clone() };
        let picture = without_ground(&mut renderer, &stage.shot(size));
        if pictures.send(Ok(picture)).is_err() {
            return;
        }
    }
}

/// Loads the file, whatever its name.
fn stage(file: &Path) -> Result<Stage, Failure> {
    let input = Input::of_file(file)?;
    let (reading, progress) = (Reading::default(), Progress::new());
    let files = [PathBuf::from("-")];
    let watch = Watch::Progress(&progress);
    let mut stage = Stage::with_input(&files, Some(&input), &reading, watch)?;
    for (_, object) in stage.scene.objects.iter() {
        object.model.mesh.draw_as_filed();
    }
    look(&mut stage, &Seeing::default(), &Aim::Options)?;
    Ok(stage)
}
