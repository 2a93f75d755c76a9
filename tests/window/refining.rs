//! The picture of an idle window: refined as far as the user allows.
//!
//! Catches: a refined picture that differs from `render --samples`, settings changed by refining, a
//! window that keeps drawing when it is done, refining that blocks input.

use egui::Key;
use marraztu::app::actions::Chord::Lower;
use marraztu::app::actions::{Action, Request};
use marraztu::app::state::DrawingChoices;
use marraztu_core::accuracy::{Coverage, Samples, Settings, Shot};
use marraztu_core::base::image::Picture;
use marraztu_render::{Renderer, plan_frame};

use crate::editor::Editor;

/// Switches refining on, and waits for the result.
fn refined_to(editor: &mut Editor, refined: Samples) {
    let now = editor.state().drawing;
    editor.ask(Request::Drawing(DrawingChoices { refines: true, refined, ..now }));
    rest(editor);
}

fn rest(editor: &mut Editor) {
    editor.settle();
    // Two changes in quick succession count as motion, for which a slow machine draws less.
    editor.harness.run_steps(15);
    editor.settle();
    editor.harness.state().wait_until_refined();
    editor.harness.run_steps(2);
}

/// Draws with these settings, without the window.
fn rendered(editor: &Editor, settings: Settings) -> Picture {
    let size = editor.state().statistics.size;
    let shot = Shot::new(&editor.scene(), &editor.view(), &settings, size);
    Renderer::default().render(&plan_frame(&shot)).clone()
}

fn shown(editor: &Editor) -> Picture {
    editor.harness.state().shown_picture().unwrap()
}

#[test]
fn a_still_picture_becomes_the_one_that_render_draws_with_as_many_samples() {
    let mut editor = Editor::small();
    let settings = editor.state().settings;
    assert!(shown(&editor) == rendered(&editor, settings), "it is off unless wanted");
    for samples in [Samples::Sixteen, Samples::SixtyFour, Samples::Four] {
        refined_to(&mut editor, samples);
        assert!(shown(&editor) == rendered(&editor, Settings { samples, ..settings }));
        assert!(editor.shows(&format!("refined: {} samples", samples.count())));
    }
    assert_eq!(editor.state().settings, settings, "files and the laboratory keep theirs");
    assert!(editor.state().history.is_saved());
    // A change shows at once, and the picture is refined again.
    editor.press(Lower(Key::Z));
    rest(&mut editor);
    let samples = Samples::Four;
    assert!(shown(&editor) == rendered(&editor, Settings { samples, ..settings }));
    editor.perform(Action::ToggleRefine);
    assert!(shown(&editor) == rendered(&editor, settings), "off again");
}

#[test]
fn chosen_samples_beyond_the_limit_and_the_ancestors_ways_are_not_refined() {
    let mut editor = Editor::small();
    refined_to(&mut editor, Samples::Four);
    let chosen = Settings { samples: Samples::Sixteen, ..Settings::default() };
    let points = Settings { coverage: Coverage::Points, ..Settings::default() };
    for settings in [chosen, points] {
        editor.ask(Request::Settings(settings));
        rest(&mut editor);
        assert!(shown(&editor) == rendered(&editor, settings));
        assert_eq!(editor.state().refined_to(), None);
    }
}

#[test]
fn a_refined_window_draws_nothing_more() {
    let mut editor = Editor::small();
    refined_to(&mut editor, Samples::Four);
    let pictures = editor.state().statistics.pictures;
    editor.harness.run_steps(5);
    assert_eq!(editor.state().statistics.pictures, pictures);
    let waiting = editor.harness.output().viewport_output.values().map(|it| it.repaint_delay);
    assert!(waiting.min().unwrap() > std::time::Duration::from_secs(60), "nothing is to come");
}
