//! The dial and the loupe: what accuracy costs and gives in this view.
//!
//! Catches: figures of another view that look current, a preset that a key or a click does not
//! choose, a window that measures forever, a loupe that stays after its key is released.

use std::time::Duration;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Chord::Named;
use marraztu::app::actions::{Action, LabRequest, Request};
use marraztu::app::panels::Panel;
use marraztu::app::state::laboratory::Compare;
use marraztu_core::accuracy::{AccuracyPreset, Filter, Settings};
use marraztu_lab::dial::in_words;

use crate::editor::Editor;
use crate::helpers::texts;
use crate::panels::control;

/// A window with the dial, measured.
fn measured() -> Editor {
    let mut editor = Editor::of_size(1000.0, 640.0);
    editor.perform(Action::ToggleDial);
    rest(&mut editor);
    editor
}

fn rest(editor: &mut Editor) {
    editor.settle();
    editor.harness.run_steps(15);
    editor.settle();
    editor.harness.state().wait_until_refined();
    editor.harness.run_steps(3);
}

fn preset(word: &str) -> Settings {
    AccuracyPreset::named(word).unwrap().of(&Settings::default())
}

#[test]
fn the_dial_is_measured_when_nothing_moves_and_then_draws_nothing_more() {
    let mut editor = measured();
    let dial = &editor.state().dial;
    assert!(dial.current);
    let figures = dial.figures();
    let settings: Vec<Settings> = figures.iter().map(|it| it.settings).collect();
    assert_eq!(settings, ["draft", "default", "exact", "ideal"].map(preset));
    let errors: Vec<f64> = figures.iter().filter_map(|it| Some(it.error?.value)).collect();
    assert!(errors[0] > errors[1] && errors[3] == 0.0, "{errors:?}");
    let said = in_words(figures).unwrap();
    assert!(editor.shows(&said), "{said}");
    // It is measured once.
    let pictures = editor.state().statistics.pictures;
    editor.harness.run_steps(5);
    assert_eq!(editor.state().statistics.pictures, pictures);
    let waiting = editor.harness.output().viewport_output.values().map(|it| it.repaint_delay);
    assert!(waiting.min().unwrap() > Duration::from_secs(60), "nothing is to come");
    // Figures of another view are stale, until that one is measured.
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    editor.harness.step();
    assert!(!editor.state().dial.current && !editor.shows(&said));
    rest(&mut editor);
    assert!(editor.state().dial.current);
    // What the keys act on does not matter.
    editor.perform(Action::SubjectLight);
    editor.harness.step();
    assert!(editor.state().dial.current);
}

#[test]
fn a_preset_is_chosen_by_its_row_and_by_its_key() {
    let mut editor = measured();
    for (key, word) in
        [(Key::F7, "draft"), (Key::F9, "exact"), (Key::F10, "ideal"), (Key::F8, "default")]
    {
        editor.press(Named(key));
        assert_eq!(editor.state().settings, preset(word), "{word}");
        assert!(editor.state().dial.current, "all presets are measured already");
    }
    for word in ["exact", "default"] {
        let label = AccuracyPreset::named(word).unwrap().label;
        let row = texts_of_rows(&editor).into_iter().find(|name| name.starts_with(label)).unwrap();
        control(&editor, Role::RadioButton, &row).click();
        editor.settle();
        assert_eq!(editor.state().settings, preset(word), "{word}");
    }
    editor.perform(Action::ToggleDial);
    assert!(texts_of_rows(&editor).is_empty());
}

#[test]
fn a_slow_picture_shows_its_progress_and_is_cancelled_by_a_click() {
    // Small pictures are drawn before their progress is shown.
    let mut editor = Editor::of_size(3000.0, 2000.0);
    editor.settle();
    // Asking and settling would wait for the picture.
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().answer(&ctx, Request::Settings(preset("ideal")));
    let mut steps = 0..100;
    while !editor.shows("Drawing Ideal: ") {
        assert!(steps.next().is_some(), "the progress is not shown");
        std::thread::sleep(Duration::from_millis(100));
        editor.harness.step();
    }
    control(&editor, Role::Button, "Cancel").click();
    editor.settle();
    assert_eq!(editor.state().settings, preset("default"));
    assert!(!editor.shows("Drawing Ideal: "));
}

#[test]
fn settings_of_the_users_own_have_a_row_and_a_way_back() {
    let mut editor = measured();
    let own = Settings { filter: Filter::Nearest, ..preset("default") };
    editor.ask(Request::Settings(own));
    rest(&mut editor);
    let rows = texts_of_rows(&editor);
    assert_eq!(rows.len(), 5, "{rows:?}");
    assert!(rows[4].starts_with("Custom, 1 sample: "), "{rows:?}");
    let measured = editor.state().dial.figures().to_vec();
    assert_eq!(measured.len(), 4);
    assert_eq!(measured[3].error.map(|error| error.value), Some(0.0));
    editor.perform(Action::DialExact);
    assert!(editor.state().dial.current, "nothing is measured again");
    control(&editor, Role::RadioButton, &rows[4]).click();
    editor.settle();
    assert_eq!(editor.state().settings, own);
    // They belong to the scene.
    editor.perform(Action::DialExact);
    editor.ask(Request::Lab(LabRequest::ShowLesson("depth")));
    assert_ne!(editor.state().dial.own, Some(own));
    editor.ask(Request::Lab(LabRequest::Back));
    assert_eq!(editor.state().dial.own, Some(own));
}

#[test]
fn over_a_low_picture_the_dial_is_one_row_until_it_is_clicked() {
    let mut editor = measured();
    assert_eq!(texts_of_rows(&editor).len(), 4);
    editor.perform(Action::Panel(Panel::Laboratory));
    rest(&mut editor);
    assert_eq!(texts_of_rows(&editor), [""; 0]);
    let row = control(&editor, Role::ComboBox, "Accuracy").accesskit_node().value();
    assert!(row.as_ref().is_some_and(|row| row.starts_with("Default, 1 sample: ")), "{row:?}");
    control(&editor, Role::ComboBox, "Accuracy").click();
    editor.settle();
    let rows = texts_of_rows(&editor);
    assert_eq!(rows.len(), 4, "{rows:?}");
    let exact = rows.iter().find(|row| row.starts_with("Exact, 1 sample: ")).unwrap();
    control(&editor, Role::RadioButton, exact).click();
    editor.settle();
    assert_eq!(editor.state().settings, preset("exact"));
}

#[test]
fn the_line_leads_from_quick_to_exact_by_clicks_and_by_dragging() {
    let mut editor = measured();
    // The line is complete when it changes no more.
    let mut points = points_of_line(&editor);
    for _ in 0..60 {
        std::thread::sleep(Duration::from_millis(500));
        rest(&mut editor);
        let before = std::mem::replace(&mut points, points_of_line(&editor));
        if before == points && points.len() > 4 {
            break;
        }
    }
    assert!(points.len() > 2, "{points:?}");
    assert!(points.windows(2).all(|pair| pair[0].1.x < pair[1].1.x), "{points:?}");
    let [(quick, left), .., (exact, right)] = &points[..] else { panic!("{points:?}") };
    control(&editor, Role::RadioButton, exact).click();
    editor.settle();
    assert_eq!(editor.state().settings, preset("ideal"));
    assert!(editor.state().dial.current, "nothing is measured again");
    control(&editor, Role::RadioButton, quick).click();
    editor.settle();
    let quickest = editor.state().settings;
    assert_ne!(quickest, preset("ideal"));
    assert!(editor.shows(quick), "the sentence describes the point: {quick}");
    // The picture follows the pointer, which may leave the line.
    let way = [*left, left.lerp(*right, 0.5), *right + egui::vec2(40.0, -30.0)];
    editor.drag(egui::PointerButton::Primary, &way);
    editor.settle();
    assert_eq!(editor.state().settings, preset("ideal"));
    editor.drag(egui::PointerButton::Primary, &[*right, *left]);
    editor.settle();
    assert_eq!(editor.state().settings, quickest);
}

/// The names of the points of the line, and their places.
fn points_of_line(editor: &Editor) -> Vec<(String, egui::Pos2)> {
    let all = editor.harness.query_all(By::new().role(Role::RadioButton));
    let points = all.filter_map(|node| {
        let name = node.accesskit_node().label()?;
        name.contains(", an error of ").then(|| (name, node.rect().center()))
    });
    points.collect()
}

/// The names of the rows, which contain their figures.
fn texts_of_rows(editor: &Editor) -> Vec<String> {
    let all = editor.harness.query_all(By::new().role(Role::RadioButton));
    let names = all.filter_map(|node| node.accesskit_node().label());
    names.filter(|name| name.contains("s, error ")).collect()
}

#[test]
fn the_loupe_follows_the_pointer_while_its_key_is_held() {
    let mut editor = Editor::of_size(1000.0, 640.0);
    let middle = editor.at(0.5, 0.5);
    editor.hover(middle);
    let shows = |editor: &Editor| texts(editor).iter().any(|text| text == "difference, 8 times");
    editor.perform(Action::ToggleLoupe);
    assert!(editor.state().loupe && shows(&editor));
    // The ideal arrives from the drawing thread.
    editor.settle();
    assert!(!texts(&editor).iter().any(|text| text == "drawing"));
    editor.perform(Action::ToggleLoupe);
    assert!(!shows(&editor));
    // Held and released.
    editor.key(Key::K, true, Modifiers::NONE);
    editor.harness.run_steps(60);
    assert!(shows(&editor));
    editor.key(Key::K, false, Modifiers::NONE);
    editor.harness.run_steps(2);
    assert!(!editor.state().loupe && !shows(&editor));
}

#[test]
fn a_comparison_hides_the_dial() {
    let mut editor = measured();
    assert!(!texts_of_rows(&editor).is_empty());
    editor.ask(Request::Lab(LabRequest::Compare(Compare::Split(0.5))));
    assert!(texts_of_rows(&editor).is_empty());
}
