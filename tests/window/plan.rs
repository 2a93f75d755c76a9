//! The plan panel; and an idle window draws nothing.
//!
//! Catches: a panel that lags behind the scene, a list for another picture, an effect without a
//! line, a window that repaints without a cause.

use egui::accesskit::Role;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::Lower;
use marraztu::app::panels::Panel;
use marraztu_render::Effect;

use crate::editor::Editor;
use crate::panels::control;

fn effects(editor: &Editor) -> Vec<Effect> {
    let explained = editor.state().plan.explained.clone().expect("the panel is shown");
    let mut effects: Vec<Effect> = explained.uses.iter().map(|one| one.effect).collect();
    effects.dedup();
    effects
}

#[test]
fn the_plan_follows_the_scene_while_it_is_shown() {
    let mut editor = Editor::of_size(1400.0, 1400.0);
    assert!(editor.state().plan.explained.is_none(), "no one has asked");
    editor.perform(Action::Panel(Panel::Plan));
    assert!(editor.shows("sun on, all 3"));
    let lights = |editor: &Editor| {
        effects(editor).into_iter().filter(|effect| matches!(effect, Effect::Light(_))).count()
    };
    assert_eq!(lights(&editor), 5);
    editor.press(Lower(egui::Key::Num1));
    assert!(editor.shows("sun left out, the frame: switched off"));
    editor.perform(Action::Undo);
    assert!(editor.shows("sun on, all 3"));
    editor.perform(Action::Panel(Panel::Plan));
    assert!(!editor.shows("sun on, all 3"));
}

/// Clicks a line, scrolled into view if necessary.
fn unfold(editor: &mut Editor, line: &str) {
    control(editor, Role::Row, line).click_accesskit();
    editor.settle();
}

#[test]
fn every_effect_has_a_line_that_unfolds_to_its_differences() {
    let mut editor = Editor::of_size(1400.0, 1400.0);
    editor.perform(Action::Panel(Panel::Plan));
    for one in editor.state().plan.explained.clone().unwrap().uses.iter() {
        assert!(editor.shows(&format!("{} ", one.name)), "{}", one.name);
    }
    let spot = "object spot on, 2 of 3 objects";
    assert!(!editor.shows("left out, x_wing: nothing is within its cone"));
    unfold(&mut editor, spot);
    assert!(editor.shows("left out, x_wing: nothing is within its cone"));
    unfold(&mut editor, spot);
    assert!(!editor.shows("left out, x_wing: nothing is within its cone"));
}

#[test]
fn a_measurement_is_shown_until_something_changes() {
    let mut editor = Editor::of_size(900.0, 500.0);
    editor.perform(Action::MeasurePlan);
    assert!(editor.state().panels.has(Panel::Plan) && editor.state().plan.measuring);
    for _ in 0..3000 {
        if !editor.state().plan.measuring {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
        editor.harness.step();
    }
    editor.settle();
    let costs = editor.state().plan.costs.clone().expect("it was measured");
    assert!(costs.costs.frame > 0.0 && costs.costs.effects.len() > 4);
    assert!(editor.shows("ms a frame"));
    editor.press(Lower(egui::Key::Num1));
    assert!(editor.shows("measured before the last change"));
}

#[test]
fn measuring_can_be_given_up() {
    let mut editor = Editor::small();
    editor.perform(Action::MeasurePlan);
    editor.perform(Action::MeasurePlan);
    for _ in 0..3000 {
        if !editor.state().plan.measuring {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
        editor.harness.step();
    }
    assert!(!editor.state().plan.measuring && editor.state().plan.costs.is_none());
}

#[test]
fn an_idle_editor_draws_nothing_and_asks_for_no_frame() {
    for plan in [false, true] {
        let mut editor = Editor::new();
        if plan {
            editor.perform(Action::Panel(Panel::Plan));
        }
        // By now panels have faded in.
        for _ in 0..60 {
            editor.settle();
        }
        let pictures = editor.state().statistics.pictures;
        let ctx = editor.harness.ctx.clone();
        for frame in 0..200 {
            editor.harness.step();
            assert!(!ctx.has_requested_repaint(), "frame {frame}, plan {plan}");
        }
        editor.settle();
        assert_eq!(editor.state().statistics.pictures, pictures);
    }
}
