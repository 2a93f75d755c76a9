//! What can be asked for, with the help that says so.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};

use super::accuracy::Accuracy;
use super::job::Job;
use super::keys::Keys;
use super::lab::Lab;
use super::plan::Plan;
use super::prove::Prove;
use marraztu::base::color::Color;
use marraztu::base::image::Size;
use marraztu::scene::{
    Crease, LoadOptions, MaterialChoice, Normals, PresetId, Projection, Scale, Surface, UpAxis,
    Winding,
};

/// The longest side that a picture may have.
const LONGEST_SIDE: usize = 16_384;

/// Draws 3D scenes of .obj models by the CPU alone.
///
/// Without a command the editor opens, with the models and the scene that are named, or with the
/// first scene.
#[derive(Debug, Parser)]
#[command(
    name = "marraztu",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  marraztu                                  open the editor with the first scene
  marraztu teapot.obj                       open the editor with a model
  marraztu render --out first.png           draw the first scene
  marraztu render teapot.obj --out pot.png  draw a model, as near as it can be seen whole
  marraztu info teapot.obj                  say what a file holds, and what is wrong with it

Exit status: 0 where all was done, 1 where something failed, 2 for arguments that cannot be meant."
)]
pub(crate) struct Arguments {
    /// What to do without a window.
    #[command(subcommand)]
    pub(crate) command: Option<Headless>,
    /// Models (.obj) and a scene (.marraztu) to open in the editor
    pub(crate) files: Vec<PathBuf>,
}

/// What can be done without a window.
#[derive(Debug, Subcommand)]
pub(crate) enum Headless {
    /// Draws a picture into a file: the same pixels that the editor shows
    Render(Box<Render>),
    /// Says what a picture takes: each effect, on or left out, why, and its cost
    Plan(Box<Plan>),
    /// Says what files hold: shape, parts, materials, and what is wrong with them
    Info(Info),
    /// Lists every key of the editor
    Keys(Keys),
    /// Measures what accuracy costs in time: each choice of each axis, in time and in error
    Lab(Box<Lab>),
    /// Measures one drawing job in a form that other renderers share
    Job(Job),
    /// Puts what is claimed of the program to the proof, in any number of cases
    Prove(Prove),
}

/// A picture, and the file that it goes to.
#[derive(Debug, Args)]
#[command(after_help = "\
Without files the first scene is drawn, and a scene through its own camera. Models alone get the
first scene's lights, and a camera that sees them whole. What is not said stays as the scene has it;
a star marks what the first scene has.

Examples:
  marraztu render --out first.png
  marraztu render bunny.obj --out bunny.png --size 1920x1080 --material gold
  marraztu render room.obj --out room.png --up z --surface texture --filter nearest
  marraztu render spot.obj --out spot.png --from 145,20
  marraztu render shelf.marraztu --out shelf.ppm --camera 2 --time 1.5
  marraztu render ship.obj --out lines.png --edges --projection orthographic --background 0,0,0")]
pub(crate) struct Render {
    /// The picture to write; its ending says how: .png or .ppm
    #[arg(short, long, value_name = "FILE", value_parser = PathBufValueParser::new().try_map(picture))]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) shot: Shot,
}

/// A picture, whatever becomes of it.
#[derive(Debug, Args)]
pub(crate) struct Shot {
    /// Models (.obj), and at most one scene (.marraztu) that they are put into
    pub(crate) files: Vec<PathBuf>,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    pub(crate) size: Size,

    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) surfaces: Surfaces,
    #[command(flatten)]
    pub(crate) seeing: Seeing,
    #[command(flatten)]
    pub(crate) accuracy: Accuracy,
}

/// How model files are read.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Reading models")]
pub(crate) struct Reading {
    /// Which of the file's axes points up: y*, z
    #[arg(long, hide_possible_values = true, value_name = "AXIS", value_parser = choice(&[("y", UpAxis::Y), ("z", UpAxis::Z)]))]
    up: Option<UpAxis>,
    /// What the file's coordinates are multiplied by
    #[arg(long, value_name = "FACTOR", value_parser = scale)]
    scale: Option<Scale>,
    /// Turn polygons round that run clockwise seen from outside
    #[arg(long)]
    flip_winding: bool,
    /// Degrees between faces up to which their edge is smooth, if the file has neither normals nor
    /// smoothing groups: 60*, 0 for flat faces, 180 to smooth all
    #[arg(long, value_name = "DEGREES", value_parser = crease)]
    crease: Option<Crease>,
}

/// What objects are made of.
#[derive(Debug, Args)]
#[command(next_help_heading = "Surfaces, of all objects")]
pub(crate) struct Surfaces {
    /// One of the 19 materials (brass, polished-gold, ruby ...), or "file" for the file's own
    #[arg(long, value_name = "NAME", value_parser = material)]
    pub(crate) material: Option<MaterialChoice>,
    /// A picture laid over the objects: PNG, JPEG, BMP, TGA or GIF
    #[arg(long, value_name = "FILE")]
    pub(crate) texture: Option<PathBuf>,
    /// What is shown: material, texture, or both lit (lit*)
    #[arg(long, hide_possible_values = true, value_name = "WHAT", value_parser = choice(&[
        ("material", Surface::Material),
        ("texture", Surface::Texture),
        ("lit", Surface::TextureAndLight),
    ]))]
    pub(crate) surface: Option<Surface>,
    /// Compute normals even where the file has some
    #[arg(long)]
    pub(crate) no_file_normals: bool,
}

/// How the scene is looked at.
#[derive(Debug, Args)]
#[command(next_help_heading = "Looking at the scene")]
pub(crate) struct Seeing {
    /// The camera to look through, by its place in the scene's list, from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) camera: Option<u32>,
    /// From where models alone are seen: degrees to the right, and up; "0,0" is the front
    #[arg(long, value_name = "RIGHT,UP", allow_hyphen_values = true, conflicts_with = "camera", value_parser = side)]
    pub(crate) from: Option<[f64; 2]>,
    /// How space is brought onto the picture: perspective*, orthographic
    #[arg(long, hide_possible_values = true, value_name = "HOW", value_parser = choice(&[
        ("perspective", Projection::Perspective),
        ("orthographic", Projection::Orthographic),
    ]))]
    pub(crate) projection: Option<Projection>,
    /// Seconds of the scene's clock, for what turns and circles
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) time: Option<f64>,
    /// The slots of the lights that are on, as "0,2"; all others are out. "none" for darkness
    #[arg(long, value_name = "SLOTS", value_parser = slots)]
    pub(crate) lights: Option<Slots>,
    /// What is seen where nothing is: red, green and blue, each from 0 to 255
    #[arg(long, value_name = "R,G,B", value_parser = color)]
    pub(crate) background: Option<Color>,
    /// Which normals light uses: face, vertex*
    #[arg(long, hide_possible_values = true, value_name = "WHOSE", value_parser = choice(&[
        ("face", Normals::Face),
        ("vertex", Normals::Vertex),
    ]))]
    pub(crate) normals: Option<Normals>,
    /// Draw edges only
    #[arg(long)]
    pub(crate) edges: bool,
    /// Draw edges over filled polygons
    #[arg(long, conflicts_with = "edges")]
    pub(crate) edges_over: bool,
    /// Draw back faces, in red
    #[arg(long)]
    pub(crate) back_faces: bool,
    /// Draw the normals of faces
    #[arg(long)]
    pub(crate) face_normals: bool,
    /// Draw the normals of vertices
    #[arg(long)]
    pub(crate) vertex_normals: bool,
    /// The marks of cameras and bulbs: none (so for models alone), all*
    #[arg(long, hide_possible_values = true, value_name = "WHICH", value_parser = choice(&[("none", false), ("all", true)]))]
    pub(crate) helpers: Option<bool>,
}

/// Says what files hold.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  marraztu info teapot.obj
  marraztu info --up z parts/*.obj shelf.marraztu")]
pub(crate) struct Info {
    /// Models (.obj) and scenes (.marraztu)
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The slots of the lights that are on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Slots(pub(crate) BTreeSet<u32>);

impl Reading {
    /// The options as the reader takes them.
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions {
            up: self.up.unwrap_or_default(),
            scale: self.scale.unwrap_or_default(),
            winding: if self.flip_winding { Winding::Turned } else { Winding::Kept },
            crease: self.crease.unwrap_or_default(),
        }
    }

    /// Whether anything of it was said.
    pub(crate) const fn is_said(&self) -> bool {
        self.up.is_some() || self.scale.is_some() || self.flip_winding || self.crease.is_some()
    }
}

/// A parser that lets these words through, and gives what they stand for.
fn choice<T: Copy + Send + Sync>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    // The help names them in the sentence, with a star at the one that the first scene has.
    PossibleValuesParser::new(table.iter().map(|(word, _)| *word)).map(move |word| {
        let row = table.iter().find(|(other, _)| *other == word);
        row.expect("clap lets only words of the table through").1
    })
}

/// Known before anything is drawn, for drawing may take long.
fn picture(path: PathBuf) -> Result<PathBuf, String> {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    match ending.as_deref().and_then(|ending| ending.to_str()) {
        Some("png" | "ppm") => Ok(path),
        _ => Err("its name has to end in .png or .ppm".to_owned()),
    }
}

pub(crate) fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=LONGEST_SIDE).contains(side));
    let sides = text.split_once(['x', 'X']).map(|(width, height)| (side(width), side(height)));
    match sides {
        Some((Some(width), Some(height))) => Ok(Size::new(width, height)),
        _ => Err(format!("write width x height, each from 1 to {LONGEST_SIDE}, as 800x600")),
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

fn side(text: &str) -> Result<[f64; 2], String> {
    let sides = text.split_once(',').unwrap_or((text, "0"));
    match (finite(sides.0.trim()), finite(sides.1.trim())) {
        (Ok(right), Ok(up)) if up.abs() <= 90.0 => Ok([right, up]),
        _ => Err("write degrees to the right and degrees up, -90 to 90, as 30,15".to_owned()),
    }
}

fn color(text: &str) -> Result<Color, String> {
    let channels: Option<Vec<u8>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let channels = channels.and_then(|channels| <[u8; 3]>::try_from(channels).ok());
    channels.map(Color).ok_or_else(|| "write red,green,blue, each from 0 to 255".to_owned())
}

fn slots(text: &str) -> Result<Slots, String> {
    if text == "none" {
        return Ok(Slots(BTreeSet::new()));
    }
    let slots: Option<BTreeSet<u32>> =
        text.split(',').map(|part| part.trim().parse().ok()).collect();
    slots.map(Slots).ok_or_else(|| "write numbers with commas between, or none".to_owned())
}

fn material(text: &str) -> Result<MaterialChoice, String> {
    if text.eq_ignore_ascii_case("file") {
        return Ok(MaterialChoice::File);
    }
    PresetId::named(text).map(MaterialChoice::Preset).ok_or_else(|| {
        let names: Vec<&str> = PresetId::all().map(|id| id.get().name).collect();
        format!("there are {}, and file", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_colours_and_slots_are_read_or_refused() {
        assert_eq!(size("640x480"), Ok(Size::new(640, 480)));
        for wrong in ["640", "0x10", "10x0", "16385x1", "-1x5", "axb", "1x2x3", ""] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(side("145, -20"), Ok([145.0, -20.0]));
        assert_eq!(side("-30"), Ok([-30.0, 0.0]));
        for wrong in ["", "a,b", "1,2,3", "0,91", "0,NaN", "inf,0"] {
            assert!(side(wrong).is_err(), "{wrong}");
        }
        assert_eq!(color("1, 2,255"), Ok(Color([1, 2, 255])));
        for wrong in ["1,2", "1,2,3,4", "1,2,256", "red", ""] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
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
