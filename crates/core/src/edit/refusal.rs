//! Refusals: the reasons why a request cannot be carried out, worded for the status line.

use crate::scene::{Command, CommandError};

/// The command that makes a change, or the reason why it is refused.
pub type Change = Result<Command, Refusal>;

/// The reason why a request is refused. The scene is then unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The scene has no objects.
    #[error("there is no object")]
    NoObject,
    /// The scene has no lights.
    #[error("there is no light")]
    NoLight,
    /// Nothing can be framed.
    #[error("there is nothing visible to frame")]
    NothingToFrame,
    /// The item is not in the scene.
    #[error("it is no longer in the scene")]
    Gone,
    /// The item is locked.
    #[error("{0} is locked: unlock it first (Ctrl+L, or the lock in the outline)")]
    Locked(String),
    /// Only one item is selected.
    #[error("only one item is selected")]
    OneSelected,
    /// The item is the only one of its kind.
    #[error("there is only one of its kind")]
    OnlyOne,
    /// Cameras have no size.
    #[error("cameras cannot be scaled")]
    CameraScaled,
    /// Lights have no size.
    #[error("lights cannot be scaled")]
    LightScaled,
    /// Scaling was chosen while the subject is not objects.
    #[error("only objects can be scaled: press c until the subject is an object")]
    OnlyObjectsScale,
    /// The subject is not objects.
    #[error("this acts on objects: press c until the subject is an object")]
    OnlyObjects,
    /// Ambient light comes from everywhere.
    #[error("ambient light has no position or direction")]
    Ambient,
    /// A sun has no position.
    #[error("the sun has a direction only: it can be turned, not moved")]
    SunMoved,
    /// A bulb has no direction.
    #[error("a bulb shines in all directions: it can be moved, not turned")]
    BulbTurned,
    /// The spot follows an object or a camera.
    #[error("this spot follows its {0}: move the {0} instead")]
    SpotFollows(&'static str),
    /// No program has left unsaved work behind.
    #[error("there is no unsaved work to recover")]
    NothingToRecover,
    /// No work was discarded.
    #[error("no work was discarded in the last 30 days")]
    NothingDiscarded,
    /// All files of the scene exist.
    #[error("no file of the scene is missing")]
    NothingMissing,
    /// The history is at its beginning.
    #[error("there is nothing to undo")]
    NothingDone,
    /// The history is at its end.
    #[error("there is nothing to redo")]
    NothingUndone,
    /// The item was never transformed.
    #[error("there is no transformation to undo")]
    NothingToTakeBack,
    /// The object already has the placement of its file.
    #[error("it already has the placement from its file")]
    NotTransformed,
    /// The object is already on the ground.
    #[error("it is already on the ground")]
    OnGround,
    /// No selected object can be aligned.
    #[error("select more objects that are not aligned yet: Shift + click")]
    NothingToAlign,
    /// The object would become flat.
    #[error("a scale of 0 would flatten the object irreversibly")]
    Flat,
    /// A number would be infinite or NaN.
    #[error("a number would become too large")]
    TooLarge,
    /// A vector of length 0 has no direction.
    #[error("a direction needs at least one number other than 0")]
    NoDirection,
    /// The camera is at its nearest distance.
    #[error("the camera cannot come nearer to the object's centre")]
    Nearest,
    /// The observer is an object.
    #[error("the observer is an object: press C to look through the camera")]
    ObjectLooks,
    /// The picture is seen through the camera, so it has no handles.
    #[error("the view is from this camera: drag the view instead")]
    SeenThrough,
    /// Lights have neither frames nor modes.
    #[error("lights have neither a mode nor a frame to choose")]
    NoModeOfLight,
    /// The key acts on lights.
    #[error("this acts on lights: press c until the subject is a light")]
    OnlyLights,
    /// The light has no cone.
    #[error("only a spot has an aperture")]
    NotASpot,
    /// Ambient light casts no shadows.
    #[error("ambient light comes from everywhere: it casts no shadows")]
    NoShadows,
    /// The light cannot be aimed.
    #[error("only a spot or a sun can be aimed")]
    NotAimed,
    /// The light is at the point at which it should be aimed.
    #[error("the light itself is at this point")]
    AimedAtItself,
    /// The interface has the largest or the smallest size.
    #[error("the interface size is at its limit")]
    LargestOrSmallest,
    /// A number has reached the end of its range.
    #[error("{0} is already at {1}")]
    Limit(&'static str, u32),
    /// No light has this key.
    #[error("no light has the key {0}")]
    EmptySlot(u32),
    /// Another light has this key.
    #[error("the key {0} belongs to another light")]
    SlotTaken(u32),
    /// Enter was pressed outside polygon mode.
    #[error("press o first: Enter selects the next polygon in polygon mode")]
    NotInPolygonMode,
    /// The object has no polygons.
    #[error("the object has no polygons")]
    NoPolygons,
    /// The object has only one part.
    #[error("the object has only one part")]
    OnePart,
    /// The object has too many parts for the outline.
    #[error("the object has {0} parts; at most {1} can be split at once")]
    TooManyParts(usize, usize),
    /// The object does not spin.
    #[error("the object does not spin")]
    NotSpinning,
    /// The crease angle has no effect on the model.
    #[error("the crease angle has no effect: {0}")]
    NoCrease(&'static str),
    /// The light is not a bulb, and only bulbs orbit.
    #[error("only a bulb can orbit")]
    NotABulb,
    /// The name is blank.
    #[error("a name needs at least one letter")]
    NoName,
    /// The scene refuses the command.
    #[error(transparent)]
    Command(#[from] CommandError),
}
