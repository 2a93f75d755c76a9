//! Regions of the window for the keyboard: F6 goes from one to the next, Tab within one.
//!
//! A region is named where it begins to be shown. To go there, the focus is given to the first
//! control that is shown after that. Which region has the focus is told by the place of what has
//! it: controls need not know.

use std::hash::Hash;

use egui::{Context, FocusDirection, Id, Key, Rect, Sense, Ui};

/// The beginning of a region, in the order in which regions are shown.
#[derive(Clone, Copy, Debug)]
struct Region {
    id: Id,
    /// What is seen of the panel that it is in.
    column: Rect,
    top: f32,
}

#[derive(Clone, Debug, Default)]
struct Regions {
    pass: u64,
    shown: Vec<Region>,
    /// The region that the keyboard is to go to, and the one that it went to last.
    target: Option<Id>,
    current: Option<Id>,
    /// What had the keyboard before it was taken back, and the place of the region it was taken to.
    back: Option<(Id, usize)>,
}

fn key() -> Id {
    Id::unique("regions")
}

/// Begins a region at the place where `ui` goes on.
pub(crate) fn begin(ui: &Ui, name: impl Hash + std::fmt::Debug) {
    begin_in(ui, name, ui.clip_rect());
}

/// Begins a region that is seen within `column` alone.
pub(crate) fn begin_in(ui: &Ui, name: impl Hash + std::fmt::Debug, column: Rect) {
    let id = Id::unique("region").with(name);
    let region = Region { id, column, top: ui.cursor().top() };
    let pass = ui.ctx().cumulative_pass_nr();
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
    if is_target {
        ui.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
            memory.move_focus(FocusDirection::Next);
        });
    }
}

/// Forwards or backwards through the regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// To the next one.
    On,
    /// To the one before.
    Back,
}

/// Takes the keyboard to the region after or before the one that has it; beyond the ends, to
/// `viewport`.
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

/// A region whose first control is that of the next one has none of its own: on the way back, the
/// keyboard goes further. Called in each frame after all regions were shown.
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
    /// The place in the list of the region at a place of the window; if none is there, of the one
    /// where the keyboard went last.
    fn holding(&self, place: Option<Rect>) -> Option<usize> {
        let at = place.map(|place| place.center());
        let holds = |region: &Region| {
            at.is_some_and(|at| region.column.contains(at) && region.top <= at.y + 1.0)
        };
        let there = self.shown.iter().enumerate().filter(|(_, region)| holds(region));
        let there = there.max_by(|(_, a), (_, b)| a.top.total_cmp(&b.top));
        there
            .map(|(i, _)| i)
            .or_else(|| self.shown.iter().position(|region| Some(region.id) == self.current))
    }
}

/// Which of several controls that stand together Tab stops at: the one that has the keyboard, else
/// the chosen one, else the first. The arrows go from one to the next, `columns` of them in a row.
pub(crate) fn stop(ui: &Ui, ids: &[Id], chosen: Option<usize>, columns: usize) -> usize {
    let focused = ui.memory(|memory| memory.focused());
    let Some(here) = ids.iter().position(|id| Some(*id) == focused) else {
        return chosen.unwrap_or(0);
    };
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

/// A sense that Tab stops at, or does not.
pub(crate) fn sense(sense: Sense, is_stop: bool) -> Sense {
    if is_stop { sense } else { sense - Sense::FOCUSABLE }
}

/// Scrolls what got the keyboard in `ui` into sight; called where the contents end.
pub(crate) fn follow_focus(ui: &Ui) {
    let Some(focused) = ui.memory(|memory| memory.focused()) else { return };
    let id = key().with("followed");
    let Some(response) = ui.ctx().read_response(focused) else { return };
    let here = response.layer_id == ui.layer_id()
        && ui.min_rect().expand(2.0).contains(response.rect.center());
    if here && ui.data(|data| data.get_temp(id)) != Some(focused) {
        ui.data_mut(|data| data.insert_temp(id, focused));
        ui.scroll_to_rect_animation(
            response.rect.expand(4.0),
            None,
            egui::style::ScrollAnimation::none(),
        );
    }
}
