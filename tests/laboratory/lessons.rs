//! Each lesson shows its topic: its scene, drawn with its opening choice, differs visibly from the
//! reference.
//!
//! Catches: a scene in which the choice makes no difference, and a reference with the same fault as
//! the picture.

use marraztu_core::accuracy::{AXES, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_io as io;
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};

#[test]
fn every_lesson_opens_on_an_error_that_can_be_seen() {
    for axis in AXES {
        let opened = io::lesson_scene(axis.lesson.scene).unwrap();
        let settings = axis.lesson_choice().of(&Settings::default());
        let size = Size::new(480, 300);
        let mut studio = Studio::new(Shot::new(&opened.scene, &opened.view, &settings, size));
        let exact = studio.reference(&settings, Reference::of(axis));
        let error = studio.rendering(&settings).error(&exact);
        // Faint lights and rounding promise at most one step. Their lessons show the error
        // amplified, so it has to affect many bytes.
        let (largest, differing) = match axis.key {
            "rounding" => (1, 0.02),
            _ => (4, 0.0002),
        };
        let whole = &error.whole;
        assert!(whole.largest >= largest, "{}: {error:?}", axis.key);
        assert!(whole.differing >= differing, "{}: {error:?}", axis.key);
    }
}
