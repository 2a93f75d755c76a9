//! Saves and opens scene files.
//!
//! A file is readable and editable text: RON, with a version first and named fields. Models are
//! referenced by their path relative to the file's folder, so a folder with both can be moved. View
//! and settings are saved with the scene; the undo stack is not.

mod box_sizes;
mod error;
mod fields;
mod files;
mod format;
mod former;
mod fragment;
mod light;
mod message;
mod model_key;
mod open;
pub(crate) mod paths;
mod save;
mod view;
mod words;

use std::path::{Path, PathBuf};

pub use self::error::SceneFileError;
pub use self::files::Known;
pub use self::fragment::{Fragment, items_of_text, items_to_text, material_to_text};
pub use self::message::{scene_of_message, scene_to_message};

use self::files::{Files, StandIns};
use self::format::{FileScene, Head, VERSION};
use super::error::shown;
use super::examples;
use super::findings::{Finding, Findings, joined};
use super::fingerprint::Fingerprint;
use super::progress::Progress;
use super::read::{MOST_MODEL_BYTES, read, utf_8};
use super::replace::{SaveError, Worth, replace};
use super::sources::Sources;
use super::window_state::WindowState;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Scene, View};

/// The extension of scene files, without the dot.
pub const SCENE_ENDING: &str = "marraztu";

/// A scene from a file.
#[derive(Debug)]
pub struct Opened {
    /// The scene.
    pub scene: Scene,
    /// The view at the time of saving.
    pub view: View,
    /// The state of the window at the time of saving.
    pub window: WindowState,
    /// The accuracy settings at the time of saving.
    pub settings: Settings,
    /// The findings in the file, its models and its textures.
    pub findings: Vec<Finding>,
    /// The content of the file.
    pub content: Fingerprint,
}

/// Saves a scene; the previous file is kept, with `~` appended to its name.
///
/// # Errors
/// If the file or a part of the scene cannot be written. An existing file is unchanged.
pub fn save(path: &Path, scene: &Scene, view: &View, settings: &Settings) -> Result<(), SaveError> {
    save_with_window(path, scene, view, settings, &WindowState::DEFAULT).map(|_content| ())
}

/// Saves a scene like [`save()`], with the state of the window. Returns the content of the file.
///
/// # Errors
/// The same as [`save()`].
pub fn save_with_window(
    path: &Path,
    scene: &Scene,
    view: &View,
    settings: &Settings,
    window: &WindowState,
) -> Result<Fingerprint, SaveError> {
    let text = text_with_window(path, scene, view, settings, window)?;
    Sources::of(scene).spare(path)?;
    replace(path, text.as_bytes(), Worth::Work)?;
    Ok(Fingerprint::of(text.as_bytes()))
}

/// Returns the text that [`save()`] would write to `path`.
///
/// # Errors
/// If a part of the scene cannot be written.
pub fn to_text(
    path: &Path,
    scene: &Scene,
    view: &View,
    settings: &Settings,
) -> Result<String, SaveError> {
    text_with_window(path, scene, view, settings, &WindowState::DEFAULT)
}

pub(crate) fn text_with_window(
    path: &Path,
    scene: &Scene,
    view: &View,
    settings: &Settings,
    window: &WindowState,
) -> Result<String, SaveError> {
    let fail = |reason: String| SaveError::new(path, reason);
    let file = save::file_scene(scene, view, window, settings, &complete_folder(path));
    let file = file.map_err(fail)?;
    let config = ron::ser::PrettyConfig::new().new_line("\n");
    let text = ron::ser::to_string_pretty(&file, config).map_err(|e| fail(e.to_string()))?;
    if text.len() >= MOST_MODEL_BYTES {
        return Err(fail("it is too large".to_owned()));
    }
    // Read the text back: a number that is not finite could be written, but not read.
    let again = file_scene(&text, "").map_err(|error| fail(error.to_string()))?;
    open::scene(&again, &StandIns, &mut Findings::default()).map_err(fail)?;
    Ok(text + "\n")
}

/// Opens a scene file. Models and textures that are missing or cannot be read become placeholders,
/// see [`Model::is_placeholder`](marraztu_core::scene::Model::is_placeholder), with one finding
/// each.
///
/// # Errors
/// If the file cannot be read or parsed, and if `progress` is cancelled.
pub fn open(path: &Path, progress: &Progress) -> Result<Opened, SceneFileError> {
    let name = shown(path);
    if let Some(text) = examples::scene_text(path) {
        let folder = path.parent().unwrap_or(path).to_owned();
        return open_text(text, &name, folder, progress);
    }
    let bytes = read(path, MOST_MODEL_BYTES, &Progress::new())?;
    let content = Fingerprint::of(&bytes);
    let text = String::from_utf8(utf_8(bytes)).map_err(|_bytes| SceneFileError::File {
        file: name.clone(),
        reason: "this is not a scene file: it is not text".to_owned(),
    })?;
    let folder = path.parent().map_or_else(PathBuf::new, paths::plain);
    Ok(Opened { content, ..open_text(&text, &name, folder, progress)? })
}

/// Opens the text of a scene file called `name`, with paths relative to `folder`.
pub(crate) fn open_text(
    text: &str,
    name: &str,
    folder: PathBuf,
    progress: &Progress,
) -> Result<Opened, SceneFileError> {
    let fail = |reason: String| SceneFileError::File { file: name.to_owned(), reason };
    let file = file_scene(text, name)?;
    let mut files = Files::new(folder, name);
    files.load(&file, name, progress)?;
    let mut own = std::mem::take(&mut files.lost);
    let (scene, view) = open::scene(&file, &files, &mut own).map_err(fail)?;
    former::note(text, &mut own);
    let findings = joined(own.into_list().into_iter().chain(files.findings).collect());
    let (window, settings) = (file.view.window(), file.settings);
    let content = Fingerprint::of(text.as_bytes());
    Ok(Opened { scene, view, window, settings, findings, content })
}

/// Returns the absolute folder of a file.
fn complete_folder(path: &Path) -> PathBuf {
    let complete = std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned());
    complete.parent().map_or_else(PathBuf::new, paths::plain)
}

/// Parses the text of a scene file.
fn file_scene(text: &str, name: &str) -> Result<FileScene, SceneFileError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let fail = |error: ron::error::SpannedError| SceneFileError::Line {
        file: name.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        reason: words::sentence(&error.code),
    };
    if !text.trim_start().starts_with(['(', '#', '/']) {
        let reason = "this is not a scene file: it does not begin with \"(\"".to_owned();
        return Err(SceneFileError::Line { file: name.to_owned(), line: 1, column: 1, reason });
    }
    // The version comes first: fields of a newer version would only give a confusing error.
    let Head { version } = ron::from_str(text).map_err(fail)?;
    if (1..=VERSION).contains(&version) {
        return ron::from_str(text).map_err(fail);
    }
    // Point the error at the version in the text.
    let place = text.lines().zip(1..).find_map(|(line, number)| {
        let before = line.find("version")?;
        Some((number, line[..before].chars().count() + 1))
    });
    let (line, column) = place.unwrap_or((1, 1));
    let reason = if version == 0 {
        "0 is not a version: the first one is 1".to_owned()
    } else {
        format!(
            "the file has version {version}, from a newer program; this program reads versions up \
                to {VERSION}"
        )
    };
    Err(SceneFileError::Line { file: name.to_owned(), line, column, reason })
}
