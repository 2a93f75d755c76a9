//! The target of a picture: standard output or a file. The default file name derives from the input
//! files.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use marraztu_core::base::image::Size;
use marraztu_io::{self as io, PICTURE_FORMATS, Sources};

use super::arguments::Render;
use super::failure::{Failure, usage};
use super::layers::{Encoding, FIELD, LayerContent, LayerFile, LayerOptions};
use super::stage::is_scene;
use super::talk::write_out;
use super::terminal::{TerminalForm, cells};
use super::values::{is_standard, is_terminal, stem};

/// The picture's name if no input file has a name.
const UNNAMED: &str = "scene";

/// The target of a picture.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// The files of the picture and its layers.
    Files(Vec<LayerFile>),
    /// Standard output, as PNG.
    Output,
    /// The terminal.
    Terminal(TerminalForm),
}

impl Target {
    /// Returns the target given in the arguments, checked before anything is read or drawn.
    pub(super) fn of(arguments: &Render) -> Result<Self, Failure> {
        let layers = &arguments.layers;
        let out = match &arguments.out {
            Some(out) if is_standard(out) => {
                if layers.are_given() {
                    return Err(usage("layers are written to files, not to standard output"));
                }
                if std::io::stdout().is_terminal() {
                    return Err(usage(
                        "standard output is a terminal: send it to a file or another program, as \
                         in `marraztu render --out - > picture.png`",
                    ));
                }
                return Ok(Self::Output);
            }
            Some(out) if is_terminal(out) => {
                if layers.are_given() {
                    return Err(usage("layers are written to files, not to the terminal"));
                }
                let variable = |name: &str| std::env::var(name).ok();
                let form = arguments.terminal.unwrap_or_else(|| TerminalForm::of(&variable));
                return Ok(Self::Terminal(form));
            }
            Some(out) => out.clone(),
            None if layers.are_given() => {
                let name = default_name(&arguments.picture.files);
                let stem = name.file_stem().unwrap_or_default().to_string_lossy();
                PathBuf::from(format!("{stem}-{FIELD}.png"))
            }
            None => default_name(&arguments.picture.files),
        };
        let path = |layer: &str| match out.to_str() {
            Some(name) if layers.are_given() => PathBuf::from(name.replace(FIELD, layer)),
            _ => out.clone(),
        };
        let files = layers.files(path).map_err(Failure::Usage)?;
        for file in &files {
            io::check_layer_target(&file.path)?;
        }
        Ok(Self::Files(files))
    }

    /// Returns the file, if the picture is written to one in a common format, without layers.
    pub(super) fn plain_file(&self, options: &LayerOptions) -> Option<&Path> {
        match self {
            Self::Files(files) if !options.are_given() => match &files[..] {
                [LayerFile { path, encoding: Encoding::Picture(_), .. }] => Some(path),
                _ => None,
            },
            Self::Files(_) | Self::Output | Self::Terminal(_) => None,
        }
    }

    /// Returns the folder of the first file.
    pub(super) fn folder(&self) -> &Path {
        let Self::Files(files) = self else { return Path::new("") };
        files.first().and_then(|file| file.path.parent()).unwrap_or(Path::new(""))
    }

    /// Returns the size of the picture.
    pub(super) fn size(&self, size: Size) -> Size {
        match self {
            Self::Terminal(form) => form.size(size, cells()),
            Self::Files(_) | Self::Output => size,
        }
    }

    /// Refuses to overwrite an input file, and rejects formats without an alpha channel if the
    /// picture needs one.
    pub(super) fn check(&self, sources: &Sources, transparent: bool) -> Result<(), Failure> {
        let Self::Files(files) = self else { return Ok(()) };
        for LayerFile { path, encoding, .. } in files {
            sources.spare(path)?;
            if let (true, Encoding::Picture(_)) = (transparent, encoding) {
                io::check_alpha(path)?;
            }
        }
        Ok(())
    }

    /// Writes the picture and its layers.
    pub(super) fn write(
        &self,
        content: &LayerContent<'_>,
        options: &LayerOptions,
    ) -> Result<(), Failure> {
        match (self, content.color) {
            (Self::Files(files), _) => {
                // If a layer cannot be encoded, no file is written.
                let png = options.png();
                let encoded = files.iter().map(|file| {
                    file.encode(content, &png, None).map_err(|reason| {
                        Failure::Absent(format!("{}: {reason}", file.path.display()))
                    })
                });
                let encoded = encoded.collect::<Result<Vec<_>, _>>()?;
                for (file, encoded) in files.iter().zip(&encoded) {
                    io::save_encoded(&file.path, encoded)?;
                }
                Ok(())
            }
            (Self::Output | Self::Terminal(_), None) => Ok(()),
            (Self::Terminal(form), Some(picture)) => {
                write_out(form.encode(picture).map_err(Failure::Absent)?.as_bytes())
            }
            (Self::Output, Some(picture)) => {
                write_out(&PICTURE_FORMATS[0].encode(picture).map_err(Failure::Absent)?)
            }
        }
    }
}

/// Returns the name of the scene or first model with .png, in the current folder.
pub(super) fn default_name(files: &[PathBuf]) -> PathBuf {
    let named = || files.iter().filter(|file| !is_standard(file));
    let file = named().find(|file| is_scene(file)).or_else(|| named().next());
    let stem = file.map(|file| stem(file)).filter(|stem| !stem.is_empty());
    let mut name = stem.unwrap_or_else(|| UNNAMED.into());
    name.push(".png");
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_is_named_after_the_scene_or_the_first_model() {
        for (files, name) in [
            (&["models/teapot.obj"][..], "teapot.png"),
            (&["models/teapot.obj.gz", "b.obj"], "teapot.png"),
            (&["a.obj", "../shelf.marraztu"], "shelf.png"),
            (&["-", "b.obj"], "b.png"),
            (&["-"], "scene.png"),
            (&[], "scene.png"),
            (&["no.ending.here"], "no.ending.png"),
        ] {
            let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
            assert_eq!(default_name(&files), Path::new(name), "{files:?}");
        }
    }
}
