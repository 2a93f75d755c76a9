//! Arguments that several commands share, with their help.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser};

use super::accuracy::Accuracy;
use super::budget::Budget;
use super::layers::{Encoding, LayerOptions};
use super::sky::{Sky, sky};
use super::talk::Talk;
use super::terminal::TerminalForm;
use super::values::{color, is_standard, is_terminal, size, threads};
use marraztu::directions::direction;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    BumpMaps, Crease, LoadOptions, MaterialChoice, Normals, PresetId, Projection, Scale, Sides,
    Surface, UpAxis, View, Winding,
};
use marraztu_io::{self as io, Input, PICTURE_FORMATS, PictureFormat};

/// A picture, and the file that it goes to.
#[derive(Debug, Args)]
#[command(after_help = "\
Without files, draws the first scene. A scene is drawn through its selected camera. Models without
a scene are framed by a new camera, and lit by the lights of the first scene, moved and balanced for
them. Options that are not given keep the values of the scene; a star marks the value of the first
scene.

The file \"-\" is a model or a scene on standard input. Models may be compressed (.obj.gz). The
picture never overwrites an input file, or a file that is not a picture.

Examples:
  marraztu render teapot.obj
  marraztu render teapot.obj --out terminal
  marraztu render example:/chess.marraztu --out chess.png
  xz -dc pot.obj.xz | marraztu render - --out - > pot.png
  marraztu render bunny.obj --out bunny.png --size 1920x1080 --material gold
  marraztu render room.obj --out room.png --up z --surface texture --filter nearest
  marraztu render spot.obj --out spot.png --from 145,20
  marraztu render shelf.marraztu --out shelf.ppm --camera 2 --time 1.5
  marraztu render example:/chess.marraztu --within 20ms
  marraztu render cow.obj --out cow-{layer}.png --layers color,depth,normal,object
  marraztu render cow.obj --out cow.exr --layers all
  marraztu render ship.obj --out lines.png --edges --projection orthographic --background 0,0,0")]
pub(crate) struct Render {
    #[arg(short, long, value_name = "FILE", help = out_help())]
    #[arg(value_parser = PathBufValueParser::new().try_map(picture))]
    pub(crate) out: Option<PathBuf>,
    /// How to show the picture with "--out terminal": kitty, sixel, blocks (half blocks in 24-bit
    /// colours) [default: the best one that the terminal is known to support]
    #[arg(long, value_name = "FORM", hide_possible_values = true)]
    #[arg(value_parser = choice(&TerminalForm::ALL))]
    pub(crate) terminal: Option<TerminalForm>,
    /// Omit the background: the picture gets an alpha channel
    #[arg(long)]
    pub(crate) transparent: bool,
    /// Also print what the picture costs and gives: the milliseconds of a picture, and its error
    /// against the ideal, 256 samples per pixel, as on the dial of the editor
    #[arg(long, conflicts_with = "transparent")]
    pub(crate) report: bool,
    #[command(flatten)]
    pub(crate) picture: PictureArguments,
    #[command(flatten)]
    pub(crate) budget: Budget,
    #[command(flatten)]
    pub(crate) layers: LayerOptions,
}

/// A picture: what it shows and how it is drawn.
#[derive(Debug, Args)]
pub(crate) struct PictureArguments {
    /// Models (.obj, .stl, also .gz), and at most one scene (.marraztu) to add them to; "-" is
    /// standard input
    pub(crate) files: Vec<PathBuf>,

    /// Width and height in pixels; one number for a square
    #[arg(
        long,
        value_name = "WxH",
        default_value = "800x800",
        allow_negative_numbers = true,
        value_parser = size
    )]
    pub(crate) size: Size,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    #[command(flatten)]
    pub(crate) talk: Talk,

    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    #[command(flatten)]
    pub(crate) accuracy: Accuracy,
}

/// How files become a scene: how they are read, how surfaces look, and how it is looked at.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) surfaces: Surfaces,
    #[command(flatten)]
    pub(crate) seeing: Seeing,
}

/// How model files are read.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Reading models")]
pub(crate) struct Reading {
    /// The up axis of the file: x, y*, z, -x, -y, -z; by default, the axis stated in comments at
    /// the top of the file, and z for STL. The model is rotated, not mirrored
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    #[arg(hide_possible_values = true, value_parser = choice(&UP_AXES))]
    up: Option<UpAxis>,
    /// Multiply the file's coordinates by this factor
    #[arg(long, value_name = "FACTOR", value_parser = scale)]
    scale: Option<Scale>,
    /// Reverse the winding of all polygons, for files with clockwise front faces
    #[arg(long)]
    flip_winding: bool,
    /// Edges between two faces are smooth below this angle in degrees, if the file has neither
    /// normals nor smoothing groups: 60*, and 0 for STL; 0 for flat faces, 180 to smooth all
    #[arg(long, value_name = "DEGREES", value_parser = crease)]
    crease: Option<Crease>,
    /// How to read the pictures of `bump` statements: heights, normals, auto* (detected)
    #[arg(long, value_name = "WHAT", hide_possible_values = true, value_parser = choice(&[
        ("auto", BumpMaps::Auto),
        ("heights", BumpMaps::Heights),
        ("normals", BumpMaps::Normals),
    ]))]
    bump_maps: Option<BumpMaps>,
}

/// How the surfaces of objects look.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Surfaces of all objects")]
pub(crate) struct Surfaces {
    /// One of the 19 materials (brass, polished-gold, ruby ...), or "file" for the file's own
    #[arg(long, value_name = "NAME", value_parser = material)]
    pub(crate) material: Option<MaterialChoice>,
    #[arg(long, value_name = "FILE", help = texture_help())]
    pub(crate) texture: Option<PathBuf>,
    /// The surface to show: material, texture (unlit), lit* (both, lit)
    #[arg(long, hide_possible_values = true, value_name = "WHAT", value_parser = choice(&[
        ("material", Surface::Material),
        ("texture", Surface::Texture),
        ("lit", Surface::TextureAndLight),
    ]))]
    pub(crate) surface: Option<Surface>,
    /// The sides of faces to draw: one, two, auto* (two for open surfaces, one for closed ones)
    #[arg(long, hide_possible_values = true, value_name = "WHICH", value_parser = choice(&[
        ("one", Sides::One),
        ("two", Sides::Two),
        ("auto", Sides::Auto),
    ]))]
    pub(crate) sides: Option<Sides>,
    /// Compute normals even if the file has some
    #[arg(long)]
    pub(crate) no_file_normals: bool,
}

/// How the scene is looked at.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct Seeing {
    /// The camera to look through, by its number in the scene's list, from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) camera: Option<u32>,
    /// The view of models without a scene: degrees to the right, and up (30,20*); or front, right,
    /// back, left, top, bottom, iso
    #[arg(long, value_name = "RIGHT,UP", allow_hyphen_values = true)]
    #[arg(conflicts_with = "camera", value_parser = direction)]
    pub(crate) from: Option<[f64; 2]>,
    /// The projection: perspective*, orthographic
    #[arg(long, hide_possible_values = true, value_name = "HOW", value_parser = choice(&[
        ("perspective", Projection::Perspective),
        ("orthographic", Projection::Orthographic),
    ]))]
    pub(crate) projection: Option<Projection>,
    /// The time of the scene in seconds, for objects that spin and lights that circle
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) time: Option<f64>,
    /// The lights of models without a scene: plain*; studio, a sky with occlusion and a large lamp
    /// with soft shadows
    #[arg(long, hide_possible_values = true, value_name = "HOW", value_parser = choice(&[
        ("plain", Look::Plain),
        ("studio", Look::Studio),
    ]))]
    pub(crate) look: Option<Look>,
    /// A panorama (HDR, EXR or other picture) that replaces all lights and is seen behind
    /// everything; with --background, it only lights
    #[arg(long, value_name = "FILE", value_parser = sky)]
    pub(crate) sky: Option<Sky>,
    /// The slots of the lights to switch on, as "0,2"; the others are off. "none" switches all off
    #[arg(long, value_name = "SLOTS", value_parser = slots)]
    pub(crate) lights: Option<Slots>,
    /// The slots of the lights that cast shadows, as "1,3"; or "all", or "none*"
    #[arg(long, value_name = "SLOTS", value_parser = shadow_slots)]
    pub(crate) shadows: Option<ShadowSlots>,
    /// Exposure in stops (each doubles the light): 0*; "fit" puts the brightest surfaces just below
    /// white
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = exposure)]
    pub(crate) exposure: Option<Exposure>,
    /// The width in pixels of the lines of models, and the diameter of their points: 1 to 64 (1.5*)
    #[arg(long, value_name = "PIXELS", value_parser = line_width)]
    pub(crate) line_width: Option<f64>,
    /// The colour of the background: "0,0,179", "#0000b3", "#fff", or a name such as "white"
    #[arg(long, value_name = "COLOUR", value_parser = color)]
    pub(crate) background: Option<Color>,
    /// The normals that light uses: face, vertex*
    #[arg(long, hide_possible_values = true, value_name = "WHICH", value_parser = choice(&[
        ("face", Normals::Face),
        ("vertex", Normals::Vertex),
    ]))]
    pub(crate) normals: Option<Normals>,
    /// Draw a wireframe
    #[arg(long)]
    pub(crate) edges: bool,
    /// Draw edges over filled polygons
    #[arg(long, conflicts_with = "edges")]
    pub(crate) edges_over: bool,
    /// Draw back faces in red
    #[arg(long)]
    pub(crate) back_faces: bool,
    /// Draw the normals of faces
    #[arg(long)]
    pub(crate) face_normals: bool,
    /// Draw the normals of vertices
    #[arg(long)]
    pub(crate) vertex_normals: bool,
    /// The markers of cameras and bulbs: none (the default without a scene), all*
    #[arg(long, value_name = "WHICH", hide_possible_values = true)]
    #[arg(value_parser = choice(&[("none", false), ("all", true)]))]
    pub(crate) helpers: Option<bool>,
}

/// An exposure option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Exposure {
    /// A number of stops.
    Stops(f64),
    /// Fitted to the picture.
    Fit,
}

fn line_width(text: &str) -> Result<f64, String> {
    let widths = View::LINE_WIDTHS;
    let width = text.parse().ok().filter(|width| widths.contains(width));
    width.ok_or_else(|| format!("write pixels from {} to {}", widths.start(), widths.end()))
}

fn exposure(text: &str) -> Result<Exposure, String> {
    let most = View::MOST_EXPOSURE;
    if text == "fit" {
        return Ok(Exposure::Fit);
    }
    let stops = text.parse().ok().filter(|stops| (-most..=most).contains(stops));
    stops.map(Exposure::Stops).ok_or_else(|| format!("write stops from -{most} to {most}, or fit"))
}

/// Files to describe.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  marraztu info teapot.obj
  marraztu info teapot.obj --json
  marraztu info --up z parts/*.obj shelf.marraztu")]
pub(crate) struct Info {
    /// Models (.obj, .stl, also .gz) and scenes (.marraztu); "-" is standard input
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The possible up axes, by name.
const UP_AXES: [(&str, UpAxis); 6] = {
    let mut axes = [("", UpAxis::Y); 6];
    let mut i = 0;
    while i < axes.len() {
        axes[i] = (UpAxis::ALL[i].word(), UpAxis::ALL[i]);
        i += 1;
    }
    axes
};

/// The lights of models without a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Look {
    /// Those of the first scene.
    #[default]
    Plain,
    /// Those of a studio.
    Studio,
}

/// The selection of lights that cast shadows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ShadowSlots {
    /// Every light that can cast shadows.
    All,
    /// The lights in these slots.
    These(Slots),
}

/// The slots of the lights that are on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Slots(pub(crate) BTreeSet<u32>);

impl Reading {
    /// Returns the load options for a file or for standard input.
    pub(crate) fn options(&self, file: &Path, input: Option<&Input>) -> LoadOptions {
        let usual_up = || input.map_or_else(|| io::usual_up(file), Input::usual_up);
        let usual_crease = || input.map_or_else(|| io::usual_crease(file), Input::usual_crease);
        LoadOptions {
            up: self.up.unwrap_or_else(usual_up),
            scale: self.scale.unwrap_or_default(),
            winding: if self.flip_winding { Winding::Turned } else { Winding::Kept },
            crease: self.crease.unwrap_or_else(usual_crease),
            bumps: self.bump_maps.unwrap_or_default(),
        }
    }

    /// Returns whether any of the options was given.
    pub(crate) const fn is_given(&self) -> bool {
        let crease_or_bumps = self.crease.is_some() || self.bump_maps.is_some();
        self.up.is_some() || self.scale.is_some() || self.flip_winding || crease_or_bumps
    }
}

/// Returns a parser that accepts the words of a table and returns their values.
pub(super) fn choice<T: Copy + Send + Sync>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    // The help text lists the words, with a star at the default.
    PossibleValuesParser::new(table.iter().map(|(word, _)| *word)).map(move |word| {
        let row = table.iter().find(|(other, _)| *other == word);
        row.expect("clap lets only words of the table through").1
    })
}

fn out_help() -> String {
    format!(
        "The picture to write: {}; \"-\" writes a {} to standard output, and \"terminal\" shows it \
         [default: the name of the scene or first model with .{}, in the current folder]",
        PictureFormat::usual_endings(),
        PICTURE_FORMATS[0].name,
        PICTURE_FORMATS[0].endings[0],
    )
}

fn texture_help() -> String {
    format!("The texture of all objects: {}", io::texture_formats())
}

/// Checks the file name before the picture is drawn, which may take long.
fn picture(path: PathBuf) -> Result<PathBuf, String> {
    if is_standard(&path) || is_terminal(&path) {
        Ok(path)
    } else {
        Encoding::of(&path).map(|_| path)
    }
}

fn scale(text: &str) -> Result<Scale, String> {
    let factor = text.parse().ok().and_then(Scale::new);
    factor.ok_or_else(|| "a scale is a finite number above 0".to_owned())
}

fn crease(text: &str) -> Result<Crease, String> {
    let crease = text.parse().ok().and_then(Crease::new);
    crease.ok_or_else(|| "a crease angle is a number of degrees from 0 to 180".to_owned())
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "this is not a finite number".to_owned())
}

fn slots(text: &str) -> Result<Slots, String> {
    if text == "none" {
        return Ok(Slots(BTreeSet::new()));
    }
    let slots: Option<BTreeSet<u32>> =
        text.split(',').map(|part| part.trim().parse().ok()).collect();
    slots.map(Slots).ok_or_else(|| "write numbers with commas between, or none".to_owned())
}

fn shadow_slots(text: &str) -> Result<ShadowSlots, String> {
    if text == "all" {
        return Ok(ShadowSlots::All);
    }
    slots(text).map(ShadowSlots::These).map_err(|reason| format!("{reason}, or all"))
}

fn material(text: &str) -> Result<MaterialChoice, String> {
    if text.eq_ignore_ascii_case("file") {
        return Ok(MaterialChoice::File);
    }
    PresetId::named(text).map(MaterialChoice::Preset).ok_or_else(|| {
        let names: Vec<&str> = PresetId::all().map(|id| id.get().name).collect();
        format!("possible values: {}, file", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_and_factors_are_read_or_refused() {
        assert_eq!(slots("0,2,12"), Ok(Slots([0, 2, 12].into())));
        assert_eq!(slots("none"), Ok(Slots([].into())));
        assert!(slots("").is_err() && slots("1;2").is_err());
        assert!(scale("0").is_err() && scale("inf").is_err() && finite("NaN").is_err());
    }

    #[test]
    fn each_of_the_nineteen_materials_can_be_named_as_one_word() {
        for id in PresetId::all() {
            let word = id.get().name.replace(' ', "-");
            assert_eq!(material(&word), Ok(MaterialChoice::Preset(id)));
        }
        assert_eq!(material("file"), Ok(MaterialChoice::File));
        assert!(material("unobtainium").is_err());
    }
}
