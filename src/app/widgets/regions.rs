//! Regions of the window for the keyboard: F6 moves to the next region, Tab moves within one.
//!
//! A region is registered where it begins to be shown. To enter it, the focus moves to the first
//! control shown after that point. The region with the focus is found from the position of the
//! focused control, so controls need not know about regions.

use std::hash::Hash;

use egui::{Context, FocusDirection, Id, Key, Rect, Sense, Ui};

/// A registered region. The list has the order of display.
#[derive(Clone, Copy, Debug)]
struct Region {
    id: Id,
    /// The visible part of the panel that contains it.
    column: Rect,
    top: f32,
}

#[derive(Clone, Debug, Default)]
struct Regions {
    pass: u64,
    shown: Vec<Region>,
    /// The region to focus next, and the last one that got the focus.
    target: Option<Id>,
    current: Option<Id>,
    /// The control that had the focus before a step back, and the index of the region it went to.
    back: Option<(Id, usize)>,
}

fn key() -> Id {
    Id::unique("regions")
}

/// Begins a region at the current position of `ui`.
pub(crate) fn begin(ui: &Ui, name: impl Hash + std::fmt::Debug) {
    begin_in(ui, name, ui.clip_rect());
}

/// Begins a region that is visible only within `column`.
pub(crate) fn begin_in(ui: &Ui, name: impl Hash + std::fmt::Debug, column: Rect) {
    let id = Id::unique("region").with(name);
    let region = Region { id, column, top: ui.cursor().top() };
    let pass = ui.ctx().cumulative_pass_nr();
    // The first region of a frame clears the list of the frame before.
    let is_target = ui.data_mut(|data| {
        let regions: &mut Regions = data.get_temp_mut_or_default(key());
        if regions.pass != pass {
            regions.pass = pass;
            regions.shown.clear();
        }
        regions.shown.push(region);
        let is_target = regions.target == Some(id);
        if is_target {
            regions.target = None;
            regions.current = Some(id);
        }
        is_target
    });
    // The focus moves to the next control that is shown, the first of this region.
    if is_target {
        ui.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
            memory.move_focus(FocusDirection::Next);
        });
    }
}

/// A direction through the regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// To the next region.
    On,
    /// To the previous region.
    Back,
}

/// Moves the focus to the next or the previous region; beyond either end, to `viewport`.
pub(crate) fn go(ctx: &Context, viewport: Id, way: Way) {
    let focused = ctx.memory(|memory| memory.focused()).filter(|id| *id != viewport);
    let place = focused.and_then(|id| ctx.read_response(id)).map(|response| response.rect);
    let to_viewport = ctx.data_mut(|data| {
        let regions: &mut Regions = data.get_temp_mut_or_default(key());
        let next = match (focused, way) {
            (None, Way::On) => regions.shown.first(),
            (None, Way::Back) => regions.shown.last(),
            (Some(_), Way::On) => {
                regions.holding(place).and_then(|here| regions.shown.get(here + 1))
            }
            (Some(_), Way::Back) => {
                let here = regions.holding(place).and_then(|here| here.checked_sub(1));
                here.and_then(|before| regions.shown.get(before))
            }
        };
        // The focus moves when the target is shown, in the next frame.
        regions.target = next.map(|region| region.id);
        let place = next.and_then(|next| regions.shown.iter().position(|it| it.id == next.id));
        regions.back = focused.zip(place).filter(|_| way == Way::Back);
        regions.target.is_none()
    });
    if to_viewport {
        ctx.memory_mut(|memory| memory.request_focus(viewport));
    }
    ctx.request_repaint();
}

/// Moves the focus one more region back if the last step back found a region without controls.
///
/// The first control shown after the start of such a region belongs to the next one, which had the
/// focus already. Called in each frame after all regions were shown.
pub(crate) fn go_further(ctx: &Context, viewport: Id) {
    let focused = ctx.memory(|memory| memory.focused());
    let beyond = ctx.data_mut(|data| {
        let regions: &mut Regions = data.get_temp_mut_or_default(key());
        if regions.target.is_some() {
            return None;
        }
        let (before, place) = regions.back.take()?;
        if focused != Some(before) {
            return None;
        }
        let next =
            place.checked_sub(1).and_then(|place| Some((place, regions.shown.get(place)?.id)));
        regions.target = next.map(|(_, id)| id);
        regions.back = next.map(|(place, _)| (before, place));
        Some(next.is_none())
    });
    if beyond == Some(true) {
        ctx.memory_mut(|memory| memory.request_focus(viewport));
    }
    if beyond.is_some() {
        ctx.request_repaint();
    }
}

impl Regions {
    /// Finds the index of the region at a place of the window, else of the region that last got the
    /// focus.
    fn holding(&self, place: Option<Rect>) -> Option<usize> {
        let at = place.map(|place| place.center());
        let holds = |region: &Region| {
            at.is_some_and(|at| region.column.contains(at) && region.top <= at.y + 1.0)
        };
        // A column may hold several regions: the lowest one that begins above the place counts. Of
        // two columns, the inner one does: it may be scrolled, and the outer one is not.
        let there = self.shown.iter().enumerate().filter(|(_, region)| holds(region));
        let there = there.max_by(|(_, a), (_, b)| {
            let inner = b.column.area().total_cmp(&a.column.area());
            inner.then(a.top.total_cmp(&b.top))
        });
        there
            .map(|(i, _)| i)
            .or_else(|| self.shown.iter().position(|region| Some(region.id) == self.current))
    }
}

/// Returns the index of the control in a group at which Tab stops: the focused one, else the chosen
/// one, else the first. The arrow keys move between the controls, `columns` to a row.
pub(crate) fn stop(ui: &Ui, ids: &[Id], chosen: Option<usize>, columns: usize) -> usize {
    let focused = ui.memory(|memory| memory.focused());
    let Some(here) = ids.iter().position(|id| Some(*id) == focused) else {
        return chosen.unwrap_or(0);
    };
    // While the group has the focus, egui leaves the arrow keys to it.
    let filter = egui::EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..egui::EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(ids[here], filter));
    let pressed = |key| ui.input(|input| input.key_pressed(key));
    let last = ids.len() - 1;
    let there = if pressed(Key::ArrowRight) {
        (here + 1).min(last)
    } else if pressed(Key::ArrowLeft) {
        here.saturating_sub(1)
    } else if pressed(Key::ArrowDown) {
        let below = if columns == ids.len() { here + 1 } else { here + columns };
        if below <= last { below } else { here }
    } else if pressed(Key::ArrowUp) {
        let step = if columns == ids.len() { 1 } else { columns };
        here.checked_sub(step).unwrap_or(here)
    } else {
        here
    };
    if there != here {
        ui.memory_mut(|memory| memory.request_focus(ids[there]));
        ui.ctx().request_repaint();
    }
    there
}

/// Returns a sense with or without a stop of Tab.
pub(crate) fn sense(sense: Sense, is_stop: bool) -> Sense {
    if is_stop { sense } else { sense - Sense::FOCUSABLE }
}

/// Scrolls the focused control of `ui` into view; called at the end of its contents.
pub(crate) fn follow_focus(ui: &Ui) {
    let Some(focused) = ui.memory(|memory| memory.focused()) else { return };
    let id = key().with("followed");
    let Some(response) = ui.ctx().read_response(focused) else { return };
    let here = response.layer_id == ui.layer_id()
        && ui.min_rect().expand(2.0).contains(response.rect.center());
    if here && ui.data(|data| data.get_temp(id)) != Some(focused) {
        ui.data_mut(|data| data.insert_temp(id, focused));
        let at_once = egui::style::ScrollAnimation::none();
        ui.scroll_to_rect_animation(response.rect.expand(4.0), None, at_once);
    }
}
