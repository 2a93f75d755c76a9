//! Loads models and textures, and saves pictures.
//!
//! Files are loaded on background threads. The scene changes only after a file was read completely,
//! so a bad file leaves it unchanged.

use std::path::PathBuf;

use egui::Context;

use super::App;
use super::turning::usual_up;
use super::unseen::{Searches, out_of_sight};
use crate::app::documents::answer::Answer;
use crate::app::documents::dialogs::Dialog;
use crate::app::documents::loading::{Fetched, FetchedModel, Loading, Queued, Wish, is_scene};
use crate::app::documents::material_dialog::{
    MaterialChoices, MaterialDialog, details, opened, own_or_silver, summary,
};
use crate::app::documents::wanted::{After, Wanted};
use crate::app::drawing::images;
use crate::app::state::dial::DialState;
use crate::app::state::{Notice, NoticeKind, OUT_OF_VIEW, Offer, Reduction, State};
use crate::app::tasks::{Outcome, Task};
use crate::app::widgets::text::file_name;
use marraztu_core::accuracy::{AccuracyPreset, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::edit::{Gesture, items, lighting};
use marraztu_core::scene::{
    Command, LoadOptions, MaterialChoice, Object, ObjectId, Subject, Texture,
};
use marraztu_io::{self as io, Finding, LoadError, Loaded};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// The maximum number of files read at the same time.
const MOST_LOADING: usize = 8;

impl App {
    /// Loads models as the key `f` does, or opens the scenes among the files. Models go to the
    /// user's scene: the scene of a lesson ends with the lesson.
    pub(crate) fn load_files(&mut self, ctx: &Context, paths: Vec<PathBuf>) {
        self.back_to_scene();
        for path in paths {
            if is_scene(&path) {
                self.unless_unsaved(ctx, After::Open(Some(path)));
            } else {
                self.load_model(ctx, path, Wish::default());
            }
        }
    }

    /// Handles the answer to a dialog.
    pub(crate) fn take_answer(&mut self, ctx: &Context, answer: Answer) {
        match answer {
            Answer::Files(wanted, paths) => self.take_files(ctx, wanted, paths),
            Answer::NoFile => {}
            Answer::Find(file) => self.find_missing(ctx, Some(file)),
            Answer::Changed(choice, path, after) => self.take_changed(ctx, choice, path, after),
            Answer::RecoverDiscarded(at) => {
                self.unless_unsaved(ctx, After::RecoverDiscarded(at));
            }
            Answer::Save(after) => self.save(ctx, Some(after)),
            Answer::Discard(after) => self.after(ctx, after),
            Answer::Material(dialog, choices) => self.take_material(ctx, *dialog, choices),
            Answer::Picture(choices, file) => self.take_picture(ctx, choices, file),
            Answer::ChooseTexture => self.ask_file(ctx, Wanted::TextureOfModel, ""),
        }
    }

    fn take_files(&mut self, ctx: &Context, wanted: Wanted, paths: Vec<PathBuf>) {
        let first = paths.first().cloned();
        match (wanted, first) {
            (Wanted::Model, _) => self.load_files(ctx, paths),
            (Wanted::Dropped, _) => self.open_files(ctx, paths),
            (_, None) => {}
            (Wanted::Texture(ids), Some(path)) => self.load_texture(ctx, ids, path),
            (Wanted::Panorama, Some(path)) => self.load_panorama(ctx, path),
            (Wanted::TextureOfModel, Some(path)) => {
                if let Some(dialog) = self.dialogs.material() {
                    dialog.set_texture(path);
                }
            }
            (Wanted::PictureTo, Some(path)) => self.save_picture(ctx, path),
            (Wanted::PictureWithOptionsTo | Wanted::TurntableTo, Some(path)) => {
                self.make_picture(ctx, path);
            }
            (Wanted::ExportTo(options), Some(path)) => self.export(ctx, path, options),
            (Wanted::Scene, Some(path)) => self.open_scene(ctx, path),
            (Wanted::SceneTo(after), Some(path)) => self.save_to(ctx, path, after),
            (Wanted::Missing(old), Some(path)) => self.found_missing(ctx, old, path),
        }
    }

    fn take_material(&mut self, ctx: &Context, dialog: MaterialDialog, choices: MaterialChoices) {
        let MaterialChoices { material, options, texture } = choices;
        let Some((path, loaded)) = dialog.loaded else {
            let model = io::cam_model();
            let command = items::insert_camera(&self.state.scene, model, material);
            self.add_all(command, Subject::Camera, "Add a camera");
            return;
        };
        if loaded.model.options == options && texture.is_none() {
            self.insert(ctx, loaded, material, None);
        } else {
            self.load_model(
                ctx,
                path,
                Wish { options, material: Some(material), texture, keeps_saved: false },
            );
        }
    }

    pub(crate) fn load_model(&mut self, ctx: &Context, path: PathBuf, wish: Wish) {
        // Without a material, a dialog asks for it when the file has been read.
        let label = format!("Loading {}", file_name(&path));
        let asks = wish.material.is_none();
        // A user who has chosen a material in the dialog has chosen the up axis there too.
        let chosen = !asks && !wish.keeps_saved;
        let usual = self.state.up;
        self.begin_loading(ctx, label, asks, move |progress| {
            let (up, _) = usual_up(&path, usual);
            let options = if chosen {
                wish.options
            } else {
                LoadOptions { up, crease: io::usual_crease(&path), ..wish.options }
            };
            let result = io::load(&path, &options, progress).and_then(|mut loaded| {
                let mut load = |path| io::load_texture_with(path, &mut loaded.findings);
                let texture = wish.texture.as_deref().map(&mut load).transpose()?;
                Ok((loaded, texture))
            });
            let Wish { material, keeps_saved, .. } = wish;
            Fetched::Model(Box::new(FetchedModel { path, material, keeps_saved, result }))
        });
    }

    fn load_texture(&mut self, ctx: &Context, ids: Vec<ObjectId>, path: PathBuf) {
        let label = format!("Loading {}", file_name(&path));
        self.begin_loading(ctx, label, false, move |_| {
            let mut findings = Vec::new();
            let texture = io::load_texture_with(&path, &mut findings);
            Fetched::Texture(ids, texture.map(|texture| (texture, findings)))
        });
    }

    fn load_panorama(&mut self, ctx: &Context, path: PathBuf) {
        let label = format!("Loading {}", file_name(&path));
        self.begin_loading(ctx, label, false, move |_| {
            Fetched::Panorama(io::load_panorama(&path).map(Shared::new))
        });
    }

    /// Reads a file on a background thread.
    pub(crate) fn begin_loading(
        &mut self,
        ctx: &Context,
        label: String,
        asks: bool,
        work: impl FnOnce(&io::Progress) -> Fetched + Send + 'static,
    ) {
        let of_lesson = self.state.lab.away;
        self.queued.push_back(Queued { label, asks, of_lesson, work: Box::new(work) });
        self.begin_queued(ctx);
    }

    /// Starts to read queued files, up to the maximum.
    fn begin_queued(&mut self, ctx: &Context) {
        while self.loading.len() < MOST_LOADING
            && let Some(Queued { label, asks, of_lesson, work }) = self.queued.pop_front()
        {
            match Task::start(ctx, label, work) {
                Ok(task) => self.loading.push(Loading { task, asks, of_lesson }),
                Err(error) => {
                    self.dialogs.tell_fault(format!("Cannot start a thread to load: {error}."));
                }
            }
        }
    }

    /// Handles the files that were read.
    pub(crate) fn hear_loading(&mut self, ctx: &Context) {
        // Files are handled in the order of the requests, whatever order they finish in.
        while let Some(loading) = self.loading.first() {
            // Only one material dialog is open at a time, so further models wait.
            if loading.asks && self.dialogs.material().is_some() {
                return;
            }
            let fetched = match loading.task.outcome() {
                Outcome::Running => return,
                Outcome::Done(fetched) => Some(fetched),
                Outcome::Lost => None,
            };
            // A place is free again for a queued file.
            let Loading { task, of_lesson, .. } = self.loading.remove(0);
            self.begin_queued(ctx);
            ctx.request_repaint();
            // A lesson may have been opened while a file for the user's scene was read.
            if !of_lesson {
                self.back_to_scene();
            }
            match fetched {
                // The lesson has ended, and its items with it.
                Some(_) if of_lesson && !self.state.lab.away => {}
                Some(fetched) => self.take_fetched(ctx, fetched),
                None => self.dialogs.tell_fault(format!(
                    "{} failed because of a bug in the program; nothing has changed.",
                    task.label
                )),
            }
        }
    }

    fn take_fetched(&mut self, ctx: &Context, fetched: Fetched) {
        match fetched {
            Fetched::Model(model) => {
                let FetchedModel { path, material, keeps_saved, result } = *model;
                match (result, material) {
                    (Err(error), _) => self.tell_load_error(&error),
                    (Ok((loaded, texture)), Some(material)) => {
                        // Models of the command line do not make the scene unsaved.
                        let keeps_saved = keeps_saved && self.state.history.is_saved();
                        self.insert(ctx, loaded, material, texture);
                        if keeps_saved {
                            self.state.history.mark_saved();
                        }
                    }
                    (Ok((loaded, _)), None) => {
                        let dialog = MaterialDialog::of_model(path, loaded);
                        self.dialogs.show(Dialog::Material(Box::new(dialog)));
                    }
                }
            }
            Fetched::Texture(_, Err(error)) => self.tell_load_error(&error),
            Fetched::Texture(ids, Ok((texture, findings))) => {
                let notice =
                    |finding: Finding| Notice::new(NoticeKind::Opened, finding.to_string());
                self.state.notices.extend(findings.into_iter().map(notice));
                let set = |object: &mut Object| object.texture = Some(texture.clone());
                let scene = &self.state.scene;
                // Objects that were removed meanwhile are left out.
                let ids = ids.into_iter().filter(|id| scene.objects.contains(*id));
                match ids.map(|id| items::change_object(scene, id, set)).collect() {
                    Ok(commands) => {
                        self.change(Command::Batch(commands), Gesture::Whole, "Choose a texture");
                    }
                    Err(refusal) => self.refuse(refusal.to_string()),
                }
            }
            Fetched::Panorama(Err(error)) => self.tell_load_error(&error),
            Fetched::Panorama(Ok(panorama)) => {
                match lighting::panorama(&self.state.scene, &self.state.view, panorama) {
                    Ok(command) => self.change(command, Gesture::Whole, "Choose a panorama"),
                    Err(refusal) => self.refuse(refusal.to_string()),
                }
            }
            Fetched::Pasted(result) => self.take_pasted(result),
            Fetched::Turned(read, up) => self.take_turned(read, up),
            Fetched::Again(all) => self.take_again(ctx, all),
            Fetched::Found(all) => self.take_found(all),
            Fetched::Scene(opening) => self.take_scene(ctx, *opening),
            Fetched::Alone(read, arrival) => self.take_alone(ctx, read, arrival),
        }
    }

    pub(crate) fn tell_load_error(&mut self, error: &LoadError) {
        match error {
            LoadError::Cancelled => self.state.tell(Some("Loading was cancelled".to_owned())),
            LoadError::File { .. } | LoadError::Line { .. } => {
                let title = "The file was not loaded";
                self.dialogs.show(Dialog::Fault(title, format!("{error}.")));
            }
        }
    }

    /// Reports that a model was loaded. Findings are reported in a notice.
    pub(crate) fn tell_loaded(&mut self, name: &str, found: &str, findings: &[String]) {
        self.state.tell(Some(match findings {
            [] => format!("Opened {name}: {found}"),
            _ => format!("Opened {name}"),
        }));
    }

    /// Adds a loaded model to the scene and reports the findings about its file.
    fn insert(
        &mut self,
        ctx: &Context,
        loaded: Loaded,
        material: MaterialChoice,
        texture: Option<Shared<Texture>>,
    ) {
        let (found, said) = (summary(&loaded), opened(&loaded));
        if let Some(path) = loaded.model.source.clone() {
            self.note_recent(&path);
        }
        let material = settled(material, &loaded);
        let (details, findings) = (details(&loaded.findings), loaded.findings);
        let mut object = Object::new(Shared::new(loaded.model), material);
        object.texture = texture;
        let name = object.name.clone();
        let size = self.viewport.size().unwrap_or(Size::new(800, 600));
        let unseen = out_of_sight(&self.state, &object, size);
        let command = items::insert_object(&self.state.scene, object);
        self.change(command, Gesture::Whole, &format!("Load {name}"));
        let Some(id) = self.state.view.object else { return };
        self.tell_loaded(&name, &found, &details);
        // Two notices, since framing the object dismisses only one of them.
        if !details.is_empty() {
            self.state.notices.push(Notice::new(NoticeKind::Opened, said).with(details));
        }
        self.offer_texture(id, &findings);
        if unseen {
            let notice = Notice::new(NoticeKind::Unseen, format!("{name}{OUT_OF_VIEW}"));
            self.state.notices.push(notice.offering(Some(Offer::Frame(id))));
        } else {
            self.look_for_unseen(ctx, [id]);
        }
    }

    /// Saves the picture as the still window shows it. If the window does not show it yet, it is
    /// drawn in the background.
    fn save_picture(&mut self, ctx: &Context, path: PathBuf) {
        if !self.shows_all() {
            return self.draw_as_shown(ctx, path);
        }
        let Some(picture) = self.shown_picture() else {
            self.refuse("no picture has been drawn yet".to_owned());
            return;
        };
        let sources = self.state.sources();
        match sources.spare(&path).and_then(|()| io::save_picture(&path, &picture)) {
            Ok(()) => self.state.tell_saved(&path),
            Err(error) => self.dialogs.tell_fault(format!("{error}.")),
        }
    }

    /// Copies the picture of the viewport to the clipboard.
    pub(crate) fn copy_picture(&mut self, ctx: &Context) {
        let Some(picture) = self.picture() else {
            self.refuse("no picture has been drawn yet".to_owned());
            return;
        };
        let Size { width, height } = picture.size();
        let bytes: &[u8] = picture.pixels().as_flattened();
        ctx.copy_image(egui::ColorImage::from_rgba_unmultiplied([width, height], bytes));
        self.state.tell(Some(format!("Copied a picture of {width} x {height} pixels")));
    }

    /// Returns the picture that the viewport shows.
    pub fn shown_picture(&self) -> Option<Picture> {
        self.viewport.image().and_then(|image| images::picture(image))
    }

    /// Returns whether the viewport shows the picture at full quality and fully refined.
    fn shows_all(&self) -> bool {
        let statistics = &self.state.statistics;
        statistics.reduction == Reduction::NONE && statistics.refined == self.state.refined_to()
    }

    /// Returns the picture of the viewport at full quality.
    fn picture(&self) -> Option<Picture> {
        if self.shows_all() {
            return self.shown_picture();
        }
        let mut shot = self.state.shot(self.viewport.size()?);
        shot.settings.samples = self.state.refined_to().unwrap_or(shot.settings.samples);
        Some(Renderer::default().render(&plan_frame(&shot)).clone())
    }

    /// Continues with the user's request after the scene was saved or discarded.
    pub(crate) fn after(&mut self, ctx: &Context, after: After) {
        match after {
            After::Quit => self.leave(ctx),
            After::New => {
                let (scene, view) = io::default_scene();
                self.replace(State::new(scene, view));
            }
            After::NewAncestor => {
                let (scene, view) = io::default_scene();
                let preset = AccuracyPreset::named("ancestor-a");
                let settings = Settings::default();
                let settings = preset.map_or(settings, |preset| preset.of(&settings));
                self.replace(State { settings, ..State::new(scene, view) });
            }
            After::Recover(at) => self.recover(ctx, at),
            After::RecoverDiscarded(at) => self.recover_discarded(ctx, at),
            After::Open(Some(path)) => self.open_scene(ctx, path),
            After::Open(None) => self.ask_file(ctx, Wanted::Scene, ""),
        }
    }

    /// Replaces the edited scene; the open panels stay. Returns the old state.
    pub(crate) fn replace(&mut self, state: State) -> State {
        // Background work for the old scene is of no use for the new one.
        self.end_measuring();
        self.comparison.forget();
        self.first_steps = None;
        self.searches = Searches::default();
        let mut old = std::mem::replace(&mut self.state, state);
        // Preferences of the window and lists of files belong to the window, not to the scene. The
        // palette closes itself after the request that replaces the scene.
        let new = &mut self.state;
        (new.panels, new.theme, new.drawing, new.layout) =
            (old.panels, old.theme, old.drawing, old.layout);
        (new.overlays, new.palette, new.gizmo, new.helpers) =
            (old.overlays, old.palette, old.gizmo, old.helpers);
        (new.watches, new.up, new.zoom, new.narrow) = (old.watches, old.up, old.zoom, old.narrow);
        (new.picture_only, new.greeting) = (old.picture_only, old.greeting);
        new.presenting = old.presenting;
        new.dial = DialState { shown: old.dial.shown, own: new.dial.own, ..DialState::default() };
        new.statistics = old.statistics.clone();
        new.recent = std::mem::take(&mut old.recent);
        new.recoverable = std::mem::take(&mut old.recoverable);
        new.discarded = std::mem::take(&mut old.discarded);
        new.generation = old.generation + 1;
        old
    }
}

/// Replaces the file's material by silver if the file does not contain materials.
fn settled(material: MaterialChoice, loaded: &Loaded) -> MaterialChoice {
    if material == MaterialChoice::File { own_or_silver(loaded) } else { material }
}
