//! The history against a model of it: a list of the scenes there were.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

#[path = "common/plates.rs"]
mod common;

use glam::{DVec2, DVec3};
use marraztu::base::color::Color;
use marraztu::base::image::Size;
use marraztu::base::math::Axis;
use marraztu::edit::lights::{self, Channel};
use marraztu::edit::look::{self, Pointer};
use marraztu::edit::transform::{self, Sign};
use marraztu::edit::{Gesture, History, Refusal, Stroke, frame, items, motion, place, selection};
use marraztu::scene::{
    Command, Frame, ItemId, LightKind, MaterialChoice, ObjectId, Scene, SpotOwner, Subject,
    Transformation, View,
};
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
        let object = marraztu::scene::Object { visible, ..item(id) };
        marraztu::scene::Item::Object(ObjectId(id), Box::new(object))
    };
    let id = || 1_u32..4;
    prop_oneof![
        2 => id().prop_map(|id| Command::Remove(ItemId::Object(ObjectId(id)))),
        2 => (0_usize..3, id()).prop_map(move |(at, id)| Command::Insert { at, item: shown(id, true) }),
        4 => (id(), any::<bool>()).prop_map(move |(id, on)| Command::Replace(shown(id, on))),
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

/// The scenes before and after each step, where we are among them, and which of them is on the disk.
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
    fn the_history_goes_where_a_list_of_scenes_goes(script in prop::collection::vec(step(), 0..60)) {
        let mut scene = common::three_objects().0;
        let mut history = History::new();
        let mut model = Model {
            scenes: vec![scene.clone()],
            now: 0,
            open: Gesture::Whole,
            saved: scene.clone(),
        };
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
            // It may ask once too often, but never once too little.
            prop_assert!(!history.is_saved() || scene == model.saved);
        }
    }
}

#[test]
fn the_scene_is_saved_again_when_undo_comes_back_to_what_was_saved_and_never_once_that_is_gone() {
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
fn one_undo_takes_back_a_whole_drag_and_says_what_it_was() {
    let (mut scene, mut view) = common::three_objects();
    view.subject = Subject::Object;
    let start = scene.clone();
    let mut history = History::new();
    for i in 0..500 {
        let stroke = if i == 0 { Stroke::First } else { Stroke::Continued };
        let command = transform::translate(&scene, &view, DVec3::X, stroke).unwrap();
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

/// Numbers that look random and are the same on every machine (Marsaglia's xorshift).
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }

    fn index(&mut self, n: usize) -> usize {
        usize::try_from(self.below(n as u64)).unwrap()
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.index(all.len())]
    }

    fn number(&mut self) -> f64 {
        f64::from(u32::try_from(self.below(2001)).unwrap()) / 100.0 - 10.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    fn item(&mut self, scene: &Scene) -> Option<ItemId> {
        let objects = scene.objects.ids().map(ItemId::Object);
        let cameras = scene.cameras.ids().map(ItemId::Camera);
        let all: Vec<ItemId> =
            objects.chain(cameras).chain(scene.lights.ids().map(ItemId::Light)).collect();
        (!all.is_empty()).then(|| self.one_of(&all))
    }
}

/// Anything that a person can do.
fn anything(scene: &Scene, view: &mut View, dice: &mut Dice) -> Result<Command, Refusal> {
    let stroke = dice.one_of(&[Stroke::First, Stroke::First, Stroke::Continued]);
    view.time += 0.1;
    let item = dice.item(scene).ok_or(Refusal::Gone)?;
    let size = Size::new(640, 480);
    let at = DVec2::new(dice.number() * 20.0 + 320.0, dice.number() * 20.0 + 240.0);
    match dice.below(24) {
        0..5 => {
            use Transformation::{Rotation, Scaling, Translation};
            let all = [Subject::Camera, Subject::Object, Subject::Light];
            selection::set_subject(view, dice.one_of(&all));
            let kind = dice.one_of(&[Translation, Rotation, Scaling]);
            let _ = selection::set_transformation(view, kind);
            view.frame = dice.one_of(&[Frame::Local, Frame::Global]);
            let sign = dice.one_of(&[Sign::Positive, Sign::Negative]);
            transform::step(scene, view, dice.one_of(&Axis::ALL), sign, stroke)
        }
        5 => transform::rotate(scene, view, dice.vector(), dice.number(), stroke),
        6 | 7 => transform::take_back(scene, view),
        8 => transform::toggle_analysis(scene, view),
        9 => look::orbit(scene, view, dice.number(), dice.number(), stroke),
        10 => look::pan(scene, view, at, size, stroke),
        11 => {
            let pointer = Pointer { at, depth: None };
            look::zoom(scene, view, dice.number(), pointer, size, stroke)
        }
        12 => frame::selection(scene, view),
        13 => items::duplicate(scene, item).and_then(|command| {
            let few = scene.objects.len() + scene.cameras.len() + scene.lights.len() < 20;
            if few { Ok(command) } else { Err(Refusal::TooLarge) }
        }),
        14 => items::remove(scene, item),
        15 => items::toggle_shown(scene, item),
        16 => items::reorder(scene, item, dice.index(5)),
        17 => {
            let channel = dice.one_of(&[Channel::Red, Channel::Green, Channel::Blue]);
            lights::step_color(scene, view, channel, dice.one_of(&[-1, 1]))
        }
        18 => lights::step_aperture(scene, view, dice.one_of(&[-5.0, 5.0])),
        19 => {
            let object = view.object.ok_or(Refusal::NoObject)?;
            motion::toggle_spin(scene, object, dice.one_of(&Axis::ALL), view.time)
        }
        20 => {
            let object = view.object.ok_or(Refusal::NoObject)?;
            place::object_turn(scene, view, object, dice.vector() * 20.0, stroke)
        }
        21 => {
            let object = view.object.ok_or(Refusal::NoObject)?;
            let kind = dice.one_of(&[true, false]);
            let owner = if kind { SpotOwner::Object(object) } else { lights::fixed() };
            if scene.lights.len() > 8 {
                return Err(Refusal::TooLarge);
            }
            let spot: LightKind = lights::spot(owner);
            items::insert_light(scene, spot)
        }
        22 => {
            let camera = common::model();
            if scene.cameras.len() > 4 {
                return Err(Refusal::TooLarge);
            }
            Ok(items::insert_camera(scene, camera, MaterialChoice::File))
        }
        _ => {
            let chosen = selection::select(scene, view, item)?;
            *view = chosen.view;
            chosen.command.ok_or(Refusal::OnlyOne)
        }
    }
}

/// Every number of a scene, and of all the stacks in it, in letters: -0 and 0 differ, and no two
/// numbers are written alike.
fn every_bit(scene: &Scene) -> String {
    let mut text = format!("{scene:?}");
    for (_, object) in scene.objects.iter() {
        text += &format!("{:?}", object.placement.earlier().collect::<Vec<_>>());
    }
    for (_, camera) in scene.cameras.iter() {
        text += &format!("{:?}", camera.pose.earlier().collect::<Vec<_>>());
    }
    for (_, light) in scene.lights.iter() {
        if let LightKind::Bulb { position, .. } = &light.kind {
            text += &format!("{:?}", position.earlier().collect::<Vec<_>>());
        }
    }
    text
}

#[test]
fn a_hundred_thousand_commands_are_undone_and_redone_bit_for_bit() {
    let (mut scene, mut view) = common::three_objects();
    let start = every_bit(&scene);
    let mut history = History::new();
    let mut dice = Dice(0x2545_f491_4f6c_dd1d);
    let (mut performed, mut refused) = (0, 0);
    while performed < 100_000 {
        match anything(&scene, &mut view, &mut dice) {
            Ok(command) => {
                let before = scene.clone();
                let gesture = match dice.below(4) {
                    0 => Gesture::Part(dice.below(2)),
                    _ => Gesture::Whole,
                };
                history.perform(&mut scene, command, gesture, "anything").unwrap();
                selection::follow(&before, &scene, &mut view);
                performed += 1;
            }
            Err(_) => refused += 1,
        }
        assert!(refused < 400_000, "hardly anything can be done any more");
    }
    let end = every_bit(&scene);
    let steps = history.steps().len();
    assert!(steps > 80_000);
    while history.undo(&mut scene).is_some() {}
    assert!(every_bit(&scene) == start, "undone to somewhere else");
    while history.redo(&mut scene).is_some() {}
    assert!(every_bit(&scene) == end, "redone to somewhere else");
    assert_eq!(history.position(), steps);
}
