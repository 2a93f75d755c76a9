//! Passes scenes to another instance of the program that draws them, as a page does with a worker.
//!
//! The text is that of a scene file with complete paths, so every number arrives with all its bits.
//! Objects that have not changed are left out, because a scene may have thousands while the camera
//! moves.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::SceneFileError;
use super::files::{Files, Known};
use super::format::FileScene;
use super::{open, save};
use crate::findings::Findings;
use crate::progress::Progress;
use crate::window_state::WindowState;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Objects, Scene, View};

/// The name of the text in errors.
const NAME: &str = "the scene to draw";

/// The text, with or without the objects.
#[derive(Serialize, Deserialize)]
struct Message {
    /// Whether the objects are left out, because the previous message has the same.
    same_objects: bool,
    scene: FileScene,
}

/// Writes a scene with its view and settings for [`scene_of_message`]. Objects are left out if they
/// equal the objects of `before`, the scene of the previous message.
///
/// # Errors
/// The reason, if a model or a texture comes from no file, or its path is not UTF-8.
pub fn scene_to_message(
    (scene, view, settings): (&Scene, &View, &Settings),
    before: Option<&Scene>,
) -> Result<String, String> {
    let same_objects = before.is_some_and(|before| before.objects == scene.objects);
    let sent = Scene {
        objects: if same_objects { Objects::default() } else { scene.objects.clone() },
        ..scene.clone()
    };
    // Paths are complete, as from no folder.
    let scene = save::file_scene(&sent, view, &WindowState::DEFAULT, settings, Path::new(""))?;
    ron::to_string(&Message { same_objects, scene }).map_err(|error| error.to_string())
}

/// Reads a scene of [`scene_to_message`]. `before` is the scene of the previous message. Models and
/// textures that are not in `known` are loaded.
///
/// # Errors
/// If the text is not such a message. Missing models become placeholders, as in a scene file.
pub fn scene_of_message(
    text: &str,
    before: Option<&Scene>,
    known: &Known,
) -> Result<(Scene, View, Settings), SceneFileError> {
    let fail = |reason: String| SceneFileError::File { file: NAME.to_owned(), reason };
    let message: Message = ron::from_str(text).map_err(|error| fail(error.to_string()))?;
    let Message { same_objects, scene: file } = message;
    let kept = before.filter(|_| same_objects).map(|before| before.objects.clone());
    let mut files = Files::new(PathBuf::new(), NAME);
    files.know(known);
    files.load(&file, NAME, &Progress::new())?;
    let kept = kept.unwrap_or_default();
    let (scene, view) =
        open::scene_with(kept, &file, &files, &mut Findings::new(NAME)).map_err(fail)?;
    Ok((scene, view, file.settings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::scene::{Command, ItemId};

    #[test]
    fn a_scene_arrives_with_all_its_bits_and_unchanged_objects_are_not_sent_again() {
        let lesson = crate::lesson_scene(&crate::lessons()[0].scene).unwrap();
        for (mut scene, view) in [crate::default_scene(), (lesson.scene, lesson.view)] {
            let settings = Settings::default();
            let text = scene_to_message((&scene, &view, &settings), None).unwrap();
            let (there, there_view, there_settings) =
                scene_of_message(&text, None, &Known::default()).unwrap();
            assert!((&there, &there_view, there_settings) == (&scene, &view, settings));
            // A change of the background leaves the objects as they are.
            let before = scene.clone();
            Command::Background(marraztu_core::base::color::Color([1, 2, 3]))
                .apply(&mut scene)
                .unwrap();
            let short = scene_to_message((&scene, &view, &settings), Some(&before)).unwrap();
            assert!(short.len() < text.len(), "{} {}", short.len(), text.len());
            let (again, ..) = scene_of_message(&short, Some(&there), &Known::of(&there)).unwrap();
            assert!(again == scene);
            // A deleted object is a change of the list.
            let id = scene.objects.first().unwrap();
            Command::Remove(ItemId::Object(id)).apply(&mut scene).unwrap();
            let view = scene.first_view();
            let text = scene_to_message((&scene, &view, &settings), Some(&before)).unwrap();
            let (last, ..) = scene_of_message(&text, Some(&again), &Known::of(&again)).unwrap();
            assert!(last == scene);
        }
    }

    #[test]
    fn what_is_no_message_is_refused() {
        for text in ["", "(", "(same_objects: false)", "\u{0}"] {
            assert!(scene_of_message(text, None, &Known::default()).is_err(), "{text:?}");
        }
    }
}
