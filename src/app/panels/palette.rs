//! The command palette finds actions, items and settings by typed words.
//!
//! It opens with an empty query. The arrow keys move through the results, Enter chooses one, Esc
//! closes the palette.

use egui::{
    Align2, Id, Key, Modal, RichText, ScrollArea, Sense, TextStyle, Ui, UiBuilder, WidgetInfo, vec2,
};

use crate::app::actions::search::{Search, Texts};
use crate::app::actions::{Action, LabRequest, Request, Requests};
use crate::app::input::keyboard::Keyboard;
use crate::app::input::keymap::Keymap;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::color_picker::hexadecimal;
use crate::app::widgets::controls;
use marraztu_core::accuracy::{ACCURACY_PRESETS, AXES, AccuracyPreset};
use marraztu_core::base::color::Color;
use marraztu_core::edit::{Gesture, several};
use marraztu_core::scene::{Command, ItemId, Light, Material, MaterialChoice, Object, PresetId};
use marraztu_io::{EXAMPLES, lessons};

const WIDTH: f32 = 560.0;

/// The maximum number of results.
const MOST: usize = 60;

/// The loss in rank of what cannot be done now.
const UNAVAILABLE: u32 = 300;

/// A result of the search.
struct Entry {
    label: String,
    /// The kind of entry.
    kind: &'static str,
    hint: String,
    key: String,
    on: bool,
    /// The reason why it is not available now, if any.
    refused: Option<String>,
    score: u32,
    request: Request,
}

/// The height of an entry.
const ENTRY: f32 = theme::ROW + 2.0;

pub(crate) fn show(ui: &Ui, state: &State, requests: &mut Requests) {
    let id = Id::unique("palette");
    let room = ui.ctx().content_rect().size();
    let width = WIDTH.min(room.x - 40.0);
    let frame = egui::Frame::popup(&ui.ctx().global_style()).inner_margin(8.0);
    // The palette stays in place, whatever the number of results.
    let area = Modal::default_area(id).anchor(Align2::CENTER_TOP, vec2(0.0, 48.0));
    let before = requests.len();
    let shown = Modal::new(id).area(area).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(width);
        contents(ui, state, requests, (room.y - 120.0).clamp(90.0, 420.0))
    });
    if shown.should_close() || shown.inner {
        forget(ui);
        // It closes before what was chosen is done, which may say something.
        requests.insert(before, Action::Palette.into());
    }
}

fn query_id() -> Id {
    Id::unique("palette: query")
}

/// Clears the query for the next palette.
fn forget(ui: &Ui) {
    ui.data_mut(|data| {
        data.remove_temp::<String>(query_id());
        data.remove_temp::<usize>(query_id());
    });
}

/// Shows the field and the list. Returns whether an entry was chosen.
fn contents(ui: &mut Ui, state: &State, requests: &mut Requests, height: f32) -> bool {
    let id = query_id();
    let first = ui.data(|data| data.get_temp::<String>(id)).is_none();
    let mut query: String = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut chosen: usize = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    // The keys are consumed before the field sees them, where they would move the cursor.
    let (down, up, enter) = ui.input_mut(|input| {
        let mut count = |key| input.count_and_consume_key(egui::Modifiers::NONE, key);
        (count(Key::ArrowDown), count(Key::ArrowUp), count(Key::Enter) > 0)
    });
    let field = egui::TextEdit::singleline(&mut query)
        .id(id.with("field"))
        .hint_text("Search actions, items and settings")
        .align(Align2::LEFT_CENTER)
        .min_size(vec2(0.0, theme::ROW + 4.0))
        .desired_width(f32::INFINITY);
    let response = ui.add(field).accessible_name("Search everything");
    if first || !response.has_focus() {
        response.request_focus();
    }
    if response.changed() {
        chosen = 0;
    }
    let entries = found(&Keyboard::keymap(ui.ctx()), state, &query);
    let last = entries.len().saturating_sub(1);
    chosen = (chosen + down).saturating_sub(up).min(last);
    ui.data_mut(|data| {
        data.insert_temp(id, query);
        data.insert_temp(id, chosen);
    });
    ui.add_space(theme::GAP);
    let mut clicked = None;
    // The list is only as high as its results.
    let rows = if entries.is_empty() { 2 } else { entries.len().min(99) };
    let rows = u16::try_from(rows).unwrap_or(99);
    let height = height.min(f32::from(rows) * ENTRY);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let mut list = ui.new_child(UiBuilder::new().id_salt("found").max_rect(rect));
    let area = ScrollArea::vertical().auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(&mut list, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (i, entry) in entries.iter().enumerate() {
            let response = entry.ui(ui, i == chosen);
            if i == chosen && (down > 0 || up > 0) {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                clicked = Some(i);
            }
        }
        if entries.is_empty() {
            ui.weak("No match. Try another word, a key, or a colour such as #ff8000.");
        }
    });
    let Some(entry) = clicked.or(enter.then_some(chosen)).and_then(|at| entries.get(at)) else {
        return false;
    };
    requests.push(match &entry.refused {
        Some(why) => Request::Refuse(why.clone()),
        None => entry.request.clone(),
    });
    true
}

/// Lists all matching entries, best first.
fn found(keymap: &Keymap, state: &State, query: &str) -> Vec<Entry> {
    let mut search = Search::new(query);
    let mut entries = Vec::new();
    for action in Action::ALL.iter().copied().filter(|action| *action != Action::Palette) {
        let keys = keymap.keys(action);
        let Some(score) = action.score(keys, &mut search, query) else { continue };
        let info = action.info();
        entries.push(Entry {
            label: info.label.to_owned(),
            kind: info.group.label(),
            hint: info.hint.to_owned(),
            key: keys.first().map(|key| key.name()).unwrap_or_default(),
            on: action.is_on(state) == Some(true),
            refused: action.availability(state).err(),
            score,
            request: action.into(),
        });
    }
    items(state, &mut search, &mut entries);
    // Without a query, only actions are listed.
    if !search.is_empty() {
        settings(state, &mut search, &mut entries);
        materials(state, &mut search, &mut entries);
        for (name, color) in Color::NAMED.into_iter().filter(|(name, _)| *name != "grey") {
            let words =
                if name == "gray" { "colour color paint grey" } else { "colour color paint" };
            let score = |label: &str| search.score(Texts { label, words, hint: "" });
            colors(state, (name, color), score, &mut entries);
        }
    }
    if let Some(color) = hexadecimal(query).filter(|_| query.trim().starts_with('#')) {
        let Color([r, g, b]) = color;
        let written = format!("#{r:02x}{g:02x}{b:02x}");
        colors(state, (&written, color), |_| Some(u32::MAX), &mut entries);
    }
    // What cannot be done now ranks below other matches of its kind.
    let rank = |entry: &Entry| match entry.refused {
        None => entry.score,
        Some(_) => entry.score.saturating_sub(UNAVAILABLE),
    };
    entries.sort_by_key(|entry| std::cmp::Reverse(rank(entry)));
    entries.truncate(MOST);
    entries
}

fn items(state: &State, search: &mut Search, entries: &mut Vec<Entry>) {
    let scene = &state.scene;
    let objects = scene.objects.iter().map(|(id, it)| (ItemId::Object(id), &it.name, "Object"));
    let cameras = scene.cameras.iter().map(|(id, it)| (ItemId::Camera(id), &it.name, "Camera"));
    let lights = scene.lights.iter().map(|(id, it)| (ItemId::Light(id), &it.name, "Light"));
    for (id, name, kind) in objects.chain(cameras).chain(lights) {
        if search.is_empty() {
            return;
        }
        let texts = Texts { label: name, words: "select", hint: "" };
        let Some(score) = search.score(texts) else { continue };
        entries.push(Entry {
            label: name.clone(),
            kind,
            hint: "Selects it.".to_owned(),
            key: String::new(),
            on: state.selected() == Some(id),
            refused: None,
            // Items rank before actions with equal matches, as the user chose their names to find
            // them.
            score: score + 50,
            request: Request::Select(id),
        });
    }
}

/// Adds the materials for the selected objects.
fn materials(state: &State, search: &mut Search, entries: &mut Vec<Entry>) {
    let Some(ItemId::Object(id)) = state.selected() else { return };
    let Some(object) = state.scene.objects.get(id) else { return };
    let presets = PresetId::all().map(|id| (id.get().name, MaterialChoice::Preset(id)));
    let own = MaterialChoice::Own(object.part_look(0).material);
    let is_own = matches!(object.material, MaterialChoice::Own(_));
    let others = [("the file's own", MaterialChoice::File), ("your own", own)];
    for (name, to) in presets.chain(others) {
        let label = format!("Material: {name}");
        let texts = Texts { label: &label, words: "surface shader look custom", hint: "" };
        let Some(score) = search.score(texts) else { continue };
        let on = object.material == to || (is_own && matches!(to, MaterialChoice::Own(_)));
        let hint = "Applies it to the selected object.".to_owned();
        let what = format!("Material of {}", state.acted_on_name());
        let request = of_objects(state, what, |object| object.material = to.clone());
        let (kind, key, refused) = ("Material", String::new(), None);
        entries.push(Entry { label, kind, hint, key, on, refused, score, request });
    }
}

fn of_objects(state: &State, label: String, change: impl Fn(&mut Object)) -> Request {
    let command = several::change_objects(&state.scene, &state.view, &state.others(), change);
    Request::change(label, Gesture::Whole, command)
}

/// Adds everything that can get a colour, written as `#ff8000` or by its name.
fn colors(
    state: &State,
    (written, color): (&str, Color),
    mut score: impl FnMut(&str) -> Option<u32>,
    entries: &mut Vec<Entry>,
) {
    let mut add = |what: String, hint: &str, request: &dyn Fn(String) -> Request| {
        let (label, hint) = (format!("{what}: {written}"), hint.to_owned());
        let Some(score) = score(&label) else { return };
        let (kind, key, on, refused) = ("Colour", String::new(), false, None);
        let request = request(what);
        entries.push(Entry { label, kind, hint, key, on, refused, score, request });
    };
    let name = state.acted_on_name();
    match state.selected() {
        Some(ItemId::Object(_)) => {
            let paint = |object: &mut Object| {
                // Highlights stay as they are; ambient light follows the new colour.
                let Material { specular, exponent, .. } = object.part_look(0).material;
                let diffuse = color.factors();
                let ambient = diffuse.map(|part| 0.2 * part);
                let own = Material { specular, exponent, ..Material::matte(ambient, diffuse) };
                object.material = MaterialChoice::Own(own);
            };
            let hint = "Gives it a custom material in this colour.";
            add(format!("Colour of {name}"), hint, &|what| of_objects(state, what, paint));
        }
        Some(ItemId::Light(_)) => {
            let hint = "Sets the light to this colour.";
            add(format!("Colour of {name}"), hint, &|what| {
                let (view, others) = (&state.view, state.others());
                let set = |light: &mut Light| light.color = color;
                let command = several::change_lights(&state.scene, view, &others, set);
                Request::change(what, Gesture::Whole, command)
            });
        }
        Some(ItemId::Camera(_)) | None => {}
    }
    add("Background".to_owned(), "Sets the background to this colour.", &|_| {
        Request::change("Set the background", Gesture::Whole, Ok(Command::Background(color)))
    });
}

fn settings(state: &State, search: &mut Search, entries: &mut Vec<Entry>) {
    let now = state.settings;
    let mut add = |label: String, words: &str, kind, hint: &str, on, request| {
        if let Some(score) = search.score(Texts { label: &label, words, hint }) {
            let (hint, key, refused) = (hint.to_owned(), String::new(), None);
            entries.push(Entry { label, kind, hint, key, on, refused, score, request });
        }
    };
    // The presets of the dial are actions.
    for preset in &ACCURACY_PRESETS[AccuracyPreset::dial().len()..] {
        let to = preset.of(&now);
        let label = format!("Accuracy: {}", preset.label);
        add(label, "quality preset", "Setting", preset.what, to == now, Request::Settings(to));
    }
    for lesson in lessons() {
        let show = Request::Lab(LabRequest::ShowLesson(&lesson.axis));
        let label = format!("Lesson: {}", lesson.title);
        let words = format!("learn help {}", lesson.words);
        add(label, &words, "Lesson", &lesson.why, false, show);
    }
    for axis in AXES {
        // The words of its lesson are those of its choices, too.
        let words = lessons().iter().find(|lesson| lesson.axis == axis.key);
        let words = words.map_or("", |lesson| lesson.words.as_str());
        let words = format!("accuracy quality {words}");
        for choice in axis.choices {
            let label = format!("{}: {}", axis.label, choice.label);
            let to = Request::Settings(choice.of(&now));
            add(label, &words, "Setting", choice.what, choice.is(&now), to);
        }
    }
    for example in EXAMPLES {
        let open = Request::LoadFiles(vec![example.path.into()]);
        let label = format!("Example: {}", example.title);
        add(label, "open sample demo", "Example", "Opens it in place of this scene.", false, open);
    }
}

impl Entry {
    fn ui(&self, ui: &mut Ui, chosen: bool) -> egui::Response {
        let enabled = self.refused.is_none();
        let size = vec2(ui.available_width(), ENTRY);
        // The entry takes no focus, so the field keeps the keyboard while the arrow keys move.
        let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK);
        response.widget_info(|| {
            WidgetInfo::selected(egui::Role::ListBoxOption, enabled, chosen, &self.label)
        });
        let visuals = ui.visuals();
        let mut color = controls::text_color(ui, enabled);
        let mut weak = visuals.weak_text_color();
        if chosen {
            ui.painter().rect_filled(rect, 4.0, visuals.selection.bg_fill);
            let bar = rect.with_max_x(rect.left() + 3.0).shrink2(vec2(0.0, 3.0));
            ui.painter().rect_filled(bar, 1.5, theme::accent(visuals));
            color = visuals.selection.stroke.color;
            weak = color;
        } else if response.hovered() {
            ui.painter().rect_filled(rect, 4.0, visuals.widgets.inactive.bg_fill);
        }
        // From the right: the key, the kind, and the hint if there is space.
        let mut right = rect.right() - 6.0;
        if !self.key.is_empty() {
            let at = egui::pos2(right, rect.center().y);
            right = controls::key_cap(ui, at, &self.key, enabled) - 6.0;
        }
        let text = |text: RichText, width| controls::text(ui, text, TextStyle::Body, width);
        let kind = text(RichText::new(self.kind).small(), 90.0);
        right -= kind.size().x;
        controls::put_text(ui, rect.with_min_x(right), kind, weak);
        let left = rect.left() + 10.0;
        let room = right - theme::GAP - left;
        let state = if self.on { "  (on)" } else { "" };
        let label = text(RichText::new(format!("{}{state}", self.label)), room);
        let end = left + label.size().x + 12.0;
        controls::put_text(ui, rect.with_min_x(left), label, color);
        let said = match &self.refused {
            Some(why) => format!("Unavailable: {why}."),
            None => self.hint.clone(),
        };
        if right - 12.0 - end > 60.0 {
            let hint = text(RichText::new(&said).small(), right - 12.0 - end);
            controls::put_text(ui, rect.with_min_x(end), hint, weak);
        }
        response.on_hover_text(said)
    }
}
