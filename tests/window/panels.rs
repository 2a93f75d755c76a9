//! Menus, outline, view switches, status line and list of keys.
//!
//! Catches: a switch that acts differently from its key, an action missing from the menus, a
//! control without a name, a list in another order than the scene, a name lost or changed without a
//! request.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Node;
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Chord::{Command, Either, Named};
use marraztu::app::actions::Request;
use marraztu::app::actions::{Action, Group};
use marraztu::app::panels::Panel;
use marraztu_core::accuracy::{Arithmetic, Filter, LightAt, Settings, SpecularForm};
use marraztu_core::base::color::Color;
use marraztu_core::scene::{ItemId, LightKind, Subject};

use crate::editor::Editor;

/// Finds the only control of this kind and name.
pub(crate) fn control<'a>(editor: &'a Editor, role: Role, label: &'a str) -> Node<'a> {
    let mut found = editor.harness.query_all(By::new().role(role).label(label));
    let first = found.next().unwrap_or_else(|| panic!("no {role:?} is called {label}"));
    assert!(found.next().is_none(), "several {role:?} are called {label}");
    first
}

pub(crate) fn click(editor: &mut Editor, role: Role, label: &str) {
    control(editor, role, label).click();
    editor.settle();
}

/// Types text letter by letter.
pub(crate) fn type_text(editor: &mut Editor, text: &str) {
    for letter in text.chars() {
        editor.harness.event(Event::Text(letter.to_string()));
        editor.harness.step();
    }
    editor.settle();
}

pub(crate) fn middle(editor: &Editor, role: Role, label: &str) -> Pos2 {
    control(editor, role, label).rect().center()
}

#[test]
fn every_switch_of_the_view_runs_its_action() {
    let switches = [
        Action::ToggleEdges,
        Action::ToggleEdgesOverFill,
        Action::TogglePolygons,
        Action::ToggleOthers,
        Action::ToggleBackFaces,
        Action::ToggleFaceNormals,
        Action::ToggleVertexNormals,
        Action::ToggleNormalLength,
        Action::ToggleMarks,
    ];
    let slots = Action::ALL.iter().copied().filter(|action| action.slot().is_some_and(|i| i < 5));
    let (mut clicked, mut asked) = (Editor::tall(), Editor::tall());
    for action in switches.into_iter().chain(slots) {
        for _ in 0..2 {
            click(&mut clicked, Role::CheckBox, action.info().label);
            asked.perform(action);
            assert_eq!(clicked.view(), asked.view(), "{action:?}");
            assert!(clicked.scene() == asked.scene(), "{action:?}");
            let shown = control(&clicked, Role::CheckBox, action.info().label);
            let ticked = shown.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True);
            assert_eq!(Some(ticked), action.is_on(clicked.state()), "{action:?}");
        }
    }
}

#[test]
fn every_choice_of_the_view_runs_its_action() {
    let choices = [
        ("Subject: Object", Action::SubjectObject),
        ("Transformation: Rotate", Action::Rotate),
        ("Transformation: Scale", Action::Scale),
        ("Transformation: Move", Action::Translate),
        ("Frame: Global", Action::ToggleFrame),
        ("Frame: Local", Action::ToggleFrame),
        ("Subject: Light", Action::SubjectLight),
        ("Subject: Camera", Action::SubjectCamera),
        ("Observer: From object", Action::ToggleObserver),
        ("Observer: From camera", Action::ToggleObserver),
        ("Projection: Orthographic", Action::ToggleProjection),
        ("Projection: Perspective", Action::ToggleProjection),
        ("Normals: Face", Action::ToggleLightNormals),
        ("Normals: Vertex", Action::ToggleLightNormals),
    ];
    let (mut clicked, mut asked) = (Editor::tall(), Editor::tall());
    for (label, action) in choices {
        let before = asked.view();
        asked.perform(action);
        assert_ne!(asked.view(), before, "{label} has nothing to do");
        for _ in 0..2 {
            // Clicking the current choice changes nothing.
            click(&mut clicked, Role::RadioButton, label);
            assert_eq!(clicked.view(), asked.view(), "{label}");
        }
    }
    assert!(clicked.scene() == asked.scene());
}

#[test]
fn every_axis_of_accuracy_is_chosen_by_its_name() {
    let mut editor = Editor::tall();
    let first = Settings::default();
    for (label, expected) in [
        ("Shading: Flat", Settings { light: LightAt::Face, ..first }),
        ("Shading: Gouraud", Settings { light: LightAt::Vertex, ..first }),
        ("Shading: Phong", first),
        ("Specular form: N.H", Settings { specular: SpecularForm::HalfVector, ..first }),
        ("Specular form: R.V", first),
        ("Texture filter: Nearest", Settings { filter: Filter::Nearest, ..first }),
        ("Texture filter: Bilinear", first),
        ("Light arithmetic: 64 bits", Settings { arithmetic: Arithmetic::F64, ..first }),
        ("Light arithmetic: 32 bits", first),
    ] {
        // Part of the panel is scrolled out of view.
        control(&editor, Role::RadioButton, label).click_accesskit();
        editor.settle();
        assert_eq!(editor.state().settings, expected, "{label}");
    }
    assert_eq!(editor.steps(), 0, "accuracy is no step");
}

#[test]
fn the_history_is_a_list_and_a_click_goes_there() {
    let mut editor = Editor::tall();
    let before = editor.scene();
    editor.perform(Action::StepXUp);
    let after_one = editor.scene();
    editor.perform(Action::StepZUp);
    for (entry, expected) in [(1, &after_one), (0, &before), (2, &editor.scene())] {
        click(&mut editor, Role::Button, "Edit");
        click(&mut editor, Role::MenuItem, "History");
        editor.harness.run_steps(30);
        let label = std::iter::once("Beginning").chain(editor.state().history.steps()).nth(entry);
        let label = format!("{entry}  {}", label.unwrap());
        editor.click_label(&label);
        assert!(editor.scene() == *expected, "{label}");
        editor.harness.run_steps(30);
    }
}

#[test]
fn the_window_is_light_or_dark_as_the_user_says() {
    let mut editor = Editor::new();
    for (action, dark) in [(Action::ThemeLight, false), (Action::ThemeDark, true)] {
        editor.perform(action);
        assert_eq!(editor.harness.ctx.global_style().visuals.dark_mode, dark);
        assert_eq!(action.is_on(editor.state()), Some(true));
        assert_eq!(Action::ThemeSystem.is_on(editor.state()), Some(false));
    }
}

#[test]
fn a_click_in_the_outline_selects_and_makes_the_subject() {
    let mut editor = Editor::tall();
    let scene = editor.scene();
    let names = scene.objects.iter().map(|(id, object)| (ItemId::Object(id), object.name.clone()));
    let lights = scene.lights.iter().map(|(id, light)| (ItemId::Light(id), light.name.clone()));
    for (id, name) in names.chain(lights).collect::<Vec<_>>() {
        click(&mut editor, Role::ListBoxOption, &name);
        assert_eq!(editor.state().selected(), Some(id), "{name}");
        let row = control(&editor, Role::ListBoxOption, &name);
        let marked = row.accesskit_node().toggled();
        assert_eq!(marked, Some(egui::accesskit::Toggled::True), "{name}");
    }
    click(&mut editor, Role::Button, "Cameras");
    assert_eq!(editor.view().subject, Subject::Camera);
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_line_of_the_outline_is_dragged_within_its_list() {
    let mut editor = Editor::tall();
    let names = |editor: &Editor| -> Vec<String> {
        editor.scene().objects.iter().map(|(_, object)| object.name.clone()).collect()
    };
    let before = names(&editor);
    assert_eq!(before, ["r_falke", "x_wing", "cam"]);
    let from = middle(&editor, Role::ListBoxOption, "cam");
    let to = middle(&editor, Role::ListBoxOption, "r_falke") - egui::vec2(0.0, 6.0);
    editor.drag(PointerButton::Primary, &[from, from.lerp(to, 0.5), to, to]);
    assert_eq!(names(&editor), ["cam", "r_falke", "x_wing"]);
    assert_eq!(editor.steps(), 1);
    let light = middle(&editor, Role::ListBoxOption, "sun");
    let from = middle(&editor, Role::ListBoxOption, "cam");
    editor.drag(PointerButton::Primary, &[from, from.lerp(light, 0.5), light, light]);
    assert_eq!(editor.steps(), 1, "objects stay among objects");
    editor.press(Command(Key::Z));
    assert_eq!(names(&editor), before);
}

#[test]
fn the_eye_and_the_switch_of_a_light_do_and_undo() {
    let mut editor = Editor::tall();
    let before = editor.scene();
    for (hide, show) in [
        ("Hide x_wing", "Show x_wing"),
        ("Hide camera 1", "Show camera 1"),
        ("Switch off bulb", "Switch on bulb"),
    ] {
        click(&mut editor, Role::Button, hide);
        assert!(editor.scene() != before, "{hide}");
        click(&mut editor, Role::Button, show);
        assert!(editor.scene() == before, "{show}");
    }
    assert_eq!(editor.steps(), 6);
    let off = |editor: &Editor| editor.scene().lights.iter().any(|(_, light)| !light.on);
    click(&mut editor, Role::Button, "Switch off sun");
    assert!(off(&editor));
    editor.press(Command(Key::Z));
    assert!(!off(&editor));
}

#[test]
fn a_double_click_renames_and_esc_leaves_the_name() {
    let mut editor = Editor::tall();
    let names = |editor: &Editor| -> Vec<String> {
        editor.scene().objects.iter().map(|(_, object)| object.name.clone()).collect()
    };
    let at = middle(&editor, Role::ListBoxOption, "x_wing");
    for (text, end, expected) in [("gull", Key::Escape, "x_wing"), ("gull", Key::Enter, "gull")] {
        editor.harness.run_steps(60);
        for pressed in [true, false, true, false] {
            let modifiers = Modifiers::NONE;
            let button = PointerButton::Primary;
            editor.harness.event(Event::PointerMoved(at));
            editor.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        editor.settle();
        assert!(control(&editor, Role::TextInput, "New name").is_focused());
        type_text(&mut editor, text);
        editor.press(Named(end));
        assert_eq!(names(&editor)[1], expected, "{end:?}");
        assert_eq!(editor.state().renaming, None);
    }
    assert_eq!(editor.steps(), 1);
}

#[test]
fn an_abandoned_rename_is_not_resumed() {
    let mut editor = Editor::new();
    editor.press(Named(Key::F2));
    type_text(&mut editor, "half a na");
    editor.ask(Request::EndRename(None));
    editor.press(Named(Key::F2));
    let field = control(&editor, Role::TextInput, "New name");
    assert_eq!((field.value().as_deref(), field.is_focused()), (Some("camera 1"), true));
    assert_eq!(editor.steps(), 0);
}

#[test]
fn items_change_places_by_buttons_and_by_dragging_their_lines() {
    let mut editor = Editor::tall();
    let order = |editor: &Editor| -> Vec<String> {
        editor.scene().objects.iter().map(|(_, object)| object.name.clone()).collect()
    };
    assert_eq!(order(&editor), ["r_falke", "x_wing", "cam"]);
    click(&mut editor, Role::ListBoxOption, "r_falke");
    click(&mut editor, Role::Button, "Move down the list");
    assert_eq!(order(&editor), ["x_wing", "r_falke", "cam"]);
    click(&mut editor, Role::Button, "Move up the list");
    assert_eq!(order(&editor), ["r_falke", "x_wing", "cam"]);

    let row = |editor: &Editor, name| control(editor, Role::ListBoxOption, name).rect();
    let steps = editor.steps();
    // On the lower half of the last line: after it.
    let (from, to) = (row(&editor, "r_falke").center(), row(&editor, "cam"));
    let low = egui::pos2(to.center().x, to.bottom() - 3.0);
    editor.drag(PointerButton::Primary, &[from, from + egui::vec2(0.0, 9.0), low]);
    assert_eq!(order(&editor), ["x_wing", "cam", "r_falke"]);
    // On the upper half of the first line: before it.
    let (from, to) = (row(&editor, "r_falke").center(), row(&editor, "x_wing"));
    let high = egui::pos2(to.center().x, to.top() + 3.0);
    editor.drag(PointerButton::Primary, &[from, from - egui::vec2(0.0, 9.0), high]);
    assert_eq!(order(&editor), ["r_falke", "x_wing", "cam"]);
    assert_eq!(editor.steps(), steps + 2);
    // Items cannot be dropped into another list.
    let from = row(&editor, "r_falke").center();
    let lamp = row(&editor, "sun").center();
    editor.drag(PointerButton::Primary, &[from, from + egui::vec2(0.0, 9.0), lamp]);
    assert_eq!(editor.steps(), steps + 2);
}

#[test]
fn parts_of_a_model_are_listed_and_hidden_one_by_one() {
    let mut editor = Editor::tall();
    click(&mut editor, Role::DisclosureTriangle, "Parts of r_falke");
    let id = editor.view().object.unwrap();
    let part = |editor: &Editor, i: usize| {
        editor.scene().objects.get(id).unwrap().model.mesh.parts()[i].name.clone()
    };
    let name = part(&editor, 1);
    click(&mut editor, Role::Button, &format!("Hide part {name}"));
    let hidden = |editor: &Editor| editor.scene().objects.get(id).unwrap().hidden_parts.clone();
    assert_eq!(hidden(&editor).into_iter().collect::<Vec<_>>(), [1]);
    click(&mut editor, Role::Button, &format!("Show part {name}"));
    assert!(hidden(&editor).is_empty());
    click(&mut editor, Role::DisclosureTriangle, "Parts of r_falke");
    assert!(!editor.shows(&format!("Hide part {name}")));
}

#[test]
fn lights_are_added_from_the_outline_and_items_deleted() {
    let mut editor = Editor::tall();
    for (label, fits) in [
        (
            "Sun",
            (|kind: &LightKind| matches!(kind, LightKind::Sun { .. })) as fn(&LightKind) -> bool,
        ),
        ("Bulb", |kind| matches!(kind, LightKind::Bulb { .. })),
        ("Spot", |kind| matches!(kind, LightKind::Spot { .. })),
    ] {
        let count = editor.scene().lights.len();
        click(&mut editor, Role::Button, "Add a light");
        editor.click_label(label);
        let (scene, id) = (editor.scene(), editor.view().light.unwrap());
        assert_eq!(scene.lights.len(), count + 1, "{label}");
        assert!(fits(&scene.lights.get(id).unwrap().kind), "{label}");
        click(&mut editor, Role::Button, "Delete");
        assert_eq!(editor.scene().lights.len(), count, "{label}");
    }
}

#[test]
fn the_status_line_describes_the_effect_of_the_next_key() {
    let mut editor = Editor::tall();
    let status = |editor: &Editor| {
        let node = editor.harness.get_by_role(Role::Status);
        node.accesskit_node().label().unwrap_or_default()
    };
    let begins = |editor: &Editor, expected: &str| {
        let status = status(editor);
        assert!(status.starts_with(expected), "{status}");
    };
    begins(&editor, "Camera 1/1 camera 1  |  move  |  fly  |  step 10  |  camera 1, perspective");
    editor.perform(Action::SubjectObject);
    editor.perform(Action::Rotate);
    editor.perform(Action::ToggleFrame);
    editor.perform(Action::NextItem);
    begins(&editor, "Object 2/3 x_wing  |  rotate  |  global  |  step 10 deg  |  camera 1");
    editor.perform(Action::Scale);
    editor.perform(Action::ToggleObserver);
    editor.perform(Action::Light2);
    begins(&editor, "Object 2/3 x_wing  |  scale  |  global  |  step x 1.2  |  seen from x_wing");
    assert!(status(&editor).contains("4 lights"));
    editor.perform(Action::SubjectLight);
    begins(&editor, "Light 2/5 sun  |  rotate  |  step 10 deg");
    assert!(status(&editor).ends_with(" ms"));
    editor.perform(Action::ApertureUp);
    let told = editor.harness.get_by_role(Role::Alert).accesskit_node().label();
    assert_eq!(told.as_deref(), Some("only a spot has an aperture"));
}

#[test]
fn the_list_of_keys_is_searchable_and_a_click_runs_the_action() {
    let mut editor = Editor::new();
    editor.press(Either(Key::H));
    assert!(control(&editor, Role::TextInput, "Search among the keys").is_focused());
    type_text(&mut editor, "back faces");
    let entries = |editor: &Editor| -> Vec<String> {
        let entry = |role| By::new().role(role);
        let all = [Role::MenuItem, Role::MenuItemCheckBox]
            .into_iter()
            .flat_map(|role| editor.harness.query_all(entry(role)).collect::<Vec<_>>());
        all.filter_map(|node| node.accesskit_node().label()).collect()
    };
    assert_eq!(entries(&editor), ["Back faces"]);
    click(&mut editor, Role::MenuItemCheckBox, "Back faces");
    assert!(editor.view().back_faces);
    click(&mut editor, Role::TextInput, "Search among the keys");
    editor.press(Command(Key::A));
    type_text(&mut editor, "Ctrl+S");
    let found = entries(&editor);
    assert!(found.contains(&"Save scene".to_owned()) && found.len() <= 4, "{found:?}");
}

#[test]
fn the_list_of_keys_lists_every_action() {
    for group in Group::ALL {
        assert!(group.actions().next().is_some(), "{}", group.label());
    }
    let mut editor = Editor::new();
    editor.press(Either(Key::H));
    for action in Action::ALL {
        let shown = editor.harness.query_all_by_label(action.info().label);
        let as_entry = shown.into_iter().any(|node| {
            matches!(node.accesskit_node().role(), Role::MenuItem | Role::MenuItemCheckBox)
        });
        assert!(as_entry, "{action:?}");
    }
}

#[test]
fn every_control_has_a_name_whatever_is_selected_and_however_small_the_window() {
    for mut editor in [Editor::tall(), Editor::new(), Editor::small()] {
        for subject in [Action::SubjectCamera, Action::SubjectObject, Action::SubjectLight] {
            editor.perform(subject);
            for _ in 0..5 {
                editor.harness.check_accessibility();
                editor.perform(Action::NextItem);
            }
        }
    }
}

#[test]
fn the_picture_is_the_largest_thing_in_the_window() {
    for (width, height) in [(1280.0, 800.0), (1024.0, 640.0)] {
        let editor = Editor::of_size(width, height);
        let picture = editor.picture();
        assert!(picture.width() > 0.5 * width, "{picture} in {width} x {height}");
        assert!(picture.height() > 0.85 * height, "{picture} in {width} x {height}");
    }
}

#[test]
fn a_drag_in_the_colour_picker_is_one_step() {
    let mut editor = Editor::tall();
    let before = editor.scene().background;
    click(&mut editor, Role::ColorWell, "Background");
    let shades = control(&editor, Role::ColorWell, "Background: shade").rect();
    let at = |x: f32, y: f32| shades.lerp_inside(egui::vec2(x, y));
    editor.drag(PointerButton::Primary, &[at(0.5, 0.5), at(0.4, 0.3), at(0.0, 0.0), at(0.0, 0.5)]);
    let Color([r, g, b]) = editor.scene().background;
    assert!(r == g && g == b && r.abs_diff(128) <= 2, "grey, half way up: {r} {g} {b}");
    assert_eq!(editor.steps(), 1);
    // Grey remembers the hue of the blue before it.
    editor.drag(PointerButton::Primary, &[at(0.0, 0.5), at(0.5, 0.2), at(1.0, 0.0)]);
    assert_eq!(editor.scene().background, Color([0, 0, 255]));
    editor.press(Command(Key::Z));
    editor.press(Command(Key::Z));
    assert_eq!(editor.scene().background, before);
}

#[test]
fn a_colour_that_was_typed_counts_however_its_field_is_left() {
    for way in ["Enter", "Tab", "another field", "the picture", "Escape"] {
        let mut editor = Editor::tall();
        let before = editor.scene().background;
        click(&mut editor, Role::ColorWell, "Background");
        let typed = |editor: &mut Editor, text| {
            click(editor, Role::TextInput, "Background: hexadecimal");
            editor.press(Command(Key::A));
            type_text(editor, text);
        };
        typed(&mut editor, "#ff8000");
        match way {
            "Enter" => editor.press(Named(Key::Enter)),
            "Tab" => editor.press(Named(Key::Tab)),
            "Escape" => editor.press(Named(Key::Escape)),
            "another field" => click(&mut editor, Role::SpinButton, "Background: red"),
            _ => {
                let empty = editor.at(0.02, 0.02);
                editor.click(empty, PointerButton::Primary);
            }
        }
        let expected = if way == "Escape" { before } else { Color([255, 128, 0]) };
        let steps = usize::from(way != "Escape");
        assert_eq!((editor.scene().background, editor.steps()), (expected, steps), "{way}");
    }
}

#[test]
fn a_key_hides_tooltips_until_the_pointer_moves() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    let hint = "Draws the edges of polygons instead of filling them.";
    let at = middle(&editor, Role::CheckBox, "Wireframe");
    editor.hover(at);
    editor.harness.run_steps(60);
    assert!(editor.shows(hint));
    // The palette covers the switch while the pointer stays there.
    editor.press(Command(Key::K));
    type_text(&mut editor, "cube");
    editor.harness.run_steps(60);
    assert!(!editor.shows(hint));
    editor.press(Named(Key::Escape));
    editor.hover(at + egui::vec2(2.0, 0.0));
    editor.harness.run_steps(60);
    assert!(editor.shows(hint));
}

#[test]
fn the_history_is_gone_through_by_clicks_on_its_steps() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform_all(&[Action::SubjectObject, Action::Panel(Panel::History)]);
    let first = editor.scene();
    editor.perform_all(&[Action::StepXUp, Action::StepYUp]);
    let last = editor.scene();
    click(&mut editor, Role::Button, "0  Beginning");
    assert!(editor.scene() == first);
    assert!(editor.state().panels.has(Panel::History), "it stays open");
    let step = editor.harness.query_all_by_label_contains("2  ").next().expect("the last step");
    step.click();
    editor.settle();
    assert!(editor.scene() == last);
}

#[test]
fn the_explanation_of_a_pixel_fits_into_the_picture_and_links_its_neighbours() {
    for (width, height) in [(1280.0, 800.0), (1024.0, 640.0), (1024.0, 420.0)] {
        let mut editor = Editor::of_size(width, height);
        editor.perform(Action::ExplainPixel);
        let at = editor.at(0.2, 0.5);
        editor.click(at, PointerButton::Primary);
        editor.wait_until(|editor| editor.shows("Copy as text"));
        // The window settles on its size and position.
        editor.harness.run_steps(30);
        let copy = control(&editor, Role::Button, "Copy as text").rect();
        let picture = editor.picture();
        assert!(picture.contains_rect(copy), "{copy} in {picture}");
        let title = |editor: &Editor| {
            let mut found = editor.harness.query_all_by_label_contains("Pixel ");
            found.find_map(|node| node.accesskit_node().label()).unwrap_or_default()
        };
        let number = |text: &str| -> usize {
            text["Pixel ".len()..].split(',').next().unwrap().parse().unwrap()
        };
        let before = number(&title(&editor));
        click(&mut editor, Role::Button, "The pixel to the right");
        editor.wait_until(|editor| number(&title(editor)) == before + 1);
    }
}
