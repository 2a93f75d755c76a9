//! `marraztu export`: writes a scene for other programs.

use std::path::PathBuf;

use clap::Args;
use marraztu_io as io;

use super::arguments::SceneArguments;
use super::failure::Failure;
use super::render::staged;
use super::talk::{Talk, note};
use super::target::default_name;

/// A scene, and the file that it goes to.
#[derive(Debug, Args)]
#[command(after_help = "\
OBJ holds shapes and materials, in a separate .mtl file. glTF also holds cameras and lights: .glb is
one file, .gltf has a separate buffer. Textures become PNG files, or parts of the glTF. Hidden
objects are left out. Notes list the features that the format does not have.

Examples:
  marraztu export --out first.glb
  marraztu export shelf.marraztu --out shelf.obj
  marraztu export room.obj --up z --out room.gltf")]
pub(crate) struct Export {
    /// Models (.obj, .stl, also .gz), and at most one scene (.marraztu) to add them to; "-" is
    /// standard input
    files: Vec<PathBuf>,
    /// The file to write: .obj, .gltf or .glb [default: the name of the scene or first model with
    /// .glb, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Exports the scene described by the arguments.
pub(super) fn export(arguments: &Export) -> Result<(), Failure> {
    let Export { files, out, talk, scene } = arguments;
    talk.apply();
    let path = out.clone().unwrap_or_else(|| default_name(files).with_extension("glb"));
    io::check_export_target(&path)?;
    let stage = staged(files, scene)?;
    let exported = io::export(&path, &stage.scene, &stage.view, &stage.sources(files))?;
    for text in &exported.notes {
        note(text);
    }
    if out.is_none() {
        note(&format_args!("the scene is in {}", path.display()));
    }
    Ok(())
}
