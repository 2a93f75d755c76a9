//! The laboratory panel: measuring, choosing, comparing, explaining, lessons.
//!
//! Catches: a measurement that blocks the window or uses another scene, a mark or a row that draws
//! something else, a comparison of two different moments, a click on a pixel that selects.

use std::time::Duration;

use egui::accesskit::{Role, Toggled};
use egui::{Key, PointerButton};
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::Named;
use marraztu::app::actions::{LabRequest, Request};
use marraztu::app::panels::Panel;
use marraztu::app::state::laboratory::Compare;
use marraztu::app::state::laboratory::Laboratory;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{AXES, Arithmetic, Axis, Filter, LightAt, Settings};
use marraztu_core::base::image::Picture;
use marraztu_io::lessons;
use marraztu_lab::report::{Panels, tabs};
use marraztu_lab::suite::{SUITE, SuiteDetail};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::helpers::texts;
use crate::panels::{click, control};

fn editor() -> Editor {
    let mut editor = Editor::of_size(1300.0, 760.0);
    editor.perform_all(&[Action::Panel(Panel::Laboratory), Action::Panel(Panel::Properties)]);
    editor
}

fn lab(editor: &Editor) -> &Laboratory {
    &editor.state().lab
}

/// Lets the window alternately rest and draw until a condition holds.
#[track_caller]
fn until(editor: &mut Editor, what: &str, done: impl Fn(&Editor) -> bool) {
    for _ in 0..1800 {
        if done(editor) {
            return editor.settle();
        }
        std::thread::sleep(Duration::from_millis(200));
        editor.harness.step();
    }
    panic!("{what} never came");
}

fn measured() -> Editor {
    let mut editor = editor();
    click(&mut editor, Role::Button, "Measure");
    assert!(lab(&editor).running.is_some());
    until_measured(&mut editor);
    editor
}

#[track_caller]
fn until_measured(editor: &mut Editor) {
    // Frequent checks would disturb the measurement.
    for _ in 0..120 {
        std::thread::sleep(Duration::from_secs(2));
        editor.harness.step();
        if lab(editor).running.is_none() {
            break;
        }
    }
    assert_eq!((lab(editor).running, &lab(editor).failed), (None, &None));
    editor.settle();
}

#[test]
fn in_a_small_window_results_are_shown_as_soon_as_something_is_measured() {
    let mut editor = Editor::of_size(1024.0, 640.0);
    editor.perform(Action::Panel(Panel::Laboratory));
    let is_chosen = |editor: &Editor, part: &str| {
        let name = format!("Laboratory: {part}");
        control(editor, Role::RadioButton, &name).accesskit_node().toggled() == Some(Toggled::True)
    };
    assert!(is_chosen(&editor, "Options") && editor.shows("Error metric"));
    editor.ask(Request::Lab(LabRequest::MeasureAxis("rounding")));
    until_measured(&mut editor);
    let report = lab(&editor).report.clone().unwrap();
    let plotted = |editor: &Editor| editor.shows("Draw with ");
    let said = |editor: &Editor| report.verdict().iter().all(|sentence| editor.shows(sentence));
    assert!(is_chosen(&editor, "Results") && said(&editor) && plotted(&editor));
    // At twice the scale, there is room for one of both.
    editor.harness.set_size(egui::vec2(640.0, 400.0));
    editor.settle();
    assert!(is_chosen(&editor, "Verdict") && said(&editor) && !plotted(&editor));
    click(&mut editor, Role::RadioButton, "Laboratory: Plot");
    assert!(!said(&editor) && plotted(&editor));
    click(&mut editor, Role::RadioButton, "Laboratory: Table");
    assert!(editor.shows("Rounding, --rounding") && !plotted(&editor));
    editor.harness.set_size(egui::vec2(1024.0, 640.0));
    editor.settle();
    click(&mut editor, Role::RadioButton, "Laboratory: Results");
    assert!(said(&editor) && plotted(&editor));
}

/// The text that a button copies to the clipboard.
fn copied(editor: &mut Editor, button: &str) -> Option<String> {
    control(editor, Role::Button, button).click();
    (0..4).find_map(|_| {
        editor.harness.step();
        let commands = &editor.harness.output().platform_output.commands;
        commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    })
}

#[test]
fn a_measurement_is_chosen_from_by_its_marks_its_rows_and_its_budgets() {
    let mut editor = measured();
    let report = lab(&editor).report.clone().unwrap();
    assert_eq!(report.findings.size, {
        let size = editor.state().statistics.size;
        [size.width, size.height]
    });
    assert!(!lab(&editor).is_stale(editor.state()));
    assert_eq!(copied(&mut editor, "Copy table"), Some(tabs(&report)));
    assert_eq!(copied(&mut editor, "Copy command"), Some(report.command.clone()));
    for sentence in report.verdict() {
        assert!(editor.shows(&sentence), "{sentence}");
    }
    for panel in [None, Some("samples"), Some("arithmetic")] {
        let label = panel.map_or("Overview", |key| Axis::named(key).unwrap().label);
        click(&mut editor, Role::ComboBox, "Plot");
        click(&mut editor, Role::Button, label);
        assert_eq!(lab(&editor).panel, panel);
        let panels = Panels::new(&report);
        for mark in &panels.of(panel).marks {
            let point = &report.findings.points[mark.point];
            let name = format!("Draw with {}", point.name);
            // Marks may overlap.
            control(&editor, Role::RadioButton, &name).click_accesskit();
            editor.settle();
            assert_eq!(editor.state().settings, mark.chosen, "{name}");
        }
    }
    let flat = control(&editor, Role::RadioButton, "Shading, --shading: Flat");
    flat.click_accesskit();
    editor.settle();
    assert_eq!(editor.state().settings.light, LightAt::Face);
    click(&mut editor, Role::RadioButton, "presets: Default, 1 sample");
    assert_eq!(editor.state().settings, Settings::default());
    assert_eq!(editor.steps(), 0, "accuracy is no step");
    // A change of the scene makes the measurement stale.
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    assert!(lab(&editor).is_stale(editor.state()));
    assert!(editor.shows("or its size has changed since"));
}

#[test]
fn measuring_can_be_given_up_and_ends_with_its_scene() {
    let mut editor = editor();
    for way in ["Cancel", "Esc"] {
        click(&mut editor, Role::Button, "Thoroughly");
        assert!(lab(&editor).running.is_some() && !lab(&editor).is_rough);
        match way {
            "Esc" => assert!(!editor.leaves_by(Named(Key::Escape)), "the results would be lost"),
            button => click(&mut editor, Role::Button, button),
        }
        until(&mut editor, "the end of measuring", |e| lab(e).running.is_none());
        let message = editor.state().message.clone().unwrap();
        assert_eq!(message.text, "Measuring was cancelled", "{way}");
        assert_eq!(lab(&editor).is_rough, lab(&editor).report.is_some());
    }
    click(&mut editor, Role::Button, "Thoroughly");
    editor.perform(Action::New);
    assert!(lab(&editor).running.is_none() && lab(&editor).report.is_none());
}

#[test]
fn the_rows_of_the_laboratory_stay_where_they_are_when_measuring_begins_and_ends() {
    let mut editor = editor();
    let place = |editor: &Editor| control(editor, Role::RadioButton, "Error metric: RMSE").rect();
    let before = place(&editor);
    click(&mut editor, Role::Button, "Thoroughly");
    assert!(lab(&editor).running.is_some());
    assert_eq!(place(&editor), before, "while measuring");
    click(&mut editor, Role::Button, "Cancel");
    until(&mut editor, "the end of measuring", |e| lab(e).running.is_none());
    editor.settle();
    assert_eq!(place(&editor), before, "afterwards");
}

#[test]
fn a_lesson_ends_the_measurements_of_the_users_scene() {
    let mut editor = editor();
    editor.perform(Action::MeasurePlan);
    click(&mut editor, Role::Button, "Thoroughly");
    assert!(lab(&editor).running.is_some() && editor.state().plan.measuring);
    editor.ask(Request::Lab(LabRequest::ShowLesson("depth")));
    editor.ask(Request::Lab(LabRequest::Back));
    assert!(lab(&editor).running.is_none() && !editor.state().plan.measuring);
    assert_eq!(lab(&editor).is_rough, lab(&editor).report.is_some());
    click(&mut editor, Role::Button, "Thoroughly");
    assert!(lab(&editor).running.is_some());
}

#[test]
fn the_picture_is_compared_with_the_exact_one_of_the_same_moment() {
    let mut editor = editor();
    assert!(editor.harness.query_by_label("Split between the reference and the picture").is_none());
    click(&mut editor, Role::RadioButton, "Compare: Split");
    until(&mut editor, "the comparison", |e| lab(e).judged.is_some());
    let judged = lab(&editor).judged.unwrap();
    assert!(judged.error.whole.rmse < 12.0, "{judged:?}");
    let at = control(&editor, Role::Slider, "Split between the reference and the picture")
        .rect()
        .center();
    editor.drag(PointerButton::Primary, &[at, at + egui::vec2(-60.0, 0.0)]);
    let Compare::Split(part) = lab(&editor).compare else { panic!("it is no split any more") };
    assert!(part < 0.31, "{part}");
    assert_eq!(editor.steps(), 0, "the slider is no drag of the view");
    let face = Settings { light: LightAt::Face, ..Settings::default() };
    editor.ask(Request::Settings(face));
    until(&mut editor, "another comparison", |e| {
        lab(e).judged.is_some_and(|judged| judged.settings.light == LightAt::Face)
    });
    assert!(lab(&editor).judged.unwrap().error.whole.largest > 1);
    click(&mut editor, Role::RadioButton, "Compare: x16");
    assert!(editor.shows("Error with 1 sample: largest"));
    click(&mut editor, Role::RadioButton, "Compare: Off");
    assert_eq!(lab(&editor).compare, Compare::Off);
}

#[test]
fn a_pixel_is_explained_by_a_click_that_selects_nothing() {
    let mut editor = editor();
    editor.ask(Request::Settings(Settings { light: LightAt::Face, ..Settings::default() }));
    let selected = editor.view().object;
    click(&mut editor, Role::CheckBox, "Attribute the error of a pixel");
    // On the x_wing, whose light differs from face to face.
    let rect = editor.picture();
    let ship = rect.center() + egui::vec2(0.6, 0.0) * rect.size().min_elem() / 2.0;
    editor.click(ship, PointerButton::Primary);
    until(&mut editor, "the explanation", |e| lab(e).attribution.is_some());
    let lines = lab(&editor).attribution.clone().unwrap();
    assert!(lines.iter().any(|line| line.contains("polygon")), "{lines:?}");
    assert!(lines.iter().any(|line| line.contains("shading")), "{lines:?}");
    assert_eq!((lab(&editor).picking, editor.view().object), (false, selected));
}

#[test]
fn every_lesson_is_a_card_in_a_scene_in_which_it_can_be_seen() {
    let mut editor = Editor::of_size(1000.0, 640.0);
    editor.ask(Request::Lab(LabRequest::ShowLesson(AXES[0].key)));
    for (i, lesson) in lessons().iter().enumerate() {
        let axis = lesson.axis();
        for sentence in [&lesson.title, &lesson.why, &lesson.look] {
            assert!(editor.shows(sentence), "{sentence}");
        }
        assert!(editor.shows(&format!("{} of {}", i + 1, lessons().len())));
        // The title is the first line of the card.
        let card = editor.harness.get_by_label(&lesson.title).rect();
        assert!(card.top() >= editor.picture().bottom(), "the card hides the picture: {card}");
        assert!(lesson.opens_with().is(&editor.state().settings), "{}", axis.key);
        assert_eq!((axis.sense)(&editor.scene(), &editor.view()), Ok(()));
        until(&mut editor, "the comparison", |e| lab(e).judged.is_some());
        let error = lab(&editor).judged.unwrap().error.whole;
        // Rounding promises at most one step, so the error is shown amplified.
        let small = axis.key == "rounding";
        assert_eq!(lab(&editor).compare == Compare::Error(256), small, "{}", axis.key);
        assert!(error.largest >= if small { 1 } else { 4 }, "{}: {error:?}", axis.key);
        if i + 1 < lessons().len() {
            click(&mut editor, Role::Button, "Next");
        }
    }
    click(&mut editor, Role::Button, "Back");
    assert_eq!(lab(&editor).lesson, Some(&lessons()[lessons().len() - 2]));
}

#[test]
fn a_half_that_is_not_of_this_moment_says_so_and_one_of_another_scene_is_not_shown() {
    let mut editor = editor();
    let says = |editor: &Editor, text: &str| texts(editor).iter().any(|it| it == text);
    editor.ask(Request::Lab(LabRequest::Compare(Compare::Split(0.5))));
    until(&mut editor, "the comparison", |editor| says(editor, "ideal"));
    editor.perform(Action::StepXUp);
    assert!(says(&editor, "ideal: drawing") && !says(&editor, "ideal"));
    until(&mut editor, "the comparison after a step", |editor| says(editor, "ideal"));
    editor.ask(Request::Lab(LabRequest::ShowLesson("depth")));
    assert!(says(&editor, "exact depth: drawing"));
    editor.ask(Request::Lab(LabRequest::Back));
    // The view waits for the comparison of the user's scene.
    assert!(says(&editor, "ideal: drawing"));
    until(&mut editor, "the comparison of the own scene", |editor| says(editor, "ideal"));
    let judged = lab(&editor).judged.unwrap();
    assert!(judged.error.whole.rmse < 12.0, "{judged:?}");
}

/// Goes from lesson to lesson through a few axes, and back.
#[test]
fn the_way_back_from_a_lesson_restores_scene_view_settings_selection_and_history() {
    let mut editor = editor();
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    editor.ask(Request::Settings(Settings { light: LightAt::Face, ..Settings::default() }));
    let (scene, view, settings) = (editor.scene(), editor.view(), editor.state().settings);
    let steps = editor.steps();
    assert!(editor.harness.query_by_label("Close").is_none());
    for lesson in ["filter", "depth"] {
        editor.ask(Request::Lab(LabRequest::ShowLesson(lesson)));
        assert!(editor.scene() != scene && lab(&editor).away, "{lesson}");
    }
    editor.perform(Action::StepXUp);
    click(&mut editor, Role::Button, "Close");
    assert!(editor.scene() == scene && editor.view() == view);
    assert_eq!((editor.state().settings, editor.steps()), (settings, steps));
    assert!(!lab(&editor).away && lab(&editor).lesson.is_none());
    editor.perform(Action::Undo);
    assert!(editor.scene() != scene, "what was done before can be undone");
}

#[test]
fn esc_leads_back_from_a_lesson_and_only_then_out_of_the_program() {
    let mut editor = editor();
    let scene = editor.scene();
    editor.ask(Request::Lab(LabRequest::ShowLesson("depth")));
    assert!(editor.scene() != scene);
    assert!(!editor.leaves_by(Named(Key::Escape)));
    assert!(editor.scene() == scene && !lab(&editor).away);
    assert!(!editor.leaves_by(Named(Key::Escape)), "it warns first");
    assert!(editor.leaves_by(Named(Key::Escape)));
}

#[test]
fn a_model_that_is_opened_in_a_lesson_goes_to_the_users_scene() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let has_cube =
        |editor: &Editor| editor.scene().objects.iter().any(|(_, object)| object.name == "cube");
    let lesson = Request::Lab(LabRequest::ShowLesson("depth"));
    let mut editor = editor();
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    let own = editor.scene().objects.len();
    editor.ask(lesson.clone());
    editor.ask(Request::LoadFiles(vec![path.clone()]));
    assert!(!lab(&editor).away, "the way back comes first");
    until(&mut editor, "the dialog", |editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    assert!(has_cube(&editor) && editor.scene().objects.len() == own + 1);
    editor.perform(Action::Undo);
    // A model that is still being read when a lesson opens leads back, too.
    let ctx = editor.harness.ctx.clone();
    let app = editor.harness.state_mut();
    app.answer(&ctx, Request::LoadFiles(vec![path]));
    app.answer(&ctx, lesson);
    assert!(editor.harness.state().state().lab.away);
    until(&mut editor, "the dialog", |editor| editor.shows("Material of cube.obj"));
    assert!(!lab(&editor).away);
}

#[test]
fn leaving_a_lesson_for_a_new_scene_asks_for_the_unsaved_work_that_waits() {
    let mut editor = editor();
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    let before = editor.scene();
    editor.ask(Request::Lab(LabRequest::ShowLesson("filter")));
    assert_eq!(editor.state().settings.filter, Filter::Nearest);
    assert!(editor.shows("plate") && editor.scene() != before);
    editor.perform(Action::New);
    assert!(editor.scene() == before);
    click(&mut editor, Role::Button, "Cancel");
    assert!(editor.scene() == before && !lab(&editor).away);
}

#[test]
fn a_lesson_measures_its_axis_by_itself_and_tells_the_cost() {
    let mut editor = Editor::of_size(1300.0, 760.0);
    // Figures of another scene are not quoted.
    editor.ask(Request::Lab(LabRequest::MeasureAxis("rounding")));
    until_measured(&mut editor);
    editor.ask(Request::Lab(LabRequest::ShowLesson("rounding")));
    // The measurement waits for the final size of the picture.
    editor.settle();
    assert!(lab(&editor).running.is_some() && editor.shows("Measuring on this machine"));
    assert!(!lab(&editor).is_stale(editor.state()), "the picture is smaller than before the card");
    until_measured(&mut editor);
    let rounding = Axis::named("rounding").unwrap();
    let cost = lab(&editor).costs["rounding"].clone();
    let chosen =
        |editor: &Editor| cost.choices[rounding.chosen(&editor.state().settings).word].clone();
    let first = chosen(&editor);
    assert!(editor.shows(&first), "{first}");
    assert!(first.contains("of 255 instead of "), "{first}");
    // Another choice has another line.
    let default = rounding.default_choice();
    let settings = default.of(&editor.state().settings);
    editor.ask(Request::Settings(settings));
    let second = chosen(&editor);
    assert!(second.contains("the default: error ") && editor.shows(&second), "{second}");
    let report = lab(&editor).report.as_ref().unwrap();
    assert_eq!(report.findings.rows_of(Axis::named("rounding").unwrap()).count(), 3);
    // Shown again, it is not measured again.
    editor.ask(Request::Lab(LabRequest::Back));
    editor.ask(Request::Lab(LabRequest::ShowLesson("rounding")));
    assert!(lab(&editor).running.is_none() && editor.shows(&first));
    // On request it is.
    click(&mut editor, Role::Button, "Measure again");
    assert!(lab(&editor).running.is_some());
}

#[test]
fn the_suite_is_measured_and_looked_through() {
    let mut editor = editor();
    editor.ask(Request::Lab(LabRequest::Suite(SuiteDetail::TINY)));
    assert!(lab(&editor).running.is_some());
    until_measured(&mut editor);
    assert_eq!((lab(&editor).suite.len(), lab(&editor).shown_suite), (SUITE.len(), Some(0)));
    click(&mut editor, Role::RadioButton, "Measured: depth");
    assert!(lab(&editor).shown().unwrap().scene.ends_with("depth"));
    click(&mut editor, Role::ComboBox, "Plot");
    click(&mut editor, Role::Button, "Depth");
    control(&editor, Role::RadioButton, "Draw with depth in 16 bits");
    click(&mut editor, Role::RadioButton, "Measured: This scene");
    assert!(lab(&editor).shown().is_none());
}

#[test]
fn the_help_menu_leads_to_every_lesson() {
    let mut editor = Editor::of_size(1300.0, 760.0);
    assert!(!editor.state().panels.has(Panel::Laboratory));
    for lesson in [&lessons()[0], &lessons()[AXES.len() - 1]] {
        click(&mut editor, Role::Button, "Help");
        click(&mut editor, Role::MenuItem, "Lessons");
        editor.harness.run_steps(30);
        for other in lessons() {
            let found = editor.harness.query_by_role_and_label(Role::MenuItem, &other.title);
            assert!(found.is_some(), "{}", other.title);
        }
        click(&mut editor, Role::MenuItem, &lesson.title);
        editor.harness.run_steps(30);
        assert_eq!(lab(&editor).lesson, Some(lesson));
        assert!(editor.shows(&lesson.look));
    }
}

/// The compare line cuts the bright spot in half: light at vertices misses one half, and the exact
/// picture shows the other.
#[test]
fn the_bright_spot_of_the_first_lesson_lies_on_the_compare_line() {
    let mut editor = Editor::of_size(1300.0, 760.0);
    editor.ask(Request::Lab(LabRequest::ShowLesson("shading")));
    assert_eq!(editor.state().settings.light, LightAt::Vertex);
    assert_eq!(lab(&editor).compare, Compare::Split(0.5));
    let (scene, view) = (editor.scene(), editor.view());
    let size = editor.state().statistics.size;
    let drawn = |light| {
        let settings = Settings { light, ..Settings::default() };
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, size));
        Renderer::default().render(&plan).clone()
    };
    let (vertex, pixel) = (drawn(LightAt::Vertex), drawn(LightAt::Pixel));
    let bright = |picture: &Picture| -> Vec<usize> {
        let pixels = picture.pixels().iter().enumerate();
        pixels.filter(|(_, pixel)| pixel[1] > 200).map(|(i, _)| i % size.width).collect()
    };
    let columns = bright(&pixel);
    assert!(columns.len() > 100 && bright(&vertex).is_empty(), "{}", columns.len());
    let left = columns.iter().filter(|x| **x < size.width / 2).count();
    assert!((left * 2).abs_diff(columns.len()) * 10 < columns.len(), "{left} of {}", columns.len());
}

#[test]
fn every_axis_and_every_preset_is_a_choice_among_the_switches_of_the_view() {
    let mut editor = Editor::tall();
    for axis in AXES {
        for choice in axis.choices.iter().chain(&axis.choices[..1]) {
            let label = format!("{}: {}", axis.label, choice.label);
            // Part of the panel is scrolled out of view.
            control(&editor, Role::RadioButton, &label).click_accesskit();
            editor.settle();
            assert_eq!(Axis::chosen(axis, &editor.state().settings).word, choice.word, "{label}");
        }
    }
    editor.ask(Request::Settings(Settings::default()));
    control(&editor, Role::RadioButton, "Accuracy: Exact").click_accesskit();
    editor.settle();
    assert_eq!(editor.state().settings.arithmetic, Arithmetic::F64);
    let found = editor.harness.query_all(By::new().role(Role::RadioButton)).count();
    assert!(found > AXES.len());
}
