//! The changes that can be made to a scene.
//!
//! Undo needs no separate code: [`Command::apply`] returns the inverse command, so a change and its
//! undo cannot drift apart. Everything large in a scene is shared, so a change of an item holds the
//! whole new item, and its inverse holds the whole old item.

use super::{Camera, CameraId, ItemId, Light, LightId, Object, ObjectId, Scene};
use crate::base::color::Color;

/// One change to a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Inserts an item into its list, before the item at `at`.
    Insert {
        /// The index in the list; past the end means last.
        at: usize,
        /// The item, under an unused id.
        item: Item,
    },
    /// Removes an item.
    Remove(ItemId),
    /// Replaces an item, found by its id.
    Replace(Item),
    /// Moves an item to another place in its list.
    Reorder {
        /// The item.
        id: ItemId,
        /// The index in the list afterwards.
        to: usize,
    },
    /// Locks an item, or unlocks it.
    Lock {
        /// The item.
        id: ItemId,
        /// Whether it is locked afterwards.
        locked: bool,
    },
    /// Sets the background.
    Background(Color),
    /// Sets the id that the next new item gets.
    NextId(u32),
    /// Applies all of these commands in order, or none of them.
    Batch(Vec<Self>),
}

/// A value of a scene that a command sets as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// An item, without its position in its list.
    Item(ItemId),
    /// Whether an item is locked.
    Lock(ItemId),
    /// The background.
    Background,
    /// The id of the next new item.
    NextId,
}

/// An item of one of the lists, with its id.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// An object.
    Object(ObjectId, Box<Object>),
    /// A camera.
    Camera(CameraId, Box<Camera>),
    /// A light.
    Light(LightId, Box<Light>),
}

impl Item {
    /// Returns the id.
    pub const fn id(&self) -> ItemId {
        match self {
            Self::Object(id, _) => ItemId::Object(*id),
            Self::Camera(id, _) => ItemId::Camera(*id),
            Self::Light(id, _) => ItemId::Light(*id),
        }
    }

    /// Returns the reason why the item is invalid in a scene, or `None` if it is valid.
    fn fault(&self) -> Option<CommandError> {
        let finite = match self {
            Self::Object(_, object) => {
                object.placement.now().is_finite() && object.opacity.is_finite()
            }
            Self::Camera(_, camera) => {
                let pose = camera.pose.now();
                if !camera.lens.is_valid() {
                    return Some(CommandError::Lens);
                }
                pose.eye.is_finite() && pose.axes.is_finite()
            }
            Self::Light(_, light) => {
                if !light.attenuation.is_valid() {
                    return Some(CommandError::Attenuation);
                }
                light.kind.is_valid()
            }
        };
        (!finite).then_some(CommandError::NotFinite)
    }
}

/// The reasons why a command cannot be applied. The scene is then unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// The item to change is not in the scene.
    #[error("the item to change is no longer in the scene")]
    Missing(ItemId),
    /// The item to insert is already in the scene.
    #[error("the item to add is already in the scene")]
    AlreadyThere(ItemId),
    /// The last camera cannot be removed.
    #[error("the last camera cannot be removed")]
    LastCamera,
    /// A number would overflow.
    #[error("a number would become too large")]
    NotFinite,
    /// The lens would give an invalid projection.
    #[error(
        "the lens needs an angle between 0 and 90 degrees, a size above 0, near before far, and a \
         pixel aspect from 0.001 to 1000"
    )]
    Lens,
    /// The light would become infinite or negative.
    #[error("the attenuation of a light needs numbers of at least 0, one of them above 0")]
    Attenuation,
}

impl Command {
    /// Changes the scene, and returns the inverse command.
    ///
    /// # Errors
    /// If the command does not fit the scene. The scene is then unchanged.
    pub fn apply(self, scene: &mut Scene) -> Result<Self, CommandError> {
        match self {
            Self::Insert { at, item } => insert(scene, at, item),
            Self::Remove(id) => remove(scene, id),
            Self::Replace(item) => replace(scene, item),
            Self::Reorder { id, to } => {
                // A move is a removal and an insertion. `remove_any` allows this for the last
                // camera, too.
                let Self::Insert { at, item } = remove_any(scene, id)? else {
                    unreachable!("removing returns an insertion")
                };
                insert(scene, to, item)?;
                Ok(Self::Reorder { id, to: at })
            }
            Self::Lock { id, locked } => lock(scene, id, locked),
            Self::Background(to) => {
                Ok(Self::Background(std::mem::replace(&mut scene.background, to)))
            }
            Self::NextId(to) => Ok(Self::NextId(std::mem::replace(&mut scene.next_id, to))),
            Self::Batch(commands) => batch(scene, commands),
        }
    }

    /// Returns the value that the command sets, whatever it was before; `None` if the command
    /// changes which items exist or their order, and for batches.
    pub const fn target(&self) -> Option<Target> {
        match self {
            Self::Replace(item) => Some(Target::Item(item.id())),
            Self::Lock { id, .. } => Some(Target::Lock(*id)),
            Self::Background(_) => Some(Target::Background),
            Self::NextId(_) => Some(Target::NextId),
            Self::Insert { .. } | Self::Remove(_) | Self::Reorder { .. } | Self::Batch(_) => None,
        }
    }
}

fn lock(scene: &mut Scene, id: ItemId, locked: bool) -> Result<Command, CommandError> {
    if !scene.contains(id) {
        return Err(CommandError::Missing(id));
    }
    let was = if locked { !scene.locked.insert(id) } else { scene.locked.remove(&id) };
    Ok(Command::Lock { id, locked: was })
}

fn insert(scene: &mut Scene, at: usize, item: Item) -> Result<Command, CommandError> {
    let id = item.id();
    if scene.contains(id) {
        return Err(CommandError::AlreadyThere(id));
    }
    if let Some(fault) = item.fault() {
        return Err(fault);
    }
    match item {
        Item::Object(id, object) => scene.objects.insert(at, id, *object),
        Item::Camera(id, camera) => scene.cameras.insert(at, id, *camera),
        Item::Light(id, light) => scene.lights.insert(at, id, *light),
    }
    Ok(Command::Remove(id))
}

fn remove(scene: &mut Scene, id: ItemId) -> Result<Command, CommandError> {
    if matches!(id, ItemId::Camera(_)) && scene.contains(id) && scene.cameras.len() == 1 {
        return Err(CommandError::LastCamera);
    }
    remove_any(scene, id)
}

fn remove_any(scene: &mut Scene, id: ItemId) -> Result<Command, CommandError> {
    let missing = CommandError::Missing(id);
    let (at, item) = match id {
        ItemId::Object(id) => {
            let (at, object) = scene.objects.remove(id).ok_or(missing)?;
            (at, Item::Object(id, Box::new(object)))
        }
        ItemId::Camera(id) => {
            let (at, camera) = scene.cameras.remove(id).ok_or(missing)?;
            (at, Item::Camera(id, Box::new(camera)))
        }
        ItemId::Light(id) => {
            let (at, light) = scene.lights.remove(id).ok_or(missing)?;
            (at, Item::Light(id, Box::new(light)))
        }
    };
    Ok(Command::Insert { at, item })
}

fn replace(scene: &mut Scene, item: Item) -> Result<Command, CommandError> {
    if let Some(fault) = item.fault() {
        return Err(fault);
    }
    let missing = CommandError::Missing(item.id());
    let before = match item {
        Item::Object(id, object) => {
            Item::Object(id, Box::new(scene.objects.replace(id, *object).ok_or(missing)?))
        }
        Item::Camera(id, camera) => {
            Item::Camera(id, Box::new(scene.cameras.replace(id, *camera).ok_or(missing)?))
        }
        Item::Light(id, light) => {
            Item::Light(id, Box::new(scene.lights.replace(id, *light).ok_or(missing)?))
        }
    };
    Ok(Command::Replace(before))
}

fn batch(scene: &mut Scene, commands: Vec<Command>) -> Result<Command, CommandError> {
    let mut back = Vec::with_capacity(commands.len());
    for command in commands {
        match command.apply(scene) {
            Ok(inverse) => back.push(inverse),
            Err(error) => {
                // Undo the commands that succeeded, so a failed batch changes nothing.
                for inverse in back.into_iter().rev() {
                    inverse.apply(scene).expect("a command that was just applied can be undone");
                }
                return Err(error);
            }
        }
    }
    back.reverse();
    Ok(Command::Batch(back))
}
