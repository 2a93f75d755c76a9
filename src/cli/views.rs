//! `marraztu views`: a sheet of standard views of a model, with its facts.

use std::path::{Path, PathBuf};

use clap::Args;
use marraztu::plots::{SheetCell, contact_sheet};
use marraztu_core::base::image::Size;
use marraztu_io::{self as io, describe_model};
use marraztu_render::{Renderer, plan_frame};

use super::accuracy::Accuracy;
use super::arguments::SceneArguments;
use super::batch::views::parse_views;
use super::failure::{Failure, usage};
use super::info::scene_text;
use super::render::{cover, look};
use super::sky::Sky;
use super::stage::{Stage, Watch};
use super::talk::{Talk, note, print};
use super::target::default_name;
use super::values::{picture_file, size};

/// The most facts on the sheet; standard output has all of them.
const MOST_FACTS: usize = 24;

/// The model, and the sheet to write.
#[derive(Debug, Args)]
#[command(after_help = "\
Draws a model from several sides into one labelled picture, and describes it like `info`, on the
sheet and on standard output.

Examples:
  marraztu views teapot.obj
  marraztu views part.obj --up z --out sheet.png --views front,right,back,left,top,bottom")]
pub(crate) struct Views {
    /// A model (.obj, .stl, also .gz) or a scene (.marraztu); "-" is standard input
    file: PathBuf,
    /// The sheet to write [default: the name of the model with -views.png, in the current folder]
    #[arg(short, long, value_name = "FILE", value_parser = picture_file())]
    out: Option<PathBuf>,
    /// Width and height of each view in pixels; one number for a square
    #[arg(
        long,
        value_name = "WxH",
        default_value = "400x400",
        allow_negative_numbers = true,
        value_parser = size
    )]
    size: Size,
    /// The views, as in `batch`
    #[arg(long, value_name = "VIEWS", default_value = "front,right,top,iso")]
    views: String,
    /// The number of views in a row
    #[arg(long, value_name = "N", default_value_t = 2)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100))]
    columns: u32,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    accuracy: Accuracy,
}

/// Draws the sheet.
pub(super) fn views(arguments: &Views) -> Result<(), Failure> {
    let Views { file, out, size, views, columns, talk, scene, accuracy } = arguments;
    let SceneArguments { reading, surfaces, seeing } = scene;
    talk.apply();
    if seeing.camera.is_some() || seeing.from.is_some() {
        return Err(usage("--views replaces --camera and --from"));
    }
    let views = parse_views(views).map_err(Failure::Usage)?;
    let files = [file.clone()];
    let path = out.clone().unwrap_or_else(|| default_sheet(&files));
    io::check_picture_target(&path)?;
    let mut stage = Stage::of(&files, reading, Watch::Bar)?;
    let sky = seeing.sky.as_ref().map(Sky::path);
    stage.sources(&files).with(sky).spare(&path)?;
    let facts = facts(file, &stage);
    cover(&mut stage, surfaces)?;
    let mut renderer = Renderer::default();
    let mut cells = Vec::new();
    for view in &views {
        let mut stage = stage.clone();
        let size = view.size.unwrap_or(*size);
        look(&mut stage, seeing, &view.aim.at(size))?;
        stage.settings = accuracy.of_file(&stage.settings);
        let shot = stage.shot(size);
        let picture = renderer.render(&plan_frame(&shot)).clone();
        cells.push(SheetCell { picture, label: view.name.clone() });
    }
    let mut lines: Vec<String> = facts.lines().map(str::to_owned).collect();
    if lines.len() > MOST_FACTS {
        let more = lines.len() - MOST_FACTS;
        lines.truncate(MOST_FACTS);
        lines.push(format!("... and {more} more lines"));
    }
    let columns = usize::try_from(*columns).unwrap_or(usize::MAX);
    io::save_picture(&path, &contact_sheet(&cells, columns, &lines)?)?;
    print(&facts)?;
    if out.is_none() {
        note(&format_args!("the sheet is in {}", path.display()));
    }
    Ok(())
}

/// Describes the model or the scene.
fn facts(file: &Path, stage: &Stage) -> String {
    let mut objects = stage.scene.objects.iter();
    match (stage.models_alone, objects.next()) {
        (true, Some((_, object))) => describe_model(&object.model, &stage.findings),
        _ => scene_text(file, &stage.scene, &stage.view),
    }
}

fn default_sheet(files: &[PathBuf]) -> PathBuf {
    let name = default_name(files);
    let stem = name.file_stem().unwrap_or_default().to_string_lossy();
    PathBuf::from(format!("{stem}-views.png"))
}
