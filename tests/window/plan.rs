//! The plan panel; and an idle window draws nothing.
//!
//! Catches: a panel that lags behind the scene, a list for another picture, an effect without a
//! line, a window that repaints without a cause.

use egui::accesskit::Role;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::Lower;
use marraztu::app::actions::Request;
use marraztu::app::panels::Panel;
use marraztu_core::base::color::Color;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{Command, Item, Light, Scene};
use marraztu_render::Effect;

use crate::editor::Editor;
use crate::panels::{click, control};

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

/// Waits until the effects are measured.
fn wait_for_costs(editor: &mut Editor) {
    for _ in 0..3000 {
        if !editor.state().plan.measuring {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
        editor.harness.step();
    }
    editor.settle();
}

#[test]
fn a_measurement_is_shown_until_something_changes() {
    let mut editor = Editor::of_size(900.0, 500.0);
    editor.perform(Action::MeasurePlan);
    assert!(editor.state().panels.has(Panel::Plan) && editor.state().plan.measuring);
    wait_for_costs(&mut editor);
    let costs = editor.state().plan.costs.clone().expect("it was measured");
    assert!(costs.costs.frame > 0.0 && costs.costs.effects.len() > 4);
    assert!(editor.shows("ms a frame"));
    editor.press(Lower(egui::Key::Num1));
    assert!(editor.shows("measured before the last change"));
}

#[test]
fn the_disk_of_a_light_is_a_switch() {
    let mut editor = Editor::of_size(1400.0, 1400.0);
    editor.perform(Action::Panel(Panel::Plan));
    let sun = |editor: &Editor| {
        editor.scene().lights.iter().any(|(_, light)| light.name == "sun" && light.on)
    };
    for on in [false, true] {
        click(&mut editor, Role::CheckBox, "Switch sun");
        editor.settle();
        assert_eq!((sun(&editor), editor.shows("sun on, all 3")), (on, on));
    }
    assert_eq!(editor.steps(), 2);
}

#[test]
fn what_no_one_sees_is_dropped_in_one_step() {
    let mut editor = Editor::of_size(1400.0, 1400.0);
    // A light too dim to be seen, and the shadows that it casts.
    let (id, sun) = editor.scene().lights.iter().next().map(|(id, it)| (id, it.clone())).unwrap();
    let color = Color([1, 1, 1]);
    let dim = Item::Light(id, Box::new(Light { color, shadows: true, ..sun.clone() }));
    let (command, gesture, label) = (Command::Replace(dim), Gesture::Whole, "Dim".to_owned());
    editor.ask(Request::Change { command, gesture, label });
    editor.perform(Action::MeasurePlan);
    wait_for_costs(&mut editor);
    let costs = editor.state().plan.costs.clone().expect("it was measured");
    let seen = |effect| costs.costs.of(effect).map(|cost| cost.missed.is_seen());
    assert_eq!(seen(Effect::Light(id)), Some(false), "{costs:?}");
    assert_eq!(seen(Effect::Surfaces), Some(true), "{costs:?}");
    let (on, steps) = (editor.scene(), editor.steps());
    let lit = |scene: &Scene| scene.lights.iter().filter(|(_, light)| light.on).count();
    click(&mut editor, Role::Button, "Drop unseen (1)");
    editor.settle();
    assert!(!editor.scene().lights.get(id).unwrap().on);
    assert_eq!((lit(&editor.scene()), editor.steps()), (lit(&on) - 1, steps + 1));
    editor.perform(Action::Undo);
    assert_eq!(editor.scene(), on);
}

#[test]
fn measuring_can_be_given_up() {
    let mut editor = Editor::small();
    editor.perform(Action::MeasurePlan);
    editor.perform(Action::MeasurePlan);
    wait_for_costs(&mut editor);
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
