//! The palette, and the marks over the picture.
//!
//! Catches: a palette that keeps an old query or acts differently from its text, a mark that cannot
//! be clicked or hides the object below it, a light aimed at another point, a double click that
//! began on a notice.

use egui::accesskit::Role;
use egui::{Key, PointerButton};
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Chord::{Command, Either, Lower, Named};
use marraztu::app::actions::{Action, Also, Request};
use marraztu_core::accuracy::LightAt;
use marraztu_core::base::color::Color;
use marraztu_core::scene::{ItemId, LightKind, MaterialChoice, SpotOwner, Subject};

use crate::editor::Editor;
use crate::panels::{click, control, type_text};

/// The entries of the palette, from the top.
pub(crate) fn listed(editor: &Editor) -> Vec<String> {
    let dialog = editor.harness.get_by_label("Search everything").rect();
    let rows = editor.harness.query_all(By::new().role(Role::ListBoxOption));
    rows.filter(|row| row.rect().top() > dialog.bottom() && row.rect().width() > 400.0)
        .filter_map(|row| row.accesskit_node().label())
        .collect()
}

#[test]
fn the_palette_runs_the_listed_action_and_reopens_empty() {
    let mut editor = Editor::new();
    for (chord, query) in [(Command(Key::K), "wireframe"), (Command(Key::P), "mesh lines")] {
        let before = editor.view().fill;
        editor.press(chord);
        let field = control(&editor, Role::TextInput, "Search everything");
        assert!(field.is_focused());
        assert_eq!(field.value().unwrap_or_default(), "", "the old query does not stay");
        type_text(&mut editor, query);
        assert_eq!(listed(&editor)[0], "Wireframe", "{query}");
        editor.press(Named(Key::Enter));
        assert_ne!(editor.view().fill, before, "{query}");
        assert!(!editor.shows("Search everything"));
    }
    // The viewport has the keyboard again.
    editor.press(Lower(Key::C));
    assert_eq!(editor.view().subject, Subject::Object);
}

#[test]
fn items_and_settings_are_found_by_name_and_esc_closes() {
    let mut editor = Editor::new();
    let mut choose = |query: &str, down: usize| {
        editor.press(Command(Key::K));
        type_text(&mut editor, query);
        for _ in 0..down {
            editor.press(Named(Key::ArrowDown));
        }
        let listed = listed(&editor);
        editor.press(Named(Key::Enter));
        (listed, editor.state().selected(), editor.state().settings)
    };
    let (_, selected, _) = choose("x_wing", 0);
    assert!(matches!(selected, Some(ItemId::Object(_))));
    let (listed, _, settings) = choose("gouraud", 0);
    let at = listed.iter().position(|label| label == "Shading: Gouraud").unwrap();
    if at > 0 {
        let (_, _, settings) = choose("gouraud", at);
        assert_eq!(settings.light, LightAt::Vertex);
    } else {
        assert_eq!(settings.light, LightAt::Vertex);
    }
    editor.press(Command(Key::K));
    editor.press(Named(Key::Escape));
    assert!(!editor.shows("Search everything"));
    assert!(!editor.state().palette);
}

#[test]
fn the_background_and_the_selection_take_a_colour_by_its_name() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    editor.press(Command(Key::K));
    type_text(&mut editor, "background");
    assert!(listed(&editor).contains(&"Background: gray".to_owned()), "{:?}", listed(&editor));
    type_text(&mut editor, " white");
    assert_eq!(listed(&editor)[0], "Background: white");
    editor.press(Named(Key::Enter));
    assert_eq!(editor.scene().background, Color::WHITE);
    editor.press(Command(Key::K));
    type_text(&mut editor, "colour grey");
    assert_eq!(listed(&editor)[0], "Colour of r_falke: gray");
    editor.press(Named(Key::Enter));
    let scene = editor.scene();
    let object = scene.objects.get(editor.view().object.unwrap()).unwrap();
    assert!(matches!(object.material, MaterialChoice::Own(_)));
    assert_eq!(editor.steps(), 2);
}

#[test]
fn a_click_on_search_in_the_bar_opens_the_palette() {
    let mut editor = Editor::new();
    click(&mut editor, Role::Button, Action::Palette.info().label);
    assert!(control(&editor, Role::TextInput, "Search everything").is_focused());
}

#[test]
fn the_list_of_keys_includes_the_mouse() {
    let mut editor = Editor::new();
    editor.press(Either(Key::H));
    assert!(editor.shows("Wheel or Pinch: "));
    type_text(&mut editor, "middle");
    assert!(editor.shows("Shift+drag or Middle drag: "));
    assert!(!editor.shows("Wheel or Pinch: "));
}

#[test]
fn an_unavailable_action_says_why() {
    let mut editor = Editor::new();
    editor.press(Command(Key::K));
    type_text(&mut editor, "redo");
    editor.press(Named(Key::Enter));
    let told = editor.harness.get_by_role(Role::Alert).accesskit_node().label();
    assert_eq!(told.as_deref(), Some("there is nothing to redo"));
}

#[test]
fn the_list_of_keys_forgets_its_search_and_knows_the_words_of_the_palette() {
    let mut editor = Editor::new();
    editor.press(Either(Key::H));
    type_text(&mut editor, "screenshot");
    assert!(editor.shows("Save picture..."));
    editor.press(Named(Key::Escape));
    editor.press(Either(Key::H));
    let field = control(&editor, Role::TextInput, "Search among the keys");
    assert_eq!(field.value().unwrap_or_default(), "");
}

/// An editor with a free spot light at the origin, selected.
fn with_spot() -> Editor {
    let mut editor = Editor::new();
    editor.perform(Action::AddSpot);
    editor
}

fn direction(editor: &Editor) -> glam::DVec3 {
    let id = editor.view().light.unwrap();
    match &editor.scene().lights.get(id).unwrap().kind {
        LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } => aim.now().direction,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_spot_is_aimed_at_the_selection_and_by_a_click() {
    let mut editor = with_spot();
    let steps = editor.steps();
    editor.perform(Action::AimAtSelection);
    // The selected object is on the left.
    assert!(direction(&editor).x < -0.99);
    // The other ship is on the right.
    editor.perform(Action::AimByClick);
    assert!(editor.state().aiming);
    let nothing = editor.at(0.5, 0.95);
    editor.click(nothing, PointerButton::Primary);
    assert!(editor.state().aiming, "there is nothing to aim at");
    let at = ship_at_the_right(&editor);
    editor.click(at, PointerButton::Primary);
    assert!(!editor.state().aiming);
    assert!(direction(&editor).x > 0.8, "{}", direction(&editor));
    assert_eq!(editor.steps(), steps + 2);
    editor.perform(Action::AimByClick);
    editor.press(Named(Key::Escape));
    assert!(!editor.state().aiming && !editor.shows("Save the scene?"));
}

/// A position in the picture that shows the ship at (100, 0, 0).
fn ship_at_the_right(editor: &Editor) -> egui::Pos2 {
    let rect = editor.picture();
    // 100 units aside at a distance of 400; half of the shorter side spans 22.5 degrees.
    let half = rect.width().min(rect.height()) / 2.0;
    rect.center() + egui::vec2(100.0 / 400.0 / 22.5_f32.to_radians().tan() * half, 0.0)
}

#[test]
fn a_click_on_a_mark_selects_its_light_unless_marks_are_hidden() {
    let mut editor = with_spot();
    let spot = editor.view().light.unwrap();
    editor.perform(Action::SubjectCamera);
    let middle = editor.picture().center();
    // Slightly off, to miss the ends of the axes and other lights.
    editor.click(middle, PointerButton::Primary);
    assert_eq!(editor.state().selected(), Some(ItemId::Light(spot)));
    editor.perform(Action::ToggleOverlays);
    editor.perform(Action::SubjectCamera);
    editor.harness.run_steps(60);
    editor.click(middle, PointerButton::Primary);
    assert_ne!(editor.state().selected(), Some(ItemId::Light(spot)), "the mark is hidden");
}

#[test]
fn the_axes_turn_the_view() {
    let mut editor = Editor::new();
    let corner = editor.picture().right_top() + egui::vec2(-46.0, 46.0);
    editor.click(corner + egui::vec2(30.0, 0.0), PointerButton::Primary);
    let mut asked = Editor::new();
    asked.perform(Action::LookRight);
    assert!(editor.scene() == asked.scene() && editor.scene() != Editor::new().scene());
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_double_click_that_began_on_a_notice_does_not_count_on_the_picture() {
    let mut editor = Editor::new();
    let at = editor.picture().center();
    let outside = egui::pos2(editor.picture().left() - 40.0, at.y);
    let before = editor.scene();
    editor.harness.event(egui::Event::PointerMoved(at));
    for (place, pressed) in [(outside, true), (outside, false), (at, true), (at, false)] {
        let (button, modifiers) = (PointerButton::Primary, egui::Modifiers::NONE);
        editor.harness.event(egui::Event::PointerMoved(place));
        editor.harness.event(egui::Event::PointerButton { pos: place, button, pressed, modifiers });
    }
    editor.settle();
    assert!(editor.scene() == before, "nothing was framed");
}

#[test]
fn the_history_gives_the_total_distance_of_a_held_key() {
    let mut editor = Editor::new();
    editor.ask(Request::Do(Action::SubjectObject));
    editor.hold(Lower(Key::X), 4);
    let steps: Vec<String> = editor.state().history.steps().map(str::to_owned).collect();
    assert_eq!(steps, ["Move r_falke 50 along x"]);
}

#[test]
fn text_that_is_not_a_number_is_reported_and_changes_nothing() {
    let mut editor = Editor::tall();
    editor.perform(Action::SubjectObject);
    control(&editor, Role::SpinButton, "Position X").click();
    editor.settle();
    editor.press(Command(Key::A));
    type_text(&mut editor, "ten");
    editor.press(Named(Key::Enter));
    let told = editor.harness.get_by_role(Role::Alert).accesskit_node().label();
    assert_eq!(told.as_deref(), Some("\"ten\" is not valid here: the field keeps its value"));
    assert_eq!(editor.steps(), 0);
}

#[test]
fn esc_in_a_menu_and_esc_again_does_not_leave_the_program() {
    let mut editor = Editor::new();
    control(&editor, Role::Button, "File").click();
    editor.settle();
    assert!(editor.shows("Save scene as..."));
    editor.press(Named(Key::Escape));
    editor.press(Named(Key::Escape));
    let told = editor.harness.get_by_role(Role::Alert).accesskit_node().label();
    assert_eq!(told.as_deref(), Some("Esc again quits"));
}

#[test]
fn the_reason_for_an_invisible_object_comes_with_a_button_that_fixes_it() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::SubjectObject, Action::WhyUnseen]);
    let until = |editor: &mut Editor, text: &str| {
        for _ in 0..200 {
            if editor.shows(text) {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
            editor.settle();
        }
        panic!("{text:?} is not said");
    };
    until(&mut editor, "r_falke is in the picture");
    editor.perform_all(&[Action::ToggleVisible, Action::WhyUnseen]);
    until(&mut editor, "r_falke is hidden");
    control(&editor, Role::Button, "Show").click();
    editor.settle();
    assert_eq!(Action::ToggleVisible.is_on(editor.state()), Some(true));
    assert!(!editor.shows("r_falke is hidden"));
}

#[test]
fn one_notice_about_two_objects_frames_both() {
    let mut editor = Editor::new();
    let ids: Vec<_> = editor.scene().objects.ids().collect();
    let far = glam::DMat4::from_translation(glam::DVec3::X * 4000.0);
    // Moves two ships out of view and asks for each why it is unseen.
    for (i, id) in ids[..2].iter().enumerate() {
        let mut object = editor.scene().objects.get(*id).unwrap().clone();
        object.placement = marraztu_core::scene::Tracked::new(far * *object.placement.now());
        let item = marraztu_core::scene::Item::Object(*id, Box::new(object));
        let (gesture, label) = (marraztu_core::edit::Gesture::Whole, "Move".to_owned());
        let command = marraztu_core::scene::Command::Replace(item);
        editor.ask(Request::Change { command, gesture, label });
        let mut view = editor.view();
        view.object = Some(*id);
        editor.ask(Request::View(Box::new(view)));
        editor.perform(Action::WhyUnseen);
        editor.wait_until(|editor| editor.state().notices.len() == i + 1);
        editor.settle();
    }
    assert!(editor.shows("2 objects are out of view"));
    let framed = marraztu_core::edit::framing::objects(&editor.scene(), &editor.view(), &ids[..2]);
    let mut scene = editor.scene();
    framed.unwrap().apply(&mut scene).unwrap();
    editor.click_label("Frame all");
    assert!(!editor.shows("out of view"), "the notice is answered");
    let eye =
        |scene: &marraztu_core::scene::Scene| scene.selected_camera(&editor.view()).pose.now().eye;
    assert!(eye(&scene).distance(eye(&editor.scene())) < 1e-6, "both are framed");
}

#[test]
fn the_status_line_names_unusual_display_modes() {
    let mut editor = Editor::new();
    for (action, said) in [
        (Action::ToggleEdges, "wireframe"),
        (Action::TogglePolygons, "polygon 1 of "),
        (Action::TogglePolygons, "wireframe"),
        (Action::ToggleOthers, "isolated"),
    ] {
        editor.perform(action);
        let status = editor.harness.get_by_role(Role::Status).accesskit_node().label();
        assert!(status.clone().unwrap_or_default().contains(said), "{status:?}");
    }
}

#[test]
fn a_colour_that_is_typed_is_offered_for_the_selection_and_the_background() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectLight);
    editor.press(Command(Key::K));
    type_text(&mut editor, "#0af");
    assert_eq!(listed(&editor), ["Colour of sun: #00aaff", "Background: #00aaff"]);
    editor.press(Named(Key::Enter));
    let light = editor.view().light.unwrap();
    assert_eq!(editor.scene().lights.get(light).unwrap().color.0, [0x00, 0xaa, 0xff]);
    editor.perform(Action::SubjectObject);
    editor.press(Command(Key::K));
    type_text(&mut editor, "jade");
    assert_eq!(listed(&editor)[0], "Material: jade");
    editor.press(Named(Key::Enter));
    assert_eq!(editor.state().history.steps().last(), Some("Material of r_falke"));
    let preset = editor.scene().objects.first().unwrap();
    let before = editor.scene().objects.get(preset).unwrap().part_look(0).material;
    editor.press(Command(Key::K));
    type_text(&mut editor, "own material");
    assert!(listed(&editor).contains(&"Material: your own".to_owned()));
    editor.press(Named(Key::Escape));
    editor.press(Command(Key::K));
    type_text(&mut editor, "your own");
    editor.press(Named(Key::Enter));
    let own = editor.scene().objects.get(preset).unwrap().material.clone();
    assert_eq!(own, MaterialChoice::Own(before), "it begins as what was chosen");
    editor.press(Command(Key::K));
    type_text(&mut editor, "#0a");
    assert!(editor.shows("No match. Try another word"));
}

#[test]
fn a_colour_or_material_of_several_is_set_in_all_even_if_the_first_has_it() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let ids: Vec<_> = editor.scene().objects.ids().take(2).collect();
    let materials = |editor: &Editor| -> Vec<MaterialChoice> {
        let scene = editor.scene();
        ids.iter().map(|id| scene.objects.get(*id).unwrap().material.clone()).collect()
    };
    let choose = |editor: &mut Editor, query: &str| {
        editor.press(Command(Key::K));
        type_text(editor, query);
        editor.press(Named(Key::Enter));
    };
    choose(&mut editor, "jade");
    let jade = materials(&editor)[0].clone();
    assert_ne!(materials(&editor)[1], jade);
    editor.ask(Request::SelectAlso(ids.iter().copied().map(ItemId::Object).collect(), Also::Only));
    choose(&mut editor, "jade");
    assert_eq!(materials(&editor), [jade.clone(), jade]);
    let lights: Vec<_> = editor.scene().lights.ids().take(2).collect();
    let both: Vec<_> = lights.iter().copied().map(ItemId::Light).collect();
    editor.ask(Request::Select(both[0]));
    choose(&mut editor, "#0000ff");
    editor.ask(Request::SelectAlso(both, Also::Only));
    choose(&mut editor, "#ff0000");
    let scene = editor.scene();
    let colors = lights.iter().map(|id| scene.lights.get(*id).unwrap().color);
    assert_eq!(colors.collect::<Vec<_>>(), [Color([255, 0, 0]); 2]);
}

#[test]
fn a_lesson_chosen_in_the_palette_closes_it() {
    let mut editor = Editor::new();
    editor.press(Command(Key::K));
    type_text(&mut editor, "why points leave holes");
    editor.press(Named(Key::Enter));
    assert!(editor.state().lab.lesson.is_some());
    assert!(!editor.state().palette, "the scene was replaced before the palette was closed");
}

#[test]
fn keys_that_arrive_in_one_slow_frame_reach_what_they_were_meant_for() {
    let command = egui::Modifiers { ctrl: true, command: true, ..egui::Modifiers::NONE };
    let type_at_once = |editor: &Editor, text: &str| {
        for letter in text.chars() {
            let key = Key::from_name(&letter.to_uppercase().to_string()).unwrap();
            editor.key(key, true, egui::Modifiers::NONE);
            editor.harness.event(egui::Event::Text(letter.to_string()));
            editor.key(key, false, egui::Modifiers::NONE);
        }
    };
    let mut editor = Editor::new();
    let before = editor.view();
    editor.key(Key::K, true, command);
    editor.key(Key::K, false, command);
    type_at_once(&editor, "dim");
    editor.settle();
    editor.settle();
    let field = control(&editor, Role::TextInput, "Search everything");
    assert_eq!(field.value().unwrap_or_default(), "dim");
    assert!(editor.view() == before, "no letter acts on the scene");
    // Another name, with the first letter right after F2.
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    editor.key(Key::F2, true, egui::Modifiers::NONE);
    editor.key(Key::F2, false, egui::Modifiers::NONE);
    type_at_once(&editor, "bold");
    editor.key(Key::Enter, true, egui::Modifiers::NONE);
    editor.key(Key::Enter, false, egui::Modifiers::NONE);
    editor.settle();
    editor.settle();
    assert_eq!(editor.state().selected_name(), "bold");
}

#[test]
fn words_of_a_lesson_find_the_choices_of_its_axis_and_what_can_act_comes_first() {
    let mut editor = Editor::new();
    editor.press(Command(Key::K));
    type_text(&mut editor, "z-fighting");
    assert!(listed(&editor).iter().any(|label| label.starts_with("Depth")));
    editor.press(Named(Key::Escape));
    editor.press(Command(Key::K));
    type_text(&mut editor, "model");
    let found = listed(&editor);
    let place = |label: &str| found.iter().position(|other| other.starts_with(label)).unwrap();
    assert!(place("Load model") < place("Find missing files"), "{found:?}");
}
