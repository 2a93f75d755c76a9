//! The results of dialogs.

use std::path::PathBuf;

use super::material_dialog::{MaterialChoices, MaterialDialog};
use super::picture_dialog::PictureChoices;
use super::wanted::{After, ChangedFile, Wanted};

/// The user's answer to a dialog.
#[derive(Debug)]
pub(crate) enum Answer {
    /// These files, for this purpose.
    Files(Wanted, Vec<PathBuf>),
    /// No file.
    NoFile,
    /// Save first.
    Save(After),
    /// Continue without saving.
    Discard(After),
    /// This material.
    Material(Box<MaterialDialog>, MaterialChoices),
    /// A picture or a turntable with these options. Without a path, the file is asked for next.
    Picture(PictureChoices, Option<PathBuf>),
    /// Choose a texture for the model in the material dialog.
    ChooseTexture,
    /// Find this missing file.
    Find(PathBuf),
    /// Recover the discarded work at this index.
    RecoverDiscarded(usize),
    /// The decision about the changed file of the scene, and the work that follows.
    Changed(ChangedFile, PathBuf, Option<After>),
}

/// The way a dialog ends.
pub(crate) enum End {
    Cancelled,
    File(PathBuf),
    Material(MaterialChoices),
    /// The dialog ends with this answer.
    Answer(Answer),
    /// The dialog stays open while the user chooses a texture.
    Asked,
}
