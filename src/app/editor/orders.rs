//! Orders for files that take time to make: pictures with options, turntables, exports.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::app::documents::picture_dialog::{PictureChoices, Purpose};
use crate::app::widgets::text::file_name;
use crate::picture_file::draw_into;
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::edit::turntable::turned;
use marraztu_core::scene::{Scene, View};
use marraztu_io::{self as io, Animation, AnimationWriter, ExportOptions, Progress, Sources};
use marraztu_render::{Renderer, plan_frame, without_ground_while};

/// A file to make from a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Order {
    pub(super) path: PathBuf,
    pub(super) content: Content,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum Content {
    /// A picture, or a turntable.
    Drawn(PictureChoices),
    /// The scene in another format, or a part of it.
    Exported(ExportOptions),
}

/// The outcome of making a file.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum Made {
    /// The file was written; with notes about it.
    Done(PathBuf, Vec<String>),
    Cancelled,
    /// It was cancelled after some of the numbered pictures in this folder.
    Partial(PathBuf),
    /// The reason, as a sentence.
    Failed(String),
}

/// The notes about a file, `None` if it was cancelled, or why it failed.
type Notes = Result<Option<Vec<String>>, String>;

impl Order {
    /// Describes the work: "Drawing cow.png".
    pub(super) fn label(&self) -> String {
        let name = file_name(&self.path);
        match self.content {
            Content::Drawn(_) => format!("Drawing {name}"),
            Content::Exported(_) => format!("Exporting {name}"),
        }
    }

    /// Makes the file. No file of `sources` is overwritten.
    pub(super) fn fulfil(
        &self,
        (scene, view, settings): (Scene, View, Settings),
        sources: &Sources,
        progress: &Progress,
    ) -> Made {
        let made = match self.content {
            Content::Drawn(choices) => {
                let settings = Settings { samples: choices.samples, ..settings };
                let shot = Shot { scene, view, settings, size: choices.whole() };
                match choices.purpose {
                    Purpose::Picture => self.picture(&shot, choices.transparent, progress),
                    Purpose::Turntable => self.turntable(&shot, &choices, sources, progress),
                }
            }
            Content::Exported(options) => io::export(&self.path, &scene, &view, options, sources)
                .map(|exported| Some(exported.notes))
                .map_err(|error| error.to_string()),
        };
        match made {
            Ok(Some(notes)) => Made::Done(self.path.clone(), notes),
            Ok(None) if self.path.is_dir() => Made::Partial(self.path.clone()),
            Ok(None) => Made::Cancelled,
            Err(why) => Made::Failed(why),
        }
    }

    fn picture(&self, shot: &Shot, transparent: bool, progress: &Progress) -> Notes {
        let save =
            |size, next: &mut io::NextBand<'_>| io::save_bands(&self.path, size, transparent, next);
        match draw_into(shot, transparent, progress, save) {
            Ok((Ok(()), _)) => Ok(Some(Vec::new())),
            Ok((Err(why), _)) => Err(why.to_string()),
            Err(io::Cancelled) => Ok(None),
        }
    }

    fn turntable(
        &self,
        shot: &Shot,
        choices: &PictureChoices,
        sources: &Sources,
        progress: &Progress,
    ) -> Notes {
        let PictureChoices { frames, seconds, transparent, turn, .. } = *choices;
        let fail = |error: &dyn std::fmt::Display| error.to_string();
        let animation = Animation { size: shot.size, frames, seconds, transparent };
        let mut writer =
            AnimationWriter::begin(&self.path, animation, sources).map_err(|it| fail(&it))?;
        let notes = writer.notes().to_vec();
        let mut renderer = Renderer::default();
        // Frames are written one by one, so memory holds a single picture.
        for i in 0..frames {
            let part = f64::from(i) / f64::from(frames);
            let scene = turned(&shot.scene, &shot.view, turn, part).map_err(|it| fail(&it))?;
            let view = View { time: shot.view.time + seconds * part, ..shot.view.clone() };
            let shot = Shot { scene, view, ..shot.clone() };
            let wanted = || !progress.is_cancelled();
            let drawn = if transparent {
                without_ground_while(&mut renderer, &shot, &wanted)
            } else {
                renderer.redraw(&plan_frame(&shot), &wanted).map(|_| renderer.picture().clone())
            };
            let Ok(picture) = drawn else { return Ok(None) };
            writer.push(&picture).map_err(|it| fail(&it))?;
            if progress.reached(i as usize + 1, frames as usize).is_err() {
                return Ok(None);
            }
        }
        writer.finish().map_err(|it| fail(&it))?;
        Ok(Some(notes))
    }
}
