//! Commands of every kind are undone and redone bit for bit, across saving and loading.

use glam::{DVec2, DVec3};

use super::{Proof, Tally};
use marraztu_core::accuracy::Settings;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::base::math::Axis;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::lights::{self, Channel};
use marraztu_core::edit::navigation::{self, Pointer};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{
    Gesture, GesturePhase, History, Refusal, framing, items, motion, placement, selection,
};
use marraztu_core::scene::{
    Command, Frame, ItemId, LightKind, MaterialChoice, Model, Scene, SpotOwner, Subject,
    Transformation, View,
};
use marraztu_io as io;

pub(crate) const PROOF: Proof = Proof {
    name: "undo",
    claim: "commands of every kind are undone and redone bit for bit, and a scene saved on the way \
            is, opened again, the one that undo and redo come back to",
    unit: "commands",
    batch: COMMANDS,
    quick: COMMANDS,
    whole: COMMANDS,
    shows: &[],
    regressions: &[],
    check,
};

const COMMANDS: u64 = 100_000;

/// The number of commands between two saved scenes.
const SAVED: u64 = 2500;

fn check(batch: u64) -> Result<Tally, String> {
    let mut rng = Rng::new(batch);
    let (mut scene, mut view) = io::default_scene();
    let mut history = History::new();
    let start = every_bit(&scene);
    let mut saved: Vec<(usize, String)> = Vec::new();
    let (mut performed, mut refused) = (0, 0);
    while performed < COMMANDS {
        let Ok(command) = anything(&scene, &mut view, &mut rng) else {
            refused += 1;
            if refused > 8 * COMMANDS {
                return Err("hardly anything can be done any more".to_owned());
            }
            continue;
        };
        // One command in four belongs to one of two drags.
        let before = scene.clone();
        let gesture = match rng.below(4) {
            0 => Gesture::Part(rng.below(2)),
            _ => Gesture::Whole,
        };
        history
            .perform(&mut scene, command, gesture, "anything")
            .map_err(|error| format!("command {performed}: {error}"))?;
        selection::follow(&before, &scene, &mut view);
        performed += 1;
        if performed % SAVED == 0 {
            // A continued gesture would change the saved step.
            let mark = Command::Background(scene.background);
            let whole = Gesture::Whole;
            history.perform(&mut scene, mark, whole, "mark").map_err(|e| e.to_string())?;
            saved.push((history.position(), text(&scene)?));
        }
    }
    // Undo, redo and every saved file restore all bits.
    let end = every_bit(&scene);
    let steps = history.steps().len();
    walk(&mut scene, &mut history, [&start, &end], &saved)?;
    for (position, text) in &saved {
        reopen(text, batch).map_err(|what| format!("saved at step {position}: {what}"))?;
    }
    let mut tally = Tally::default();
    tally.count("commands", performed);
    tally.count("refusals", refused);
    tally.count("steps", steps as u64);
    tally.count("files", saved.len() as u64);
    Ok(tally)
}

/// Undoes and redoes everything, and compares the scene with each saved one along the way.
fn walk(
    scene: &mut Scene,
    history: &mut History,
    [start, end]: [&str; 2],
    saved: &[(usize, String)],
) -> Result<(), String> {
    // At a saved position the scene must equal the saved file.
    let at = |scene: &Scene, history: &History| match saved
        .iter()
        .find(|(position, _)| *position == history.position())
    {
        Some((position, file)) if text(scene)? != *file => {
            Err(format!("step {position} is not what was saved there"))
        }
        _ => Ok(()),
    };
    while history.undo(scene).is_some() {
        at(scene, history)?;
    }
    if every_bit(scene) != start {
        return Err("undone to somewhere else".to_owned());
    }
    while history.redo(scene).is_some() {
        at(scene, history)?;
    }
    if every_bit(scene) == end { Ok(()) } else { Err("redone to somewhere else".to_owned()) }
}

/// The scene as a file, without the selection, which undo does not restore.
fn text(scene: &Scene) -> Result<String, String> {
    let view = scene.first_view();
    let path = std::path::Path::new("/scene.marraztu");
    io::to_text(path, scene, &view, &Settings::default()).map_err(|error| error.to_string())
}

/// Saves a scene file, opens it, and compares it when saved again.
fn reopen(file: &str, batch: u64) -> Result<(), String> {
    let name = format!("marraztu-{}-{batch}.{}", std::process::id(), io::SCENE_ENDING);
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, file).map_err(|error| error.to_string())?;
    let opened = io::open(&path, &io::Progress::new());
    let removed = std::fs::remove_file(&path);
    let opened = opened.map_err(|error| error.to_string())?;
    removed.map_err(|error| error.to_string())?;
    if text(&opened.scene)? == file { Ok(()) } else { Err("opened as something else".to_owned()) }
}

/// Formats every number of a scene and its undo stacks. Different numbers have different text, and
/// so have -0 and 0.
fn every_bit(scene: &Scene) -> String {
    use std::fmt::Write;
    let mut text = format!("{scene:?}");
    let mut add = |stack: &dyn std::fmt::Debug| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{stack:?}");
    };
    for (_, object) in scene.objects.iter() {
        add(&object.placement.earlier().collect::<Vec<_>>());
    }
    for (_, camera) in scene.cameras.iter() {
        add(&camera.pose.earlier().collect::<Vec<_>>());
    }
    for (_, light) in scene.lights.iter() {
        if let LightKind::Bulb { position, .. } = &light.kind {
            add(&position.earlier().collect::<Vec<_>>());
        }
    }
    text
}

/// A random command.
fn anything(scene: &Scene, view: &mut View, rng: &mut Rng) -> Result<Command, Refusal> {
    let stroke = rng.one_of(&[GesturePhase::First, GesturePhase::First, GesturePhase::Continued]);
    view.time += 0.1;
    let item = any_item(scene, rng).ok_or(Refusal::Gone)?;
    let object = || view.object.ok_or(Refusal::NoObject);
    match rng.below(15) {
        0..6 => placing(scene, view, rng, stroke),
        6 => transform::toggle_analysis(scene, view),
        7 => looking(scene, view, rng, stroke),
        8 => items::duplicate(scene, item, DVec3::ZERO).and_then(|command| few(scene, command)),
        9 => items::remove(scene, item),
        10 => items::toggle_shown(scene, item),
        11 => items::reorder(scene, item, rng.index(5)),
        12 => lighting(scene, view, rng),
        13 => motion::toggle_spin(scene, object()?, rng.one_of(&Axis::ALL), view.time),
        _ => {
            let chosen = selection::select(scene, view, item)?;
            *view = chosen.view;
            chosen.command.ok_or(Refusal::OnlyOne)
        }
    }
}

/// A random transformation, or one step back.
fn placing(
    scene: &Scene,
    view: &mut View,
    rng: &mut Rng,
    stroke: GesturePhase,
) -> Result<Command, Refusal> {
    use Transformation::{Rotation, Scaling, Translation};
    match rng.below(8) {
        0..5 => {
            let all = [Subject::Camera, Subject::Object, Subject::Light];
            selection::set_subject(view, rng.one_of(&all));
            let kind = rng.one_of(&[Translation, Rotation, Scaling]);
            // Refused if the subject cannot be scaled; the previous kind stays.
            let _ = selection::set_transformation(view, kind);
            view.frame = rng.one_of(&[Frame::Local, Frame::Global]);
            let sign = rng.one_of(&[Sign::Positive, Sign::Negative]);
            transform::step(scene, view, rng.one_of(&Axis::ALL), sign, stroke)
        }
        5 => transform::rotate(scene, view, rng.vector(10.0), rng.real(-10.0, 10.0), stroke),
        6 => {
            let object = view.object.ok_or(Refusal::NoObject)?;
            placement::object_turn(scene, view, object, rng.vector(200.0), stroke)
        }
        _ => transform::take_back(scene, view),
    }
}

/// Moves or changes the camera.
fn looking(
    scene: &Scene,
    view: &View,
    rng: &mut Rng,
    stroke: GesturePhase,
) -> Result<Command, Refusal> {
    let size = Size::new(640, 480);
    let at = DVec2::new(rng.real(120.0, 520.0), rng.real(40.0, 440.0));
    let amount: DVec3 = rng.vector(10.0);
    match rng.below(4) {
        0 => navigation::orbit(scene, view, amount.x, amount.y, stroke),
        1 => navigation::pan(scene, view, at, size, stroke),
        2 => navigation::zoom(scene, view, amount.z, Pointer { at, depth: None }, size, stroke),
        _ => framing::selection(scene, view),
    }
}

/// Changes a light, or adds a light or a camera.
fn lighting(scene: &Scene, view: &View, rng: &mut Rng) -> Result<Command, Refusal> {
    match rng.below(4) {
        0 => {
            let channel = rng.one_of(&[Channel::Red, Channel::Green, Channel::Blue]);
            lights::step_color(scene, view, channel, rng.one_of(&[-1, 1]))
        }
        1 => lights::step_aperture(scene, view, rng.one_of(&[-5.0, 5.0])),
        2 => {
            let owner = match view.object.filter(|_| rng.one_in(2)) {
                Some(object) => SpotOwner::Object(object),
                None => lights::fixed(),
            };
            let spot: LightKind = lights::spot(owner);
            items::insert_light(scene, spot).and_then(|command| few(scene, command))
        }
        _ => {
            let mark: Shared<Model> = io::cam_model();
            few(scene, items::insert_camera(scene, mark, MaterialChoice::File))
        }
    }
}

/// Rejects commands that would let the scene grow beyond 20 items.
fn few(scene: &Scene, command: Command) -> Result<Command, Refusal> {
    let all = scene.objects.len() + scene.cameras.len() + scene.lights.len();
    if all < 20 { Ok(command) } else { Err(Refusal::TooLarge) }
}

fn any_item(scene: &Scene, rng: &mut Rng) -> Option<ItemId> {
    let objects = scene.objects.ids().map(ItemId::Object);
    let cameras = scene.cameras.ids().map(ItemId::Camera);
    let all: Vec<ItemId> =
        objects.chain(cameras).chain(scene.lights.ids().map(ItemId::Light)).collect();
    (!all.is_empty()).then(|| rng.one_of(&all))
}
