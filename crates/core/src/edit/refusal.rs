//! Refusals: the reasons why a request cannot be carried out, worded for the status line.

use crate::scene::{Command, CommandError};

/// The command that makes a change, or the reason why it is refused.
pub type Change = Result<Command, Refusal>;

/// The reason why a request is refused. The scene is then unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "its message says what a variant means")]
pub enum Refusal {
    #[error("there is no object")]
    NoObject,
    #[error("there is no light")]
    NoLight,
    #[error("there is nothing visible to frame")]
    NothingToFrame,
    #[error("it is no longer in the scene")]
    Gone,
    #[error("{0} is locked: unlock it first (Ctrl+L, or the lock in the outline)")]
    Locked(String),
    #[error("only one item is selected")]
    OneSelected,
    #[error("there is only one of its kind")]
    OnlyOne,
    #[error("cameras cannot be scaled")]
    CameraScaled,
    #[error("lights cannot be scaled")]
    LightScaled,
    #[error("only objects can be scaled: press c until the subject is an object")]
    OnlyObjectsScale,
    #[error("this acts on objects: press c until the subject is an object")]
    OnlyObjects,
    #[error("ambient light has no position or direction")]
    Ambient,
    #[error("the sun has a direction only: it can be turned, not moved")]
    SunMoved,
    #[error("a bulb shines in all directions: it can be moved, not turned")]
    BulbTurned,
    #[error("this spot follows its {0}: move the {0} instead")]
    SpotFollows(&'static str),
    #[error("there is no unsaved work to recover")]
    NothingToRecover,
    #[error("no work was discarded in the last 30 days")]
    NothingDiscarded,
    #[error("no file of the scene is missing")]
    NothingMissing,
    #[error("there is nothing to undo")]
    NothingDone,
    #[error("there is nothing to redo")]
    NothingUndone,
    #[error("there is no transformation to undo")]
    NothingToTakeBack,
    #[error("it already has the placement from its file")]
    NotTransformed,
    #[error("it is already on the ground")]
    OnGround,
    #[error("select more objects that are not aligned yet: Shift + click")]
    NothingToAlign,
    #[error("a scale of 0 would flatten the object irreversibly")]
    Flat,
    #[error("a number would become too large")]
    TooLarge,
    #[error("a direction needs at least one number other than 0")]
    NoDirection,
    #[error("the camera cannot come nearer to the object's centre")]
    Nearest,
    #[error("the camera cannot come nearer to this surface")]
    NearestToSurface,
    #[error("there is no earlier view")]
    NoEarlierView,
    #[error("there is no later view")]
    NoLaterView,
    #[error("this is the saved view")]
    AtSavedView,
    #[error("the observer is an object: press C to look through the camera")]
    ObjectLooks,
    #[error("the view is from this camera: drag the view instead")]
    SeenThrough,
    #[error("lights have neither a mode nor a frame to choose")]
    NoModeOfLight,
    #[error("this acts on lights: press c until the subject is a light")]
    OnlyLights,
    #[error("only a spot has an aperture")]
    NotASpot,
    #[error("ambient light comes from everywhere: it casts no shadows")]
    NoShadows,
    #[error("only a spot or a sun can be aimed")]
    NotAimed,
    #[error("the light itself is at this point")]
    AimedAtItself,
    #[error("the interface size is at its limit")]
    LargestOrSmallest,
    #[error("{0} is already at {1}")]
    Limit(&'static str, u32),
    #[error("no light has the key {0}")]
    EmptySlot(u32),
    #[error("the key {0} belongs to another light")]
    SlotTaken(u32),
    #[error("press o first: Enter selects the next polygon in polygon mode")]
    NotInPolygonMode,
    #[error("the object has no polygons")]
    NoPolygons,
    #[error("the object has only one part")]
    OnePart,
    #[error("the object has {0} parts; at most {1} can be split at once")]
    TooManyParts(usize, usize),
    #[error("the object does not spin")]
    NotSpinning,
    #[error("the crease angle has no effect: {0}")]
    NoCrease(&'static str),
    #[error("only a bulb can orbit")]
    NotABulb,
    #[error("a name needs at least one letter")]
    NoName,
    #[error(transparent)]
    Command(#[from] CommandError),
}
