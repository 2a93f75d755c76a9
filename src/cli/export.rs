//! `marraztu export`: writes a scene for other programs.

use std::path::PathBuf;

use clap::Args;
use marraztu_io::{self as io, ExportOptions};

use super::arguments::{SceneArguments, choice};
use super::failure::Failure;
use super::render::staged;
use super::talk::{Talk, note};
use super::target::default_name;

/// A scene, and the file that it goes to.
#[derive(Debug, Args)]
#[command(after_help = "\
OBJ holds shapes and materials, in a separate .mtl file. glTF also holds cameras and lights: .glb is
one file, .gltf has a separate buffer. Textures become separate files, or parts of the glTF: PNG and
JPEG files are copied, others become PNG. Hidden objects are left out. Notes list the features that
the format does not have.

A model is exported alone, since other programs have their own cameras and lights. A scene file is
exported with its cameras and lights.

Examples:
  marraztu export --out first.glb
  marraztu export shelf.marraztu --out shelf.obj
  marraztu export shelf.marraztu --content models --out shelf.glb
  marraztu export room.obj --up z --out room.gltf")]
pub(crate) struct Export {
    /// Models (.obj, .stl, also .gz), and at most one scene (.marraztu) to add them to; "-" is
    /// standard input
    files: Vec<PathBuf>,
    /// The file to write: .obj, .gltf or .glb [default: the name of the scene or first model with
    /// .glb, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What to export: models (the objects alone), scene (with cameras and lights) [default: models
    /// if only models are given. --lights, --camera and --from add the lights and the camera]
    #[arg(long, value_name = "WHAT", hide_possible_values = true, value_parser = choice(&[
        ("models", ExportOptions::MODELS),
        ("scene", ExportOptions::SCENE),
    ]))]
    content: Option<ExportOptions>,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Exports the scene described by the arguments.
pub(super) fn export(arguments: &Export) -> Result<(), Failure> {
    let Export { files, out, content, talk, scene } = arguments;
    talk.apply();
    let path = out.clone().unwrap_or_else(|| default_name(files).with_extension("glb"));
    io::check_export_target(&path)?;
    let stage = staged(files, scene)?;
    let seeing = &scene.seeing;
    let options = content.unwrap_or_else(|| match stage.models_alone {
        false => ExportOptions::SCENE,
        // Options about them ask for them.
        true => ExportOptions {
            cameras: seeing.camera.is_some() || seeing.from.is_some(),
            lights: seeing.lights.as_ref().is_some_and(|slots| !slots.0.is_empty()),
        },
    });
    let sources = stage.sources(files);
    let exported = io::export(&path, &stage.scene, &stage.view, options, &sources)?;
    for text in &exported.notes {
        note(text);
    }
    if out.is_none() {
        note(&format_args!("the scene is in {}", path.display()));
    }
    Ok(())
}
