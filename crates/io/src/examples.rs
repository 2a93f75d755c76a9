//! The built-in example scenes, with their models and textures.
//!
//! They are ordinary scene files, `assets/examples/*.marraztu`. Paths that begin with [`FOLDER`]
//! refer to files inside the program, so a scene that uses them can be saved anywhere and opened
//! again without the files.
//!
//! WebAssembly has to be small, so there the models and textures are files of the host: see
//! `HOSTED`.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::error::{LoadError, shown};
use super::load::parse;
use super::loaded::Loaded;
use super::progress::Progress;
use super::read::readable;
use super::texture::own_picture;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::{LoadOptions, Texture};

/// The prefix of paths to the built-in examples.
const FOLDER: &str = "example:/";

/// The folder in which the host of WebAssembly provides the models and textures.
#[cfg(target_family = "wasm")]
const HOSTED: &str = "/examples";

/// A built-in scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The label in the menu.
    pub title: &'static str,
    /// The path that [`super::open`] takes.
    pub path: &'static str,
    /// A JPEG of 288 x 180 pixels, drawn by `marraztu render`.
    thumbnail: &'static [u8],
    text: &'static str,
}

impl Example {
    /// Decodes its thumbnail of 288 x 180 pixels.
    pub fn thumbnail(&self) -> Option<Picture> {
        own_picture(self.thumbnail)
    }
}

/// The examples, in the order of the menu.
pub const EXAMPLES: &[Example] = &[
    Example {
        title: "Still life",
        path: "example:/still-life.marraztu",
        thumbnail: include_bytes!("../../../assets/examples/still-life.jpg"),
        text: include_str!("../../../assets/examples/still-life.marraztu"),
    },
    Example {
        title: "Chess",
        path: "example:/chess.marraztu",
        thumbnail: include_bytes!("../../../assets/examples/chess.jpg"),
        text: include_str!("../../../assets/examples/chess.marraztu"),
    },
    Example {
        title: "Harbour",
        path: "example:/harbour.marraztu",
        thumbnail: include_bytes!("../../../assets/examples/harbour.jpg"),
        text: include_str!("../../../assets/examples/harbour.marraztu"),
    },
];

#[cfg(not(target_family = "wasm"))]
macro_rules! files {
    ($($name:literal,)*) => {
        &[$(($name, include_bytes!(concat!("../../../assets/examples/", $name)))),*]
    };
}

/// The models and textures, by their paths in [`FOLDER`].
#[cfg(not(target_family = "wasm"))]
const FILES: &[(&str, &[u8])] = files![
    "chess/bishop.obj",
    "chess/board.obj",
    "chess/board.png",
    "chess/king.obj",
    "chess/knight.obj",
    "chess/pawn.obj",
    "chess/queen.obj",
    "chess/rook.obj",
    "chess/table.obj",
    "chess/table.png",
    "harbour/birds.obj",
    "harbour/hills.obj",
    "harbour/hull.obj",
    "harbour/jetty.obj",
    "harbour/lamp.obj",
    "harbour/lamp.png",
    "harbour/light.obj",
    "harbour/lighthouse.obj",
    "harbour/rig.obj",
    "harbour/rock.obj",
    "harbour/sails.obj",
    "harbour/sea.obj",
    "harbour/sky.obj",
    "harbour/sky.png",
    "harbour/town.obj",
    "harbour/town.png",
    "still-life/apple.obj",
    "still-life/bottle.obj",
    "still-life/bowl.obj",
    "still-life/bowl.png",
    "still-life/candle.obj",
    "still-life/cloth.obj",
    "still-life/cloth.png",
    "still-life/cork.obj",
    "still-life/flame.obj",
    "still-life/flame.png",
    "still-life/grapes.obj",
    "still-life/half.obj",
    "still-life/half.png",
    "still-life/holder.obj",
    "still-life/label.obj",
    "still-life/label.png",
    "still-life/lemon.obj",
    "still-life/orange.obj",
    "still-life/pear.obj",
    "still-life/table.obj",
    "still-life/table.png",
    "still-life/wall.obj",
    "still-life/wall.png",
];

/// Returns whether a path names an example or one of its files.
pub fn is_example(path: &Path) -> bool {
    path.to_str().is_some_and(|path| path.starts_with(FOLDER))
}

/// Resolves a path in the scene file of an example, or one that names a file of the examples. The
/// result has slashes on every system.
pub(super) fn resolved(folder: &Path, path: &str) -> Option<PathBuf> {
    let within = format!("{}/{path}", folder.to_str()?);
    let names = [path, &within];
    names.into_iter().find(|name| name.starts_with(FOLDER)).map(PathBuf::from)
}

/// Checks whether `path` is a file that can be read, or a built-in example, without reading it.
///
/// # Errors
/// If it does not exist, or is not a file: a folder, a device, or a pipe that was not inherited.
pub fn check_file(path: &Path) -> Result<(), LoadError> {
    if scene_text(path).is_some() {
        return Ok(());
    }
    readable(path).map(|_| ())
}

/// Returns the text of an example's scene file.
pub(super) fn scene_text(path: &Path) -> Option<&'static str> {
    EXAMPLES.iter().find(|example| Path::new(example.path) == path).map(|example| example.text)
}

/// Returns the content of a file in [`FOLDER`].
pub(super) fn content(path: &Path) -> Option<Cow<'static, [u8]>> {
    content_of(path.to_str()?.strip_prefix(FOLDER)?)
}

#[cfg(not(target_family = "wasm"))]
fn content_of(name: &str) -> Option<Cow<'static, [u8]>> {
    let file = FILES.iter().find(|(other, _)| *other == name);
    file.map(|(_, content)| Cow::Borrowed(*content))
}

#[cfg(target_family = "wasm")]
fn content_of(name: &str) -> Option<Cow<'static, [u8]>> {
    std::fs::read(Path::new(HOSTED).join(name)).ok().map(Cow::Owned)
}

/// Parses a model of the examples from its `content`. Fails if `progress` is cancelled.
pub(super) fn model(
    path: &Path,
    content: &[u8],
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let mut loaded = parse(content, &shown(path), None, options, progress)?;
    loaded.model.source = Some(path.to_owned());
    Ok(loaded)
}

/// Decodes a texture of the examples from its `content`. Fails if it is not a picture.
pub(super) fn texture(path: &Path, content: &[u8]) -> Result<Shared<Texture>, LoadError> {
    let not_a_picture = || LoadError::file(&shown(path), "the picture cannot be decoded");
    let picture = own_picture(content).ok_or_else(not_a_picture)?;
    Ok(Shared::new(Texture::new(path, picture)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::{Opened, open, save};

    /// Returns `assets/examples`.
    fn folder() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/examples")
    }

    fn opened(path: &Path) -> Opened {
        let opened = open(path, &Progress::new()).unwrap();
        assert_eq!(opened.findings, [], "{}", path.display());
        opened
    }

    #[test]
    fn the_program_carries_every_file_of_the_examples() {
        let mut files = BTreeSet::new();
        let mut size = 0;
        for example in EXAMPLES {
            let name = example.path.strip_prefix(FOLDER).unwrap();
            size += example.text.len();
            let name = name.strip_suffix(".marraztu").unwrap();
            for entry in std::fs::read_dir(folder().join(name)).unwrap() {
                let file = entry.unwrap().file_name().into_string().unwrap();
                files.insert(format!("{name}/{file}"));
            }
        }
        let carried: BTreeSet<String> = FILES.iter().map(|(name, _)| (*name).to_owned()).collect();
        assert_eq!(carried, files);
        size += FILES.iter().map(|(_, content)| content.len()).sum::<usize>();
        assert!(size < 1_500_000, "the examples take {size} bytes");
    }

    #[test]
    fn an_example_is_the_same_scene_from_the_program_and_from_its_folder() {
        for example in EXAMPLES {
            let carried = opened(Path::new(example.path));
            let disk = opened(&folder().join(example.path.strip_prefix(FOLDER).unwrap()));
            assert_eq!(carried.view, disk.view, "{}", example.title);
            assert_eq!(carried.settings, disk.settings, "{}", example.title);
            assert_eq!(carried.scene.objects.len(), disk.scene.objects.len());
            let objects = carried.scene.objects.iter().zip(disk.scene.objects.iter());
            for ((_, carried), (_, disk)) in objects {
                assert_eq!(carried.model.mesh, disk.model.mesh, "{}", carried.name);
                let picture = |texture: &Option<Shared<Texture>>| {
                    texture.as_ref().map(|texture| (texture.picture.clone(), texture.wrap))
                };
                assert_eq!(picture(&carried.texture), picture(&disk.texture), "{}", carried.name);
            }
        }
    }

    #[test]
    fn a_saved_example_opens_again_from_another_folder() {
        let folder = tempfile::tempdir().unwrap();
        for example in EXAMPLES {
            let Opened { scene, view, settings, .. } = opened(Path::new(example.path));
            let path = folder.path().join("mine.marraztu");
            save(&path, &scene, &view, &settings).unwrap();
            let again = opened(&path);
            assert_eq!((again.scene, again.view), (scene, view), "{}", example.title);
        }
    }
}
