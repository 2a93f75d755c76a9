//! The target of a picture: standard output or a file. The default file name derives from the input
//! files.

use std::io::{BufWriter, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

use marraztu_core::base::image::Size;
use marraztu_io::{self as io, PICTURE_FORMATS, Sources};

use super::arguments::Render;
use super::failure::{Failure, usage};
use super::stage::is_scene;
use super::values::is_standard;

/// The picture's name if no input file has a name.
const UNNAMED: &str = "scene";

/// The target of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// A file.
    File(PathBuf),
    /// Standard output, as PNG.
    Output,
}

impl Target {
    /// Returns the target given in the arguments, checked before anything is read or drawn.
    pub(super) fn of(arguments: &Render) -> Result<Self, Failure> {
        let target = match &arguments.out {
            Some(out) if is_standard(out) => Self::Output,
            Some(out) => Self::File(out.clone()),
            None => Self::File(default_name(&arguments.picture.files)),
        };
        match &target {
            Self::Output if std::io::stdout().is_terminal() => Err(usage(
                "standard output is a terminal: send it to a file or another program, as in \
                 `marraztu render --out - > picture.png`",
            )),
            Self::Output => Ok(target),
            Self::File(path) => {
                io::check_picture_target(path)?;
                Ok(target)
            }
        }
    }

    /// Refuses to overwrite an input file, and rejects formats without an alpha channel if the
    /// picture needs one.
    pub(super) fn check(&self, sources: &Sources, transparent: bool) -> Result<(), Failure> {
        let Self::File(path) = self else { return Ok(()) };
        sources.spare(path)?;
        if transparent {
            io::check_alpha(path)?;
        }
        Ok(())
    }

    /// Writes the picture, which arrives in bands of rows.
    pub(super) fn write(
        &self,
        size: Size,
        transparent: bool,
        next: &mut io::NextBand<'_>,
    ) -> Result<(), Failure> {
        match self {
            Self::File(path) => Ok(io::save_bands(path, size, transparent, next)?),
            Self::Output => {
                let mut output = BufWriter::new(std::io::stdout().lock());
                let png = &PICTURE_FORMATS[0];
                let written = png
                    .encode_bands(size, transparent, next, &mut output)
                    .and_then(|()| output.flush());
                match written {
                    // The reader has closed the pipe, like `head`.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                    written => written.map_err(Failure::Output),
                }
            }
        }
    }
}

/// Returns the name of the scene or first model with .png, in the current folder.
pub(super) fn default_name(files: &[PathBuf]) -> PathBuf {
    let named = || files.iter().filter(|file| !is_standard(file));
    let file = named().find(|file| is_scene(file)).or_else(|| named().next());
    let name = file.and_then(|file| file.file_name()).map(Path::new);
    let stem = name.and_then(|name| match name.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("gz") => {
            Path::new(name.file_stem()?).file_stem()
        }
        _ => name.file_stem(),
    });
    let mut name = stem.unwrap_or(UNNAMED.as_ref()).to_owned();
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
