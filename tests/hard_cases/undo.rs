//! Undo and saving restore every bit.

use marraztu_core::accuracy::Settings;
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{Gesture, GesturePhase, History, items, selection};
use marraztu_core::scene::{ItemId, ObjectId, Scene, Subject, Transformation, View};
use marraztu_io::{self as io, Progress};

use glam::{DMat3, DVec3};

use super::camera::desk;
use super::cases::quick_round;
use super::figures::Figure;

#[test]
fn case_62_a_hundred_thousand_commands_are_undone_and_redone_bit_for_bit() {
    let tally = quick_round("undo");
    assert!(tally.counts["steps"] > 80_000 && tally.counts["files"] >= 40, "{tally}");
    // The naive way: 50,000 rotations, then the inverse of each.
    let turn = math::rotation(DVec3::new(0.6, 0.0, 0.8), 0.1);
    let mut m = DMat3::IDENTITY;
    for _ in 0..50_000 {
        m *= turn;
    }
    for _ in 0..50_000 {
        m *= turn.inverse();
    }
    let off = (m - DMat3::IDENTITY).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    Figure {
        case: 62,
        what: "a scene after 100,000 commands undone, and redone",
        naive: Some(("50,000 turns and their inverses", off)),
        ours: 0.0,
        bound: 0.0,
        unit: "off",
    }
    .hold();
}

#[test]
fn case_63_deletion_and_return_and_joined_drags_bring_back_every_stack() {
    let (mut scene, mut view) = desk(Subject::Object, Transformation::Rotation);
    let mut history = History::new();
    let mut seen = vec![scene.clone()];
    let drag = |history: &mut History, scene: &mut Scene, view: &View, number| {
        for i in 0..100 {
            let phase = if i == 0 { GesturePhase::First } else { GesturePhase::Continued };
            let command = transform::rotate(scene, view, DVec3::ONE, 0.1, phase).unwrap();
            history.perform(scene, command, Gesture::Part(number), "Turn").unwrap();
        }
    };
    let stack = |scene: &Scene, view: &View| {
        scene.objects.get(view.object.unwrap()).unwrap().placement.clone()
    };
    for number in 0..5 {
        let still = stack(&scene, &view);
        drag(&mut history, &mut scene, &view, number);
        // A drag of a hundred parts is one step, on top of the previous state.
        assert!(stack(&scene, &view).undone() == Some(still), "drag {number}");
        seen.push(scene.clone());
        let before = scene.clone();
        let id = [ObjectId(3), ObjectId(1), ObjectId(2)][usize::from(number > 2)];
        if scene.objects.get(id).is_some() {
            let command = items::remove(&scene, ItemId::Object(id)).unwrap();
            history.perform(&mut scene, command, Gesture::Whole, "Remove").unwrap();
            seen.push(scene.clone());
        }
        selection::follow(&before, &scene, &mut view);
    }
    for round in 0..2 {
        for (position, expected) in seen.iter().enumerate().rev() {
            history.go_to(&mut scene, position);
            assert!(scene == *expected, "round {round}, step {position}");
        }
        history.go_to(&mut scene, usize::MAX);
        assert!(Some(&scene) == seen.last());
    }
}

#[test]
fn case_63_a_scene_saved_on_the_way_is_the_one_that_redo_comes_back_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.marraztu");
    let (mut scene, mut view) = io::default_scene();
    view.subject = Subject::Object;
    let settings = Settings::default();
    let text = |scene: &Scene| io::to_text(&path, scene, &view, &settings).unwrap();
    let mut history = History::new();
    for axis in Axis::ALL.into_iter().cycle().take(30) {
        let command =
            transform::step(&scene, &view, axis, Sign::Positive, GesturePhase::First).unwrap();
        history.perform(&mut scene, command, Gesture::Whole, "Move").unwrap();
        if history.position() == 20 {
            io::save(&path, &scene, &view, &settings).unwrap();
            history.mark_saved();
        }
    }
    history.go_to(&mut scene, 0);
    history.go_to(&mut scene, 20);
    assert!(history.is_saved());
    assert_eq!(text(&scene), std::fs::read_to_string(&path).unwrap());
    let opened = io::open(&path, &Progress::new()).unwrap().scene;
    assert_eq!(text(&opened), text(&scene));
    let depths = opened.objects.iter().map(|(_, object)| object.placement.depth());
    assert_eq!(depths.sum::<usize>(), 0, "a loaded scene starts with no past");
}

#[test]
fn case_63_numbers_are_saved_with_enough_digits() {
    // 15 digits, common in file formats, lose the last bits of a placement.
    let (mut scene, view) = io::default_scene();
    let view = View { subject: Subject::Object, transformation: Transformation::Rotation, ..view };
    let mut naive = 0;
    for i in 0..200 {
        let axis = Axis::ALL[i % 3];
        let command =
            transform::step(&scene, &view, axis, Sign::Positive, GesturePhase::First).unwrap();
        command.apply(&mut scene).unwrap();
        let placement = scene.objects.get(view.object.unwrap()).unwrap().placement.now();
        let short = |x: f64| format!("{x:.14e}").parse::<f64>().unwrap();
        naive += placement.to_cols_array().into_iter().filter(|x| short(*x) != *x).count();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.marraztu");
    io::save(&path, &scene, &view, &Settings::default()).unwrap();
    let opened = io::open(&path, &Progress::new()).unwrap().scene;
    let numbers = |scene: &Scene| -> Vec<u64> {
        let objects = scene.objects.iter().map(|(_, object)| *object.placement.now());
        objects.flat_map(|m| m.to_cols_array()).map(f64::to_bits).collect()
    };
    let (before, after) = (numbers(&scene), numbers(&opened));
    let differ = before.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert_eq!(before.len(), after.len());
    Figure {
        case: 63,
        what: "numbers of placements that saving and loading changes",
        naive: Some(("written with 15 digits, of 3200", naive as f64)),
        ours: differ as f64,
        bound: 0.0,
        unit: "numbers",
    }
    .hold();
}
