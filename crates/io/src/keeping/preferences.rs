//! Settings that persist between starts.
//!
//! A file that cannot be parsed is renamed and reported; the program starts anyway.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::slots::{Lock, OwnFolders, made};
use crate::error::reason;
use crate::replace::{Worth, replace};
use crate::window_state::Panels;
use marraztu_core::accuracy::Samples;
use marraztu_core::scene::UpAxis;

/// The number of recent files that are remembered.
pub const MOST_RECENT: usize = 10;

/// The persistent settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Whether the window is light or dark.
    pub theme: Theme,
    /// Which panels are open.
    pub panels: Panels,
    /// Whether handles to move, rotate and scale the selection are drawn over the picture.
    pub gizmo: bool,
    /// The zoom of the interface, relative to the system's.
    pub scale: f32,
    /// The inner width and height of the window in points, if it was ever open.
    pub window: Option<[f32; 2]>,
    /// Whether the window fills the screen.
    pub maximized: bool,
    /// The widths in points and the shares of resized panels, by the names of their borders.
    pub shares: BTreeMap<String, f32>,
    /// Whether the selection's outline, axes and marks of lights are drawn over the picture.
    pub overlays: bool,
    /// Whether the dial of accuracy lies over the picture.
    pub dial: bool,
    /// Overlays that help to judge positions.
    pub helpers: Helpers,
    /// Whether models are reloaded when their files change.
    pub watches: bool,
    /// The up axis of models with files that do not state one. Older versions stored the axis of
    /// the last model as `up`, which no one had chosen as the default.
    #[serde(rename = "default_up")]
    pub up: UpAxis,
    /// Custom key bindings, by action.
    pub keys: BTreeMap<String, Vec<String>>,
    /// Whether the window refines its picture while idle.
    pub refines: bool,
    /// The samples per pixel of a refined picture.
    pub refined: Samples,
    /// The time budget of a picture during motion, in milliseconds.
    pub budget_ms: u16,
    /// The models and scenes that were opened or saved last, the latest first.
    pub recent: Vec<PathBuf>,
}

/// Overlays that help to judge the positions of objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Helpers {
    /// A grid on the ground.
    pub grid: bool,
    /// The bounding boxes of the selected objects, with their sizes.
    pub dimensions: bool,
    /// The directions of all suns and spots, not just the selected one.
    pub directions: bool,
}

/// Whether the window is light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// Follows the system.
    #[default]
    System,
    /// Light.
    Light,
    /// Dark.
    Dark,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: Theme::System,
            panels: Panels::default(),
            gizmo: true,
            scale: 1.0,
            window: None,
            maximized: false,
            shares: BTreeMap::new(),
            overlays: true,
            dial: true,
            helpers: Helpers::default(),
            watches: false,
            up: UpAxis::default(),
            keys: BTreeMap::new(),
            refines: true,
            refined: Samples::Sixteen,
            budget_ms: 33,
            recent: Vec::new(),
        }
    }
}

impl Preferences {
    /// The size of the window at the first start, in points.
    pub const WINDOW: [f32; 2] = [1280.0, 800.0];

    /// Loads the preferences, with a message if the file could not be parsed and was renamed.
    pub fn load(folders: &OwnFolders) -> (Self, Option<String>) {
        let path = file(folders);
        let text = match fs::read(&path) {
            Ok(bytes) => String::from_utf8(bytes).map_err(|_bytes| "it is not text".to_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => return (Self::default(), None),
            Err(error) => {
                let text = format!("The preferences in {} cannot be read: ", path.display());
                return (Self::default(), Some(text + &reason(&error) + "."));
            }
        };
        // A broken file is renamed, never overwritten: the user may want to repair it.
        let read = text
            .and_then(|text| ron::from_str::<Self>(&text).map_err(|error| format!("line {error}")));
        match read {
            Ok(preferences) => (preferences.within_limits(), None),
            Err(why) => {
                let text = format!("The preferences could not be parsed ({why}). ");
                let rest = match set_aside(&path) {
                    Ok(aside) => format!("They were moved to {}.", aside.display()),
                    Err(error) => format!("They could not be moved: {error}."),
                };
                (Self::default(), Some(text + &rest))
            }
        }
    }

    /// Writes the preferences atomically. Settings that are as `before`, when this program last
    /// read or wrote them, keep the values in the file: another program may have changed them
    /// meanwhile.
    ///
    /// # Errors
    /// The reason, if they cannot be written.
    pub fn save(&self, folders: &OwnFolders, before: &Self) -> Result<(), String> {
        made(&folders.config)?;
        let path = file(folders);
        // The lock makes reading and writing one step among several programs.
        let lock = Lock::take(&folders.config.join("lock")).map_err(|error| reason(&error))?;
        let others = fs::read_to_string(&path).ok();
        let others = others.and_then(|text| ron::from_str::<Self>(&text).ok());
        let merged = others.map_or_else(|| self.clone(), |others| self.merged(before, others));
        let config = ron::ser::PrettyConfig::new().new_line("\n");
        let text = ron::ser::to_string_pretty(&merged, config).map_err(|e| e.to_string())?;
        replace(&path, (text + "\n").as_bytes(), Worth::Journal).map_err(|e| e.to_string())?;
        drop(lock);
        Ok(())
    }

    /// Merges these preferences with another program's, given the state before both.
    fn merged(&self, before: &Self, others: Self) -> Self {
        // New recent files go to the front; this program comes first.
        let is_new = |path: &&PathBuf| !before.recent.contains(path);
        let (new, old): (Vec<_>, Vec<_>) = self.recent.iter().partition(is_new);
        let theirs = others.recent.iter().filter(is_new).filter(|path| !self.recent.contains(path));
        let recent = new.into_iter().chain(theirs).chain(old).take(MOST_RECENT).cloned().collect();
        macro_rules! merge {
            ($($field:ident)+) => {
                Self {
                    $($field: match self.$field == before.$field {
                        true => others.$field,
                        false => self.$field.clone(),
                    },)+
                    recent,
                }
            };
        }
        merge!(
            theme panels gizmo scale window maximized shares overlays dial helpers watches up keys
            refines refined budget_ms
        )
    }

    /// Moves a file to the front of the recent ones.
    pub fn note_recent(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned());
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// Replaces values that no window can have by the defaults.
    fn within_limits(mut self) -> Self {
        let sound = |x: f32, min: f32, max: f32| x.is_finite() && x >= min && x <= max;
        if !sound(self.scale, 0.2, 5.0) {
            self.scale = 1.0;
        }
        self.window = self.window.filter(|size| size.iter().all(|x| sound(*x, 100.0, 20_000.0)));
        self.shares.retain(|_, share| sound(*share, 0.0, 20_000.0));
        self.budget_ms = self.budget_ms.clamp(1, 1000);
        self.recent.truncate(MOST_RECENT);
        self
    }
}

fn file(folders: &OwnFolders) -> PathBuf {
    folders.config.join("preferences.ron")
}

/// Renames a file to a free name.
fn set_aside(path: &Path) -> Result<PathBuf, String> {
    let named = |number: u32| path.with_extension(format!("broken-{number}.ron"));
    let free = (1..1000).map(named).find(|aside| !aside.exists());
    let aside = free.ok_or_else(|| "there are too many such files already".to_owned())?;
    fs::rename(path, &aside).map_err(|error| reason(&error))?;
    Ok(aside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the absolute paths of files, on the present drive of Windows.
    fn absolute<const N: usize>(names: [&str; N]) -> [PathBuf; N] {
        names.map(|name| std::path::absolute(name).unwrap())
    }

    #[test]
    fn preferences_come_back_and_a_broken_file_is_set_aside_and_said() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        assert_eq!(Preferences::load(&folders), (Preferences::default(), None));
        let mut first = Preferences { scale: 1.5, ..Preferences::default() };
        first.window = Some([900.0, 700.0]);
        first.note_recent(Path::new("/a.obj"));
        first.note_recent(Path::new("/b.obj"));
        first.note_recent(Path::new("/a.obj"));
        first.save(&folders, &Preferences::default()).unwrap();
        assert_eq!(first.recent, absolute(["/a.obj", "/b.obj"]));
        assert_eq!(Preferences::load(&folders), (first, None));
        for broken in [&b"(scale: "[..], b"\xff\xfe", b"(scale: 1.0) more"] {
            fs::write(file(&folders), broken).unwrap();
            let (preferences, said) = Preferences::load(&folders);
            assert_eq!(preferences, Preferences::default());
            assert!(said.unwrap().contains("They were moved to"));
        }
        let asides = fs::read_dir(&folders.config).unwrap().flatten();
        assert_eq!(asides.filter(|e| e.path().to_string_lossy().contains("broken-")).count(), 3);
        assert!(!file(&folders).exists());
    }

    #[test]
    fn the_up_axis_that_an_older_version_kept_from_the_last_model_is_no_default() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        fs::create_dir_all(&folders.config).unwrap();
        fs::write(file(&folders), "(scale: 1.5, up: Z)").unwrap();
        let expected = Preferences { scale: 1.5, ..Preferences::default() };
        assert_eq!(Preferences::load(&folders), (expected, None));
        // An axis that is asked for is kept.
        let asked = Preferences { up: UpAxis::Z, ..Preferences::default() };
        asked.save(&folders, &Preferences::default()).unwrap();
        assert_eq!(Preferences::load(&folders).0.up, UpAxis::Z);
    }

    #[test]
    fn numbers_that_no_window_can_have_are_left_out() {
        let wild = Preferences { scale: f32::NAN, window: Some([0.0, 5.0]), ..Default::default() };
        assert_eq!(wild.within_limits(), Preferences::default());
    }

    #[test]
    fn two_programs_keep_each_others_recent_files() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        for name in ["/a.obj", "/b.obj"] {
            let mut own = Preferences::default();
            own.note_recent(Path::new(name));
            own.save(&folders, &Preferences::default()).unwrap();
        }
        let both = absolute(["/b.obj", "/a.obj"]);
        assert_eq!(Preferences::load(&folders).0.recent, both);
        // A program that clears its list of recent files removes only its own.
        let before = Preferences { recent: both[1..].to_vec(), ..Preferences::default() };
        Preferences::default().save(&folders, &before).unwrap();
        assert_eq!(Preferences::load(&folders).0.recent, both[..1]);
    }

    #[test]
    fn a_program_keeps_the_settings_that_another_one_has_changed() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        let named = |number: usize| absolute([&format!("/{number}.obj")])[0].clone();
        let recent: Vec<_> = (0..MOST_RECENT).map(named).collect();
        let before = Preferences { recent, ..Preferences::default() };
        before.save(&folders, &Preferences::default()).unwrap();
        let mut other = Preferences { theme: Theme::Light, scale: 2.0, ..before.clone() };
        other.note_recent(&named(77));
        other.save(&folders, &before).unwrap();
        // This one has opened a file of the list, and changed the scale only.
        let mut own = Preferences { scale: 1.5, ..before.clone() };
        own.note_recent(&named(3));
        own.save(&folders, &before).unwrap();
        let (merged, _) = Preferences::load(&folders);
        assert_eq!((merged.theme, merged.scale), (Theme::Light, 1.5));
        let expected = [77, 3, 0, 1, 2, 4, 5, 6, 7, 8].map(named);
        assert_eq!(merged.recent, expected);
    }
}
