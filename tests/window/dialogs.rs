//! Dialogs: files, materials, unsaved work, errors.
//!
//! Catches: work lost without a question, needless questions, a bad file that changes the scene,
//! keys that act behind a dialog.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Key, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Lower, Named, Upper};
use marraztu::app::actions::{LabRequest, Request};
use marraztu::app::panels::Panel;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{MaterialChoice, ObjectId, PresetId, Sides};

use crate::editor::Editor;
use crate::panels::{click, control, type_text};

pub(crate) const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
    v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

pub(crate) fn folder_with(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

impl Editor {
    /// Whether the program asked the window to close in the last frame.
    fn leaves(&self) -> bool {
        let commands = self.harness.output().viewport_output.get(&ViewportId::ROOT);
        commands.is_some_and(|output| output.commands.contains(&ViewportCommand::Close))
    }

    /// Presses a key, and returns whether the program then quits.
    pub(crate) fn leaves_by(&mut self, chord: marraztu::app::actions::Chord) -> bool {
        let (key, modifiers, _) = crate::editor::events_of(chord);
        let mut leaves = false;
        for pressed in [true, false] {
            self.set_modifiers(if pressed { modifiers } else { egui::Modifiers::NONE });
            self.harness.step();
            self.key(key, pressed, modifiers);
            self.harness.step();
            leaves |= self.leaves();
        }
        self.settle();
        leaves
    }

    /// Runs frames until a loading thread has finished, and its result is shown.
    pub(crate) fn wait_until(&mut self, done: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        while !done(self) {
            if begun.elapsed() > Duration::from_secs(20) {
                let labels = self
                    .harness
                    .query_all_by(|_| true)
                    .filter_map(|node| node.accesskit_node().label());
                let shown: Vec<String> = labels.collect();
                panic!("waited too long; the window shows: {}", shown.join(" | "));
            }
            self.settle();
            std::thread::sleep(Duration::from_millis(2));
        }
        self.settle();
    }

    /// Types a path into the program's own file dialog.
    pub(crate) fn type_path(&mut self, path: &Path) {
        // Selects the whole field and replaces it.
        self.press(Command(Key::A));
        self.harness.event(egui::Event::Text(path.display().to_string()));
        self.settle();
        self.press(Named(Key::Enter));
    }
}

#[test]
fn ctrl_q_leaves_at_once_while_nothing_is_unsaved() {
    assert!(Editor::new().leaves_by(Command(Key::Q)));
}

#[test]
fn esc_closes_the_history_before_it_leaves() {
    let mut editor = Editor::new();
    editor.perform(Action::Panel(Panel::History));
    assert!(!editor.leaves_by(Named(Key::Escape)));
    assert!(!editor.state().panels.has(Panel::History));
    assert!(!editor.leaves_by(Named(Key::Escape)), "it warns first");
    assert!(editor.leaves_by(Named(Key::Escape)));
}

#[test]
fn esc_asks_while_something_is_unsaved_and_cancel_keeps_everything() {
    for chord in [Named(Key::Escape), Command(Key::Q)] {
        let mut editor = Editor::new();
        editor.press(Lower(Key::Z));
        let scene = editor.scene();
        let ask = |editor: &mut Editor| {
            if chord == Named(Key::Escape) {
                assert!(!editor.leaves_by(chord), "it warns first");
                assert!(editor.shows("Esc again quits"));
            }
            assert!(!editor.leaves_by(chord));
        };
        ask(&mut editor);
        assert!(editor.shows("Save the scene?"));
        editor.press(Lower(Key::Z));
        assert!(editor.scene() == scene, "keys do not act behind a question");
        // After Cancel the chord asks again. Within the question, Esc means Cancel.
        editor.click_label("Cancel");
        assert!(!editor.shows("Save the scene?"));
        ask(&mut editor);
        assert!(editor.shows("Save the scene?"), "and it asks again");
        assert!(!editor.leaves_by(Named(Key::Escape)), "Esc is Cancel there");
        assert!(!editor.shows("Save the scene?"));
        // Discard leaves the program.
        ask(&mut editor);
        editor.harness.step();
        let left = {
            use egui_kittest::kittest::Queryable as _;
            editor.harness.get_by_label("Discard").click();
            (0..4).any(|_| {
                editor.harness.step();
                editor.leaves()
            })
        };
        assert!(left);
    }
}

#[test]
fn undoing_all_needs_no_saving() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    editor.press(Command(Key::Z));
    assert!(editor.leaves_by(Command(Key::Q)));
}

#[test]
fn the_cross_of_the_window_asks_too() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    let viewport = editor.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    viewport.events.push(ViewportEvent::Close);
    editor.harness.step();
    let output = &editor.harness.output().viewport_output[&ViewportId::ROOT];
    assert!(output.commands.contains(&ViewportCommand::CancelClose));
    editor.settle();
    assert!(editor.shows("Save the scene?"));
}

#[test]
fn a_model_is_loaded_by_key_path_and_material() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    let before = editor.scene();
    editor.press(Lower(Key::F));
    assert!(editor.shows("Load a model"));
    editor.type_path(&path);
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    assert!(editor.scene() == before, "nothing is changed before the material is chosen");
    editor.click_label("gold");
    editor.click_label("Load");
    let view = editor.view();
    let scene = editor.scene();
    let (first, object) = scene.objects.iter().next().unwrap();
    assert_eq!((object.name.as_str(), view.object), ("cube", Some(first)));
    assert_eq!(object.material, MaterialChoice::Preset(PresetId::named("gold").unwrap()));
    assert_eq!(object.placement.depth(), 0);
    assert_eq!(editor.steps(), 1);
    assert!(editor.shows("is out of view or too small to see"), "a cube of one unit is tiny");
    editor.click_label("Frame");
    assert!(!editor.shows("is out of view or too small to see"));
    assert_eq!(editor.steps(), 1, "framing is no step");
    editor.press(Command(Key::Z));
    assert!(editor.scene().objects == before.objects);
}

#[test]
fn a_model_is_read_with_the_crease_angle_that_is_typed() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::tall();
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Import options");
    for _ in 0..30 {
        editor.settle();
    }
    click(&mut editor, Role::SpinButton, "Crease angle");
    type_text(&mut editor, "95");
    editor.press(Named(Key::Enter));
    editor.click_label("Load");
    editor.wait_until(|editor| editor.steps() == 1);
    let scene = editor.scene();
    let (_, object) = scene.objects.iter().next().unwrap();
    assert_eq!((&*object.name, object.model.options.crease.get()), ("cube", 95.0));
    assert_eq!(object.model.mesh.points().len(), 8, "right angles are smooth then");
}

#[test]
fn the_crease_angle_is_off_if_the_file_has_smoothing_groups() {
    let (_folder, path) = folder_with("cube.obj", &format!("s 1\n{CUBE}"));
    let mut editor = Editor::tall();
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Import options");
    for _ in 0..30 {
        editor.settle();
    }
    assert!(control(&editor, Role::SpinButton, "Crease angle").accesskit_node().is_disabled());
}

#[test]
fn a_dropped_file_loads_as_by_key_and_cancelling_changes_nothing() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    let before = editor.scene();
    editor.ask(Request::LoadFiles(vec![path.clone(), path]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.press(Named(Key::Escape));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Cancel");
    editor.settle();
    assert!(!editor.shows("Material of cube.obj"));
    assert!(editor.scene() == before);
}

#[test]
fn a_bad_file_is_reported_in_one_sentence_with_its_line_and_changes_nothing() {
    let (_folder, path) = folder_with("bad.obj", "v 0 0 0\nv 1 zero 0\nf 1 2 2\n");
    let mut editor = Editor::new();
    let before = editor.scene();
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("The file was not loaded"));
    assert!(editor.shows("bad.obj:2: "));
    assert!(editor.scene() == before);
    editor.press(Named(Key::Enter));
    assert!(!editor.shows("The file was not loaded"), "Enter closes it");
}

#[test]
fn a_missing_file_is_reported() {
    let mut editor = Editor::new();
    editor.ask(Request::LoadFiles(vec![PathBuf::from("nowhere.obj")]));
    editor.wait_until(|editor| editor.shows("The file was not loaded"));
    assert!(editor.shows("there is no such file"));
}

#[test]
fn a_notice_names_a_missing_texture_before_repairs() {
    let text = "mtllib c.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
    let (folder, path) = folder_with("cube.obj", text);
    std::fs::write(folder.path().join("c.mtl"), "newmtl m\nNs 0\nmap_Kd none.png\n").unwrap();
    let mut editor = Editor::new();
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    editor.wait_until(|editor| !editor.state().notices.is_empty());
    let said = &editor.state().notices[0].text;
    assert!(said.contains("c.mtl: the texture \"none.png\" was not found"), "{said}");
    assert!(said.contains(" more finding"), "{said}");
    let first = &editor.state().notices[0].details[0];
    assert!(first.contains("none.png"), "{first}");
}

#[test]
fn findings_are_announced_and_listed_on_a_click() {
    let text = format!("{CUBE}f 1 2 99\nf 1 2\n");
    let (_folder, path) = folder_with("mended.obj", &text);
    let mut editor = Editor::new();
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("Material of mended.obj"));
    editor.click_label("Load");
    editor.click_label("Details");
    assert!(editor.shows("that the file does not have"), "a sentence for each finding");
    editor.click_label("Close");
    editor.click_label("Frame");
    assert!(!editor.shows("is out of view or too small to see"), "it is seen now");
    assert!(editor.shows("Details"), "what was mended is another matter");
    editor.click_label("Dismiss");
    assert!(editor.state().notices.is_empty());
}

#[test]
fn a_new_camera_asks_for_its_material() {
    let mut editor = Editor::new();
    editor.press(Upper(Key::F));
    editor.click_label("jade");
    editor.click_label("Add");
    let (scene, view) = (editor.scene(), editor.view());
    let camera = scene.cameras.get(view.camera).unwrap();
    assert_eq!(scene.cameras.len(), 2);
    assert_eq!(camera.material, MaterialChoice::Preset(PresetId::named("jade").unwrap()));
    assert_eq!(camera.pose.now().eye, glam::DVec3::ZERO);
}

#[test]
fn the_picture_is_saved_as_it_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("view.png");
    let mut editor = Editor::new();
    editor.press(Named(Key::F12));
    editor.type_path(&path);
    editor.wait_until(|_| path.is_file());
    let saved = image::open(&path).unwrap().to_rgb8();
    let size = editor.state().statistics.size;
    assert_eq!((saved.width() as usize, saved.height() as usize), (size.width, size.height));
    assert_eq!(saved.get_pixel(0, 0).0, [0, 0, 179]);
}

#[test]
fn the_picture_is_copied_as_it_is_shown() {
    let mut editor = Editor::new();
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().perform(&ctx, Action::CopyPicture, Gesture::Whole);
    editor.harness.step();
    let commands = &editor.harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image.clone()),
        _ => None,
    });
    let (copied, size) = (copied.unwrap(), editor.state().statistics.size);
    assert_eq!(copied.size, [size.width, size.height]);
    assert_eq!(copied.pixels[0], egui::Color32::from_rgb(0, 0, 179));
}

#[test]
fn a_scene_is_saved_and_opened_again_and_a_lost_model_can_be_found() {
    let (folder, path) = folder_with("cube.obj", CUBE);
    let file = folder.path().join("my.marraztu");
    let mut editor = Editor::new();
    editor.ask(Request::LoadFiles(vec![path.clone()]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    assert!(!editor.state().history.is_saved());
    editor.press(Command(Key::S));
    // The dialog adds the file name extension.
    editor.type_path(&folder.path().join("my"));
    editor.wait_until(|_| file.is_file());
    assert!(editor.state().history.is_saved());
    assert_eq!(editor.state().path.as_deref(), Some(&*file));

    editor.press(Lower(Key::Z));
    editor.press(Command(Key::S));
    assert!(editor.state().history.is_saved(), "the second time nothing is asked");
    let saved = editor.scene();

    let elsewhere = tempfile::tempdir().unwrap();
    let moved = elsewhere.path().join("cube.obj");
    std::fs::rename(&path, &moved).unwrap();
    let mut other = Editor::new();
    other.ask(Request::LoadFiles(vec![file]));
    other.wait_until(|editor| editor.shows("cube.obj is missing"));
    assert_eq!(other.scene().objects.len(), saved.objects.len());
    let pose = |editor: &Editor| *editor.scene().selected_camera(&editor.view()).pose.now();
    assert_eq!(pose(&other), pose(&editor));
    assert!(other.state().history.is_saved());
    other.perform(Action::FindMissing);
    assert!(other.shows("Where is the missing model?"));
    other.type_path(&moved);
    other.wait_until(|editor| editor.scene().missing_files().is_empty());
    assert_eq!(other.steps(), 1);
}

#[test]
fn save_in_the_question_saves_and_then_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("work.marraztu");
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    assert!(!editor.leaves_by(Command(Key::Q)));
    editor.click_label("Save");
    assert!(editor.shows("Save the scene"));
    editor.type_path(&file);
    assert!(file.is_file());
    assert!(editor.leaves_by(Command(Key::Q)));
}

#[test]
fn a_scene_opens_with_the_panels_that_it_was_saved_with() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.marraztu");
    let mut editor = Editor::new();
    let usual = editor.state().panels;
    editor.perform_all(&[Action::Panel(Panel::Statistics), Action::Panel(Panel::Outline)]);
    let shown = editor.state().panels;
    assert_ne!(shown, usual);
    editor.press(Command(Key::S));
    editor.type_path(&file);
    editor.wait_until(|_| file.is_file());

    let mut other = Editor::new();
    let path = file.clone();
    other.ask(Request::LoadFiles(vec![file]));
    other.wait_until(|editor| editor.state().path.as_deref() == Some(&*path));
    assert_eq!(other.state().panels, shown);
}

#[test]
fn an_object_turned_away_is_reported_with_a_button_that_draws_both_sides() {
    let square = "v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nf 4 3 2 1\n";
    let (folder, _) = folder_with("square.obj", square);
    let file = folder.path().join("turned.marraztu");
    let scene = r#"(
        version: 1,
        objects: [
            (id: 1, name: "square", model: File(path: "square.obj"), sides: One),
            (id: 2, name: "behind", model: File(path: "square.obj")),
        ],
        cameras: [(id: 3, name: "camera 1", eye: (0.0, 0.0, 300.0))],
        view: (object: Some(1), camera: 3),
    )"#;
    std::fs::write(&file, scene).unwrap();
    let mut editor = Editor::new();
    editor.ask(Request::LoadFiles(vec![file.clone()]));
    editor.wait_until(|editor| editor.shows("Nothing of square is visible"));
    assert!(editor.shows("its only face is turned away"));
    assert!(
        !editor.shows("Nothing of behind is visible"),
        "both sides of an open surface are drawn"
    );
    editor.click_label("Draw both sides");
    let scene = editor.scene();
    assert_eq!(scene.objects.get(ObjectId(1)).unwrap().sides, Sides::Two);
    assert_eq!(editor.steps(), 1, "it can be undone");
    assert!(editor.state().notices.is_empty());
}

#[test]
fn a_scene_that_cannot_be_saved_is_reported_and_stays_unsaved() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    editor.press(Command(Key::S));
    editor.type_path(Path::new("/proc/nowhere/x.marraztu"));
    assert!(editor.shows("Something went wrong"));
    assert!(!editor.state().history.is_saved());
}

#[test]
fn opening_a_scene_over_unsaved_work_asks_first() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    for key in [Command(Key::O), Command(Key::N)] {
        editor.press(key);
        assert!(editor.shows("Save the scene?"), "{key}");
        editor.click_label("Cancel");
    }
    editor.press(Command(Key::N));
    editor.click_label("Discard");
    assert_eq!(editor.steps(), 0);
}

/// Saves the first scene, and begins to open it in another editor.
fn opening() -> (tempfile::TempDir, Editor) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.marraztu");
    let mut first = Editor::small();
    first.press(Command(Key::S));
    first.type_path(&path);
    first.wait_until(|_| path.is_file());
    let mut editor = Editor::small();
    let ctx = editor.harness.ctx.clone();
    // The scene arrives in a later frame.
    editor.harness.state_mut().answer(&ctx, Request::LoadFiles(vec![path]));
    (folder, editor)
}

#[test]
fn a_change_made_while_a_scene_is_read_is_asked_about() {
    let (_folder, mut editor) = opening();
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().perform(&ctx, Action::StepXUp, Gesture::Whole);
    editor.wait_until(|editor| editor.shows("Save the scene?"));
    assert_eq!(editor.steps(), 1);
    editor.click_label("Discard");
    editor.wait_until(|editor| editor.state().path.is_some());
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_scene_read_while_a_lesson_was_opened_has_no_way_back() {
    let (_folder, mut editor) = opening();
    let ctx = editor.harness.ctx.clone();
    let lesson = Request::Lab(LabRequest::ShowLesson("depth"));
    editor.harness.state_mut().answer(&ctx, lesson);
    editor.wait_until(|editor| editor.state().path.is_some());
    editor.ask(Request::Lab(LabRequest::Back));
    assert!(editor.state().path.is_some());
}

#[test]
fn files_of_the_command_line_keep_their_order_and_count_as_saved() {
    let (folder, small) = folder_with("small.obj", CUBE);
    let large = folder.path().join("large.obj");
    std::fs::write(&large, CUBE.repeat(3000)).unwrap();
    let mut editor = Editor::new();
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().load_at_start(&ctx, vec![large, small]);
    editor.wait_until(|editor| editor.scene().objects.len() == 2);
    let scene = editor.scene();
    let names: Vec<&str> = scene.objects.iter().map(|(_, object)| &*object.name).collect();
    assert_eq!(names, ["small", "large"], "each goes to the front, and the ships are gone");
    let silver = MaterialChoice::Preset(PresetId::SILVER);
    assert!(scene.objects.iter().all(|(_, object)| object.material == silver));
    assert!(editor.leaves_by(Command(Key::Q)));
    editor.press(Lower(Key::Z));
    assert!(!editor.leaves_by(Command(Key::Q)));
}

#[test]
fn a_path_that_was_refused_is_typed_on() {
    let (folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.press(Lower(Key::F));
    editor.press(Command(Key::A));
    type_text(&mut editor, &folder.path().join("nothing").display().to_string());
    editor.press(Named(Key::Enter));
    assert!(editor.shows("There is no such file."));
    // New text goes after the rejected path, and may begin a new path there.
    type_text(&mut editor, &format!("/{}", path.with_extension("").display()));
    editor.press(Named(Key::Enter));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
}

#[test]
fn a_notice_is_over_the_picture_and_covers_no_panel() {
    let (_folder, path) = folder_with("cube.obj", &format!("{CUBE}f 1 2 99\n"));
    let mut editor = Editor::of_size(640.0, 480.0);
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    editor.wait_until(|editor| editor.shows("Details"));
    editor.perform(Action::Panel(Panel::Properties));
    let picture = editor.picture();
    for label in ["Details", "Dismiss"] {
        for notice in editor.harness.query_all_by_label(label) {
            assert!(picture.contains_rect(notice.rect()), "{label}");
        }
    }
}
