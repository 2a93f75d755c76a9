//! Answers the requests of keys, panels, menus and the viewport.
//!
//! Only [`App::perform`] turns an action into a command or another view. Only [`App::change`] and
//! [`App::navigate`] write the scene.

use std::path::{Path, PathBuf};

use egui::Context;
use glam::DVec3;

use super::App;
use crate::app::actions::{Action, FileIntent, Intent, KeyRequest, Request, resolve};
use crate::app::documents::dialogs::Dialog;
use crate::app::documents::material_dialog::MaterialDialog;
use crate::app::documents::picture_dialog::{PictureChoices, Purpose};
use crate::app::documents::wanted::{After, Wanted};
use crate::app::input::keyboard::Keyboard;
use crate::app::input::keymap::Keymap;
use crate::app::panels::Panel;
use crate::app::state::{Message, Offer, State, Tone};
use marraztu_core::edit::selection::{self, Selection};
use marraztu_core::edit::several::Others;
use marraztu_core::edit::{Gesture, GesturePhase, Selected, aiming, items, lights};
use marraztu_core::scene::{Command, ItemId, View};
use marraztu_io::is_example;

impl App {
    /// Closes a panel. Returns whether it was open.
    pub(super) fn closes(&mut self, panel: Panel) -> bool {
        let panels = self.state.panels;
        self.state.panels = panels.with(panel, false);
        panels.has(panel)
    }

    /// Performs the actions of all keys that were pressed.
    pub(crate) fn press_all(&mut self, ctx: &Context) {
        if !self.pressed.is_empty() {
            ctx.request_repaint();
        }
        for press in std::mem::take(&mut self.pressed) {
            self.perform(ctx, press.action, press.gesture);
        }
    }

    /// Answers a request.
    pub fn answer(&mut self, ctx: &Context, request: Request) {
        let state = &mut self.state;
        match request {
            // Changes of the scene and of the view.
            Request::Do(action) => self.perform(ctx, action, Gesture::Whole),
            Request::Change { command, gesture, label } => self.change(command, gesture, &label),
            Request::Navigate { command, gesture } => self.navigate(command, gesture),
            Request::View(view) => self.show_view(*view),
            Request::Settings(settings) => state.settings = settings,
            Request::Drawing(choices) => state.drawing = choices,
            Request::Lab(request) => self.answer_lab(ctx, request),
            // The selection.
            Request::Select(id) => match selection::pick(&state.scene, &state.view, id) {
                Ok(selection) => self.select(selection, Gesture::Whole),
                Err(refusal) => self.refuse(refusal.to_string()),
            },
            Request::SelectAlso(items, how) => self.select_also(&items, how),
            Request::Others(others) => state.several = others,
            Request::Explain(at) => self.explain_pixel(ctx, at),
            Request::EndExplaining => {
                (self.explaining, state.explained, state.explaining) = (None, None, false);
            }
            Request::AimAt(point) => self.aim_at(point),
            Request::SelectPolygon(polygon) => {
                let mut view = state.view.clone();
                match selection::go_to_polygon(&state.scene, &mut view, polygon) {
                    Ok(()) => self.show_view(view),
                    Err(refusal) => self.refuse(refusal.to_string()),
                }
            }
            Request::Filter(filter) => state.filter = filter,
            // The history.
            Request::GoTo(position) => self.go_to(position),
            Request::Abandon(gesture) => self.abandon(gesture),
            Request::BeginRename(id) => state.renaming = Some(id),
            Request::EndRename(name) => self.end_rename(name),
            // Files.
            Request::ChooseTexture(ids) => self.ask_file(ctx, Wanted::Texture(ids), ""),
            Request::LoadFiles(paths) => self.load_files(ctx, paths),
            Request::OpenFiles(paths) => self.open_files(ctx, paths),
            Request::AskModels => self.ask_file(ctx, Wanted::Dropped, ""),
            // Notices.
            Request::Accept(kind) => self.accept(ctx, kind),
            Request::Details(kind) => self.show_details(kind),
            Request::Settle(kind) => state.settle_notices(|notice| notice.kind == kind),
            Request::DismissNotices => {
                self.dismiss_notices();
            }
            Request::ClearNotices => state.past_notices.clear(),
            Request::TurnUp(ids, up) => self.turn_up(ctx, &ids, up),
            Request::UpByDefault(up) => state.up = up,
            // Background work.
            Request::CancelLoading(at) => {
                if let Some(loading) = self.loading.get(at) {
                    loading.task.progress.cancel();
                }
            }
            Request::CancelMaking(at) => {
                if let Some(task) = self.making.tasks.get(at) {
                    task.progress.cancel();
                }
            }
            Request::Recover(at) => self.unless_unsaved(ctx, After::Recover(at)),
            Request::DiscardWork(at) => self.discard_work(at),
            Request::Layout(layout) => state.layout = layout,
            Request::Missing(request) => self.answer_missing(ctx, request),
            Request::Keys(request) => answer_keys(ctx, request),
            Request::EndGreeting => state.greeting = false,
            Request::Preferences(preferences) => self.take_preferences(ctx, &preferences),
            Request::Refuse(why) => self.refuse(why),
        }
    }

    /// Performs an action. Every key, menu entry and button ends here.
    pub fn perform(&mut self, ctx: &Context, action: Action, gesture: Gesture) {
        let label = action.step_label(&self.state, self.state.next_repeat(gesture));
        // Framing the object, by any key or button, dismisses the notice that offers it.
        if action == Action::FrameSelection {
            let framed = self.state.view.object.map(Offer::Frame);
            self.state.notices.retain(|notice| notice.offer.is_none() || notice.offer != framed);
        }
        // The action is resolved against the scene as it is now, which also decides its
        // availability.
        if action != Action::Escape {
            self.forget_quitting();
        }
        let resolved = resolve(action, &self.state, self.state.phase(gesture));
        // The lights that are on are remembered, to restore them when the user ends the solo.
        if action == Action::SoloLight && action.is_on(&self.state) == Some(false) {
            self.state.lit_before = lights::lit(&self.state.scene);
        }
        match resolved {
            Err(refusal) => self.refuse(refusal.to_string()),
            Ok(Intent::Change(command)) => self.change(command, gesture, &label),
            Ok(Intent::Add(command, subject)) => self.add_all(command, subject, &label),
            Ok(Intent::Navigate(command)) => self.navigate(command, gesture),
            Ok(Intent::ToViewpoint(step)) => self.go_to_viewpoint(step),
            Ok(Intent::View(view)) => self.show_view(*view),
            Ok(Intent::Select(selection)) => self.select(*selection, gesture),
            Ok(Intent::Show(change)) => {
                change(&mut self.state);
                if action == Action::ToggleGrid && self.hides_grid() {
                    let text = "The ground hides the grid, which is drawn behind everything";
                    self.state.tell(Some(text.to_owned()));
                }
            }
            Ok(Intent::Theme(theme)) => {
                self.state.theme = theme;
                ctx.set_theme(theme);
            }
            Ok(Intent::Rename(id)) => {
                self.state.panels = self.state.panels.with(Panel::Outline, true);
                self.state.renaming = Some(id);
            }
            Ok(Intent::Undo) => {
                let label = self.undo();
                self.state.tell(label.map(|label| format!("Undone: {label}")));
            }
            Ok(Intent::Redo) => {
                let label = self.redo();
                self.state.tell(label.map(|label| format!("Redone: {label}")));
            }
            Ok(Intent::File(intent)) => self.file(ctx, intent),
            Ok(Intent::Clipboard(intent)) => self.clipboard(ctx, intent, &label),
            Ok(Intent::AskCamera) => {
                self.dialogs.show(Dialog::Material(Box::new(MaterialDialog::of_camera())));
            }
            Ok(Intent::Measure) => self.measure(ctx),
            Ok(Intent::ChooseTexture(ids)) => self.ask_file(ctx, Wanted::Texture(ids), ""),
            Ok(Intent::ChoosePanorama) => self.ask_file(ctx, Wanted::Panorama, ""),
            Ok(Intent::WhyUnseen(id)) => self.why_unseen(ctx, id),
            Ok(Intent::Present) => self.present(ctx),
            Ok(Intent::Zoom(zoom)) => ctx.set_zoom_factor(zoom),
            Ok(Intent::FitExposure) => self.fit_exposure(),
            Ok(Intent::Loupe) => self.toggle_loupe(ctx),
            Ok(Intent::TypeAmount) => self.type_amount(ctx),
            Ok(Intent::PastNotices) => self.show_past_notices(),
            Ok(Intent::ChangeKeyboardOwner(way)) => Keyboard::change_owner(ctx, way),
            Ok(Intent::Escape) => self.escape(ctx),
        }
    }

    /// Aims the selected light at a point clicked in the picture.
    fn aim_at(&mut self, point: DVec3) {
        let State { scene, view, .. } = &self.state;
        let command = aiming::can_aim(scene, view)
            .and_then(|id| aiming::aim(scene, view, id, point, GesturePhase::First));
        match command {
            Ok(command) => {
                let name = view.light.and_then(|id| self.state.name(ItemId::Light(id)));
                let label = format!("Aim {}", name.unwrap_or("a light"));
                self.state.aiming = false;
                self.change(command, Gesture::Whole, &label);
            }
            Err(refusal) => self.refuse(refusal.to_string()),
        }
    }

    pub(super) fn file(&mut self, ctx: &Context, intent: FileIntent) {
        match intent {
            FileIntent::New => self.unless_unsaved(ctx, After::New),
            FileIntent::Open => self.unless_unsaved(ctx, After::Open(None)),
            FileIntent::Quit if cfg!(target_family = "wasm") => {
                let text = "The browser closes this page; the next visit offers unsaved changes";
                self.state.tell(Some(text.to_owned()));
            }
            FileIntent::Quit => self.unless_unsaved(ctx, After::Quit),
            FileIntent::Load => self.ask_file(ctx, Wanted::Model, ""),
            FileIntent::Save => self.save(ctx, None),
            FileIntent::SaveAs => self.save_as(ctx, None),
            FileIntent::CopyPicture => self.copy_picture(ctx),
            FileIntent::SavePicture => self.ask_file(ctx, Wanted::PictureTo, "picture.png"),
            FileIntent::PictureOptions => self.ask_picture(Purpose::Picture),
            FileIntent::Turntable => self.ask_picture(Purpose::Turntable),
            FileIntent::Export(options) => {
                let name = format!("{}.glb", self.state.proposed_name());
                self.ask_file(ctx, Wanted::ExportTo(options), &name);
            }
            FileIntent::Recover => self.unless_unsaved(ctx, After::Recover(0)),
            FileIntent::RecoverDiscarded => match &self.state.discarded[..] {
                [_] => self.unless_unsaved(ctx, After::RecoverDiscarded(0)),
                all => self.dialogs.show(Dialog::Discarded(all.to_vec())),
            },
            FileIntent::FindMissing => self.find_missing(ctx, None),
            FileIntent::Reload => self.reload_models(ctx, None),
            FileIntent::NewAncestor => self.unless_unsaved(ctx, After::NewAncestor),
        }
    }

    /// Asks for a file, unless a system dialog is open already: it may be hidden behind the window.
    pub(crate) fn ask_file(&mut self, ctx: &Context, wanted: Wanted, name: &str) {
        self.note_folders(&wanted);
        if let Err(open) = self.dialogs.ask_file(ctx, wanted, name) {
            self.refuse(format!("the dialog \"{open}\" is open: close it first"));
        }
    }

    /// Sets the folders for dialogs: that of the scene or the model in question, and those of
    /// recent files.
    fn note_folders(&mut self, wanted: &Wanted) {
        let own = match wanted {
            Wanted::TextureOfModel => {
                let loaded = self.dialogs.material().and_then(|dialog| dialog.loaded.as_ref());
                loaded.map(|(path, _)| path.clone())
            }
            Wanted::Texture(ids) => {
                let first = ids.first().and_then(|id| self.state.scene.objects.get(*id));
                first.and_then(|object| object.model.source.clone())
            }
            _ => None,
        };
        let folder = |path: &PathBuf| {
            let path = std::path::absolute(path).ok()?;
            path.parent().map(Path::to_owned)
        };
        let is_own = |path: &PathBuf| !is_example(path);
        let recent = self.state.recent.iter().filter_map(folder).collect();
        let folders = &mut self.dialogs.folders;
        folders.home = own.filter(is_own).as_ref().and_then(folder).or_else(|| self.state.folder());
        folders.recent = recent;
    }

    /// Asks for the options of a picture or a turntable.
    fn ask_picture(&mut self, purpose: Purpose) {
        let Some(size) = self.viewport.size() else { return };
        let samples = self.state.refined_to().unwrap_or(self.state.settings.samples);
        self.note_folders(&Wanted::PictureWithOptionsTo);
        self.dialogs.ask_picture(PictureChoices::new(purpose, size, samples));
    }

    fn end_rename(&mut self, name: Option<String>) {
        let Some(id) = self.state.renaming.take() else { return };
        let Some(name) = name else { return };
        if self.state.name(id) == Some(name.trim()) {
            return;
        }
        match items::rename(&self.state.scene, id, &name) {
            Ok(command) => self.change(command, Gesture::Whole, "Rename"),
            Err(refusal) => self.refuse(refusal.to_string()),
        }
    }

    pub(crate) fn show_view(&mut self, view: View) {
        self.noting_viewpoint(Gesture::Whole, |app| app.set_view(view));
    }

    pub(super) fn set_view(&mut self, view: View) {
        self.state.message = None;
        self.state.view = view;
        selection::settle(&self.state.scene, &mut self.state.view);
    }

    /// Selects an item alone.
    pub(crate) fn select(&mut self, selection: Selection, gesture: Gesture) {
        self.noting_viewpoint(gesture, |app| {
            if let Some(command) = selection.command {
                app.move_view(command, gesture);
            }
            app.set_view(selection.view);
        });
        self.state.several = Others::default();
    }

    /// Changes the scene. Every change except undo and redo ends here.
    pub(crate) fn change(&mut self, command: Command, gesture: Gesture, label: &str) {
        self.change_then(command, gesture, label, |_| {});
    }

    /// Changes the scene as [`Self::change`] does, then selects items, which redo selects again.
    pub(crate) fn change_then(
        &mut self,
        command: Command,
        gesture: Gesture,
        label: &str,
        select: impl FnOnce(&mut State),
    ) {
        let state = &mut self.state;
        let before = state.scene.clone();
        let acted_on = state.selected();
        let selected = Selected::of(&state.view, &state.several);
        let repeats = state.next_repeat(gesture);
        let is_first = state.history.position() == 0;
        match state.history.perform(&mut state.scene, command, gesture, label) {
            // The selection before and after the step is recorded, so undo and redo restore it.
            Ok(()) => {
                self.changes += 1;
                // Redo no longer leads to models that replaced the first scene.
                if is_first {
                    self.first_steps = None;
                }
                (state.gesture, state.repeats) = (gesture, repeats);
                state.message = None;
                selection::follow(&before, &state.scene, &mut state.view);
                // The others belonged to the item that was selected before.
                if state.selected() != acted_on {
                    state.several = Others::default();
                }
                select(state);
                let after = Selected::of(&state.view, &state.several);
                state.history.note_selected(selected, after);
                self.adapt_near(Gesture::Whole);
            }
            Err(error) => self.refuse(error.to_string()),
        }
    }

    /// Moves the view, which is not a step of the history.
    pub(crate) fn navigate(&mut self, command: Command, gesture: Gesture) {
        self.noting_viewpoint(gesture, |app| app.move_view(command, gesture));
    }

    /// Shows in the status line why a request was refused.
    pub(crate) fn refuse(&mut self, why: String) {
        self.state.message = Some(Message { text: why, tone: Tone::Refused });
    }
}

fn answer_keys(ctx: &Context, request: KeyRequest) {
    let mut keymap = Keymap::clone(&Keyboard::keymap(ctx));
    match request {
        KeyRequest::Choose(action) => return Keyboard::choose_for(ctx, Some(action)),
        KeyRequest::Cancel => return Keyboard::choose_for(ctx, None),
        KeyRequest::Take(action, chord) => {
            keymap.set(action, chord);
            Keyboard::choose_for(ctx, None);
        }
        KeyRequest::Reset(action) => keymap.reset(action),
        KeyRequest::ResetAll => keymap = Keymap::default(),
    }
    Keyboard::set_keymap(ctx, keymap);
    ctx.request_repaint();
}
