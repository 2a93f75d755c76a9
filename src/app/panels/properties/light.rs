//! The properties of a light.

use egui::{ComboBox, Slider, Ui};
use glam::DVec3;

use super::several::label;
use super::{missing_ui, number_row, steps_ui};
use crate::app::actions::{Action, Request, Requests, change};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Switch, fact, row, section};
use crate::app::widgets::gestures;
use crate::app::widgets::mixed::is_mixed;
use crate::app::widgets::number::{Number, vector};
use crate::app::widgets::text::file_name;
use marraztu_core::base::color::{self, Color};
use marraztu_core::edit::{
    Change, Gesture, GesturePhase, Refusal, items, lights, motion, placement, several,
};
use marraztu_core::scene::{
    Anchor, Attenuation, ItemId, Light, LightId, LightKind, Orbit, Scene, SkyPanorama, SpotOwner,
    Tracked, View,
};

/// The light in the panel, and the other selected lights.
struct Shown<'a> {
    state: &'a State,
    others: &'a [ItemId],
    id: LightId,
    light: &'a Light,
}

pub(crate) fn show(
    ui: &mut Ui,
    state: &State,
    others: &[ItemId],
    requests: &mut Requests,
    id: LightId,
) {
    let Some(light) = state.scene.lights.get(id) else { return };
    missing_ui(ui, requests, light.missing_file().into_iter());
    let shown = Shown { state, others, id, light };
    section(ui, "Colour", true, |ui| shown.color_ui(ui, requests));
    if light.kind.numbers().next().is_some() {
        section(ui, "Cone", true, |ui| shown.numbers_ui(ui, requests));
    }
    // The sections depend on how the light is placed.
    match light.kind.anchor() {
        Anchor::Everywhere => {}
        Anchor::Direction(direction) => {
            section(ui, "Direction", true, |ui| {
                shown.direction_ui(ui, requests, *direction.now());
                aim_ui(ui, state, requests);
            });
        }
        Anchor::Position(position) => {
            section(ui, "Position", true, |ui| {
                shown.position_ui(ui, requests, *position.now());
                if let Some(orbit) = light.kind.orbit() {
                    shown.orbit_ui(ui, requests, *orbit);
                }
            });
        }
        Anchor::Owner(owner) => {
            section(ui, "Position", true, |ui| {
                shown.owner_ui(ui, requests, owner);
                if let Some(aim) = owner.fixed() {
                    shown.position_ui(ui, requests, aim.now().position);
                    shown.direction_ui(ui, requests, aim.now().direction);
                }
                aim_ui(ui, state, requests);
            });
        }
    }
    if light.kind.has_position() {
        section(ui, "Attenuation", false, |ui| shown.fading_ui(ui, requests));
    }
    if light.kind.has_position() || light.kind.has_direction() {
        steps_ui(ui, state, requests, false);
    }
}

/// Shows the actions that aim the light.
fn aim_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    ui.horizontal_wrapped(|ui| {
        requests.extend(Action::AimAtSelection.button(ui, state).map(Request::from));
        requests.extend(Action::AimByClick.switch(ui, state).map(Request::from));
    });
}

impl Shown<'_> {
    /// Requests a change of each light, labelled with a verb and the name of the first.
    fn change(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        act: impl Fn(&Scene, &View, LightId) -> Change,
    ) {
        let State { scene, view, .. } = self.state;
        let command = several::each_light(scene, view, self.others, act);
        change(requests, label(verb, &self.light.name, self.others), gesture, command);
    }

    /// Requests a change of the properties of each light.
    fn set(&self, requests: &mut Requests, verb: &str, gesture: Gesture, to: impl Fn(&mut Light)) {
        self.change(requests, verb, gesture, |scene, _, id| items::change_light(scene, id, &to));
    }

    /// Shows the extent of a light with shadows.
    fn size_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let light = self.light;
        let (label, hint) = match light.kind.has_position() {
            true => ("Radius", "The radius of the light: larger lights have softer shadows"),
            false => ("Angle", "The angular diameter of the sun in degrees; 0.53 from the Earth"),
        };
        let number = Number::new(label, hint).speed(0.05).range(0.0..=light.largest_size());
        if let Some((size, gesture)) = number_row(ui, label, number, light.size) {
            self.change(requests, "Size of", gesture, |scene, _, id| {
                lights::set_size(scene, id, size)
            });
        }
    }

    fn color_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let Self { state, others: _, id, light } = *self;
        if Switch::new("Shines", light.on).ui(ui).on_hover_text(self.key_hint()).clicked() {
            self.set(requests, "Switch", Gesture::Whole, |other| other.on = !light.on);
        }
        if light.can_cast_shadows() {
            let hint = "Lets objects cast shadows in this light; exact shadows need no bias";
            let switch = Switch::new("Casts shadows", light.shadows).ui(ui);
            if switch.on_hover_text(hint).clicked() {
                self.change(requests, "Shadows of", Gesture::Whole, |scene, _, id| {
                    lights::set_shadows(scene, id, !light.shadows)
                });
            }
            if light.shadows && light.largest_size() > 0.0 {
                self.size_ui(ui, requests);
            }
        }
        let channels = [("Red", "q and Q"), ("Green", "v and V"), ("Blue", "a and A")];
        for (i, (name, keys)) in channels.into_iter().enumerate() {
            if let Some((to, gesture)) = channel_ui(ui, name, keys, light.color.0[i]) {
                self.set(requests, "Colour", gesture, |light| light.color.0[i] = to);
            }
        }
        row(ui, "Picker", |ui| {
            if let Some((color, gesture)) = swatch(ui, "Colour", "The light's colour", light.color)
            {
                // All lights get the whole colour, even the channels that this one already has.
                self.set(requests, "Colour", gesture, |light| light.color = color);
            }
        });
        if let LightKind::Sky { ground, panorama } = &light.kind {
            self.sky_ui(ui, requests, (*ground, panorama.as_ref()));
        }
        let hint = "The key from 0 to 9 that switches the light; each key belongs to one light";
        let number = Number::new("Key", hint).speed(0.05).range(0.0..=9999.0).whole();
        if let Some((to, gesture)) = number_row(ui, "Key", number, f64::from(light.slot)) {
            // No two lights have the same key.
            let command = lights::set_slot(&state.scene, id, whole(to));
            change(requests, format!("Key of {}", light.name), gesture, command);
        }
    }

    /// Shows what a sky shines with: the colour of the ground, or a panorama.
    fn sky_ui(
        &self,
        ui: &mut Ui,
        requests: &mut Requests,
        (ground, panorama): (Color, Option<&SkyPanorama>),
    ) {
        if panorama.is_none() {
            row(ui, "Ground", |ui| {
                let hint = "The colour below the horizon";
                if let Some((color, gesture)) = swatch(ui, "Ground", hint, ground) {
                    self.set(requests, "Ground of", gesture, |light| {
                        if let LightKind::Sky { ground, .. } = &mut light.kind {
                            *ground = color;
                        }
                    });
                }
            });
        }
        let source = panorama.map(|it| &it.panorama.source);
        let mixed = is_mixed(ui.ctx(), "Panorama");
        let text = source.map_or_else(|| "none".to_owned(), |source| file_name(source));
        fact(ui, "Panorama", if mixed { "mixed" } else { &text });
        row(ui, "", |ui| {
            let hint = "Chooses a picture of everything around: HDR, EXR, PNG or JPEG";
            if ui.button("Choose...").on_hover_text(hint).clicked() {
                requests.push(Request::Do(Action::ChoosePanorama));
            }
            let remove = egui::Button::new("Remove");
            let hint = "Removes the panorama: the sky has two colours again";
            let remove = ui.add_enabled(panorama.is_some(), remove).on_hover_text(hint);
            if remove.on_disabled_hover_text(hint).clicked() {
                self.set(requests, "Remove the panorama of", Gesture::Whole, |light| {
                    if let LightKind::Sky { panorama, .. } = &mut light.kind {
                        *panorama = None;
                    }
                });
            }
        });
        let Some(SkyPanorama { turn, is_shown, .. }) = panorama else { return };
        let hint = "Turns the panorama about the vertical, anticlockwise seen from above";
        let number = Number::new("Turn", hint).speed(1.0).range(-360.0..=360.0).suffix(" deg");
        if let Some((turn, gesture)) = number_row(ui, "Turn", number, *turn) {
            self.set(requests, "Turn of", gesture, |light| of_sky(light, |own| own.turn = turn));
        }
        let hint = "Shows the panorama behind everything; mirrors show it in any case";
        let switch = Switch::new("Background", *is_shown).ui(ui);
        if switch.on_hover_text(hint).clicked() {
            let set = |light: &mut Light| of_sky(light, |own| own.is_shown = !is_shown);
            self.set(requests, "Background of", Gesture::Whole, set);
        }
    }

    fn key_hint(&self) -> String {
        match self.light.slot {
            key @ 0..=9 => format!("Key: {key}"),
            _ => "No key switches this light".to_owned(),
        }
    }

    fn position_ui(&self, ui: &mut Ui, requests: &mut Requests, position: DVec3) {
        let hint = "Position of the light";
        let changed =
            row(ui, "Position", |ui| vector(ui, &Number::new("Position", hint), position));
        if let Some((to, gesture)) = changed {
            let phase = self.state.phase(gesture);
            self.change(requests, "Move", gesture, |scene, _, id| {
                let own = scene.lights.get(id).and_then(own_position).unwrap_or(position);
                placement::light_position(scene, id, to.set_in(own), phase)
            });
        }
    }

    fn direction_ui(&self, ui: &mut Ui, requests: &mut Requests, direction: DVec3) {
        let hint = "Direction of the light; normalised";
        let field = Number::new("Direction", hint).speed(0.01).range(-1.0..=1.0);
        let changed = row(ui, "Direction", |ui| vector(ui, &field, direction));
        if let Some((to, gesture)) = changed {
            let phase = self.state.phase(gesture);
            // All lights get the whole direction: normalising changes each of its coordinates.
            let to = to.set_in(direction);
            self.change(requests, "Turn", gesture, |scene, _, id| {
                placement::light_direction(scene, id, to, phase)
            });
        }
    }

    fn orbit_ui(&self, ui: &mut Ui, requests: &mut Requests, orbit: Orbit) {
        let time = self.state.view.time;
        let of = |scene: &Scene, id| -> Result<Orbit, Refusal> {
            let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
            light.kind.orbit().copied().ok_or(Refusal::NotABulb)
        };
        let hint = "Circles the world's Y axis";
        if Switch::new("Circles", orbit.on).ui(ui).on_hover_text(hint).clicked() {
            self.change(requests, "Circle", Gesture::Whole, |scene, _, id| {
                let to = Orbit { on: !orbit.on, ..of(scene, id)? };
                motion::set_orbit(scene, id, to, time, GesturePhase::First)
            });
        }
        let number = Number::new("Circling speed", "Degrees a second").suffix(" deg/s");
        if let Some((speed, gesture)) = number_row(ui, "Speed", number, orbit.speed) {
            let phase = self.state.phase(gesture);
            self.change(requests, "Circle", gesture, |scene, _, id| {
                motion::set_orbit(scene, id, Orbit { speed, ..of(scene, id)? }, time, phase)
            });
        }
    }

    fn numbers_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        for (row, now) in self.light.kind.numbers() {
            let number = Number::new(row.name, row.hint).speed(row.speed);
            let number = number.range(0.0..=row.most_typed).suffix(row.suffix);
            if let Some((to, gesture)) = number_row(ui, row.label, number, now) {
                self.change(requests, row.step, gesture, |scene, _, id| {
                    lights::set_number(scene, id, row, to)
                });
            }
        }
    }

    /// Shows the choice of the spot's owner.
    fn owner_ui(&self, ui: &mut Ui, requests: &mut Requests, owner: &SpotOwner) {
        let scene = &self.state.scene;
        let mut owners = vec![SpotOwner::SelectedObject, SpotOwner::SelectedCamera];
        owners.extend(scene.objects.ids().map(SpotOwner::Object));
        owners.extend(scene.cameras.ids().map(SpotOwner::Camera));
        let fixed = matches!(owner, SpotOwner::Fixed(_)).then(|| owner.clone());
        owners.push(fixed.unwrap_or_else(lights::fixed));
        row(ui, "Shines from", |ui| {
            let mixed = is_mixed(ui.ctx(), "Owner");
            let now = if mixed { "mixed".to_owned() } else { owner_name(scene, owner) };
            let combo = ComboBox::from_id_salt("owner")
                .selected_text(now)
                .width(ui.available_width())
                .truncate();
            let shown = combo.show_ui(ui, |ui| {
                let size = egui::vec2(1.0, ui.spacing().interact_size.y);
                for to in owners {
                    // Only visible entries are created, since a scene may have many objects.
                    if !ui.is_rect_visible(egui::Rect::from_min_size(ui.cursor().min, size)) {
                        ui.allocate_space(size);
                        continue;
                    }
                    let (name, on) = (owner_name(scene, &to), !mixed && to == *owner);
                    if ui.selectable_label(on, name).clicked() && !on {
                        self.change(requests, "Fix", Gesture::Whole, |scene, view, id| {
                            lights::set_owner(scene, id, own_owner(scene, view, id, &to))
                        });
                    }
                }
            });
            shown.response.accessible_name("Shines from").on_hover_text(
                "The item that the spot is attached to; it shines from there along -Z",
            );
        });
    }

    fn fading_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        ui.weak("1 / (constant + linear d + quadratic d^2)");
        let now = self.light.attenuation;
        let mut set = |label: &str, value: f64, to: &dyn Fn(f64, Attenuation) -> Attenuation| {
            let number = Number::new(label, "At least 0; one of the three above 0");
            let number = number.speed(value.abs().max(1e-6) / 50.0).range(0.0..=1e12);
            if let Some((value, gesture)) = number_row(ui, label, number, value) {
                self.change(requests, "Attenuation of", gesture, |scene, _, id| {
                    let own = scene.lights.get(id).ok_or(Refusal::Gone)?.attenuation;
                    lights::set_attenuation(scene, id, to(value, own))
                });
            }
        };
        set("Constant", now.constant, &|constant, own| Attenuation { constant, ..own });
        set("Linear", now.linear, &|linear, own| Attenuation { linear, ..own });
        set("Quadratic", now.quadratic, &|quadratic, own| Attenuation { quadratic, ..own });
    }
}

/// Changes the panorama of a sky, if it has one.
fn of_sky(light: &mut Light, change: impl FnOnce(&mut SkyPanorama)) {
    if let LightKind::Sky { panorama: Some(own), .. } = &mut light.kind {
        change(own);
    }
}

/// Returns the position of a light that has one of its own.
fn own_position(light: &Light) -> Option<DVec3> {
    match light.kind.anchor() {
        Anchor::Position(position) => Some(*position.now()),
        Anchor::Owner(owner) => owner.fixed().map(|aim| aim.now().position),
        Anchor::Everywhere | Anchor::Direction(_) => None,
    }
}

/// Returns the owner to give to a spot: if `to` is a fixed position, the one that it has now.
fn own_owner(scene: &Scene, view: &View, id: LightId, to: &SpotOwner) -> SpotOwner {
    let owner = scene.lights.get(id).and_then(|light| light.kind.owner());
    match (to, owner) {
        (SpotOwner::Fixed(_), Some(SpotOwner::Fixed(own))) => SpotOwner::Fixed(own.clone()),
        (SpotOwner::Fixed(_), Some(owner)) => scene
            .aim(view, owner)
            .map_or_else(lights::fixed, |aim| SpotOwner::Fixed(Tracked::new(aim))),
        _ => to.clone(),
    }
}

/// Shows a channel of the colour as a slider and a number.
fn channel_ui(ui: &mut Ui, name: &str, keys: &str, value: u8) -> Option<(u8, Gesture)> {
    row(ui, name, |ui| {
        const FIELD: f32 = 46.0;
        let mut to = value;
        let hint = format!("0 to 255; keys {keys}");
        let slid = ui.scope(|ui| {
            ui.spacing_mut().slider_width = ui.available_width() - FIELD - theme::GAP;
            // The handle's size depends on the height.
            ui.spacing_mut().interact_size.y = 15.0;
            ui.add(Slider::new(&mut to, 0..=255).show_value(false))
        });
        let response = slid.inner.accessible_name(name).on_hover_text(&hint);
        let slid = (to != value).then(|| (to, gestures::of(&response)));
        let number = Number::new(format!("{name} as a number"), &hint);
        let number = number.range(0.0..=255.0).speed(0.5).whole();
        let typed = number.ui(ui, FIELD, f64::from(value));
        slid.or(typed.map(|(to, gesture)| (color::byte(to / 255.0), gesture)))
    })
}

fn owner_name(scene: &Scene, owner: &SpotOwner) -> String {
    let named = |name: Option<&String>| name.cloned().unwrap_or_else(|| "nothing".to_owned());
    match owner {
        SpotOwner::SelectedObject => "the selected object".to_owned(),
        SpotOwner::SelectedCamera => "the selected camera".to_owned(),
        SpotOwner::Object(id) => named(scene.objects.get(*id).map(|object| &object.name)),
        SpotOwner::Camera(id) => named(scene.cameras.get(*id).map(|camera| &camera.name)),
        SpotOwner::Fixed(_) => "a fixed position".to_owned(),
    }
}

/// Converts the value of a field for whole numbers.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "kept from 0 to 9999")]
fn whole(number: f64) -> u32 {
    number.clamp(0.0, 9999.0) as u32
}
