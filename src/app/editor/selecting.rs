//! Selects several items, and takes typed amounts.

use std::collections::BTreeSet;

use egui::Context;

use super::App;
use crate::app::actions::Also;
use crate::app::input::keyboard::Keyboard;
use marraztu_core::edit::Gesture;
use marraztu_core::edit::selection;
use marraztu_core::edit::several::Others;
use marraztu_core::scene::{Command, ItemId, Scene, Subject};

impl App {
    /// Adds items to the selection, removes them, or selects only them.
    pub(crate) fn select_also(&mut self, items: &[ItemId], how: Also) {
        let state = &self.state;
        let first = state.selected();
        let mut all: Vec<ItemId> = match how {
            Also::Only => Vec::new(),
            Also::Add | Also::Toggle => first.into_iter().chain(state.others()).collect(),
        };
        let mut current = first;
        for item in items {
            match all.iter().position(|other| other == item) {
                // The last item stays selected: the keys always need an item to act on.
                Some(at) if how == Also::Toggle && all.len() > 1 => {
                    all.remove(at);
                    current = current.filter(|current| current != item).or(all.first().copied());
                }
                Some(_) => {}
                None => {
                    all.push(*item);
                    // A box keeps the item that the keys act on, if the box contains it.
                    if how != Also::Only {
                        current = Some(*item);
                    }
                }
            }
        }
        // The keys act on the item added last, or on the first one that is left.
        let current = current.filter(|current| all.contains(current)).or(all.first().copied());
        let Some(current) = current else { return };
        if state.selected() != Some(current) {
            match selection::pick(&state.scene, &state.view, current) {
                Ok(selection) => self.select(selection, Gesture::Whole),
                Err(refusal) => return self.refuse(refusal.to_string()),
            }
        }
        self.state.several = Others::new(current, all);
    }

    /// Adds items and selects all of them. The keys then act on the first.
    pub(crate) fn add_all(&mut self, command: Command, subject: Subject, label: &str) {
        let ids = |scene: &Scene| -> BTreeSet<ItemId> {
            let objects = scene.objects.ids().map(ItemId::Object);
            let cameras = scene.cameras.ids().map(ItemId::Camera);
            objects.chain(cameras).chain(scene.lights.ids().map(ItemId::Light)).collect()
        };
        let before = ids(&self.state.scene);
        self.change_then(command, Gesture::Whole, label, |state| {
            selection::set_subject(&mut state.view, subject);
            let added: Vec<ItemId> = ids(&state.scene).difference(&before).copied().collect();
            if let (Some(first), true) = (state.selected(), added.len() > 1) {
                state.several = Others::new(first, added);
            }
        });
    }

    /// Takes an axis and a number from the keyboard, for the selected items.
    pub(crate) fn type_amount(&mut self, ctx: &Context) {
        self.state.message = None;
        if self.viewport.type_amount(&self.state) {
            self.viewport.take_keyboard(ctx);
            Keyboard::begin_typing(ctx);
        } else {
            self.refuse("the viewport has not been drawn yet".to_owned());
        }
    }
}
