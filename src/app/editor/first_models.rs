//! Models that open alone: from the command line, from the greeting, or dropped on the untouched
//! first scene.
//!
//! They are shown as `render` shows them: without the first scene's objects, framed and lit. The
//! key `f` and the menu add a model to the current scene, even if that is the first one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui::Context;

use super::App;
use super::turning::usual_up;
use crate::app::documents::loading::{Arrival, Arrived, Fetched, Wish, is_scene};
use crate::app::documents::material_dialog::{details, opened, own_or_silver};
use crate::app::state::{Notice, NoticeKind, Offer, State, Viewpoints};
use crate::app::widgets::text::{file_name, one_or_count};
use marraztu_core::base::Shared;
use marraztu_core::edit::{Gesture, Refusal, Viewpoint, framing, items, lighting, presenting};
use marraztu_core::scene::{
    Command, Item, LoadOptions, MaterialChoice, Object, Pose, Scene, UpAxis, View,
};
use marraztu_io::{self as io, LoadError, Loaded, Progress};

impl App {
    /// Loads the files of the command line: models alone, or into the scene among the files. They
    /// do not count as unsaved changes.
    pub fn load_at_start(&mut self, ctx: &Context, paths: Vec<PathBuf>) {
        let (scenes, models): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_scene(path));
        if scenes.is_empty() && !models.is_empty() {
            // Without this, the first scene's objects would appear briefly and vanish.
            let (scene, mut view) = io::empty_scene();
            view.steps.by_size = true;
            self.replace(State::new(scene, view));
            return self.load_alone(ctx, models, Arrival::Start);
        }
        for path in scenes {
            self.open_scene(ctx, path);
        }
        for path in models {
            let material = Some(MaterialChoice::File);
            let wish = Wish { material, keeps_saved: true, ..Wish::default() };
            self.load_model(ctx, path, wish);
        }
    }

    /// Opens files that were dropped on the window.
    pub(crate) fn take_dropped(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_owned()).collect();
        if !paths.is_empty() {
            self.open_files(ctx, paths);
        }
    }

    /// Opens files. If the first scene is untouched, models replace it.
    pub(crate) fn open_files(&mut self, ctx: &Context, paths: Vec<PathBuf>) {
        self.back_to_scene();
        if self.is_untouched() && !paths.iter().any(|path| is_scene(path)) {
            self.load_alone(ctx, paths, Arrival::Dropped);
        } else {
            self.load_files(ctx, paths);
        }
    }

    /// Returns whether the scene is the first one or empty, and was never changed.
    pub(crate) fn is_untouched(&self) -> bool {
        let State { scene, history, path, .. } = &self.state;
        let first = io::default_scene().0;
        // Camera positions are ignored, since the user may have looked around.
        let looked = Scene { cameras: first.cameras.clone(), ..scene.clone() };
        path.is_none()
            && history.steps().len() == 0
            && (scene.objects.is_empty() || looked == first)
    }

    /// Reads these models together, to show them together.
    fn load_alone(&mut self, ctx: &Context, paths: Vec<PathBuf>, arrival: Arrival) {
        let what = one_or_count(&paths, "models", |path| file_name(path));
        let label = format!("Loading {what}");
        let usual = self.state.up;
        self.begin_loading(ctx, label, false, move |progress| {
            Fetched::Alone(read_all(&paths, usual, progress), arrival)
        });
    }

    /// Shows models that were read together: alone if the scene is untouched, else next to its
    /// objects.
    pub(crate) fn take_alone(
        &mut self,
        ctx: &Context,
        read: Vec<Result<Arrived, LoadError>>,
        arrival: Arrival,
    ) {
        let mut arrived = Vec::new();
        for result in read {
            match result {
                Ok(model) => arrived.push(model),
                Err(error) => self.tell_load_error(&error),
            }
        }
        if arrived.is_empty() {
            if arrival == Arrival::Start && self.is_untouched() {
                let (scene, view) = io::default_scene();
                self.replace(State::new(scene, view));
                // The greeting offers other ways to begin.
                self.greet();
            }
            return;
        }
        let objects: Vec<Object> = arrived.iter().map(|model| model.object.clone()).collect();
        let what = one_or_count(&objects, "models", |object| object.name.clone());
        if let Err(refusal) = self.show_alone(objects, arrival, &format!("Load {what}")) {
            return self.refuse(refusal.to_string());
        }
        // With many models, one notice for each would hide the models.
        let only = if arrived.len() == 1 { self.state.scene.objects.ids().next() } else { None };
        for Arrived { object, said, findings } in arrived {
            if let Some(path) = &object.model.source {
                self.note_recent(path);
            }
            self.state.tell(Some(format!("Opened {}", object.name)));
            if only.is_some() || !findings.is_empty() {
                let offer = only.filter(|_| object.model.source.is_some()).map(Offer::Up);
                let notice = Notice::new(NoticeKind::Opened, said).with(details(&findings));
                self.state.notices.push(notice.offering(offer));
            }
            if let Some(id) = only {
                self.offer_texture(id, &findings);
            }
        }
        let ids: Vec<_> = self.state.scene.objects.ids().collect();
        self.look_for_unseen(ctx, ids);
    }

    fn show_alone(
        &mut self,
        objects: Vec<Object>,
        arrival: Arrival,
        label: &str,
    ) -> Result<(), Refusal> {
        if !self.is_untouched() {
            let keeps_saved = arrival == Arrival::Start && self.state.history.is_saved();
            let command = items::insert_objects(&self.state.scene, objects);
            self.change(command, Gesture::Whole, label);
            if keeps_saved {
                self.state.history.mark_saved();
            }
            return Ok(());
        }
        let (command, view) = presenting::alone(&self.state.scene, &self.state.view, objects)?;
        match arrival {
            Arrival::Start => {
                let mut scene = self.state.scene.clone();
                command.apply(&mut scene)?;
                if let Some(from) = self.models_from {
                    turn(&mut scene, &view, from)?;
                }
                self.replace(State::new(scene, view));
            }
            Arrival::Dropped => {
                let steps = self.state.view.steps;
                self.change_then(command, Gesture::Whole, label, |state| {
                    state.view = view;
                    let first = Viewpoint::of(&state.scene, &state.view);
                    state.viewpoints = Viewpoints::new(first);
                });
                self.first_steps = Some(steps);
                // Nothing is lost yet: the models are files. Their figures are not known yet.
                self.state.history.mark_saved();
                self.state.dial.last = None;
            }
        }
        Ok(())
    }

    /// Exchanges the step sizes if undo or redo has crossed the replacement of the first scene: the
    /// first scene and the models each keep their own. `from` is the position before that.
    pub(crate) fn follow_steps(&mut self, from: usize) {
        let State { history, view, .. } = &mut self.state;
        let has_crossed = (from == 0) != (history.position() == 0);
        if let (Some(kept), true) = (&mut self.first_steps, has_crossed) {
            std::mem::swap(&mut view.steps.translation, &mut kept.translation);
            std::mem::swap(&mut view.steps.by_size, &mut kept.by_size);
        }
    }
}

/// Frames and lights everything from another direction, and keeps what the camera orbits.
fn turn(scene: &mut Scene, view: &View, from: [f64; 2]) -> Result<(), Refusal> {
    let mode = scene.selected_camera(view).pose.now().mode;
    framing::models(scene, view, from)?.apply(scene)?;
    lighting::models(scene, view)?.apply(scene)?;
    let mut camera = scene.selected_camera(view).clone();
    camera.pose = camera.pose.replaced(Pose { mode, ..*camera.pose.now() });
    Command::Replace(Item::Camera(view.camera, Box::new(camera))).apply(scene)?;
    Ok(())
}

/// Reads models with their materials. A file that is named twice is read once.
fn read_all(
    paths: &[PathBuf],
    usual: UpAxis,
    progress: &Progress,
) -> Vec<Result<Arrived, LoadError>> {
    let mut known: BTreeMap<PathBuf, Object> = BTreeMap::new();
    let count = paths.len().max(1);
    let mut read = |(i, path): (usize, &PathBuf)| {
        let place = std::path::absolute(path).unwrap_or_else(|_empty| path.clone());
        if let Some(object) = known.get(&place) {
            return Ok(Arrived {
                object: object.clone(),
                said: format!("Opened {} once more", object.name),
                findings: Vec::new(),
            });
        }
        let part = progress.part(share(i, count), share(i + 1, count));
        let arrived = arrived(path, usual, &part)?;
        known.insert(place, arrived.object.clone());
        Ok(arrived)
    };
    paths.iter().enumerate().map(&mut read).collect()
}

fn arrived(path: &Path, usual: UpAxis, progress: &Progress) -> Result<Arrived, LoadError> {
    let (up, why) = usual_up(path, usual);
    let crease = io::usual_crease(path);
    let options = LoadOptions { up, crease, ..LoadOptions::default() };
    let loaded = io::load(path, &options, progress)?;
    let said = opened(&loaded);
    let said = why.map_or_else(|| said.clone(), |why| format!("{said}. {why}"));
    let material = own_or_silver(&loaded);
    let Loaded { model, findings } = loaded;
    let object = Object::new(Shared::new(model), material);
    Ok(Arrived { object, said, findings })
}

#[expect(clippy::cast_precision_loss, reason = "the number of files on a command line")]
fn share(i: usize, of: usize) -> f64 {
    i as f64 / of as f64
}
