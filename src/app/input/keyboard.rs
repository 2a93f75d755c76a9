//! The keyboard: which keys belong to the viewport, and the actions they press.
//!
//! The keys are read before egui sees them: what the viewport owns (Tab, Enter, Esc, arrows) never
//! moves the focus or clicks a button, not even in the frame in which the viewport gets the
//! keyboard. While text is edited, a menu is open, or a panel's control has the keyboard, they stay
//! egui's.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Context, Event, Id, Key, Modifiers, RawInput, ViewportCommand};

use super::keymap::{Keymap, chord_of};
use crate::app::actions::{Action, Chord, Group};
use crate::app::widgets::gestures;
use crate::app::widgets::regions::{self, Way};
use marraztu_core::edit::Gesture;

/// A press of a key that asks for something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// What it asks for.
    pub action: Action,
    /// The key.
    pub chord: Chord,
    /// A held key is one gesture, from its press until it is let go.
    pub gesture: Gesture,
}

/// Reads the keys; one lives in each [`Context`].
#[derive(Debug, Default)]
pub(crate) struct Keyboard {
    viewport: Option<Id>,
    /// What letters and numbers do over the viewport.
    letters: Letters,
    /// What was typed while they are [`Letters::Type`]; Enter is a new line, Backspace itself.
    typed: String,
    down: BTreeSet<Key>,
    /// While Alt is down, typed text may belong to a menu or another layer of the layout.
    alt: bool,
    /// Whether the last key event was sent by a held key: its text follows it.
    last_was_repeat: bool,
    presses: u64,
    waiting: Vec<Press>,
    /// Whether the last thing that was pressed was Esc, and closed or left something.
    left_by_escape: bool,
    /// Whether an Esc was held back since this was last asked.
    held_escape: bool,
    keymap: Arc<Keymap>,
    /// The text that was pasted.
    pasted: Option<String>,
    /// Whether the window was asked for the text of the clipboard.
    asks_paste: bool,
    /// The action that the next key is chosen for, and that key.
    choosing: Option<(Action, Option<Chord>)>,
}

impl Keyboard {
    /// Sees to it that `ctx` has one.
    pub(crate) fn install(ctx: &Context) {
        let _ = ctx.plugin_or_default::<Self>();
    }

    /// Tells it which widget is the viewport, and what letters do there.
    pub(crate) fn set_viewport(ctx: &Context, viewport: Id, letters: Letters) {
        let handle = ctx.plugin_or_default::<Self>();
        let mut keyboard = handle.lock();
        (keyboard.viewport, keyboard.letters) = (Some(viewport), letters);
        drop(keyboard);
        regions::go_further(ctx, viewport);
    }

    /// What was typed for a handle since this was last asked.
    pub(crate) fn take_typed(ctx: &Context) -> String {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().typed)
    }

    /// The keys of all actions.
    pub(crate) fn keymap(ctx: &Context) -> Arc<Keymap> {
        Arc::clone(&ctx.plugin_or_default::<Self>().lock().keymap)
    }

    /// Gives actions other keys.
    pub(crate) fn set_keymap(ctx: &Context, keymap: Keymap) {
        ctx.plugin_or_default::<Self>().lock().keymap = Arc::new(keymap);
    }

    /// The action that the next key is chosen for, and that key once it was pressed.
    pub(crate) fn choosing(ctx: &Context) -> Option<(Action, Option<Chord>)> {
        ctx.plugin_or_default::<Self>().lock().choosing
    }

    /// Lets the next key be chosen for an action, or no longer.
    pub(crate) fn choose_for(ctx: &Context, action: Option<Action>) {
        ctx.plugin_or_default::<Self>().lock().choosing = action.map(|action| (action, None));
    }

    /// What was pressed since it was last asked, in order.
    pub(crate) fn take(ctx: &Context) -> Vec<Press> {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().waiting)
    }

    /// The text that was pasted since this was last asked.
    pub(crate) fn take_pasted(ctx: &Context) -> Option<String> {
        ctx.plugin_or_default::<Self>().lock().pasted.take()
    }

    /// Asks the window for the text of the clipboard; it is pasted when it comes.
    pub(crate) fn ask_paste(ctx: &Context) {
        ctx.plugin_or_default::<Self>().lock().asks_paste = true;
        ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
    }

    /// Whether an Esc was held back: it came after one that closed or left something. Whoever
    /// presses it twice there does not mean to leave the program.
    pub(crate) fn take_held_escape(ctx: &Context) -> bool {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().held_escape)
    }

    /// Notes that an Esc closed something.
    pub(crate) fn note_escape(ctx: &Context) {
        ctx.plugin_or_default::<Self>().lock().left_by_escape = true;
    }

    /// From region to region, and to the viewport after the last or before the first.
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

    /// Notes a key, and says whether the viewport keeps it from egui.
    fn key(&mut self, owner: Owner, key: Key, modifiers: Modifiers, repeat: bool) -> bool {
        self.last_was_repeat = repeat;
        let left_by_escape = std::mem::take(&mut self.left_by_escape);
        if key == Key::Escape {
            self.left_by_escape = owner != Owner::Viewport;
            if left_by_escape && owner == Owner::Viewport {
                self.held_escape = true;
                return true;
            }
        }
        let types = self.letters == Letters::Type && owner == Owner::Viewport;
        if types && matches!(key, Key::Enter | Key::Backspace) {
            self.typed.push(if key == Key::Enter { '\n' } else { '\u{8}' });
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

    /// Takes the events that the window system sends in place of Ctrl+X, Ctrl+C and Ctrl+V.
    fn clipboard(&mut self, owner: Owner, event: &Event) {
        let Some(key) = clipboard_key(event) else { return };
        if let Event::Paste(text) = event {
            let acts = matches!(owner, Owner::Viewport | Owner::Panel);
            self.pasted = Some(text.clone()).filter(|_| acts);
            if std::mem::take(&mut self.asks_paste) && acts {
                // It answers the action, whatever key that is on.
                let (action, chord) = (Action::Paste, Chord::Command(key));
                self.waiting.push(Press { action, chord, gesture: Gesture::Whole });
                return;
            }
        }
        // The release of the key comes as usual.
        let repeats = !self.down.insert(key);
        self.key(owner, key, Modifiers::COMMAND, repeats);
    }

    /// Asks for the action whose chord fits, if it may act.
    fn ask(&mut self, owner: Owner, fits: impl Fn(&Chord) -> bool) {
        let keymap = Arc::clone(&self.keymap);
        let fitting = |action: &Action| keymap.keys(*action).iter().copied().find(|key| fits(key));
        let found = Action::ALL.iter().find_map(|action| Some((*action, fitting(action)?)));
        let Some((action, chord)) = found else { return };
        let info = action.info();
        let acts = match owner {
            Owner::Viewport => self.letters == Letters::Act || chord == Chord::Named(Key::Escape),
            Owner::Panel => chord.is_global(),
            // A text field has an undo of its own.
            Owner::Text => chord.is_global() && info.group != Group::Edit,
            Owner::Modal => false,
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
        self.waiting.push(Press { action, chord, gesture });
    }
}

/// The key of a clipboard event.
const fn clipboard_key(event: &Event) -> Option<Key> {
    match event {
        Event::Cut => Some(Key::X),
        Event::Copy => Some(Key::C),
        Event::Paste(_) => Some(Key::V),
        _ => None,
    }
}

/// What letters and numbers do over the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Letters {
    /// They ask for actions.
    #[default]
    Act,
    /// They steer, and ask for nothing.
    Steer,
    /// They are an amount for a handle, and ask for nothing.
    Type,
}

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
            // What is chosen presses nothing and types nothing.
            let is_key = |event: &Event| matches!(event, Event::Key { .. } | Event::Text(_));
            input.events.retain(|event| !is_key(event) && clipboard_key(event).is_none());
        }
        input.events.retain(|event| match event {
            Event::Key { key, physical_key, pressed: true, modifiers, repeat } => {
                let held = !self.down.insert(physical_key.unwrap_or(*key));
                !self.key(owner, *key, *modifiers, *repeat || held)
            }
            Event::Key { key, physical_key, pressed: false, .. } => {
                self.down.remove(&physical_key.unwrap_or(*key));
                true
            }
            Event::Text(text) => {
                if self.letters == Letters::Type && owner == Owner::Viewport {
                    self.typed.push_str(text);
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
                true
            }
            Event::PointerButton { pressed: true, .. } => {
                self.left_by_escape = false;
                gestures::count_press(ctx);
                true
            }
            _ => true,
        });
    }
}
