//! The messages of the window: in the status line, and as notices with offers.

use std::path::PathBuf;

use crate::app::widgets::text::one_or_count;
use marraztu_core::edit::{Refusal, items};
use marraztu_core::scene::{
    Command, ItemId, MaterialChoice, Object, ObjectId, Scene, Sides, Surface,
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

/// A notice over the picture. Notices of one kind are shown as one, with their number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// What it is about.
    pub kind: NoticeKind,
    /// One line.
    pub text: String,
    /// Details, one line each.
    pub details: Vec<String>,
    /// An offer shown with it as a button.
    pub offer: Option<Offer>,
}

/// What a notice is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NoticeKind {
    /// A file was opened.
    Opened,
    /// A file was saved or exported with less than the scene.
    Written,
    /// A model has changed on disk.
    Changed,
    /// An object is not in the picture, or covered.
    Unseen,
    /// An object is hidden.
    Hidden,
    /// An object shows only backs, which are not drawn.
    TurnedAway,
    /// An object is wholly transparent.
    Transparent,
    /// The texture of a model is missing.
    Texture,
    /// The program's own files and fonts.
    Program,
}

impl NoticeKind {
    /// All kinds, in the order in which they are shown.
    pub const ALL: [Self; 9] = [
        Self::Opened,
        Self::Written,
        Self::Changed,
        Self::Unseen,
        Self::Hidden,
        Self::TurnedAway,
        Self::Transparent,
        Self::Texture,
        Self::Program,
    ];
}

impl Notice {
    /// Creates a notice of one line.
    pub const fn new(kind: NoticeKind, text: String) -> Self {
        Self { kind, text, details: Vec::new(), offer: None }
    }

    /// Returns the notice with details.
    #[must_use]
    pub fn with(self, details: Vec<String>) -> Self {
        Self { details, ..self }
    }

    /// Returns the notice with an offer.
    #[must_use]
    pub fn offering(self, offer: Option<Offer>) -> Self {
        Self { offer, ..self }
    }

    /// Returns whether it still describes the scene. A notice about something that has changed
    /// since, for example by undo, is withdrawn.
    pub(crate) fn holds(&self, scene: &Scene) -> bool {
        let Some(offer) = &self.offer else { return true };
        let object = |id: &ObjectId| scene.objects.get(*id);
        match offer {
            Offer::Show(id) => object(id).is_some_and(|object| !object.visible),
            Offer::Frame(id) | Offer::Opaque(id) => object(id).is_some_and(|object| object.visible),
            Offer::TwoSides(id) => object(id).is_some_and(|object| !object.is_two_sided()),
            Offer::Up(id) => object(id).is_some(),
            Offer::Texture(id) => {
                object(id).is_some_and(|object| object.part_look(0).texture.is_none())
            }
            Offer::Reload(path) => {
                let mut all = scene.objects.iter().map(|(_, object)| &object.model);
                all.any(|model| model.source.as_ref() == Some(path))
            }
        }
    }
}

/// The end of the text about an object outside of the view.
pub(crate) const OUT_OF_VIEW: &str = " is out of view or too small to see";

/// The notices of one kind, shown as one.
#[derive(Clone, Debug)]
pub(crate) struct NoticeGroup<'a> {
    pub(crate) kind: NoticeKind,
    all: Vec<&'a Notice>,
}

impl<'a> NoticeGroup<'a> {
    /// Lists the groups of notices that are not empty.
    pub(crate) fn of(notices: &'a [Notice]) -> Vec<Self> {
        let group = |kind| {
            let all: Vec<_> = notices.iter().filter(|notice| notice.kind == kind).collect();
            (!all.is_empty()).then_some(Self { kind, all })
        };
        NoticeKind::ALL.into_iter().filter_map(group).collect()
    }

    /// Returns one line about all of them.
    pub(crate) fn text(&self) -> String {
        let count = self.all.len();
        let [.., last] = &self.all[..] else { return String::new() };
        if count == 1 {
            return last.text.clone();
        }
        let is_aside = |notice: &&Notice| notice.text.ends_with(OUT_OF_VIEW);
        match self.kind {
            NoticeKind::Unseen if self.all.iter().all(is_aside) => {
                format!("{count} objects are out of view or too small to see")
            }
            NoticeKind::Unseen => format!("{count} objects are not visible"),
            NoticeKind::Hidden => format!("{count} objects are hidden"),
            NoticeKind::TurnedAway => format!("All faces of {count} objects are turned away"),
            NoticeKind::Transparent => format!("{count} objects are wholly transparent"),
            NoticeKind::Changed => format!("{count} models have changed on disk"),
            NoticeKind::Texture => format!("The textures of {count} models were not found"),
            NoticeKind::Opened | NoticeKind::Written | NoticeKind::Program => {
                format!("{} (and {} more)", last.text, count - 1)
            }
        }
    }

    /// Returns the details of all of them, one line each.
    pub(crate) fn details(&self) -> Vec<String> {
        match &self.all[..] {
            [only] => only.details.clone(),
            all => {
                let lines = |notice: &&Notice| {
                    let details = notice.details.iter().map(|line| format!("    {line}"));
                    std::iter::once(notice.text.clone()).chain(details).collect::<Vec<_>>()
                };
                all.iter().flat_map(lines).collect()
            }
        }
    }

    /// Returns their offers.
    pub(crate) fn offers(&self) -> Vec<&'a Offer> {
        self.all.iter().filter_map(|notice| notice.offer.as_ref()).collect()
    }

    /// Returns whether it waits for an answer. Any other notice moves to the status line after some
    /// seconds.
    pub(crate) fn needs_answer(&self) -> bool {
        self.offers().iter().any(|offer| !matches!(offer, Offer::Up(_)))
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
#[derive(Clone, Debug, PartialEq, Eq)]
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
    /// Choose the texture of an object.
    Texture(ObjectId),
    /// Read a model again.
    Reload(PathBuf),
}

/// The words around an object's name, and the change of the object.
type NamedChange = ([&'static str; 2], fn(&mut Object));

impl Offer {
    /// Returns the label of its button.
    pub const fn label(&self) -> &'static str {
        match self {
            Self::Frame(_) => "Frame",
            Self::TwoSides(_) => "Draw both sides",
            Self::Show(_) => "Show",
            Self::Opaque(_) => "Make opaque",
            Self::Up(_) => "Up axis",
            Self::Texture(_) => "Find...",
            Self::Reload(_) => "Reload",
        }
    }

    /// Returns the object that it is about, if it is about one.
    pub const fn object(&self) -> Option<ObjectId> {
        match self {
            Self::Frame(id)
            | Self::TwoSides(id)
            | Self::Show(id)
            | Self::Opaque(id)
            | Self::Texture(id)
            | Self::Up(id) => Some(*id),
            Self::Reload(_) => None,
        }
    }

    /// Returns the change of an object that it makes, and the words around the object's name.
    fn change(&self) -> Option<NamedChange> {
        Some(match self {
            Self::TwoSides(_) => {
                (["Draw both sides of ", ""], |object: &mut Object| object.sides = Sides::Two)
            }
            Self::Show(_) => (["Show ", ""], |object: &mut Object| object.visible = true),
            Self::Opaque(_) => (["Make ", " opaque"], make_opaque),
            Self::Frame(_) | Self::Up(_) | Self::Texture(_) | Self::Reload(_) => return None,
        })
    }

    /// Returns the change of the scene by offers of one kind, and its label in the history; `None`
    /// if they do not change objects.
    ///
    /// # Errors
    /// Fails if all objects are gone.
    pub(crate) fn command(
        offers: &[&Self],
        scene: &Scene,
    ) -> Result<Option<(Command, String)>, Refusal> {
        let Some(([before, after], change)) = offers.first().and_then(|offer| offer.change())
        else {
            return Ok(None);
        };
        let ids = offers.iter().filter_map(|offer| offer.object());
        let ids: Vec<_> = ids.filter(|id| scene.objects.contains(*id)).collect();
        let name = |id: &ObjectId| scene.name(ItemId::Object(*id)).unwrap_or_default().to_owned();
        let label = format!("{before}{}{after}", one_or_count(&ids, "objects", name));
        let all = ids.iter().map(|id| items::change_object(scene, *id, change));
        match all.collect::<Result<Vec<_>, _>>()? {
            none if none.is_empty() => Err(Refusal::Gone),
            all => Ok(Some((Command::Batch(all), label))),
        }
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
