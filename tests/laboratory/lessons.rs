//! Each lesson shows its topic: its scene, drawn with its opening choice, differs visibly from the
//! reference.
//!
//! Catches: a scene in which the choice makes no difference, and a reference with the same fault as
//! the picture.

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_io as io;
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};

#[test]
fn every_lesson_opens_on_an_error_that_can_be_seen() {
    for lesson in io::lessons() {
        let (axis, settings) = (lesson.axis(), lesson.settings());
        let opened = io::lesson_scene(&lesson.scene).unwrap();
        let size = Size::new(480, 300);
        let mut studio = Studio::new(Shot::new(&opened.scene, &opened.view, &settings, size));
        let exact = studio.rendering(&Reference::Alone(axis).of(&settings));
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
