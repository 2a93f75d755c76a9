//! The keyboard: which keys belong to the viewport, and the actions they press.
//!
//! The keys are read before egui sees them: what the viewport owns (Tab, Enter, Esc, arrows) never
//! moves the focus or clicks a button, not even in the frame in which the viewport gets the
//! keyboard. While text is edited, a menu is open, or a panel's control has the keyboard, they stay
//! egui's.

use std::collections::BTreeSet;

use egui::{Context, Event, Id, Key, Modifiers, RawInput};

use crate::app::actions::{Action, Chord, Group};
use crate::app::widgets::gestures;
use crate::app::widgets::regions::{self, Way};
use crate::edit::Gesture;

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
    /// While the viewport flies, letters steer and ask for nothing.
    steering: bool,
    down: BTreeSet<Key>,
    /// While Alt is down, typed text may belong to a menu or another layer of the layout.
    alt: bool,
    /// Whether the last key event was sent by a held key: its text follows it.
    last_was_repeat: bool,
    presses: u64,
    waiting: Vec<Press>,
    /// Whether the last thing that was pressed was Esc, to leave a menu, a panel or a dialog.
    left_by_escape: bool,
    /// Whether an Esc was held back since this was last asked.
    held_escape: bool,
}

impl Keyboard {
    /// Sees to it that `ctx` has one.
    pub(crate) fn install(ctx: &Context) {
        let _ = ctx.plugin_or_default::<Self>();
    }

    /// Tells it which widget is the viewport, and whether letters steer it.
    pub(crate) fn set_viewport(ctx: &Context, viewport: Id, steering: bool) {
        let handle = ctx.plugin_or_default::<Self>();
        let mut keyboard = handle.lock();
        (keyboard.viewport, keyboard.steering) = (Some(viewport), steering);
    }

    /// What was pressed since it was last asked, in order.
    pub(crate) fn take(ctx: &Context) -> Vec<Press> {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().waiting)
    }

    /// Whether an Esc was held back: it came after one that closed a menu or left a panel. Whoever
    /// presses it twice there does not mean to leave the program.
    pub(crate) fn take_held_escape(ctx: &Context) -> bool {
        std::mem::take(&mut ctx.plugin_or_default::<Self>().lock().held_escape)
    }

    /// Notes that an Esc closed something that is no question.
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
        self.last_was_repeat = repeat || !self.down.insert(key);
        let left_by_escape = std::mem::take(&mut self.left_by_escape);
        if key == Key::Escape {
            // A dialog that Esc closes may be the question whether to leave: Esc asks it again.
            self.left_by_escape = matches!(owner, Owner::Panel | Owner::Text);
            if left_by_escape && owner == Owner::Viewport {
                self.held_escape = true;
                return true;
            }
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

    /// Asks for the action whose chord fits, if it may act.
    fn ask(&mut self, owner: Owner, fits: impl Fn(&Chord) -> bool) {
        let fitting = |action: &Action| action.info().keys.iter().copied().find(|key| fits(key));
        let found = Action::ALL.iter().find_map(|action| Some((*action, fitting(action)?)));
        let Some((action, chord)) = found else { return };
        let info = action.info();
        let acts = match owner {
            Owner::Viewport => !self.steering || chord == Chord::Named(Key::Escape),
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
        input.events.retain(|event| match event {
            Event::Key { key, pressed: true, modifiers, repeat, .. } => {
                !self.key(owner, *key, *modifiers, *repeat)
            }
            Event::Key { key, pressed: false, .. } => {
                self.down.remove(key);
                true
            }
            Event::Text(text) => {
                if !self.alt {
                    self.ask(owner, |chord| matches!(chord, Chord::Text(sign) if sign == text));
                }
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
