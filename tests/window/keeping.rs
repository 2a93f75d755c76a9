//! Unsaved work, preferences and recent files.
//!
//! Catches: work lost when the program is killed, work offered although it was saved or discarded,
//! a program that takes over the work of a running one, forgotten preferences.
//!
//! The kill test starts its own executable again, which changes a scene without pause, and kills it
//! at random moments: 20 times, or `MARRAZTU_KILLS` times.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Key, ThemePreference};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Lower};
use marraztu::app::actions::Request;
use marraztu::app::panels::Panel;
use marraztu::app::state::layout::Layout;
use marraztu_core::base::rng::Rng;
use marraztu_io::{Abandoned, OwnFolders, Preferences};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::click;

/// The environment variable with the folder of the program to be killed.
const FOLDER: &str = "MARRAZTU_KILLED_IN";

/// The number of programs that run at a time, each in a separate folder.
const AT_ONCE: u64 = 4;

/// The work that a kill may lose: the last second, plus delays of a busy machine.
const LOST_AT_MOST: Duration = Duration::from_secs(2);

impl Editor {
    /// An editor with its own files in this folder.
    pub(crate) fn keeping(folder: &Path) -> Self {
        Self::small().kept_in(folder)
    }

    fn keeping_in_a_large_window(folder: &Path) -> Self {
        Self::of_size(1300.0, 760.0).kept_in(folder)
    }

    fn kept_in(mut self, folder: &Path) -> Self {
        let folders = OwnFolders::within(folder);
        let (preferences, said) = Preferences::load(&folders);
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().keep_in(&ctx, folders, preferences, said);
        self.settle();
        self
    }

    pub(crate) fn is_offered(&self) -> usize {
        self.state().recoverable.len()
    }

    /// The distance of the camera along Z, in steps of the key `z`.
    #[expect(clippy::cast_possible_truncation, reason = "a test makes few steps")]
    fn steps_of_camera(&self) -> u64 {
        let (scene, view) = (self.scene(), self.view());
        let z = scene.selected_camera(&view).pose.now().eye.z;
        ((z - 400.0) / 10.0).round().abs() as u64
    }
}

#[test]
fn work_of_a_program_that_ended_is_offered_and_recovered_as_unsaved() {
    let folder = tempfile::tempdir().unwrap();
    let scene = {
        let mut editor = Editor::keeping(folder.path());
        assert_eq!(editor.is_offered(), 0);
        editor.perform_all(&[Action::Panel(Panel::Statistics), Action::ToggleCoarse]);
        editor.press(Lower(Key::Z));
        editor.press(Lower(Key::X));
        editor.harness.state().wait_for_journal();
        editor.scene()
    };
    let mut editor = Editor::keeping(folder.path());
    assert_eq!(editor.is_offered(), 1);
    assert!(editor.shows("The program ended with unsaved changes to a new scene"));
    editor.press(Lower(Key::O));
    assert!(editor.view().polygons.is_some(), "the notice blocks nothing");
    editor.press(Lower(Key::O));
    editor.click_label("Recover");
    editor.wait_until(|editor| editor.is_offered() == 0);
    let camera = |scene: &marraztu_core::scene::Scene| {
        scene.cameras.iter().map(|(_, camera)| *camera.pose.now()).collect::<Vec<_>>()
    };
    assert_eq!(camera(&editor.scene()), camera(&scene));
    assert!(!editor.state().history.is_saved());
    assert!(editor.state().panels.has(Panel::Statistics) && !editor.state().coarse_while_moving);
    editor.harness.state().wait_for_journal();
    // Recovered work belongs to this program: killed at once, it is offered again.
    drop(editor);
    let mut editor = Editor::keeping(folder.path());
    assert_eq!(editor.is_offered(), 1);
    editor.click_label("Discard");
    drop(editor);
    let mut editor = Editor::keeping(folder.path());
    assert_eq!(editor.is_offered(), 0);
    // Discarded work was moved aside, and can be restored.
    editor.perform(Action::RecoverDiscarded);
    editor.wait_until(|editor| !editor.state().history.is_saved());
    assert_eq!(camera(&editor.scene()), camera(&scene));
    editor.harness.state().wait_for_journal();
}

/// Leaves one step of work behind in this folder.
fn leave_work(folder: &Path) {
    let mut editor = Editor::keeping(folder);
    editor.press(Lower(Key::Z));
    editor.harness.state().wait_for_journal();
}

/// Makes these requests in one frame, and lets the files be read.
fn ask_at_once(editor: &mut Editor, requests: impl IntoIterator<Item = Request>) {
    let ctx = editor.harness.ctx.clone();
    for request in requests {
        editor.harness.state_mut().answer(&ctx, request);
    }
    for _ in 0..20 {
        editor.settle();
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn work_that_is_read_twice_or_discarded_while_it_is_read_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    leave_work(folder.path());
    let mut editor = Editor::keeping(folder.path());
    ask_at_once(&mut editor, [Request::Recover(0), Request::Recover(0)]);
    assert!(!editor.state().history.is_saved() && editor.steps_of_camera() == 1);
    assert_eq!((editor.state().path.as_deref(), &editor.state().recent[..]), (None, &[][..]));
    assert!(!editor.shows("Something went wrong"));
    editor.harness.state().wait_for_journal();
    drop(editor);
    let mut editor = Editor::keeping(folder.path());
    assert_eq!(editor.is_offered(), 1, "it is in the journal");
    ask_at_once(&mut editor, [Request::Recover(0), Request::DiscardWork(0)]);
    assert!(editor.state().history.is_saved() && editor.steps_of_camera() == 0);
    assert_eq!((editor.is_offered(), editor.state().discarded.len()), (0, 1));
}

#[test]
fn recovered_work_is_not_replaced_without_a_question_by_a_scene_that_is_read_meanwhile() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.marraztu");
    let mut editor = Editor::keeping(folder.path());
    editor.press(Command(Key::S));
    editor.type_path(&file);
    editor.wait_until(|_| file.is_file());
    drop(editor);
    leave_work(folder.path());
    let mut editor = Editor::keeping(folder.path());
    ask_at_once(&mut editor, [Request::Recover(0), Request::LoadFiles(vec![file.clone()])]);
    assert!(editor.shows("Save the scene?") && editor.steps_of_camera() == 1);
    editor.click_label("Discard");
    editor.wait_until(|editor| editor.state().path.as_deref() == Some(&*file));
}

#[test]
fn all_discarded_work_is_listed_and_without_any_the_entry_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = Editor::keeping(folder.path());
    assert!(Action::RecoverDiscarded.availability(first.state()).is_err());
    first.press(Lower(Key::Z));
    first.harness.state().wait_for_journal();
    let mut second = Editor::keeping(folder.path());
    second.hold(Lower(Key::Z), 4);
    second.harness.state().wait_for_journal();
    drop((first, second));
    let mut editor = Editor::keeping(folder.path());
    for _ in 0..2 {
        editor.click_label("Discard");
    }
    assert_eq!((editor.is_offered(), editor.state().discarded.len()), (0, 2));
    editor.perform(Action::RecoverDiscarded);
    assert!(editor.shows("Discarded work"));
    let first = editor.state().discarded[0].clone();
    editor.click_label(&first);
    editor.wait_until(|editor| !editor.state().history.is_saved());
    assert!([1, 5].contains(&editor.steps_of_camera()));
    assert_eq!(editor.state().discarded.len(), 2, "it is kept until its time is over");
}

#[test]
fn two_running_programs_do_not_take_each_others_work() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = Editor::keeping(folder.path());
    first.press(Lower(Key::Z));
    first.harness.state().wait_for_journal();
    let mut second = Editor::keeping(folder.path());
    assert_eq!(second.is_offered(), 0);
    second.press(Lower(Key::Z));
    second.harness.state().wait_for_journal();
    drop(first);
    let third = Editor::keeping(folder.path());
    assert_eq!(third.is_offered(), 1, "that of the one that has ended");
    // Work offered by one program is not offered by another.
    assert_eq!(Editor::keeping(folder.path()).is_offered(), 0);
    drop((second, third));
    assert_eq!(Editor::keeping(folder.path()).is_offered(), 2);
}

#[test]
fn saved_undone_or_discarded_work_is_not_offered() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.marraztu");
    // Saved work.
    let mut saved = Editor::keeping(folder.path());
    saved.press(Lower(Key::Z));
    saved.press(Command(Key::S));
    saved.type_path(&file);
    saved.wait_until(|_| file.is_file());
    saved.settle();
    saved.harness.state().wait_for_journal();
    drop(saved);
    // Undone work.
    let mut undone = Editor::keeping(folder.path());
    assert_eq!(undone.is_offered(), 0, "it was saved");
    undone.press(Lower(Key::Z));
    undone.press(Command(Key::Z));
    undone.harness.state().wait_for_journal();
    drop(undone);
    // Discarded work.
    let mut discarded = Editor::keeping(folder.path());
    assert_eq!(discarded.is_offered(), 0, "it was undone");
    discarded.press(Lower(Key::Z));
    assert!(!discarded.leaves_by(Command(Key::Q)));
    discarded.click_label("Discard");
    discarded.harness.state_mut().end_keeping();
    drop(discarded);
    assert_eq!(Editor::keeping(folder.path()).is_offered(), 0, "it was discarded");
    let left: Vec<PathBuf> = std::fs::read_dir(folder.path().join("state"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| !path.ends_with("lock"))
        .collect();
    assert!(left.len() <= 1, "only the last one's lock: {left:?}");
}

#[test]
fn recovered_work_goes_back_to_its_scene_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.marraztu");
    let mut editor = Editor::keeping(folder.path());
    editor.press(Command(Key::S));
    editor.type_path(&file);
    editor.wait_until(|_| file.is_file());
    editor.press(Lower(Key::Z));
    editor.harness.state().wait_for_journal();
    drop(editor);
    let mut editor = Editor::keeping(folder.path());
    assert!(editor.shows("unsaved changes to my.marraztu"));
    editor.press(Lower(Key::X));
    editor.click_label("Recover");
    assert!(editor.shows("Save the scene?"), "this program's own work comes first");
    editor.click_label("Discard");
    editor.wait_until(|editor| editor.state().path.as_deref() == Some(&*file));
    assert!(!editor.state().history.is_saved());
    assert_eq!(editor.steps_of_camera(), 1);
}

#[test]
fn theme_panels_scale_and_recent_files_are_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let (_models, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::keeping_in_a_large_window(folder.path());
    editor.perform_all(&[
        Action::ThemeLight,
        Action::Panel(Panel::Outline),
        Action::Panel(Panel::Statistics),
    ]);
    editor.harness.ctx.set_zoom_factor(1.25);
    editor.ask(Request::LoadFiles(vec![path.clone()]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    let panels = editor.state().panels;
    let layout =
        Layout::of_shares(&[("right".to_owned(), 333.0), ("plan".to_owned(), 0.25)].into());
    editor.ask(Request::Layout(layout));
    editor.perform(Action::ToggleOverlays);
    editor.settle();
    editor.harness.state_mut().end_keeping();
    drop(editor);
    let mut other = Editor::keeping_in_a_large_window(folder.path());
    assert_eq!(other.state().theme, ThemePreference::Light);
    assert_eq!(other.state().panels, panels);
    assert_eq!(other.state().layout, layout);
    assert!(!other.state().overlays);
    assert_eq!(other.harness.ctx.zoom_factor(), 1.25);
    assert_eq!(other.state().recent, [path]);
    other.harness.ctx.set_zoom_factor(1.0);
    other.settle();
    click(&mut other, Role::Button, "File");
    click(&mut other, Role::MenuItem, "Recent files");
    other.harness.run_steps(30);
    click(&mut other, Role::MenuItem, "cube.obj");
    other.wait_until(|editor| editor.shows("Material of cube.obj"));
}

#[test]
fn a_broken_file_of_preferences_is_set_aside_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("config");
    std::fs::create_dir_all(&config).unwrap();
    std::fs::write(config.join("preferences.ron"), "(scale: nonsense").unwrap();
    let editor = Editor::keeping(folder.path());
    assert!(editor.shows("The preferences could not be parsed"));
    assert!(config.join("preferences.broken-1.ron").is_file());
}

/// The program to be killed. Does nothing unless the test below starts it.
#[test]
fn changes_a_scene_until_it_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let folder = PathBuf::from(folder);
    let number: u64 = std::env::var("MARRAZTU_KILLED").unwrap().parse().unwrap();
    let file = folder.join(format!("saved-{number}.marraztu"));
    let mut editor = Editor::keeping(&folder.join(format!("own-{}", number % AT_ONCE)));
    let mut rng = Rng::new(number);
    let mut out = std::io::stdout();
    for step in 1_u64.. {
        // A gesture of several changes, a single step, or saving and reopening the scene.
        match rng.below(12) {
            0 => {
                editor.press(Command(Key::S));
                if editor.shows("Save the scene") {
                    editor.type_path(&file);
                }
                editor.press(Lower(Key::Z));
            }
            1..4 => editor.hold(Lower(Key::Z), 0),
            _ => editor.press(Lower(Key::Z)),
        }
        assert_eq!(editor.steps_of_camera(), step);
        writeln!(out, "\nstep {step}").unwrap();
        out.flush().unwrap();
    }
}

/// A running program, with the time at which it reported each step.
struct Running {
    child: Child,
    steps: Arc<Mutex<Vec<(u64, Instant)>>>,
}

impl Running {
    fn start(folder: &Path, number: u64) -> Self {
        let mut child = Process::new(std::env::current_exe().unwrap())
            .args(["--exact", "keeping::changes_a_scene_until_it_is_killed", "--nocapture"])
            .env(FOLDER, folder)
            .env("MARRAZTU_KILLED", number.to_string())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let steps = Arc::new(Mutex::new(Vec::new()));
        let (lines, theirs) = (BufReader::new(child.stdout.take().unwrap()), Arc::clone(&steps));
        let read = move || {
            for line in lines.lines().map_while(Result::ok) {
                if let Some(step) = line.strip_prefix("step ").and_then(|n| n.parse().ok()) {
                    theirs.lock().unwrap().push((step, Instant::now()));
                }
            }
        };
        std::thread::Builder::new().spawn(read).unwrap();
        Self { child, steps }
    }

    /// Kills the program, and returns the last step that must survive.
    fn kill(mut self) -> u64 {
        let killed = Instant::now();
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        let steps = self.steps.lock().unwrap();
        let old = steps.iter().filter(|(_, told)| killed - *told > LOST_AT_MOST);
        old.map(|(step, _)| *step).max().unwrap_or(0)
    }
}

#[test]
fn a_program_killed_at_any_moment_loses_at_most_the_last_seconds() {
    let kills: u64 =
        std::env::var("MARRAZTU_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(20);
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Rng::new(17);
    let mut most_wanted = 0;
    for round in 0..kills.div_ceil(AT_ONCE) {
        let numbers = AT_ONCE * round..AT_ONCE * (round + 1);
        let running: Vec<_> = numbers.map(|n| (n, Running::start(folder.path(), n))).collect();
        std::thread::sleep(Duration::from_millis(rng.below(4500)));
        for (number, program) in running {
            let wanted = program.kill();
            let own = folder.path().join(format!("own-{}", number % AT_ONCE));
            let file = folder.path().join(format!("saved-{number}.marraztu"));
            let recovered = recovered(&own, &file);
            assert!(recovered >= wanted, "kill {number}: {recovered} of {wanted} steps");
            most_wanted = most_wanted.max(wanted);
        }
    }
    assert!(most_wanted > 0, "no program was killed after its first seconds");
}

/// The camera's steps in the recovered work, or in the scene file if none is offered.
fn recovered(own: &Path, file: &Path) -> u64 {
    let mut editor = Editor::keeping(own);
    if editor.is_offered() > 0 {
        editor.click_label("Recover");
        editor.wait_until(|editor| editor.is_offered() == 0);
        assert!(!editor.shows("Something went wrong"));
    } else if file.is_file() {
        editor.ask(Request::LoadFiles(vec![file.to_owned()]));
        editor.wait_until(|editor| editor.state().path.as_deref() == Some(file));
    }
    let steps = editor.steps_of_camera();
    // A regular exit, after which the next program has nothing to recover.
    editor.leaves_by(Command(Key::Q));
    if editor.shows("Save the scene?") {
        editor.click_label("Discard");
    }
    editor.harness.state_mut().end_keeping();
    drop(editor);
    assert!(Abandoned::all(&OwnFolders::within(own)).is_empty());
    steps
}
