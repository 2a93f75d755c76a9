//! Copies items and materials as text, and pastes them.
//!
//! The text is a fragment of a scene file: it can be pasted into other windows and text editors. It
//! names models by their files; models of this scene are not read again.

use egui::Context;

use super::App;
use crate::app::actions::ClipboardIntent;
use crate::app::documents::loading::Fetched;
use crate::app::input::keyboard::Keyboard;
use crate::app::state::State;
use crate::app::widgets::text::one_or_count;
use marraztu_core::edit::{Gesture, Refusal, copies, several};
use marraztu_core::scene::{ItemId, MaterialChoice, Object, ObjectId, Subject, View};
use marraztu_io::{self as io, Fragment, Known, LoadError, SceneFileError};

impl App {
    pub(crate) fn clipboard(&mut self, ctx: &Context, intent: ClipboardIntent, label: &str) {
        match intent {
            ClipboardIntent::Copy => {
                self.copy(ctx);
            }
            ClipboardIntent::Cut(command) => {
                if self.copy(ctx) {
                    self.change(command, Gesture::Whole, label);
                    self.state.tell(Some(label.to_owned()));
                }
            }
            ClipboardIntent::Paste => match Keyboard::take_pasted(ctx) {
                Some(text) => self.paste(ctx, text),
                None => Keyboard::ask_paste(ctx),
            },
            ClipboardIntent::CopyMaterial(id) => self.copy_material(ctx, id),
        }
    }

    /// Copies the selected items. Returns whether it succeeded.
    fn copy(&mut self, ctx: &Context) -> bool {
        let items: Vec<ItemId> =
            self.state.selected().into_iter().chain(self.state.others()).collect();
        match io::items_to_text(&self.state.scene, &items) {
            Ok(text) => {
                ctx.copy_text(text);
                self.state.tell(Some(format!("Copied {}", self.state.acted_on_name())));
                true
            }
            Err(why) => {
                self.refuse(why);
                false
            }
        }
    }

    fn copy_material(&mut self, ctx: &Context, id: ObjectId) {
        let Some(object) = self.state.scene.objects.get(id) else { return };
        let material = match &object.material {
            // A file's material belongs to the file, so its values are copied.
            MaterialChoice::File => MaterialChoice::Own(object.part_look(0).material),
            other => other.clone(),
        };
        let mut told = format!("Copied the material of {}", object.name);
        if object.part_look(0).texture.is_some() {
            told += ", without its texture";
        }
        match io::material_to_text(&material) {
            Ok(text) => {
                ctx.copy_text(text);
                self.state.tell(Some(told));
            }
            Err(why) => self.refuse(why),
        }
    }

    /// Reads pasted text on a thread, since it may name models that have to be read.
    fn paste(&mut self, ctx: &Context, text: String) {
        let known = Known::of(&self.state.scene);
        self.begin_loading(ctx, "Pasting".to_owned(), false, move |progress| {
            Fetched::Pasted(io::items_of_text(&text, &known, progress).map(Box::new))
        });
    }

    /// Inserts pasted items that were read.
    pub(crate) fn take_pasted(&mut self, read: Result<Box<Fragment>, SceneFileError>) {
        let result = match read {
            Ok(fragment) => self.insert_fragment(*fragment).map_err(|refusal| refusal.to_string()),
            Err(SceneFileError::Model(LoadError::Cancelled)) => Err("it was cancelled".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        if let Err(why) = result {
            self.refuse(format!("cannot paste: {why}"));
        }
    }

    fn insert_fragment(&mut self, fragment: Fragment) -> Result<(), Refusal> {
        let Fragment { objects, cameras, lights, material } = fragment;
        let State { scene, view, .. } = &self.state;
        let names = objects.iter().map(|(_, it)| &it.name);
        let names = names.chain(cameras.iter().map(|(_, it)| &it.name));
        let names: Vec<&String> = names.chain(lights.iter().map(|(_, it)| &it.name)).collect();
        let what = one_or_count(&names, "items", |name| (*name).clone());
        // The kind of the first pasted items becomes the subject.
        let subject = match (objects.is_empty(), lights.is_empty()) {
            (false, _) => Subject::Object,
            (true, false) => Subject::Light,
            (true, true) => Subject::Camera,
        };
        // Items are added first; a material then goes to the selected objects.
        let copies = copies::Copies { objects, cameras, lights };
        if !copies.is_empty() {
            let command = copies::insert(scene, view, copies)?;
            self.add_all(command, subject, &format!("Paste {what}"));
            self.state.tell(Some(format!("Pasted {what}")));
        }
        let Some(material) = material else { return Ok(()) };
        // It goes to the objects, whatever the keys act on.
        let view = View { subject: Subject::Object, ..self.state.view.clone() };
        let (scene, others) = (&self.state.scene, self.state.others());
        let set = |object: &mut Object| object.material = material.clone();
        let command = several::change_objects(scene, &view, &others, set)?;
        let label = format!("Paste a material to {}", self.state.acted_on_name());
        self.change(command, Gesture::Whole, &label);
        self.state.tell(Some(label.replacen("Paste", "Pasted", 1)));
        Ok(())
    }
}
