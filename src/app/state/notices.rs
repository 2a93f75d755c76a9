//! The messages of the window: in the status line, and as notices with offers.

use std::path::PathBuf;

use marraztu_core::edit::{Refusal, framing, items};
use marraztu_core::scene::{
    Command, MaterialChoice, Object, ObjectId, Scene, Sides, Surface, View,
};

/// A message to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// One sentence.
    pub text: String,
    /// Its tone.
    pub tone: Tone,
}

/// The tone of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// An action was done.
    Done,
    /// An action was not done, for the reason given.
    Refused,
}

/// A notice over the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// One line.
    pub text: String,
    /// Details, one line each.
    pub details: Vec<String>,
    /// An offer shown with it as a button.
    pub offer: Option<Offer>,
}

impl Notice {
    /// Creates a notice of one line.
    pub const fn new(text: String) -> Self {
        Self { text, details: Vec::new(), offer: None }
    }

    /// Returns whether it waits for an answer. Any other notice moves to the status line after some
    /// seconds.
    pub const fn needs_answer(&self) -> bool {
        match self.offer {
            Some(Offer::Frame(_) | Offer::TwoSides(_) | Offer::Show(_) | Offer::Opaque(_)) => true,
            Some(Offer::Up(_)) | None => false,
        }
    }
}

/// The notices about missing files of the scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MissingFiles {
    /// Whether the notice that counts them was dismissed.
    pub dismissed: bool,
    /// The old and new paths of missing files that lie in the folder of a file found by the user.
    pub nearby: Vec<[PathBuf; 2]>,
}

/// An action that a notice offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// Bring an object into view.
    Frame(ObjectId),
    /// Draw both sides of an object's faces.
    TwoSides(ObjectId),
    /// Show a hidden object.
    Show(ObjectId),
    /// Make an object opaque.
    Opaque(ObjectId),
    /// Choose the axis of its file that points up.
    Up(ObjectId),
}

impl Offer {
    /// Returns the label of its button.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Frame(_) => "Frame",
            Self::TwoSides(_) => "Draw both sides",
            Self::Show(_) => "Show",
            Self::Opaque(_) => "Make opaque",
            Self::Up(_) => "Up axis",
        }
    }

    /// Returns the object that it is about.
    pub const fn object(self) -> ObjectId {
        match self {
            Self::Frame(id)
            | Self::TwoSides(id)
            | Self::Show(id)
            | Self::Opaque(id)
            | Self::Up(id) => id,
        }
    }

    /// Returns the change of the scene and its label in the history; `None` if the model has to be
    /// read again first.
    ///
    /// # Errors
    /// Fails if the object is gone or is the observer.
    pub fn command(self, scene: &Scene, view: &View) -> Result<Option<(Command, String)>, Refusal> {
        let id = self.object();
        let name = &scene.objects.get(id).ok_or(Refusal::Gone)?.name;
        Ok(Some(match self {
            Self::Frame(_) => (framing::objects(scene, view, &[id])?, format!("Frame {name}")),
            Self::TwoSides(_) => {
                let two = |object: &mut Object| object.sides = Sides::Two;
                (items::change_object(scene, id, two)?, format!("Draw both sides of {name}"))
            }
            Self::Show(_) => {
                let show = |object: &mut Object| object.visible = true;
                (items::change_object(scene, id, show)?, format!("Show {name}"))
            }
            Self::Opaque(_) => {
                (items::change_object(scene, id, make_opaque)?, format!("Make {name} opaque"))
            }
            Self::Up(_) => return Ok(None),
        }))
    }
}

/// Makes an object opaque by setting its opacity to 1.
///
/// If the opacity was 1 already, the materials or the texture of the file make it transparent. If
/// every part has an opacity of 0, the object gets the first part's material as its own. If a part
/// has a texture, the object shows its material alone.
fn make_opaque(object: &mut Object) {
    let was_transparent = object.opacity < 1.0;
    object.opacity = 1.0;
    if was_transparent {
        return;
    }
    let parts = u32::try_from(object.model.mesh.parts().len()).unwrap_or(u32::MAX);
    if (0..parts).all(|part| object.part_look(part).opacity == 0.0) {
        object.material = MaterialChoice::Own(object.part_look(0).material);
    } else if (0..parts).any(|part| object.part_look(part).texture.is_some()) {
        object.surface = Surface::Material;
    }
}
