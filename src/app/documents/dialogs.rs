//! The dialogs over the window: files, materials, unsaved changes, errors.
//!
//! Files are chosen in the system's dialog, which runs on a separate thread. On a system without
//! such a dialog it returns immediately, faster than any user. The simple browser of this program
//! then takes its place.

use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use egui::{Context, Id, Modal, ScrollArea, Ui};
#[cfg(feature = "desktop")]
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

use super::answer::{Answer, End};
use super::browser::{Browser, Choice, Look, Mode};
use super::folders::{Folders, Kind};
use super::material_dialog::MaterialDialog;
use super::picture_dialog::{PictureChoices, PictureDialog};
use super::questions::{self, close_ui, limit_width};
use super::wanted::{After, Wanted};
use crate::app::tasks::{Outcome, Task};
use crate::app::widgets::controls::heading;

/// A system dialog that ends within this time was never shown.
const AT_ONCE: Duration = Duration::from_millis(400);

/// The space between a dialog and the edges of a low window, with the dialog's frame.
const MARGIN: f32 = 24.0;

/// In less room, a dialog may be too high.
const LOW: f32 = 420.0;

/// The window as the parent of system dialogs.
#[cfg(feature = "desktop")]
pub(crate) trait Parent: HasWindowHandle + HasDisplayHandle {}

#[cfg(feature = "desktop")]
impl<T: HasWindowHandle + HasDisplayHandle> Parent for T {}

#[derive(Debug, Default)]
pub(crate) struct Dialogs {
    /// Whether to use the system's file dialogs.
    pub(crate) native: bool,
    /// The start folders of dialogs.
    pub(crate) folders: Folders,
    /// The display of lists of files.
    look: Look,
    system: Option<SystemDialog>,
    /// The system dialog to open next.
    waiting: Option<(Wanted, String)>,
    /// The open dialogs, the top one last.
    open: Vec<Dialog>,
}

/// A request for files to a shell without system dialogs.
#[derive(Debug)]
pub(crate) struct FileRequest {
    /// Whether a file will be written, not read.
    pub(crate) saves: bool,
    /// The extensions of the files.
    pub(crate) endings: Vec<&'static str>,
    /// The suggested name.
    pub(crate) name: String,
    /// Takes the files.
    pub(crate) answer: Sender<Option<Vec<PathBuf>>>,
}

/// A system dialog on its thread.
#[derive(Debug)]
struct SystemDialog {
    wanted: Wanted,
    /// The suggested name.
    name: String,
    begun: Instant,
    task: Task<Option<Vec<PathBuf>>>,
}

#[derive(Debug)]
pub(crate) enum Dialog {
    Browser(Wanted, Box<Browser>),
    Unsaved(After),
    Material(Box<MaterialDialog>),
    Picture(Box<PictureDialog>),
    /// An error in one sentence, with a title.
    Fault(&'static str, String),
    /// The details of a notice, with its text as the title.
    Details(String, Vec<String>),
    /// The missing files of the scene.
    Missing(Vec<PathBuf>),
    /// Descriptions of the discarded work.
    Discarded(Vec<String>),
    /// The file of the scene was changed by another program.
    Changed(PathBuf, Option<After>),
    /// Whether to replace a file, with the answer of the dialog below for a yes.
    Replace(PathBuf, Option<Box<Answer>>),
}

impl Dialogs {
    /// Shows a dialog over all others.
    pub(crate) fn show(&mut self, dialog: Dialog) {
        self.open.push(dialog);
    }

    /// Reports an error in one sentence.
    pub(crate) fn tell_fault(&mut self, sentence: String) {
        self.show(Dialog::Fault("Something went wrong", sentence));
    }

    /// Returns the sentence of the first error that is shown.
    pub(crate) fn fault(&self) -> Option<&str> {
        self.open.iter().find_map(|dialog| match dialog {
            Dialog::Fault(_, sentence) => Some(&**sentence),
            _ => None,
        })
    }

    /// Asks whether to save unsaved changes.
    pub(crate) fn ask_unsaved(&mut self, after: After) {
        if !self.open.iter().any(|dialog| matches!(dialog, Dialog::Unsaved(_))) {
            self.open.push(Dialog::Unsaved(after));
        }
    }

    /// Returns whether a dialog of the window is open; system dialogs do not count.
    pub(crate) const fn is_open(&self) -> bool {
        !self.open.is_empty()
    }

    /// Asks for the options of a picture or a turntable.
    pub(crate) fn ask_picture(&mut self, choices: PictureChoices) {
        let dialog = PictureDialog::new(choices, self.folders.start(Kind::Saved));
        self.open.push(Dialog::Picture(Box::new(dialog)));
    }

    pub(crate) fn material(&mut self) -> Option<&mut MaterialDialog> {
        self.open.iter_mut().rev().find_map(|dialog| match dialog {
            Dialog::Material(material) => Some(&mut **material),
            _ => None,
        })
    }

    /// Asks for a file and proposes `name`.
    ///
    /// # Errors
    /// The title of the system dialog that is open already.
    pub(crate) fn ask_file(
        &mut self,
        ctx: &Context,
        wanted: Wanted,
        name: &str,
    ) -> Result<(), &'static str> {
        if let Some(open) = self.system_title() {
            return Err(open);
        }
        if self.native {
            self.waiting = Some((wanted, name.to_owned()));
            ctx.request_repaint();
        } else {
            self.browse(wanted, name);
        }
        Ok(())
    }

    /// Returns the title of the open system dialog.
    pub(crate) fn system_title(&self) -> Option<&'static str> {
        let open = self.system.as_ref().map(|open| &open.wanted);
        let wanted = open.or(self.waiting.as_ref().map(|(wanted, _)| wanted));
        wanted.map(|wanted| wanted.description().0)
    }

    /// Returns the request for files, which the shell has to answer. `None` as an answer opens the
    /// built-in browser.
    pub(crate) fn file_request(&mut self) -> Option<FileRequest> {
        let (wanted, name) = self.waiting.take()?;
        let (title, mode, endings) = wanted.description();
        let (task, answer) = Task::promised(title.to_owned());
        self.system =
            Some(SystemDialog { wanted, name: name.clone(), begun: Instant::now(), task });
        Some(FileRequest { saves: mode == Mode::Save, endings, name, answer })
    }

    /// Opens the requested system dialog over its parent.
    #[cfg(feature = "desktop")]
    pub(crate) fn open_system(&mut self, ctx: &Context, parent: &dyn Parent) {
        let Some((wanted, name)) = self.waiting.take() else { return };
        let (title, mode, endings) = wanted.description();
        let mut dialog = rfd::FileDialog::new()
            .set_title(title)
            .add_filter(endings.join(", "), &endings)
            .set_directory(self.folders.start(wanted.kind()))
            .set_parent(parent);
        if !name.is_empty() {
            dialog = dialog.set_file_name(&name);
        }
        let task = Task::start(ctx, title.to_owned(), move |_| match mode {
            Mode::Open => dialog.pick_files(),
            Mode::Save => dialog.save_file().map(|path| vec![path]),
        });
        // Without a thread, the built-in browser is the alternative.
        match task {
            Ok(task) => {
                let begun = Instant::now();
                self.system = Some(SystemDialog { wanted, name, begun, task });
            }
            Err(_) => self.browse(wanted, &name),
        }
    }

    /// Shows the open dialogs. Returns the answer, if any.
    pub(crate) fn ui(&mut self, ctx: &Context) -> Option<Answer> {
        if let Some(answer) = self.hear_system() {
            return Some(answer);
        }
        // Only the top dialog is shown and takes input.
        let number = self.open.len();
        let dialog = self.open.last_mut()?;
        let frame = egui::Frame::popup(&ctx.global_style()).inner_margin(16.0);
        let kind = std::mem::discriminant(dialog);
        let modal = Modal::new(Id::unique(("dialog", number, kind))).frame(frame);
        // In a low window, a dialog scrolls.
        let room = ctx.content_rect().height() - 2.0 * MARGIN;
        let response = modal.show(ctx, |ui| match room < LOW {
            true => ScrollArea::vertical().max_height(room).show(ui, |ui| dialog.ui(ui)).inner,
            false => dialog.ui(ui),
        });
        let ended = match response.inner {
            Some(end) => end,
            None if response.should_close() => End::Cancelled,
            None => return None,
        };
        ctx.request_repaint();
        if matches!(ended, End::Asked) {
            return Some(Answer::ChooseTexture);
        }
        let dialog = self.open.pop()?;
        self.close(dialog, ended)
    }

    /// Returns the answer of a dialog, unless it would replace a file: then the user is asked
    /// first.
    fn unless_replaced(
        &mut self,
        mut dialog: Dialog,
        answer: Answer,
        path: &Path,
    ) -> Option<Answer> {
        if !path.is_file() {
            return Some(answer);
        }
        // If the user keeps the file, the dialog asks for another one.
        if let Dialog::Browser(_, browser) = &mut dialog {
            browser.ask_again();
        }
        self.open.push(dialog);
        self.open.push(Dialog::Replace(path.to_owned(), Some(Box::new(answer))));
        None
    }

    fn close(&mut self, dialog: Dialog, end: End) -> Option<Answer> {
        Some(match (end, dialog) {
            (End::Answer(answer), Dialog::Replace(..)) => {
                // The answer also ends the dialog below.
                if matches!(self.open.last(), Some(Dialog::Browser(..) | Dialog::Picture(_))) {
                    self.open.pop();
                }
                answer
            }
            (End::Answer(Answer::Picture(choices, Some(path))), dialog) => {
                self.folders.remember(Kind::Saved, &path);
                let answer = Answer::Picture(choices, Some(path.clone()));
                return self.unless_replaced(dialog, answer, &path);
            }
            (End::Answer(answer), _) => answer,
            // The browser's display of lists is kept for the next one.
            (End::File(path), Dialog::Browser(wanted, browser)) => {
                self.look = browser.look;
                let path = wanted.named(path);
                let answer = self.chosen(wanted.clone(), vec![path.clone()]);
                return match wanted.description().1 {
                    Mode::Open => Some(answer),
                    Mode::Save => {
                        self.unless_replaced(Dialog::Browser(wanted, browser), answer, &path)
                    }
                };
            }
            (End::Cancelled, Dialog::Browser(_, browser)) => {
                self.look = browser.look;
                Answer::NoFile
            }
            (End::Material(choices), Dialog::Material(dialog)) => Answer::Material(dialog, choices),
            (End::Cancelled | End::File(_) | End::Material(_) | End::Asked, _) => return None,
        })
    }

    fn hear_system(&mut self) -> Option<Answer> {
        let outcome = match self.system.as_ref()?.task.outcome() {
            Outcome::Running => return None,
            Outcome::Done(paths) => Some(paths),
            Outcome::Lost => None,
        };
        let SystemDialog { wanted, name, begun, .. } = self.system.take()?;
        // A dialog that ended too early was never shown.
        match outcome {
            Some(Some(paths)) if !paths.is_empty() => self.chosen_by_system(wanted, paths),
            Some(_) if begun.elapsed() >= AT_ONCE => Some(Answer::NoFile),
            Some(_) | None => {
                // The system has no file dialog, so it is not tried again.
                self.native = false;
                self.browse(wanted, &name);
                None
            }
        }
    }

    /// Handles files from the system dialog. It has already asked whether to replace a file, unless
    /// the extension was missing.
    fn chosen_by_system(&mut self, wanted: Wanted, mut paths: Vec<PathBuf>) -> Option<Answer> {
        let Some(path) = paths.first_mut() else { return Some(Answer::NoFile) };
        let named = wanted.named(path.clone());
        let is_new = named == *path || !named.is_file();
        path.clone_from(&named);
        let answer = self.chosen(wanted, paths);
        if is_new {
            return Some(answer);
        }
        self.open.push(Dialog::Replace(named, Some(Box::new(answer))));
        None
    }

    fn chosen(&mut self, wanted: Wanted, paths: Vec<PathBuf>) -> Answer {
        if let Some(path) = paths.first() {
            self.folders.remember(wanted.kind(), path);
        }
        Answer::Files(wanted, paths)
    }

    fn browse(&mut self, wanted: Wanted, name: &str) {
        let (title, mode, endings) = wanted.description();
        let start = self.folders.start(wanted.kind());
        let browser = Browser::new(title, mode, endings, &start, name);
        let browser = browser.with(self.folders.places(), self.look);
        self.open.push(Dialog::Browser(wanted, Box::new(browser)));
    }
}

impl Dialog {
    fn ui(&mut self, ui: &mut Ui) -> Option<End> {
        match self {
            Self::Browser(_, browser) => browser.ui(ui).map(|choice| match choice {
                Choice::File(path) => End::File(path),
                Choice::Cancelled => End::Cancelled,
            }),
            Self::Unsaved(after) => questions::unsaved_ui(ui, after),
            Self::Missing(files) => questions::missing_ui(ui, files),
            Self::Discarded(all) => questions::discarded_ui(ui, all),
            Self::Changed(path, after) => questions::changed_ui(ui, path, after.as_ref()),
            Self::Replace(path, answer) => questions::replace_ui(ui, path, answer),
            Self::Material(dialog) => dialog.ui(ui),
            Self::Picture(dialog) => dialog.ui(ui),
            Self::Fault(title, sentence) => {
                limit_width(ui, 420.0);
                heading(ui, *title);
                ui.label(sentence.as_str());
                ui.add_space(4.0);
                close_ui(ui)
            }
            Self::Details(title, lines) => {
                limit_width(ui, 560.0);
                heading(ui, title.as_str());
                ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
                    for line in lines {
                        ui.label(line.as_str());
                    }
                });
                ui.add_space(4.0);
                close_ui(ui)
            }
        }
    }
}
