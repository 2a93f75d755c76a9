//! The undo stack, compared with a simple model: a list of all earlier scenes.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

#[path = "common/plates.rs"]
mod common;

use glam::DVec3;
use marraztu_core::base::color::Color;
use marraztu_core::edit::{Gesture, GesturePhase, History, transform};
use marraztu_core::scene::{Command, ItemId, ObjectId, Scene, Subject};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Step {
    Perform(Command, Gesture),
    Undo,
    Redo,
    GoTo(usize),
    Abandon(Gesture),
    Save,
}

fn command() -> impl Strategy<Value = Command> {
    let item = |id: u32| common::three_objects().0.objects.get(ObjectId(id)).unwrap().clone();
    let shown = move |id: u32, visible: bool| {
        let object = marraztu_core::scene::Object { visible, ..item(id) };
        marraztu_core::scene::Item::Object(ObjectId(id), Box::new(object))
    };
    let id = || 1_u32..4;
    prop_oneof![
        2 => id().prop_map(|id| Command::Remove(ItemId::Object(ObjectId(id)))),
        2 => (0_usize..3, id())
            .prop_map(move |(at, id)| Command::Insert { at, item: shown(id, true) }),
        4 => (id(), any::<bool>()).prop_map(move |(id, on)| Command::Replace(shown(id, on))),
        2 => (id(), any::<bool>())
            .prop_map(|(id, locked)| Command::Lock { id: ItemId::Object(ObjectId(id)), locked }),
        2 => any::<u8>().prop_map(|c| Command::Background(Color([c; 3]))),
        1 => (id(), id()).prop_map(move |(a, b)| Command::Batch(vec![
            Command::Replace(shown(a, false)),
            Command::Remove(ItemId::Object(ObjectId(b))),
        ])),
        1 => (id(), 0_usize..4)
            .prop_map(|(id, to)| Command::Reorder { id: ItemId::Object(ObjectId(id)), to }),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    let gesture = || prop_oneof![Just(Gesture::Whole), (0_u64..2).prop_map(Gesture::Part)];
    prop_oneof![
        8 => (command(), gesture()).prop_map(|(command, gesture)| Step::Perform(command, gesture)),
        2 => Just(Step::Undo),
        2 => Just(Step::Redo),
        1 => (0_usize..12).prop_map(Step::GoTo),
        1 => gesture().prop_map(Step::Abandon),
        1 => Just(Step::Save),
    ]
}

/// A trivial undo stack: the scene after each step, the current position, and the saved scene.
struct Model {
    scenes: Vec<Scene>,
    now: usize,
    open: Gesture,
    saved: Scene,
}

impl Model {
    fn perform(&mut self, scene: Scene, gesture: Gesture) {
        self.scenes.truncate(self.now + 1);
        if gesture != Gesture::Whole && gesture == self.open {
            self.scenes.pop();
        }
        self.scenes.push(scene);
        (self.now, self.open) = (self.scenes.len() - 1, gesture);
    }

    fn go(&mut self, to: Option<usize>) -> bool {
        let Some(to) = to.filter(|&to| to < self.scenes.len()) else { return false };
        (self.now, self.open) = (to, Gesture::Whole);
        true
    }
}

proptest! {
    #[test]
    fn the_history_goes_where_a_list_of_scenes_goes(
        script in prop::collection::vec(step(), 0..60),
    ) {
        let mut scene = common::three_objects().0;
        let mut history = History::new();
        let mut model = Model {
            scenes: vec![scene.clone()],
            now: 0,
            open: Gesture::Whole,
            saved: scene.clone(),
        };
        // Each step acts on both; afterwards scene, position and length must agree.
        for step in script {
            match step {
                Step::Perform(command, gesture) => {
                    if history.perform(&mut scene, command, gesture, "a step").is_ok() {
                        model.perform(scene.clone(), gesture);
                    }
                }
                Step::Undo => {
                    let done = history.undo(&mut scene).is_some();
                    prop_assert_eq!(done, model.go(model.now.checked_sub(1)));
                }
                Step::Redo => {
                    let done = history.redo(&mut scene).is_some();
                    prop_assert_eq!(done, model.go(Some(model.now + 1)));
                }
                Step::GoTo(to) => {
                    history.go_to(&mut scene, to);
                    let to = to.min(model.scenes.len() - 1);
                    if to != model.now {
                        model.go(Some(to));
                    }
                }
                Step::Abandon(gesture) => {
                    let is_open = gesture != Gesture::Whole && gesture == model.open;
                    prop_assert_eq!(history.abandon(&mut scene, gesture), is_open);
                    if is_open {
                        model.scenes.pop();
                        model.go(Some(model.now - 1));
                    }
                }
                Step::Save => {
                    history.mark_saved();
                    model.saved = scene.clone();
                }
            }
            prop_assert_eq!(&scene, &model.scenes[model.now]);
            prop_assert_eq!(history.position(), model.now);
            prop_assert_eq!(history.steps().len(), model.scenes.len() - 1);
            // The history may ask about saving once too often, but never once too rarely.
            prop_assert!(!history.is_saved() || scene == model.saved);
        }
    }
}

#[test]
fn undo_back_to_the_saved_step_marks_the_scene_as_saved_unless_it_is_gone() {
    let (mut scene, _) = common::three_objects();
    let mut history = History::new();
    let background = |history: &mut History, scene: &mut Scene, gesture| {
        let command = Command::Background(Color([scene.background.0[0].wrapping_add(1); 3]));
        history.perform(scene, command, gesture, "background").unwrap();
    };
    assert!(history.is_saved());
    background(&mut history, &mut scene, Gesture::Part(1));
    history.mark_saved();
    background(&mut history, &mut scene, Gesture::Part(1));
    assert!(!history.is_saved(), "the drag went on after saving");
    history.mark_saved();
    background(&mut history, &mut scene, Gesture::Whole);
    assert!(!history.is_saved());
    history.undo(&mut scene);
    assert!(history.is_saved());
    history.undo(&mut scene);
    background(&mut history, &mut scene, Gesture::Whole);
    assert!(!history.is_saved(), "as many steps as when it was saved, but other ones");
}

#[test]
fn one_undo_takes_back_a_whole_drag_and_names_it() {
    let (mut scene, mut view) = common::three_objects();
    view.subject = Subject::Object;
    let start = scene.clone();
    let mut history = History::new();
    for i in 0..500 {
        let phase = if i == 0 { GesturePhase::First } else { GesturePhase::Continued };
        let command = transform::translate(&scene, &view, DVec3::X, phase).unwrap();
        history.perform(&mut scene, command, Gesture::Part(7), "Move").unwrap();
    }
    let end = scene.clone();
    assert_eq!(history.steps().collect::<Vec<_>>(), ["Move"]);
    assert_eq!(history.undo(&mut scene).as_deref(), Some("Move"));
    assert_eq!(scene, start);
    assert_eq!(history.redo(&mut scene).as_deref(), Some("Move"));
    assert_eq!(scene, end);
}

#[test]
fn steps_that_fit_no_more_are_forgotten_and_the_scene_is_kept() {
    let (mut scene, _) = common::three_objects();
    let mut history = History::new();
    let remove = Command::Remove(ItemId::Object(ObjectId(2)));
    history.perform(&mut scene, remove, Gesture::Whole, "Remove").unwrap();
    let mut other = common::three_objects().0;
    let kept = other.clone();
    assert_eq!(history.undo(&mut other), None);
    assert_eq!((other, history.steps().len(), history.is_saved()), (kept, 0, false));
}
