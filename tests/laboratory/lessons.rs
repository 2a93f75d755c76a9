//! Each lesson shows its topic: its scene, drawn with its opening choice, differs visibly from the
//! reference.
//!
//! Catches: a scene in which the choice makes no difference, and a reference with the same fault as
//! the picture.

use marraztu_core::accuracy::{Axis, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_io as io;
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};
use marraztu_render::{Renderer, plan_frame};

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

#[test]
fn the_line_between_the_plates_of_the_lesson_on_depth_dissolves_into_stripes() {
    let axis = Axis::named("depth").unwrap();
    let lesson = io::lesson_on(axis);
    let opened = io::lesson_scene(&lesson.scene).unwrap();
    // The number of changes between red and blue in the row that changes most.
    let stripes = |settings: &Settings| {
        let shot = Shot::new(&opened.scene, &opened.view, settings, Size::new(480, 300));
        let mut renderer = Renderer::default();
        let picture = renderer.render(&plan_frame(&shot));
        let changes = |row: &[[u8; 4]]| {
            let plates = row.iter().filter(|pixel| pixel[0].abs_diff(pixel[2]) > 100);
            let red: Vec<bool> = plates.map(|pixel| pixel[0] > pixel[2]).collect();
            red.windows(2).filter(|pair| pair[0] != pair[1]).count()
        };
        picture.pixels().chunks(480).map(changes).max().unwrap_or(0)
    };
    let settings = lesson.settings();
    assert_eq!(stripes(&Reference::Alone(axis).of(&settings)), 1);
    assert!(stripes(&settings) >= 8, "{}", stripes(&settings));
}
