//! Applies an action to all selected items.
//!
//! The action is applied to each item in turn, as if it were the selected one, in the scene that
//! the earlier items have left. If some items refuse the action, it is done for the others; only if
//! all refuse, the action is refused.

use std::collections::BTreeSet;

use super::{Change, GesturePhase, Refusal, items, motion, placement, selection};
use crate::scene::{
    Anchor, AnchorMut, Camera, Command, Item, ItemId, LIGHT_NUMBERS, Light, LightId, LightKind,
    Object, ObjectId, Scene, SpotOwner, Subject, Tracked, View,
};

/// The items that are selected in addition to the one that the keys act on.
///
/// They belong to that item: once another item is selected alone, they are no longer selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Others {
    with: Option<ItemId>,
    items: BTreeSet<ItemId>,
}

impl Others {
    /// Selects these items in addition to `with`.
    pub fn new(with: ItemId, items: impl IntoIterator<Item = ItemId>) -> Self {
        let items = items.into_iter().filter(|item| *item != with).collect();
        Self { with: Some(with), items }
    }

    /// Returns the items that are now selected in addition to the one that the keys act on.
    pub fn of<'a>(
        &'a self,
        scene: &'a Scene,
        view: &View,
    ) -> impl Iterator<Item = ItemId> + use<'a> {
        let valid = self.with.is_some() && self.with == selection::selected(view);
        self.items.iter().copied().filter(move |item| valid && scene.contains(*item))
    }
}

/// Combines the commands that `act` returns for the selected item and for each of the others.
///
/// # Errors
/// The refusal for the selected item, if all items refuse.
pub fn each(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    act: impl Fn(&Scene, &View) -> Change,
) -> Change {
    if others.is_empty() {
        return act(scene, view);
    }
    let mut after = scene.clone();
    let (mut commands, mut refused) = (Vec::new(), None);
    for id in selection::selected(view).into_iter().chain(others.iter().copied()) {
        // An earlier command may have removed this item, too.
        if !after.contains(id) {
            continue;
        }
        match act(&after, &as_if_selected(view, id)) {
            Ok(command) => {
                command.clone().apply(&mut after)?;
                commands.push(command);
            }
            Err(why) => refused = refused.or(Some(why)),
        }
    }
    match (commands.is_empty(), refused) {
        (true, refused) => Err(refused.unwrap_or(Refusal::Gone)),
        (false, _) => Ok(Command::Batch(commands)),
    }
}

/// Returns the view with this item as the selected one.
fn as_if_selected(view: &View, id: ItemId) -> View {
    let mut view = view.clone();
    view.subject = selection::subject_of(id);
    match id {
        ItemId::Object(id) => view.object = Some(id),
        ItemId::Camera(id) => view.camera = id,
        ItemId::Light(id) => view.light = Some(id),
    }
    view
}

/// Shows or hides all of these items, whichever the selected one does.
///
/// # Errors
/// If the selected item is gone.
pub fn toggle_shown(scene: &Scene, view: &View, others: &[ItemId]) -> Change {
    let shown = |scene: &Scene, id| match id {
        ItemId::Object(id) => scene.objects.get(id).is_some_and(|object| object.visible),
        ItemId::Camera(id) => scene.cameras.get(id).is_some_and(|camera| camera.visible),
        ItemId::Light(id) => scene.lights.get(id).is_some_and(|light| light.on),
    };
    let first = selection::selected(view).ok_or(Refusal::Gone)?;
    let before = shown(scene, first);
    let others: Vec<ItemId> =
        others.iter().copied().filter(|id| shown(scene, *id) == before).collect();
    each(scene, view, &others, |scene, view| {
        items::toggle_shown(scene, selection::selected(view).ok_or(Refusal::Gone)?)
    })
}

/// Locks or unlocks all of these items, whichever the selected one does.
///
/// # Errors
/// If the selected item is gone.
pub fn toggle_locked(scene: &Scene, view: &View, others: &[ItemId]) -> Change {
    let first = selection::selected(view).ok_or(Refusal::Gone)?;
    let before = scene.locked.contains(&first);
    let alike = |id: &ItemId| scene.locked.contains(id) == before;
    let others: Vec<ItemId> = others.iter().copied().filter(alike).collect();
    each(scene, view, &others, |scene, view| {
        items::toggle_locked(scene, selection::selected(view).ok_or(Refusal::Gone)?)
    })
}

/// Changes all selected objects, even if the first one has the new value already.
///
/// # Errors
/// If no object is selected.
pub fn change_objects(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    change: impl Fn(&mut Object),
) -> Change {
    each(scene, view, others, |scene, view| match selection::selected(view) {
        Some(ItemId::Object(id)) => items::change_object(scene, id, &change),
        Some(ItemId::Camera(_) | ItemId::Light(_)) | None => Err(Refusal::NoObject),
    })
}

/// Changes all selected lights, even if the first one has the new value already.
///
/// # Errors
/// If no light is selected.
pub fn change_lights(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    change: impl Fn(&mut Light),
) -> Change {
    each(scene, view, others, |scene, view| match selection::selected(view) {
        Some(ItemId::Light(id)) => items::change_light(scene, id, &change),
        Some(ItemId::Object(_) | ItemId::Camera(_)) | None => Err(Refusal::NoLight),
    })
}

/// Extends a command to all items of a kind: a value that it changes in the selected item is set in
/// the others, too. A command that already replaces one of the others, as those of [`each`] do, is
/// returned unchanged.
#[must_use]
pub fn spread(scene: &Scene, command: Command, others: &[ItemId]) -> Command {
    let Some(changed) = replaced(&command) else { return command };
    if others.iter().any(|id| *id != changed.id() && replaces(&command, *id)) {
        return command;
    }
    let mut commands = Vec::new();
    for id in others {
        commands.extend(alike(scene, changed, *id));
    }
    if commands.is_empty() {
        return command;
    }
    commands.insert(0, command);
    Command::Batch(commands)
}

/// Returns the first item that a command replaces.
fn replaced(command: &Command) -> Option<&Item> {
    match command {
        Command::Replace(item) => Some(item),
        Command::Batch(commands) => commands.first().and_then(replaced),
        Command::Insert { .. }
        | Command::Remove(_)
        | Command::Reorder { .. }
        | Command::Lock { .. }
        | Command::Background(_)
        | Command::NextId(_) => None,
    }
}

/// Returns whether a command replaces an item.
fn replaces(command: &Command, id: ItemId) -> bool {
    match command {
        Command::Replace(item) => item.id() == id,
        Command::Batch(commands) => commands.iter().any(|command| replaces(command, id)),
        Command::Insert { .. }
        | Command::Remove(_)
        | Command::Reorder { .. }
        | Command::Lock { .. }
        | Command::Background(_)
        | Command::NextId(_) => false,
    }
}

/// Sets the values that `changed` changes in another item of the same kind.
fn alike(scene: &Scene, changed: &Item, other: ItemId) -> Option<Command> {
    let item = match (changed, other) {
        (Item::Object(id, to), ItemId::Object(other)) if *id != other => {
            let before = scene.objects.get(*id)?;
            if before.spin != to.spin {
                return spin_alike(scene, before, to, other);
            }
            let mut object = scene.objects.get(other)?.clone();
            let placement = object.placement.clone();
            // A locked item takes all changes except the placement.
            object_alike(before, to, &mut object)?;
            if scene.locked.contains(&ItemId::Object(other)) {
                object.placement = placement;
            }
            Item::Object(other, Box::new(object))
        }
        (Item::Camera(id, to), ItemId::Camera(other)) if *id != other => {
            let mut camera = scene.cameras.get(other)?.clone();
            let pose = camera.pose.clone();
            camera_alike(scene.cameras.get(*id)?, to, &mut camera);
            if scene.locked.contains(&ItemId::Camera(other)) {
                camera.pose = pose;
            }
            Item::Camera(other, Box::new(camera))
        }
        (Item::Light(id, to), ItemId::Light(other)) if *id != other => {
            let before = scene.lights.get(*id)?;
            if before.kind.orbit() != to.kind.orbit() {
                return orbit_alike(scene, before, to, other);
            }
            let mut light = scene.lights.get(other)?.clone();
            let kind = light.kind.clone();
            light_alike(before, to, &mut light);
            if scene.locked.contains(&ItemId::Light(other)) {
                light.kind = kind;
            }
            Item::Light(other, Box::new(light))
        }
        _ => return None,
    };
    Some(Command::Replace(item))
}

/// Changes the spin of another object as the selected one's was changed. Both keep their own
/// rotations so far.
fn spin_alike(scene: &Scene, before: &Object, after: &Object, other: ObjectId) -> Option<Command> {
    let mut spin = scene.objects.get(other)?.spin;
    for axis in 0..3 {
        set(&before.spin.axes[axis], &after.spin.axes[axis], &mut spin.axes[axis]);
    }
    set(&before.spin.speed, &after.spin.speed, &mut spin.speed);
    let phase = phase_of(&before.placement, &after.placement);
    motion::set_spin(scene, other, spin, after.spin.since, phase).ok()
}

/// Changes the orbit of another bulb as the selected one's was changed. Both keep their own
/// positions.
fn orbit_alike(scene: &Scene, before: &Light, after: &Light, other: LightId) -> Option<Command> {
    let (old, new) = (before.kind.orbit()?, after.kind.orbit()?);
    let mut orbit = *scene.lights.get(other)?.kind.orbit()?;
    set(&old.on, &new.on, &mut orbit.on);
    set(&old.speed, &new.speed, &mut orbit.speed);
    let phase = match (before.kind.anchor(), after.kind.anchor()) {
        (Anchor::Position(old), Anchor::Position(new)) => phase_of(old, new),
        _ => GesturePhase::First,
    };
    motion::set_orbit(scene, other, orbit, new.since, phase).ok()
}

/// Sets a field if it was changed.
fn set<T: PartialEq + Clone>(before: &T, after: &T, own: &mut T) {
    if before != after {
        own.clone_from(after);
    }
}

/// Takes the coordinates that were changed, and keeps the others.
fn vector(before: glam::DVec3, after: glam::DVec3, own: glam::DVec3) -> glam::DVec3 {
    glam::DVec3::select(before.cmpeq(after), own, after)
}

fn object_alike(before: &Object, after: &Object, own: &mut Object) -> Option<()> {
    set(&before.visible, &after.visible, &mut own.visible);
    set(&before.material, &after.material, &mut own.material);
    set(&before.surface, &after.surface, &mut own.surface);
    set(&before.texture, &after.texture, &mut own.texture);
    set(&before.tint, &after.tint, &mut own.tint);
    set(&before.opacity, &after.opacity, &mut own.opacity);
    set(&before.edge_color, &after.edge_color, &mut own.edge_color);
    set(&before.sides, &after.sides, &mut own.sides);
    set(&before.file_normals, &after.file_normals, &mut own.file_normals);
    // Another model is not spread, but another crease angle of the same model is.
    if before.model != after.model && before.model.shares_file_with(&after.model) {
        let crease = after.model.options.crease;
        if items::why_no_crease(&own.model, own.file_normals).is_none() {
            own.model = crate::base::Shared::new(own.model.with_crease(crease));
        }
    }
    let (old, new) = (before.placement.now(), after.placement.now());
    if old != new {
        let m = *own.placement.now();
        let to = placement::alike(old, new, &m)?;
        own.placement = follow(&before.placement, &after.placement, &own.placement, to);
    }
    Some(())
}

/// Pushes the old value of an item if the command pushed the selected item's value.
fn follow<T: Clone>(
    before: &Tracked<T>,
    after: &Tracked<T>,
    own: &Tracked<T>,
    to: T,
) -> Tracked<T> {
    phase_of(before, after).apply(own, to)
}

/// Returns the phase of the gesture that changed a value: the first change pushes the old one.
fn phase_of<T>(before: &Tracked<T>, after: &Tracked<T>) -> GesturePhase {
    if after.depth() > before.depth() { GesturePhase::First } else { GesturePhase::Continued }
}

fn camera_alike(before: &Camera, after: &Camera, own: &mut Camera) {
    let lens = &after.lens;
    set(&before.visible, &after.visible, &mut own.visible);
    set(&before.material, &after.material, &mut own.material);
    set(&before.lens.half_angle, &lens.half_angle, &mut own.lens.half_angle);
    set(&before.lens.near, &lens.near, &mut own.lens.near);
    set(&before.lens.far, &lens.far, &mut own.lens.far);
    set(&before.lens.half_size, &lens.half_size, &mut own.lens.half_size);
    set(&before.lens.parallel_near, &lens.parallel_near, &mut own.lens.parallel_near);
    set(&before.lens.parallel_far, &lens.parallel_far, &mut own.lens.parallel_far);
    let (old, new) = (before.pose.now(), after.pose.now());
    if old != new {
        let mut to = *own.pose.now();
        to.eye = vector(old.eye, new.eye, to.eye);
        set(&old.axes, &new.axes, &mut to.axes);
        own.pose = follow(&before.pose, &after.pose, &own.pose, to);
    }
}

fn light_alike(before: &Light, after: &Light, own: &mut Light) {
    let attenuation = &after.attenuation;
    set(&before.on, &after.on, &mut own.on);
    if own.can_cast_shadows() {
        set(&before.shadows, &after.shadows, &mut own.shadows);
    }
    for channel in 0..3 {
        set(&before.color.0[channel], &after.color.0[channel], &mut own.color.0[channel]);
    }
    set(&before.attenuation.constant, &attenuation.constant, &mut own.attenuation.constant);
    set(&before.attenuation.linear, &attenuation.linear, &mut own.attenuation.linear);
    set(&before.attenuation.quadratic, &attenuation.quadratic, &mut own.attenuation.quadratic);
    if std::mem::discriminant(&after.kind) == std::mem::discriminant(&own.kind) {
        kind_alike(&before.kind, &after.kind, &mut own.kind);
    }
}

/// Sets the changed values of a light in another light of the same kind.
fn kind_alike(before: &LightKind, after: &LightKind, own: &mut LightKind) {
    for number in LIGHT_NUMBERS {
        let (old, new) = ((number.get)(before), (number.get)(after));
        if let (Some(old), Some(new), Some(own)) = (old, new, (number.get_mut)(own)) {
            set(&old, &new, own);
        }
    }
    match (before.anchor(), after.anchor(), own.anchor_mut()) {
        (Anchor::Direction(old), Anchor::Direction(new), AnchorMut::Direction(direction))
            if old.now() != new.now() =>
        {
            *direction = follow(old, new, direction, *new.now());
        }
        (Anchor::Position(old), Anchor::Position(new), AnchorMut::Position(position))
            if old.now() != new.now() =>
        {
            let to = vector(*old.now(), *new.now(), *position.now());
            *position = follow(old, new, position, to);
        }
        (Anchor::Owner(old), Anchor::Owner(new), AnchorMut::Owner(owner)) => {
            owner_alike(old, new, owner);
        }
        _ => {}
    }
}

fn owner_alike(before: &SpotOwner, after: &SpotOwner, own: &mut SpotOwner) {
    match (before, after, &mut *own) {
        (SpotOwner::Fixed(old), SpotOwner::Fixed(new), SpotOwner::Fixed(aim))
            if old.now() != new.now() =>
        {
            let mut to = *aim.now();
            let (was, is) = (old.now(), new.now());
            to.position = vector(was.position, is.position, to.position);
            set(&was.direction, &is.direction, &mut to.direction);
            *aim = follow(old, new, aim, to);
        }
        (SpotOwner::Fixed(_), SpotOwner::Fixed(_), _) => {}
        (old, new, own) => set(old, new, own),
    }
}

/// Returns all listed items of the subject's list. If all of these are already selected, the listed
/// items of all lists.
pub fn all(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    listed: impl Fn(ItemId) -> bool,
) -> Vec<ItemId> {
    let listed = |id: &ItemId| listed(*id);
    let objects = || scene.objects.ids().map(ItemId::Object).filter(listed);
    let cameras = || scene.cameras.ids().map(ItemId::Camera).filter(listed);
    let lights = || scene.lights.ids().map(ItemId::Light).filter(listed);
    let own: Vec<ItemId> = match view.subject {
        Subject::Object => objects().collect(),
        Subject::Camera => cameras().collect(),
        Subject::Light => lights().collect(),
    };
    let is_selected = |id: &ItemId| others.contains(id) || selection::selected(view) == Some(*id);
    match own.iter().all(is_selected) {
        true => objects().chain(cameras()).chain(lights()).collect(),
        false => own,
    }
}
