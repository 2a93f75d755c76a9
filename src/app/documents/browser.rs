//! A simple file browser for systems without a file dialog.
//!
//! The user can type or paste a whole path, and the list below follows it. The arrow keys move from
//! the field into the list, so the keyboard suffices.

mod list;

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Modifiers, Ui, vec2};

use crate::app::theme;
use crate::app::widgets::controls::{Switch, heading};
pub(crate) use list::Look;

/// Whether a file is opened or saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Open,
    Save,
}

#[derive(Debug)]
pub(crate) struct Browser {
    title: &'static str,
    mode: Mode,
    /// Extensions without the dot. A name without an extension gets the first one.
    endings: Vec<&'static str>,
    /// Folders to reach with one click, with their names.
    places: Vec<(String, PathBuf)>,
    /// The display of the list.
    pub(crate) look: Look,
    /// The text of the path field.
    path: String,
    /// The path that was put into the field, with its text. The text may name another path: a name
    /// that is not UTF-8 is shown with replacements, and `~` may be the name of a folder.
    shown: (String, PathBuf),
    /// The filter of the list: the typed part of a name.
    part: Option<String>,
    /// The initial text of the path field, which does not filter the list.
    proposal: String,
    folder: PathBuf,
    entries: Vec<Entry>,
    /// The reason why the folder cannot be listed or the file cannot be chosen.
    fault: Option<String>,
    shown_once: bool,
}

#[derive(Clone, Debug)]
struct Entry {
    path: PathBuf,
    /// The name as shown.
    name: String,
    is_folder: bool,
    bytes: u64,
    modified: Option<SystemTime>,
}

/// The result of the browser.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    File(PathBuf),
    Cancelled,
}

impl Browser {
    /// Creates a browser of `folder`, with `name` in the path field.
    pub(crate) fn new(
        title: &'static str,
        mode: Mode,
        endings: Vec<&'static str>,
        folder: &Path,
        name: &str,
    ) -> Self {
        let mut browser = Self {
            title,
            mode,
            endings,
            places: Vec::new(),
            look: Look::default(),
            path: String::new(),
            shown: Default::default(),
            part: None,
            proposal: String::new(),
            folder: PathBuf::new(),
            entries: Vec::new(),
            fault: None,
            shown_once: false,
        };
        browser.enter(folder);
        browser.put(browser.folder.join(name));
        browser.proposal.clone_from(&browser.path);
        browser
    }

    /// Sets the folders to offer and the display of the list.
    pub(crate) fn with(mut self, places: Vec<(String, PathBuf)>, look: Look) -> Self {
        (self.places, self.look) = (places, look);
        self.look.sort(&mut self.entries);
        self
    }

    /// Shows the dialog. Returns the result when it has ended.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> Option<Choice> {
        ui.set_width(ui.available_width().clamp(240.0, 640.0));
        heading(ui, self.title);
        let label = ui.label("Path");
        let id = ui.scope_id().with("path");
        // The arrow keys are handled before the field, which would use them too.
        let moved = self.arrows(ui, id);
        let output = egui::TextEdit::singleline(&mut self.path)
            .id(id)
            .desired_width(f32::INFINITY)
            .align(egui::Align2::LEFT_CENTER)
            .show(ui);
        let field = output.response.response.labelled_by(label.id);
        if !self.shown_once {
            field.request_focus();
            let mut editing = output.state;
            editing.cursor.set_char_range(Some(self.proposed()));
            editing.store(ui.ctx(), field.id);
            self.shown_once = true;
        }
        // Enter confirms the path, or enters the folder and keeps the focus.
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if field.changed() && !moved {
            self.follow();
        }
        let mut choice = if entered { self.take() } else { None };
        if moved || (entered && choice.is_none()) {
            // The field keeps the focus, with the cursor behind the new path.
            self.type_on(ui, field.id);
        }
        ui.add_space(theme::GAP);
        let mut clicked = None;
        ui.horizontal_top(|ui| {
            clicked = self.places_ui(ui);
            ui.vertical(|ui| clicked = clicked.take().or_else(|| self.list_ui(ui, moved)));
        });
        if let (None, Some(clicked)) = (&choice, clicked) {
            choice = self.click(&clicked);
            self.type_on(ui, field.id);
        }
        if let Some(fault) = &self.fault {
            ui.colored_label(ui.visuals().error_fg_color, fault);
        }
        ui.add_space(theme::GAP);
        ui.horizontal(|ui| {
            if ui.button(self.verb()).clicked() {
                choice = choice.take().or_else(|| self.take());
            }
            if ui.button("Cancel").clicked() {
                choice = Some(Choice::Cancelled);
            }
            ui.add_space(theme::GAP);
            ui.allocate_ui(vec2(120.0, theme::ROW), |ui| {
                let hidden = Switch::new("Hidden files", self.look.hidden).ui(ui);
                let hint = "Also lists files with names that begin with a dot";
                self.look.hidden ^= hidden.on_hover_text(hint).clicked();
            });
        });
        choice
    }

    /// Shows the folders to reach with one click. Returns the one that was clicked.
    fn places_ui(&self, ui: &mut Ui) -> Option<PathBuf> {
        const WIDTH: f32 = 120.0;
        if self.places.is_empty() || ui.available_width() < 4.0 * WIDTH {
            return None;
        }
        let mut clicked = None;
        ui.vertical(|ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 0.0;
            for (name, folder) in &self.places {
                let here = *folder == self.folder;
                let button = egui::Button::selectable(here, (name.as_str(), egui::Atom::grow()));
                let response = ui.add_sized(vec2(WIDTH, theme::ROW), button.truncate());
                if response.on_hover_text(folder.display().to_string()).clicked() {
                    clicked = Some(folder.clone());
                }
            }
        });
        clicked
    }

    /// Moves through the list with the arrow keys and puts the entry into the field. The keys are
    /// consumed before the field sees them, where they would move the cursor. Returns whether an
    /// arrow key was pressed.
    fn arrows(&mut self, ui: &Ui, field: egui::Id) -> bool {
        if !ui.memory(|memory| memory.has_focus(field)) {
            return false;
        }
        let (down, up) = ui.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(Modifiers::NONE, key);
            (count(Key::ArrowDown), count(Key::ArrowUp))
        });
        if down + up == 0 {
            return false;
        }
        // The arrow keys move from the row of the typed path.
        let rows: Vec<PathBuf> = self.rows().into_iter().map(|(path, _)| path).collect();
        let typed = self.typed();
        let last = rows.len().saturating_sub(1);
        let to = match rows.iter().position(|row| *row == typed) {
            Some(at) => (at + down).saturating_sub(up).min(last),
            // The first entry of the list is the parent folder, which is reached with an arrow up.
            None if self.folder.parent().is_some() => down.min(last),
            None => 0,
        };
        if let Some(row) = rows.get(to) {
            self.put(row.clone());
        }
        true
    }

    /// Lists the rows with their paths: the parent folder, which has no entry, and the entries that
    /// match.
    fn rows(&self) -> Vec<(PathBuf, Option<&Entry>)> {
        let above = self.folder.parent().map(|above| (above.to_owned(), None));
        let entries = self.fitting().map(|entry| (entry.path.clone(), Some(entry)));
        above.into_iter().chain(entries).collect()
    }

    /// Puts a path into the field.
    fn put(&mut self, path: PathBuf) {
        self.path = path.display().to_string();
        self.shown = (self.path.clone(), path);
    }

    /// Focuses the path field when it is shown next, as at first.
    pub(crate) const fn ask_again(&mut self) {
        self.shown_once = false;
    }

    /// Returns the initial selection: the proposed name without its extension. Without a name, the
    /// cursor is behind the folder.
    fn proposed(&self) -> CCursorRange {
        let path = Path::new(&self.path);
        let end = self.path.chars().count();
        let count = |text: Option<&std::ffi::OsStr>| {
            text.map_or(0, |text| text.to_string_lossy().chars().count())
        };
        if path.is_dir() {
            return CCursorRange::one(CCursor::new(end));
        }
        let (name, stem) = (count(path.file_name()), count(path.file_stem()));
        let from = end.saturating_sub(name);
        CCursorRange::two(CCursor::new(from), CCursor::new(from + stem))
    }

    /// Focuses the path field, with the cursor at its end.
    fn type_on(&self, ui: &Ui, field: egui::Id) {
        let mut editing = egui::text_edit::TextEditState::load(ui.ctx(), field).unwrap_or_default();
        let end = CCursor::new(self.path.chars().count());
        editing.cursor.set_char_range(Some(CCursorRange::one(end)));
        editing.store(ui.ctx(), field);
        ui.memory_mut(|memory| memory.request_focus(field));
    }

    /// Handles a click on a path of the list. A folder is entered. A file is selected, and a second
    /// click on it confirms it.
    fn click(&mut self, clicked: &Path) -> Option<Choice> {
        let again = self.typed() == clicked;
        if clicked.is_dir() {
            self.go(clicked);
            return None;
        }
        self.put(clicked.to_owned());
        again.then(|| self.take()).flatten()
    }

    /// Goes to a folder. When saving, the name stays.
    fn go(&mut self, folder: &Path) {
        let typed = self.typed();
        let name = typed.file_name().filter(|_| self.mode == Mode::Save && !typed.is_dir());
        let name = name.map(std::ffi::OsStr::to_owned);
        self.enter(folder);
        // A name typed behind the folder is in it.
        self.put(self.folder.join(name.unwrap_or_default()));
    }

    /// Lists the entries with names that contain the typed part. Hidden entries are listed on
    /// request, or if the part begins with a dot.
    fn fitting(&self) -> impl Iterator<Item = &Entry> {
        let typed = self.typed();
        let name = typed.file_name().map(|name| name.to_string_lossy().into_owned());
        let dot = !typed.is_dir() && name.is_some_and(|name| name.starts_with('.'));
        let hidden =
            self.look.hidden || dot || self.part.as_ref().is_some_and(|it| it.starts_with('.'));
        self.entries.iter().filter(move |entry| {
            if entry.name.starts_with('.') && !hidden {
                return false;
            }
            // The extension is ignored, since all entries have it.
            let stem = Path::new(&entry.name).file_stem().map(|stem| stem.to_string_lossy());
            self.part.as_ref().is_none_or(|part| match stem {
                _ if part.starts_with('.') => entry.name.to_lowercase().starts_with(part),
                Some(stem) if !part.contains('.') => stem.to_lowercase().contains(part),
                _ => entry.name.to_lowercase().contains(part),
            })
        })
    }

    /// Returns the typed part of a name; none if the path names a folder or an entry.
    fn typed_part(&self) -> Option<String> {
        let last = self.path.rsplit(['/', std::path::MAIN_SEPARATOR]).next();
        if self.mode == Mode::Open && last == Some(".") {
            // "." is a path to the folder itself, but also the beginning of a hidden name.
            return last.map(str::to_owned);
        }
        let typed = self.typed();
        let ends = self.path.trim().ends_with(['/', std::path::MAIN_SEPARATOR]);
        let is_whole =
            ends || typed.is_dir() || self.entries.iter().any(|entry| entry.path == typed);
        let name = typed.file_name().map(|name| name.to_string_lossy().to_lowercase());
        name.filter(|_| self.mode == Mode::Open && !is_whole)
    }

    /// Returns the typed path. If a new path begins behind the folder, with a slash or with `~`,
    /// only the new path counts.
    fn typed(&self) -> PathBuf {
        let (text, path) = &self.shown;
        let (folder, typed) = match self.path.strip_prefix(text.as_str()) {
            Some("") => return path.clone(),
            Some(typed) if text.ends_with(['/', std::path::MAIN_SEPARATOR]) => (path, typed),
            _ => (&self.folder, self.path.as_str()),
        };
        let path = typed.trim();
        let path = path.rfind("//").map_or(path, |at| &path[at + 1..]);
        let home = path.rfind("/~/").map(|at| &path[at + 3..]).or(path.strip_prefix("~/"));
        match home.zip(std::env::home_dir()) {
            Some((rest, home)) => home.join(rest),
            None => folder.join(path),
        }
    }

    /// Returns whether a path has the extension of the proposed name.
    fn has_ending_of_proposal(&self, path: &Path) -> bool {
        let proposed = Path::new(&self.proposal).extension();
        proposed.is_some() && path.extension() == proposed
    }

    /// Returns the label of the button that confirms the choice.
    fn verb(&self) -> &'static str {
        match self.mode {
            Mode::Open => "Open",
            Mode::Save if self.named().is_file() => "Replace...",
            Mode::Save => "Save",
        }
    }

    /// Returns the file in the path field, with an extension. If a name with an extension was typed
    /// in place of the proposed one, the proposed extension behind it does not count.
    fn named(&self) -> PathBuf {
        let path = self.typed();
        let typed = path.file_stem().map(Path::new).and_then(Path::extension);
        let is_known = typed.is_some_and(|typed| {
            self.endings.iter().any(|ending| typed.eq_ignore_ascii_case(ending))
        });
        if self.mode == Mode::Save && is_known && self.has_ending_of_proposal(&path) {
            return path.with_extension("");
        }
        match self.endings.first() {
            Some(ending) if self.mode == Mode::Save && path.extension().is_none() => {
                path.with_extension(ending)
            }
            _ => path,
        }
    }

    fn take(&mut self) -> Option<Choice> {
        let typed = self.typed();
        if typed.is_dir() {
            self.go(&typed);
            return None;
        }
        let path = self.named();
        if path.file_name().is_none() || (self.mode == Mode::Open && !path.exists()) {
            // If only one entry matches, it is chosen.
            let is_here = typed.parent() == Some(&self.folder) && self.path != self.proposal;
            let fitting: Vec<PathBuf> =
                self.fitting().take(2).map(|entry| entry.path.clone()).collect();
            if let ([only], true) = (&fitting[..], is_here) {
                self.put(only.clone());
                return self.take();
            }
            self.fault = Some("There is no such file.".to_owned());
            return None;
        }
        Some(Choice::File(path))
    }

    /// Lists the folder of the typed path.
    fn follow(&mut self) {
        let path = self.typed();
        let folder = if path.is_dir() { Some(path) } else { path.parent().map(Path::to_owned) };
        if let Some(folder) = folder.filter(|folder| folder.is_dir() && *folder != self.folder) {
            self.enter(&folder);
        }
        self.part = self.typed_part();
        self.fault = None;
    }

    fn enter(&mut self, folder: &Path) {
        self.folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        self.entries.clear();
        (self.part, self.fault) = (None, None);
        match std::fs::read_dir(&self.folder) {
            Ok(entries) => {
                let entries = entries.flatten().map(|entry| {
                    // Links are followed to their target.
                    let data = std::fs::metadata(entry.path()).ok();
                    Entry {
                        path: entry.path(),
                        name: entry.file_name().to_string_lossy().into_owned(),
                        is_folder: data.as_ref().is_some_and(std::fs::Metadata::is_dir),
                        bytes: data.as_ref().map_or(0, std::fs::Metadata::len),
                        modified: data.and_then(|data| data.modified().ok()),
                    }
                });
                self.entries =
                    entries.filter(|entry| entry.is_folder || self.fits(&entry.name)).collect();
                self.look.sort(&mut self.entries);
            }
            Err(error) => self.fault = Some(format!("Cannot list this folder: {error}.")),
        }
    }

    fn fits(&self, name: &str) -> bool {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy());
        ending
            .is_some_and(|ending| self.endings.iter().any(|own| own.eq_ignore_ascii_case(&ending)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_an_ending_gets_the_first_one_only_where_it_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let named = |mode| {
            let browser = Browser::new("", mode, vec!["png", "ppm"], folder.path(), "view");
            browser.named().file_name().unwrap().to_string_lossy().into_owned()
        };
        assert_eq!(named(Mode::Save), "view.png");
        assert_eq!(named(Mode::Open), "view");
    }

    #[test]
    fn the_list_has_folders_first_and_only_files_of_the_endings() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("b.OBJ"), "").unwrap();
        std::fs::write(folder.path().join("a.txt"), "").unwrap();
        std::fs::create_dir(folder.path().join("z")).unwrap();
        let browser = Browser::new("", Mode::Open, vec!["obj"], folder.path(), "");
        let names: Vec<&str> = browser.entries.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(names, ["z", "b.OBJ"]);
    }

    #[test]
    fn typing_replaces_the_proposed_name_and_keeps_folder_and_ending() {
        let folder = tempfile::tempdir().unwrap();
        let proposed = |name| {
            let browser = Browser::new("", Mode::Save, vec!["png"], folder.path(), name);
            let [from, to] = browser.proposed().sorted_cursors().map(|it| usize::from(it.index));
            browser.path.chars().skip(from).take(to - from).collect::<String>()
        };
        assert_eq!(proposed("view.png"), "view");
        assert_eq!(proposed(""), "");
    }

    #[test]
    fn a_part_of_a_name_filters_files_and_selects_a_single_match() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["teapot.obj", "bunny.obj", "butter.obj"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let mut browser = Browser::new("", Mode::Open, vec!["obj"], folder.path(), "");
        let whole = browser.path.clone();
        let mut typed = |name: &str| {
            browser.path = format!("{whole}{name}");
            browser.follow();
            (browser.fitting().count(), browser.take())
        };
        assert_eq!(typed("b"), (2, None));
        assert_eq!(typed("zebra"), (0, None));
        assert_eq!(typed("Tea"), (1, Some(Choice::File(folder.path().join("teapot.obj")))));
        assert_eq!(typed("bunny.obj").0, 3, "a whole name hides nothing");
    }

    #[cfg(unix)]
    #[test]
    fn everything_that_is_listed_can_be_chosen_whatever_its_name_is() {
        use std::os::unix::ffi::OsStrExt as _;
        let folder = tempfile::tempdir().unwrap();
        // The name of a file and a folder, as of old archives.
        let old = |name: &[u8]| PathBuf::from(std::ffi::OsStr::from_bytes(name));
        for place in ["~".into(), old(b"caf\xe9")] {
            let place = folder.path().join(place);
            std::fs::create_dir(&place).unwrap();
            for name in ["a.obj".into(), old(b"a\xe9.obj")] {
                let file = place.join(name);
                std::fs::write(&file, "").unwrap();
                let mut browser = Browser::new("", Mode::Open, vec!["obj"], folder.path(), "");
                let listed = |browser: &Browser, path: &Path| {
                    browser.rows().iter().any(|(row, _)| row == path)
                };
                assert!(listed(&browser, &place));
                assert_eq!(browser.click(&place), None);
                assert!(listed(&browser, &file));
                // A name can be typed behind the folder.
                browser.path += "a";
                browser.follow();
                assert_eq!(browser.typed(), place.join("a"));
                assert_eq!(browser.click(&file), None);
                assert_eq!(browser.click(&file), Some(Choice::File(file)));
            }
        }
    }

    #[test]
    fn a_path_may_begin_anew_behind_the_folder() {
        let [here, there] = [(), ()].map(|()| tempfile::tempdir().unwrap());
        let mut browser = Browser::new("", Mode::Open, vec!["obj"], here.path(), "");
        browser.path += &there.path().display().to_string();
        browser.follow();
        assert_eq!(browser.folder, there.path());
        browser.path = format!("{}/~/x.obj", here.path().display());
        assert_eq!(Some(browser.typed()), std::env::home_dir().map(|home| home.join("x.obj")));
    }

    #[test]
    fn a_path_that_does_not_exist_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let mut browser = Browser::new("", Mode::Open, vec!["obj"], folder.path(), "none.obj");
        assert_eq!(browser.take(), None);
        assert!(browser.fault.is_some());
    }

    #[test]
    fn hidden_entries_are_listed_on_request_and_when_a_dot_is_typed() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.obj", ".b.obj"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let mut browser = Browser::new("", Mode::Open, vec!["obj"], folder.path(), "");
        let whole = browser.path.clone();
        assert_eq!(browser.fitting().count(), 1);
        browser.look.hidden = true;
        assert_eq!(browser.fitting().count(), 2);
        browser.look.hidden = false;
        browser.path = format!("{whole}.");
        browser.follow();
        assert_eq!(browser.fitting().map(|it| it.name.as_str()).collect::<Vec<_>>(), [".b.obj"]);
    }

    #[test]
    fn another_folder_keeps_the_name_to_save_under() {
        let [here, there] = [(), ()].map(|()| tempfile::tempdir().unwrap());
        let mut browser = Browser::new("", Mode::Save, vec!["png"], here.path(), "view.png");
        assert_eq!(browser.click(there.path()), None);
        assert_eq!(browser.take(), Some(Choice::File(there.path().join("view.png"))));
    }
}
