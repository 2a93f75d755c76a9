//! The scenes of the lessons: each makes one kind of error as visible as possible.
//!
//! They are ordinary scene files, built into the program with their models.

use std::path::PathBuf;

use super::progress::Progress;
use super::scene_file::{Opened, SceneFileError, open_text};

/// The scenes, by the names in [`marraztu_core::accuracy::Lesson::scene`].
const LESSONS: &[(&str, &str)] = &[
    ("ball", include_str!("../../../assets/lessons/ball.marraztu")),
    ("dimples", include_str!("../../../assets/lessons/dimples.marraztu")),
    ("dusk", include_str!("../../../assets/lessons/dusk.marraztu")),
    ("far", include_str!("../../../assets/lessons/far.marraztu")),
    ("fence", include_str!("../../../assets/lessons/fence.marraztu")),
    ("floor", include_str!("../../../assets/lessons/floor.marraztu")),
    ("highlight", include_str!("../../../assets/lessons/highlight.marraztu")),
    ("near", include_str!("../../../assets/lessons/near.marraztu")),
    ("night", include_str!("../../../assets/lessons/night.marraztu")),
    ("panes", include_str!("../../../assets/lessons/panes.marraztu")),
    ("plate", include_str!("../../../assets/lessons/plate.marraztu")),
    ("pressed", include_str!("../../../assets/lessons/pressed.marraztu")),
    ("shadow", include_str!("../../../assets/lessons/shadow.marraztu")),
    ("telescope", include_str!("../../../assets/lessons/telescope.marraztu")),
    ("wheel", include_str!("../../../assets/lessons/wheel.marraztu")),
];

/// Opens the scene of a lesson.
///
/// # Errors
/// If no lesson has this name.
pub fn lesson_scene(name: &str) -> Result<Opened, SceneFileError> {
    let found = LESSONS.iter().find(|(other, _)| *other == name);
    let Some((_, text)) = found else {
        let reason = "the program has no lesson of this name".to_owned();
        return Err(SceneFileError::File { file: name.to_owned(), reason });
    };
    open_text(text, name, PathBuf::new(), &Progress::new())
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::accuracy::AXES;

    #[test]
    fn every_axis_has_a_scene_in_which_it_means_something() {
        for axis in AXES {
            let Opened { scene, view, .. } = lesson_scene(axis.lesson.scene).unwrap();
            assert_eq!((axis.sense)(&scene, &view), Ok(()), "{}", axis.key);
        }
        assert!(lesson_scene("nothing").is_err());
    }
}
