//! A simple file browser for systems without a file dialog.
//!
//! A path can be typed or pasted as a whole; the list below follows it.

use std::path::{Path, PathBuf};

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Ui};

use crate::app::widgets::controls::heading;

/// Whether the file is opened or saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Open,
    Save,
}

/// A file browser.
#[derive(Debug)]
pub(crate) struct Browser {
    title: &'static str,
    mode: Mode,
    /// Endings without the dot, the first being the one that a name without any gets.
    endings: Vec<&'static str>,
    /// What stands in the path field.
    path: String,
    /// What stood there at first: it does not filter the list.
    proposal: String,
    folder: PathBuf,
    entries: Vec<Entry>,
    /// Why the folder cannot be listed, or the file not be chosen.
    fault: Option<String>,
    shown_once: bool,
}

#[derive(Debug)]
struct Entry {
    name: String,
    is_folder: bool,
}

/// The result of the browser.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    File(PathBuf),
    Cancelled,
}

impl Browser {
    /// A choice that begins in `folder`, with `name` in the path field.
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
            path: String::new(),
            proposal: String::new(),
            folder: PathBuf::new(),
            entries: Vec::new(),
            fault: None,
            shown_once: false,
        };
        browser.enter(folder);
        browser.path = browser.folder.join(name).display().to_string();
        browser.proposal.clone_from(&browser.path);
        browser
    }

    /// Shows the dialog. Returns how it ended, once it has.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> Option<Choice> {
        ui.set_width(ui.available_width().clamp(240.0, 520.0));
        heading(ui, self.title);
        let label = ui.label("Path");
        let output = egui::TextEdit::singleline(&mut self.path)
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
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if field.changed() {
            self.follow();
        }
        let mut choice = if entered { self.take() } else { None };
        if entered && choice.is_none() {
            // It goes on being typed into, behind what stands there now.
            self.type_on(ui, field.id);
        }
        if let (None, Some(clicked)) = (&choice, self.list_ui(ui)) {
            choice = self.click(&clicked);
            self.type_on(ui, field.id);
        }
        if let Some(fault) = &self.fault {
            ui.colored_label(ui.visuals().error_fg_color, fault);
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            if ui.button(self.verb()).clicked() {
                choice = choice.take().or_else(|| self.take());
            }
            if ui.button("Cancel").clicked() {
                choice = Some(Choice::Cancelled);
            }
        });
        choice
    }

    /// Gives the keyboard to the path field when it is shown next, as at first.
    pub(crate) const fn ask_again(&mut self) {
        self.shown_once = false;
    }

    /// What typing replaces at first: the proposed name without its ending. Without a name, it goes
    /// on behind the folder.
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

    /// Gives the keyboard to the path field, with the cursor at its end.
    fn type_on(&self, ui: &Ui, field: egui::Id) {
        let mut editing = egui::text_edit::TextEditState::load(ui.ctx(), field).unwrap_or_default();
        let end = CCursor::new(self.path.chars().count());
        editing.cursor.set_char_range(Some(CCursorRange::one(end)));
        editing.store(ui.ctx(), field);
        ui.memory_mut(|memory| memory.request_focus(field));
    }

    /// Lists what fits the typed name; gives the path that was clicked.
    fn list_ui(&self, ui: &mut Ui) -> Option<PathBuf> {
        let mut clicked = None;
        let list = egui::ScrollArea::vertical().max_height(260.0).auto_shrink([false, true]);
        list.show(ui, |ui| {
            if self.folder.parent().is_some() && ui.selectable_label(false, "..").clicked() {
                clicked = self.folder.parent().map(Path::to_owned);
            }
            for entry in self.fitting() {
                let path = self.folder.join(&entry.name);
                let chosen = self.typed() == path;
                let text = match entry.is_folder {
                    true => format!("{}/", entry.name),
                    false => entry.name.clone(),
                };
                if ui.selectable_label(chosen, text).clicked() {
                    clicked = Some(path);
                }
            }
        });
        clicked
    }

    /// Takes a click on a path of the list: a folder is entered, a file is chosen, and a second
    /// click on it takes it.
    fn click(&mut self, clicked: &Path) -> Option<Choice> {
        let again = self.typed() == clicked;
        if clicked.is_dir() {
            self.enter(clicked);
            self.path = shown_folder(&self.folder);
            return None;
        }
        self.path = clicked.display().to_string();
        again.then(|| self.take()).flatten()
    }

    /// The entries that the typed name is a part of; all if it names a folder or one of them, and
    /// while nothing was typed.
    fn fitting(&self) -> impl Iterator<Item = &Entry> {
        let typed = self.typed();
        let name = match self.path.trim().ends_with(['/', std::path::MAIN_SEPARATOR]) {
            true => None,
            false => typed.file_name().map(|name| name.to_string_lossy().to_lowercase()),
        };
        let is_whole =
            typed.is_dir() || self.entries.iter().any(|it| self.folder.join(&it.name) == typed);
        let is_typed = self.path != self.proposal;
        let part = name.filter(|_| self.mode == Mode::Open && !is_whole && is_typed);
        self.entries.iter().filter(move |entry| {
            // Without its ending, which all have.
            let stem = Path::new(&entry.name).file_stem().map(|stem| stem.to_string_lossy());
            part.as_ref().is_none_or(|part| match stem {
                Some(stem) if !part.contains('.') => stem.to_lowercase().contains(part),
                _ => entry.name.to_lowercase().contains(part),
            })
        })
    }

    /// The path that is typed. One that begins anew behind the folder, with a slash or the sign of
    /// the home folder, is taken from there.
    fn typed(&self) -> PathBuf {
        let path = self.path.trim();
        let path = path.rfind("//").map_or(path, |at| &path[at + 1..]);
        let home = path.rfind("/~/").map(|at| &path[at + 3..]).or(path.strip_prefix("~/"));
        match home.zip(std::env::home_dir()) {
            Some((rest, home)) => home.join(rest),
            None => self.folder.join(path),
        }
    }

    /// What the button that ends the choice says.
    fn verb(&self) -> &'static str {
        match self.mode {
            Mode::Open => "Open",
            Mode::Save if self.named().is_file() => "Replace...",
            Mode::Save => "Save",
        }
    }

    /// The file that the path field names, with an ending.
    fn named(&self) -> PathBuf {
        let path = self.typed();
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
            self.enter(&typed);
            self.path = shown_folder(&self.folder);
            return None;
        }
        let path = self.named();
        if path.file_name().is_none() || (self.mode == Mode::Open && !path.exists()) {
            // The only entry that fits is meant.
            let is_here = typed.parent() == Some(&self.folder) && self.path != self.proposal;
            let fitting: Vec<PathBuf> =
                self.fitting().take(2).map(|entry| self.folder.join(&entry.name)).collect();
            if let ([only], true) = (&fitting[..], is_here) {
                self.path = only.display().to_string();
                return self.take();
            }
            self.fault = Some("There is no such file.".to_owned());
            return None;
        }
        Some(Choice::File(path))
    }

    /// Lists the folder that the typed path is in.
    fn follow(&mut self) {
        let path = self.typed();
        let folder = if path.is_dir() { Some(path) } else { path.parent().map(Path::to_owned) };
        if let Some(folder) = folder.filter(|folder| folder.is_dir() && *folder != self.folder) {
            self.enter(&folder);
        }
        self.fault = None;
    }

    fn enter(&mut self, folder: &Path) {
        self.folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        self.entries.clear();
        self.fault = None;
        match std::fs::read_dir(&self.folder) {
            Ok(entries) => {
                self.entries = entries
                    .flatten()
                    .map(|entry| Entry {
                        name: entry.file_name().to_string_lossy().into_owned(),
                        is_folder: entry.path().is_dir(),
                    })
                    .filter(|entry| !entry.name.starts_with('.'))
                    .filter(|entry| entry.is_folder || self.fits(&entry.name))
                    .collect();
                self.entries.sort_by_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
            }
            Err(error) => self.fault = Some(format!("This folder cannot be listed: {error}.")),
        }
    }

    fn fits(&self, name: &str) -> bool {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy());
        ending
            .is_some_and(|ending| self.endings.iter().any(|own| own.eq_ignore_ascii_case(&ending)))
    }
}

/// A folder as it stands in the path field: a name typed behind it is in it.
fn shown_folder(folder: &Path) -> String {
    folder.join("").display().to_string()
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
    fn a_part_of_a_name_shows_what_fits_and_is_enough_if_only_one_does() {
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
}
