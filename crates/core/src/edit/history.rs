//! The history: the undo stack.
//!
//! One undo undoes one step. A step holds the commands that lead away from the current position:
//! earlier steps lead back, later steps lead forward.
//!
//! Looking around is not a step. Instead, steps that do not move the camera adopt its new pose, so
//! undoing them does not move the view.

use std::collections::HashSet;

use super::{Gesture, Selected};
use crate::scene::{
    Camera, CameraId, CameraMode, Command, CommandError, Item, ItemId, Lens, Pose, Scene, Target,
    Tracked,
};

#[derive(Debug, Default)]
struct Step {
    label: String,
    /// The commands without batches, in reverse order of application.
    commands: Vec<Command>,
    /// The indices of the commands that concern a camera. Looking around updates only these, since
    /// a step may change thousands of objects.
    of_cameras: Vec<usize>,
    /// The selection before and after the step, if it was recorded.
    selected: Option<[Selected; 2]>,
}

impl Step {
    /// Adds the inverse of a change, which is applied before the commands in the step. Commands
    /// with a target in `set` are dropped, since a command of the step sets the same value later.
    /// Thus the step leads back to the state before a gesture, without its intermediate states.
    fn add(&mut self, back: Command, set: &mut HashSet<Target>) {
        if let Command::Batch(commands) = back {
            return commands.into_iter().rev().for_each(|command| self.add(command, set));
        }
        match back.target() {
            Some(target) if !set.insert(target) => return,
            Some(_) => {}
            // Other commands change which items exist, and where.
            None => set.clear(),
        }
        if concerns_camera(&back) {
            self.of_cameras.push(self.commands.len());
        }
        self.commands.push(back);
    }
}

/// The steps done and undone. Only the history writes the scene, since any other change would
/// invalidate the steps.
#[derive(Debug)]
pub struct History {
    steps: Vec<Step>,
    /// The number of steps done; later steps were undone.
    position: usize,
    /// The gesture of the last step, while it may continue.
    open: Gesture,
    /// The targets that the last step sets, if they still exist when it is undone.
    set: HashSet<Target>,
    /// The gesture that moves the view, and the views of the cameras before it.
    looking: (Gesture, Vec<(CameraId, Looking)>),
    /// The position at which the scene was saved; `None` if no step leads there any more.
    saved: Option<usize>,
}

impl Default for History {
    fn default() -> Self {
        Self::new()
    }
}

impl History {
    /// Creates a history without steps, for a scene that counts as saved.
    pub fn new() -> Self {
        let (open, looking) = (Gesture::Whole, (Gesture::Whole, Vec::new()));
        let (steps, set) = (Vec::new(), HashSet::new());
        Self { steps, position: 0, open, set, looking, saved: Some(0) }
    }

    /// Applies a command, and records the step for undoing it under `label`. In a gesture, the last
    /// label is kept. Undone steps are discarded.
    ///
    /// # Errors
    /// If the command does not fit the scene. Scene and history are then unchanged.
    pub fn perform(
        &mut self,
        scene: &mut Scene,
        command: Command,
        gesture: Gesture,
        label: &str,
    ) -> Result<(), CommandError> {
        let back = command.apply(scene)?;
        self.steps.truncate(self.position);
        match self.steps.last_mut() {
            Some(step) if gesture != Gesture::Whole && gesture == self.open => {
                step.add(back, &mut self.set);
                // The last label describes the whole gesture.
                label.clone_into(&mut step.label);
                self.saved = self.saved.filter(|saved| *saved < self.position);
            }
            _ => {
                self.saved = self.saved.filter(|saved| *saved <= self.position);
                self.set.clear();
                let mut step = Step { label: label.to_owned(), ..Step::default() };
                step.add(back, &mut self.set);
                self.steps.push(step);
                self.position += 1;
            }
        }
        self.open = gesture;
        Ok(())
    }

    /// Moves the view: applies a command that changes only poses and lenses of cameras. This is not
    /// a step. Any other command becomes a step with the label "Move the view".
    ///
    /// # Errors
    /// If the command does not fit the scene. Scene and history are then unchanged.
    pub fn navigate(
        &mut self,
        scene: &mut Scene,
        command: Command,
        gesture: Gesture,
    ) -> Result<(), CommandError> {
        let mut ids = Vec::new();
        if !cameras_of(&command, &mut ids) {
            return self.perform(scene, command, gesture, "Move the view");
        }
        let looking = |scene: &Scene| -> Vec<(CameraId, Looking)> {
            let now = |id: &CameraId| Some((*id, Looking::of(scene.cameras.get(*id)?)));
            ids.iter().filter_map(now).collect()
        };
        let before = looking(scene);
        command.apply(scene)?;
        for ((id, before), (_, after)) in before.iter().zip(looking(scene)) {
            self.follow(*id, before, &after);
        }
        // A gesture keeps the views from before its first change, for cancelling it.
        if gesture == Gesture::Whole || gesture != self.looking.0 {
            self.looking = (gesture, before);
        }
        Ok(())
    }

    /// Updates the steps on both sides with the new view of a camera.
    fn follow(&mut self, id: CameraId, before: &Looking, after: &Looking) {
        let (done, undone) = self.steps.split_at_mut(self.position);
        let sides =
            [&mut done.iter_mut().rev() as &mut dyn Iterator<Item = _>, &mut undone.iter_mut()];
        for steps in sides {
            let mut follower =
                Follower { id, pose: Some(before.pose.clone()), lens: Some(before.lens) };
            // The nearest step comes first; the last command of a step is applied first.
            for Step { commands, of_cameras, .. } in steps {
                for at in of_cameras.iter().rev() {
                    follower.pass(&mut commands[*at], after);
                }
            }
        }
    }

    /// Records the selection before and after the last step. If the step continues a gesture, the
    /// selection from before the gesture is kept.
    pub fn note_selected(&mut self, before: Selected, after: Selected) {
        if let Some(step) = self.position.checked_sub(1).and_then(|last| self.steps.get_mut(last)) {
            let before = step.selected.take().map_or(before, |[before, _]| before);
            step.selected = Some([before, after]);
        }
    }

    /// Returns the selection before the step that undo would undo.
    pub fn selected_before(&self) -> Option<&Selected> {
        let last = self.steps.get(self.position.checked_sub(1)?)?;
        last.selected.as_ref().map(|[before, _]| before)
    }

    /// Returns the selection after the step that redo would redo.
    pub fn selected_after(&self) -> Option<&Selected> {
        self.steps.get(self.position)?.selected.as_ref().map(|[_, after]| after)
    }

    /// Undoes the last step and returns its label; `None` at the beginning of the history.
    pub fn undo(&mut self, scene: &mut Scene) -> Option<String> {
        let last = self.position.checked_sub(1)?;
        let label = self.cross(scene, last)?;
        self.position = last;
        Some(label)
    }

    /// Redoes the step that was undone last and returns its label; `None` at the end of the
    /// history.
    pub fn redo(&mut self, scene: &mut Scene) -> Option<String> {
        let label = self.cross(scene, self.position)?;
        self.position += 1;
        Some(label)
    }

    /// Cancels the current gesture, without leaving a step to redo. Returns whether there was a
    /// change to undo.
    pub fn abandon(&mut self, scene: &mut Scene, gesture: Gesture) -> bool {
        if gesture == Gesture::Whole {
            return false;
        }
        if gesture == self.looking.0 {
            let (_, before) = std::mem::replace(&mut self.looking, (Gesture::Whole, Vec::new()));
            for (id, before) in before {
                let Some(camera) = scene.cameras.get(id) else { continue };
                let camera = Box::new(before.given_to(camera));
                // The camera had this pose before, so the command fits.
                let _ = self.navigate(
                    scene,
                    Command::Replace(Item::Camera(id, camera)),
                    Gesture::Whole,
                );
            }
            return true;
        }
        if gesture != self.open || self.undo(scene).is_none() {
            return false;
        }
        self.steps.truncate(self.position);
        true
    }

    /// Goes to the point after `position` steps, or to the end if there are fewer.
    pub fn go_to(&mut self, scene: &mut Scene, position: usize) {
        while self.position > position && self.undo(scene).is_some() {}
        while self.position < position && self.redo(scene).is_some() {}
    }

    /// Returns the labels of all steps, oldest first: the steps done, then the steps undone.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = &str> {
        self.steps.iter().map(|step| step.label.as_str())
    }

    /// Returns the number of steps done.
    pub const fn position(&self) -> usize {
        self.position
    }

    /// Returns whether the scene is unchanged since it was last saved or loaded.
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.position)
    }

    /// Marks the current scene as saved.
    pub const fn mark_saved(&mut self) {
        self.saved = Some(self.position);
    }

    /// Marks the scene as unsaved, although no step leads to it.
    pub const fn mark_unsaved(&mut self) {
        self.saved = None;
    }

    /// Discards all steps: the scene is new and counts as saved.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Applies the step at `index`, and replaces it by its inverse.
    fn cross(&mut self, scene: &mut Scene, index: usize) -> Option<String> {
        let step = self.steps.get_mut(index)?;
        self.open = Gesture::Whole;
        let commands = std::mem::take(&mut step.commands);
        match Command::Batch(commands.into_iter().rev().collect()).apply(scene) {
            Ok(Command::Batch(mut back)) => {
                // The batch returns commands in the order of application; a step stores the
                // reverse.
                back.reverse();
                let cameras = (0..).zip(&back).filter(|(_, command)| concerns_camera(command));
                step.of_cameras = cameras.map(|(at, _)| at).collect();
                step.commands = back;
                Some(step.label.clone())
            }
            // This happens only if other code has written the scene. The steps are then invalid,
            // and the scene is kept as it is.
            _ => {
                (self.steps, self.position, self.saved) = (Vec::new(), 0, None);
                None
            }
        }
    }
}

/// Returns whether a command inserts, removes or replaces a camera.
const fn concerns_camera(command: &Command) -> bool {
    matches!(
        command,
        Command::Insert { item: Item::Camera(..), .. }
            | Command::Remove(ItemId::Camera(_))
            | Command::Replace(Item::Camera(..))
    )
}

/// The view of a camera: its pose and lens.
#[derive(Clone, Debug)]
struct Looking {
    pose: Tracked<Pose>,
    lens: Lens,
}

impl Looking {
    fn of(camera: &Camera) -> Self {
        Self { pose: camera.pose.clone(), lens: camera.lens }
    }

    fn given_to(self, camera: &Camera) -> Camera {
        Camera { pose: self.pose, lens: self.lens, ..camera.clone() }
    }
}

/// Passes the new view of a camera from step to step.
struct Follower {
    id: CameraId,
    /// The pose to replace; `None` beyond a step that changes it.
    pose: Option<Tracked<Pose>>,
    lens: Option<Lens>,
}

impl Follower {
    /// Sets the new view in a command that keeps the camera's old view.
    fn pass(&mut self, command: &mut Command, after: &Looking) {
        match command {
            Command::Replace(Item::Camera(id, camera)) if *id == self.id => {
                self.pose =
                    self.pose.take().and_then(|old| followed(&old, &mut camera.pose, after));
                self.lens = self.lens.filter(|old| *old == camera.lens);
                if self.lens.is_some() {
                    camera.lens = after.lens;
                }
            }
            // Beyond this command the camera does not exist.
            Command::Insert { item: Item::Camera(id, _), .. }
            | Command::Remove(ItemId::Camera(id))
                if *id == self.id =>
            {
                (self.pose, self.lens) = (None, None);
            }
            Command::Batch(_)
            | Command::Insert { .. }
            | Command::Remove(_)
            | Command::Replace(_)
            | Command::Reorder { .. }
            | Command::Lock { .. }
            | Command::Background(_)
            | Command::NextId(_) => {}
        }
    }
}

/// Sets a stored pose to the new one if its step did not move the camera, and returns the pose to
/// replace in further steps. A step that only aimed the camera at its moved object did not move it:
/// undoing that step aims the camera again.
fn followed(
    old: &Tracked<Pose>,
    stored: &mut Tracked<Pose>,
    after: &Looking,
) -> Option<Tracked<Pose>> {
    let mode = stored.now().mode;
    let is_aimed = mode != CameraMode::Fly
        && mode == old.now().mode
        && stored.now().eye == old.now().eye
        && stored.shares_stack_with(old);
    if !is_aimed && stored != old {
        return None;
    }
    Some(std::mem::replace(stored, after.pose.clone()))
}

/// Collects the cameras that a command replaces. Returns whether it has no other effect.
fn cameras_of(command: &Command, ids: &mut Vec<CameraId>) -> bool {
    match command {
        Command::Replace(Item::Camera(id, _)) => {
            if !ids.contains(id) {
                ids.push(*id);
            }
            true
        }
        Command::Batch(commands) => commands.iter().all(|command| cameras_of(command, ids)),
        Command::Replace(_)
        | Command::Insert { .. }
        | Command::Remove(_)
        | Command::Reorder { .. }
        | Command::Lock { .. }
        | Command::Background(_)
        | Command::NextId(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::DVec3;

    use super::*;
    use crate::base::Shared;
    use crate::base::color::Color;
    use crate::scene::{
        CameraId, List, MaterialChoice, Mesh, Model, Object, ObjectId, Objects, Scene,
    };

    const OBJECTS: u32 = 100;

    /// Creates a scene of many objects and one camera.
    fn scene() -> Scene {
        let model = Shared::new(Model::of_mesh("box", Mesh::placeholder(1.0)));
        let object = Object::new(model.clone(), MaterialChoice::File);
        let camera = Camera::new("camera", model, MaterialChoice::File, DVec3::ZERO);
        let objects: Objects = (0..OBJECTS).map(|id| (ObjectId(id), object.clone())).collect();
        Scene {
            objects,
            cameras: [(CameraId(OBJECTS), camera)].into_iter().collect(),
            lights: List::default(),
            background: Color([0; 3]),
            next_id: OBJECTS + 1,
            locked: BTreeSet::new(),
        }
    }

    /// Moves the objects with these ids by one unit.
    fn nudge(scene: &Scene, ids: impl Iterator<Item = u32>) -> Command {
        let moved = |id: u32| {
            let mut object = scene.objects.get(ObjectId(id)).unwrap().clone();
            let mut placement = *object.placement.now();
            placement.w_axis.x += 1.0;
            object.placement = Tracked::new(placement);
            Command::Replace(Item::Object(ObjectId(id), Box::new(object)))
        };
        Command::Batch(ids.map(moved).collect())
    }

    #[test]
    fn a_gesture_keeps_one_command_for_each_object_whatever_the_order_of_its_changes() {
        let mut scene = scene();
        let start = scene.clone();
        let mut history = History::new();
        for i in 0..50 {
            let command = match i % 3 {
                0 => nudge(&scene, 0..OBJECTS),
                1 => nudge(&scene, (0..OBJECTS).rev()),
                _ => nudge(&scene, (0..OBJECTS).step_by(2)),
            };
            history.perform(&mut scene, command, Gesture::Part(1), "Move").unwrap();
        }
        assert_eq!(history.steps[0].commands.len(), OBJECTS as usize);
        history.undo(&mut scene).unwrap();
        assert_eq!(scene, start);
    }

    #[test]
    fn looking_around_visits_no_command_of_an_object() {
        let mut scene = scene();
        let mut history = History::new();
        for _ in 0..50 {
            let command = nudge(&scene, 0..OBJECTS);
            history.perform(&mut scene, command, Gesture::Whole, "Move").unwrap();
        }
        let id = CameraId(OBJECTS);
        let named = |scene: &Scene, name: &str| {
            let camera = scene.cameras.get(id).unwrap().clone();
            Command::Replace(Item::Camera(id, Box::new(Camera { name: name.to_owned(), ..camera })))
        };
        let both = Command::Batch(vec![
            nudge(&scene, 0..OBJECTS),
            named(&scene, "b"),
            nudge(&scene, 0..9),
        ]);
        history.perform(&mut scene, both, Gesture::Whole, "Rename").unwrap();
        let visited = |history: &History| -> usize {
            history.steps.iter().map(|step| step.of_cameras.len()).sum()
        };
        assert_eq!(visited(&history), 1);
        // The camera is found in the inverse, too, which has the opposite order.
        let looked = |scene: &Scene, x: f64| {
            let mut camera = scene.cameras.get(id).unwrap().clone();
            let pose = Pose::facing_minus_z(DVec3::new(x, 0.0, 0.0));
            camera.pose = Tracked::new(pose);
            Command::Replace(Item::Camera(id, Box::new(camera)))
        };
        for x in 1..4 {
            let command = looked(&scene, f64::from(x));
            history.navigate(&mut scene, command, Gesture::Whole).unwrap();
            let way = [History::undo, History::redo][usize::from(x % 2 == 0)];
            way(&mut history, &mut scene).unwrap();
            let camera = scene.cameras.get(id).unwrap();
            assert_eq!(camera.pose.now().eye.x, f64::from(x));
            assert_eq!(camera.name, ["b", "camera"][usize::from(x % 2 == 1)]);
            assert_eq!(visited(&history), 1);
        }
    }
}
