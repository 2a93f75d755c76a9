//! The start folders of file dialogs.
//!
//! Textures are looked for in the folder of their model, and files are saved in the folder of the
//! scene or its model. If the user chooses another folder, the next dialog of that kind begins
//! there, until the scene or the model changes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The maximum number of recent folders to offer.
const MOST: usize = 6;

/// The purpose of a remembered folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Models and scenes to open.
    Opened,
    /// Textures.
    Texture,
    /// Scenes, pictures and exports to save.
    Saved,
}

/// The folders used for files.
#[derive(Debug, Default)]
pub(crate) struct Folders {
    /// The folder of the scene or of the model that the next dialog is about, if it has a file.
    pub(crate) home: Option<PathBuf>,
    /// The folders of recent files, the latest first.
    pub(crate) recent: Vec<PathBuf>,
    /// The last folder chosen for each kind, and the `home` at that time.
    chosen: BTreeMap<Kind, (Option<PathBuf>, PathBuf)>,
}

impl Folders {
    /// Returns the start folder of a dialog.
    pub(crate) fn start(&self, kind: Kind) -> PathBuf {
        let chosen = self.chosen.get(&kind);
        let start = match (chosen, &self.home) {
            // The next file to open may be unrelated to the scene.
            (Some((_, folder)), _) if kind == Kind::Opened => Some(folder),
            (Some((of, folder)), Some(home)) if of.as_ref() == Some(home) => Some(folder),
            (_, Some(home)) => Some(home),
            (Some((_, folder)), None) => Some(folder),
            (None, None) => None,
        };
        start.cloned().or_else(|| std::env::current_dir().ok()).unwrap_or_else(|| "/".into())
    }

    /// Sets the folder of the next dialog that opens a file.
    pub(crate) fn open_in(&mut self, folder: Option<PathBuf>) {
        if let Some(folder) = folder {
            self.chosen.insert(Kind::Opened, (self.home.clone(), folder));
        }
    }

    /// Remembers the folder of a chosen file.
    pub(crate) fn remember(&mut self, kind: Kind, file: &Path) {
        if let Some(folder) = file.parent() {
            self.chosen.insert(kind, (self.home.clone(), folder.to_owned()));
        }
    }

    /// Lists the folders to reach with one click, with their names: the home folder, that of the
    /// scene or its model, and recent ones.
    pub(crate) fn places(&self) -> Vec<(String, PathBuf)> {
        let user = std::env::home_dir().map(|folder| ("Home".to_owned(), folder));
        let mut places: Vec<(String, PathBuf)> = user.into_iter().collect();
        // Each folder is listed once, the most relevant first.
        let chosen = self.chosen.values().map(|(_, folder)| folder);
        for folder in self.home.iter().chain(chosen).chain(&self.recent) {
            if places.len() > MOST {
                break;
            }
            if places.iter().all(|(_, other)| other != folder) {
                let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
                places.push((name.unwrap_or_else(|| folder.display().to_string()), folder.clone()));
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_saved_in_the_folder_of_the_scene_and_not_of_its_textures() {
        let path = Path::new;
        let mut folders = Folders { home: Some("/scenes".into()), ..Folders::default() };
        folders.remember(Kind::Texture, path("/textures/wood.png"));
        assert_eq!(folders.start(Kind::Saved), path("/scenes"));
        assert_eq!(folders.start(Kind::Texture), path("/textures"), "for the same model");
        folders.remember(Kind::Saved, path("/pictures/a.png"));
        assert_eq!(folders.start(Kind::Saved), path("/pictures"), "as was chosen for this scene");
        folders.home = Some("/others".into());
        assert_eq!(folders.start(Kind::Saved), path("/others"), "another scene");
        assert_eq!(folders.start(Kind::Texture), path("/others"), "another model");
        folders.home = None;
        assert_eq!(folders.start(Kind::Saved), path("/pictures"));
        folders.remember(Kind::Opened, path("/models/a.obj"));
        assert_eq!(folders.start(Kind::Opened), path("/models"));
        folders.recent = vec!["/models".into(), "/scenes".into()];
        let places: Vec<_> = folders.places().into_iter().map(|(name, _)| name).collect();
        assert_eq!(places[places.len() - 4..], ["models", "textures", "pictures", "scenes"]);
    }
}
