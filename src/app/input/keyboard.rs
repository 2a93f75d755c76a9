//! The keyboard: decides which keys belong to the viewport, and which actions they trigger.
//!
//! Keys are read before egui sees them. Keys of the viewport (Tab, Enter, Esc, arrows) therefore
//! never move the focus or click a button, even if the viewport gets the focus in the same frame.
//! While text is edited, a menu is open, or a control of a panel has the focus, these keys are left
//! to egui.
//!
//! A slow frame may bring many keys at once. All keys of a frame have the same owner, so what
//! follows a key that moves the focus, or opens a field, waits for a later frame.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Context, Event, Id, Key, Modifiers, RawInput, ViewportCommand};

use super::keymap::{Keymap, chord_of};
use crate::app::actions::{Action, Chord, Group};
use crate::app::panels::Panel;
use crate::app::widgets::gestures;
use crate::app::widgets::regions::{self, Way};
use marraztu_core::edit::Gesture;

/// A key press that triggers an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Press {
    /// The action.
    pub(crate) action: Action,
    /// The gesture. It lasts from the press of a key to its release.
    pub(crate) gesture: Gesture,
}

/// Reads the keys of one [`Context`].
#[derive(Debug, Default)]
pub(crate) struct Keyboard {
    viewport: Option<Id>,
    /// The use of letters and numbers over the viewport.
    letters: Letters,
    /// The text typed in mode [`Letters::Type`], with Enter as a line feed and Backspace as itself.
    typed: String,
    /// Whether the last text was typed for a handle and not followed by Enter. If the release of
    /// the mouse has ended the amount, Enter confirms what is already done.
    unconfirmed: bool,
    /// The keys that are down, with what each of them was pressed for.
    down: BTreeMap<Key, Use>,
    /// The key of the last event of the clipboard, until some key is released: which key stood for
    /// it is unknown, as layouts differ and Shift+Insert pastes on Windows.
    clipboard_down: Option<Key>,
    /// Whether Alt is down: typed text may then belong to a menu or another layer of the layout.
    alt: bool,
    /// Whether the last key event was a repetition by a held key; its text event follows.
    last_was_repeat: bool,
    presses: u64,
    /// Whether an Esc was pressed for something else than the viewport.
    escaped: bool,
    waiting: Vec<Press>,
    keymap: Arc<Keymap>,
    pasted: Option<String>,
    /// Whether the text of the clipboard was requested from the window.
    asks_paste: bool,
    /// The action that waits for a key, and the key once it was pressed.
    choosing: Option<(Action, Option<Chord>)>,
    /// The events that wait for a later frame.
    later: Vec<Event>,
    /// The number of frames in which a field may still get the focus that a key has opened. Keys
    /// wait for it.
    opening: u8,
    /// Whether the text of the key that opens it has not arrived yet.
    awaits_own_text: bool,
}

/// The frames from the key of an action to the focus of the field that it opens: in the next one
/// the field is shown, and in the one after it has the focus.
const OPENING: u8 = 3;

/// Returns whether an action opens a field for text.
const fn opens_field(action: Action) -> bool {
    matches!(
        action,
        Action::Palette
            | Action::Rename
            | Action::Load
            | Action::Open
            | Action::SaveAs
            | Action::SavePicture
            | Action::PictureOptions
            | Action::SaveTurntable
            | Action::ExportModels
            | Action::ExportScene
            | Action::ChooseTexture
            | Action::ChoosePanorama
            | Action::Panel(Panel::CheatSheet)
    )
}

impl Keyboard {
    /// Ensures that `ctx` has a keyboard.
    pub(crate) fn install(ctx: &Context) {
        let _ = ctx.plugin_or_default::<Self>();
    }

    /// Sets the widget of the viewport and the use of letters there.
    pub(crate) fn set_viewport(ctx: &Context, viewport: Id, letters: Letters) {
        let handle = ctx.plugin_or_default::<Self>();
        let mut keyboard = handle.lock();
        (keyboard.viewport, keyboard.letters) = (Some(viewport), letters);
        drop(keyboard);
        regions::go_further(ctx, viewport);
    }

    /// Returns whether an Esc has closed a dialog, a menu or a field since the last call.
    pub(crate) fn take_escaped(ctx: &Context) -> bool {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().escaped)
    }

    /// Lets the next keys form an amount, even those that arrive before the next frame.
    pub(crate) fn begin_typing(ctx: &Context) {
        ctx.plugin_or_default::<Self>().lock().letters = Letters::Type;
    }

    /// Takes the text typed for a handle since the last call.
    pub(crate) fn take_typed(ctx: &Context) -> String {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().typed)
    }

    /// Returns the keys of all actions.
    pub(crate) fn keymap(ctx: &Context) -> Arc<Keymap> {
        Arc::clone(&ctx.plugin_or_default::<Self>().lock().keymap)
    }

    /// Changes the keys of actions.
    pub(crate) fn set_keymap(ctx: &Context, keymap: Keymap) {
        ctx.plugin_or_default::<Self>().lock().keymap = Arc::new(keymap);
    }

    /// Returns the action that waits for a key, and the key once it was pressed.
    pub(crate) fn choosing(ctx: &Context) -> Option<(Action, Option<Chord>)> {
        ctx.plugin_or_default::<Self>().lock().choosing
    }

    /// Starts or stops waiting for a key of an action.
    pub(crate) fn choose_for(ctx: &Context, action: Option<Action>) {
        ctx.plugin_or_default::<Self>().lock().choosing = action.map(|action| (action, None));
    }

    /// Takes the presses since the last call, in order.
    pub(crate) fn take(ctx: &Context) -> Vec<Press> {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().waiting)
    }

    /// Takes the text pasted since the last call.
    pub(crate) fn take_pasted(ctx: &Context) -> Option<String> {
        ctx.plugin_or_default::<Self>().lock().pasted.take()
    }

    /// Requests the text of the clipboard from the window; it is pasted when it arrives.
    pub(crate) fn ask_paste(ctx: &Context) {
        ctx.plugin_or_default::<Self>().lock().asks_paste = true;
        ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
    }

    /// Moves the focus to the next or previous region; after the last or before the first, to the
    /// viewport.
    pub(crate) fn change_owner(ctx: &Context, way: Way) {
        let viewport = ctx.plugin_or_default::<Self>().lock().viewport;
        if let Some(viewport) = viewport {
            regions::go(ctx, viewport, way);
        }
    }

    fn whose(&self, ctx: &Context) -> Owner {
        let focused = ctx.memory(|memory| memory.focused());
        if ctx.memory(|memory| memory.top_modal_layer().is_some()) {
            Owner::Modal
        } else if ctx.text_edit_focused() {
            Owner::Text
        } else if egui::Popup::is_any_open(ctx)
            || focused.is_some_and(|id| Some(id) != self.viewport)
        {
            Owner::Panel
        } else {
            Owner::Viewport
        }
    }

    /// Handles a key press. Returns whether the viewport keeps the key from egui.
    fn key(&mut self, owner: Owner, key: Key, modifiers: Modifiers, repeat: bool) -> bool {
        self.last_was_repeat = repeat;
        self.escaped |= key == Key::Escape && owner != Owner::Viewport;
        // Typed amounts use Enter and Backspace, which trigger no action then.
        let types = self.letters == Letters::Type && owner == Owner::Viewport;
        if types && matches!(key, Key::Enter | Key::Backspace) {
            self.typed.push(if key == Key::Enter { '\n' } else { '\u{8}' });
            self.unconfirmed = key != Key::Enter;
            return true;
        }
        let ends = !types || key == Key::Escape;
        if ends && std::mem::take(&mut self.unconfirmed) && key == Key::Enter {
            return true;
        }
        let chord = |chord: &Chord| chord.is_pressed_by(key, modifiers);
        self.ask(owner, chord);
        let own = matches!(
            key,
            Key::Escape
                | Key::Enter
                | Key::ArrowUp
                | Key::ArrowDown
                | Key::ArrowLeft
                | Key::ArrowRight
        ) || (key == Key::Tab && !modifiers.shift);
        own && owner == Owner::Viewport
    }

    /// Handles the events that the window system sends instead of Ctrl+X, Ctrl+C and Ctrl+V.
    fn clipboard(&mut self, owner: Owner, event: &Event) {
        let Some(key) = clipboard_key(event) else { return };
        if let Event::Paste(text) = event {
            let acts = matches!(owner, Owner::Viewport | Owner::Panel);
            self.pasted = Some(text.clone()).filter(|_| acts);
            if std::mem::take(&mut self.asks_paste) && acts {
                // The paste was requested by the action, whatever its key.
                self.waiting.push(Press { action: Action::Paste, gesture: Gesture::Whole });
                return;
            }
        }
        // The release arrives as a usual key event.
        let repeats = self.clipboard_down.replace(key) == Some(key);
        self.key(owner, key, Modifiers::COMMAND, repeats);
    }

    /// Triggers the action with a fitting chord, if its owner allows it.
    fn ask(&mut self, owner: Owner, fits: impl Fn(&Chord) -> bool) {
        let keymap = Arc::clone(&self.keymap);
        let fitting = |action: &Action| keymap.keys(*action).iter().copied().find(|key| fits(key));
        let found = Action::ALL.iter().find_map(|action| Some((*action, fitting(action)?)));
        let Some((action, chord)) = found else { return };
        let info = action.info();
        let acts = match owner {
            Owner::Viewport => self.letters == Letters::Act || chord == Chord::Named(Key::Escape),
            Owner::Panel => chord.is_global(),
            // A text field has an undo stack for its text.
            Owner::Text => chord.is_global() && info.group != Group::Edit,
            // The program can be closed before its dialog.
            Owner::Modal => action == Action::Quit,
        };
        if !acts || (self.last_was_repeat && !info.repeats) {
            return;
        }
        if !self.last_was_repeat {
            self.presses += 1;
        }
        let gesture = match info.repeats {
            true => gestures::numbered(self.presses, "key"),
            false => Gesture::Whole,
        };
        if opens_field(action) {
            self.opening = OPENING;
        }
        self.waiting.push(Press { action, gesture });
    }
}

const fn clipboard_key(event: &Event) -> Option<Key> {
    match event {
        Event::Cut => Some(Key::X),
        Event::Copy => Some(Key::C),
        Event::Paste(_) => Some(Key::V),
        _ => None,
    }
}

/// The use of letters and numbers over the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Letters {
    /// They trigger actions.
    #[default]
    Act,
    /// They steer the camera.
    Steer,
    /// They form an amount for a handle.
    Type,
}

/// Who gets a key, and what letters are for.
type Use = (Owner, Letters);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    Viewport,
    Panel,
    Text,
    Modal,
}

impl egui::Plugin for Keyboard {
    fn debug_name(&self) -> &'static str {
        "keyboard"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let owner = self.whose(ctx);
        let mut events = std::mem::take(&mut self.later);
        events.append(&mut input.events);
        input.events = events;
        // Keys wait for a field to get the focus, but not for long: the action may have been
        // refused.
        self.opening = if owner == Owner::Viewport { self.opening.saturating_sub(1) } else { 0 };
        if self.opening > 0 {
            let first = input.events.iter().position(|event| match event {
                Event::Text(_) => !std::mem::take(&mut self.awaits_own_text),
                other => is_pressed(other),
            });
            self.later = input.events.split_off(first.unwrap_or(input.events.len()));
            ctx.request_repaint();
        }
        // While a key is chosen, the first press is taken as the choice.
        if let Some((_, chosen @ None)) = &mut self.choosing {
            let pressed = input.events.iter().find_map(|event| match event {
                Event::Key { key, pressed: true, modifiers, .. } => Some((*key, *modifiers)),
                event => clipboard_key(event).map(|key| (key, Modifiers::COMMAND)),
            });
            match pressed {
                Some((Key::Escape, _)) => self.choosing = None,
                Some((key, modifiers)) => *chosen = chord_of(key, modifiers),
                None => {}
            }
            // Keys pressed during the choice neither trigger actions nor type text.
            let is_key = |event: &Event| matches!(event, Event::Key { .. } | Event::Text(_));
            input.events.retain(|event| !is_key(event) && clipboard_key(event).is_none());
        }
        let mut typed = false;
        let mut events = std::mem::take(&mut input.events).into_iter().peekable();
        while let Some(event) = events.next_if(|event| !typed || !is_tab(event, owner)) {
            typed |= is_pressed(&event);
            let moves = moves_focus(&event, owner);
            if self.take_event(ctx, owner, &event) {
                input.events.push(event);
            }
            if moves || self.opening == OPENING {
                // The text of the same key belongs to it.
                let text = events.next_if(|event| matches!(event, Event::Text(_)));
                self.awaits_own_text = text.is_none();
                let text = text.filter(|text| self.take_event(ctx, owner, text));
                input.events.extend(text);
                break;
            }
        }
        let rest: Vec<Event> = events.collect();
        if !rest.is_empty() {
            self.later.splice(0..0, rest);
            ctx.request_repaint();
        }
    }
}

/// Returns whether an event is a key press, or typed or pasted text.
fn is_pressed(event: &Event) -> bool {
    matches!(event, Event::Key { pressed: true, .. } | Event::Text(_) | Event::Paste(_))
}

/// Returns whether an event is a press of Tab that moves the focus: before the other events of its
/// frame arrive anywhere.
fn is_tab(event: &Event, owner: Owner) -> bool {
    owner != Owner::Viewport && matches!(event, Event::Key { key: Key::Tab, pressed: true, .. })
}

/// Returns whether a key press moves the focus, or ends a field.
fn moves_focus(event: &Event, owner: Owner) -> bool {
    let ends = matches!(event, Event::Key { key: Key::Enter | Key::Escape, pressed: true, .. });
    is_tab(event, owner) || (ends && owner != Owner::Viewport)
}

impl Keyboard {
    /// Handles an event. Returns whether egui sees it: the keys of the viewport are not for egui.
    fn take_event(&mut self, ctx: &Context, owner: Owner, event: &Event) -> bool {
        match event {
            Event::Key { key, physical_key, pressed: true, modifiers, repeat } => {
                let now = (owner, self.letters);
                let held = self.down.insert(physical_key.unwrap_or(*key), now);
                // A held key that has ended its field or its amount does not act in the viewport.
                let moved =
                    |before: &Use| *before != now && [before.0, owner].contains(&Owner::Viewport);
                if let Some(before) = held.filter(moved) {
                    self.down.insert(physical_key.unwrap_or(*key), before);
                    self.last_was_repeat = true;
                    return false;
                }
                !self.key(owner, *key, *modifiers, *repeat || held.is_some())
            }
            Event::Key { key, physical_key, pressed: false, .. } => {
                self.down.remove(&physical_key.unwrap_or(*key));
                self.clipboard_down = None;
                true
            }
            Event::Text(text) => {
                if self.letters == Letters::Type && owner == Owner::Viewport {
                    self.typed.push_str(text);
                    self.unconfirmed = true;
                } else if !self.alt {
                    self.ask(owner, |chord| matches!(chord, Chord::Text(sign) if sign == text));
                }
                true
            }
            Event::Cut | Event::Copy | Event::Paste(_) => {
                self.clipboard(owner, event);
                true
            }
            Event::ModifiersChanged(modifiers) => {
                self.alt = modifiers.alt;
                true
            }
            Event::WindowFocused(_) => {
                self.down.clear();
                self.clipboard_down = None;
                true
            }
            Event::PointerButton { pressed: true, .. } => {
                self.unconfirmed = false;
                gestures::count_press(ctx);
                true
            }
            _ => true,
        }
    }
}
