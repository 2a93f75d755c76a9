//! How a dialog ends, and what the user has answered.

use std::path::PathBuf;

use super::material_dialog::{MaterialChoices, MaterialDialog};
use super::picture_dialog::PictureChoices;
use super::wanted::{After, ChangedFile, Wanted};

/// What the user has answered.
#[derive(Debug)]
pub(crate) enum Answer {
    /// These files, for this.
    Files(Wanted, Vec<PathBuf>),
    /// No file.
    NoFile,
    /// Save first.
    Save(After),
    /// Do it without saving.
    Discard(After),
    /// This material.
    Material(Box<MaterialDialog>, MaterialChoices),
    /// A picture or a turntable with these options, into this file; it is asked for if there is
    /// none.
    Picture(PictureChoices, Option<PathBuf>),
    /// A texture is wanted for the model in the material dialog.
    ChooseTexture,
    /// This missing file is to be found.
    Find(PathBuf),
    /// The discarded work at this place is to be recovered.
    RecoverDiscarded(usize),
    /// What to do with the changed file of the scene, and then.
    Changed(ChangedFile, PathBuf, Option<After>),
}

/// How a dialog ends.
pub(super) enum End {
    Cancelled,
    File(PathBuf),
    Material(MaterialChoices),
    /// With this answer.
    Answer(Answer),
    /// It stays open, and a texture is chosen.
    Asked,
}
