//! Notices over the picture: files being loaded, and findings about them, one notice for each kind.
//! Notices that need no answer move to the status line after some seconds.

use std::time::Duration;

use std::collections::BTreeSet;
use std::path::Path;

use egui::{Align2, Area, Context, Frame, Id, Order, Rect, ScrollArea, Ui};

use super::greeting;
use super::properties::up_by_default_ui;
use crate::app::actions::{Action, MissingRequest, Request, Requests};
use crate::app::documents::loading::Loading;
use crate::app::input::buttons::first_key;
use crate::app::state::{NoticeGroup, NoticeKind, Offer, State};
use crate::app::tasks::Task;
use crate::app::theme;
use crate::app::widgets::regions;
use crate::app::widgets::text::file_name;
use marraztu_core::scene::{ObjectId, UpAxis};

/// The time, in seconds, for which a notice without a question is shown.
const SHOWN: f64 = 8.0;

/// The greatest width of a notice.
const WIDTH: f32 = 340.0;

/// The least width of a notice.
const LEAST: f32 = 180.0;

/// The height that shows a notice of some lines with its buttons.
const LEAST_HEIGHT: f32 = 140.0;

/// The share of the width of the picture that notices may cover.
const SHARE: f32 = 0.42;

/// The height of the text at the lower edge of the picture, below the notices.
const PLATE: f32 = 36.0;

/// The height of the axes of the world in the upper right corner.
const AXES: f32 = 92.0;

/// Shows the notices in the lower right corner of the picture; their requests are added to
/// `requests`. No other overlay lies there, and nothing is covered.
pub(crate) fn show<T>(
    (ctx, picture): (&Context, Rect),
    state: &State,
    loading: &[Loading],
    making: &[Task<T>],
    requests: &mut Requests,
) {
    let missing = match state.missing.dismissed {
        true => BTreeSet::new(),
        false => state.scene.missing_files(),
    };
    let groups = NoticeGroup::of(&state.notices);
    let dismissible = groups.len()
        + usize::from(!missing.is_empty())
        + usize::from(!state.missing.nearby.is_empty());
    let is_empty = loading.is_empty() && making.is_empty() && state.recoverable.is_empty();
    if is_empty && dismissible == 0 {
        return;
    }
    // The middle of the picture stays free.
    let width = (SHARE * picture.width() - 20.0).clamp(LEAST, WIDTH);
    let place = place(ctx, picture, width, state);
    let corner = Area::new(Id::unique("notices"))
        .order(Order::Middle)
        .pivot(Align2::RIGHT_BOTTOM)
        .fixed_pos(place.right_bottom());
    corner.show(ctx, |ui| {
        let most = place.height();
        let scroll = ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        scroll.show(ui, |ui| {
            // Notices overlap other regions, so their region is limited to the controls among them.
            let column = Rect::from_min_size(ui.cursor().min, ui.available_size());
            let seen: Option<Rect> = ui.data(|data| data.get_temp(seen_id()));
            regions::begin_in(ui, "notices", seen.unwrap_or(column));
            let mut popup = |add: &mut dyn FnMut(&mut Ui)| {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width(width);
                    add(ui);
                });
            };
            // Tasks in progress come first, then offers, then findings.
            if !loading.is_empty() {
                let all: Vec<_> = loading.iter().map(|loading| &loading.task).collect();
                popup(&mut |ui| tasks_ui(ui, &all, Request::CancelLoading, requests));
            }
            if !making.is_empty() {
                let all: Vec<_> = making.iter().collect();
                popup(&mut |ui| tasks_ui(ui, &all, Request::CancelMaking, requests));
            }
            if let Some(work) = state.recoverable.first() {
                popup(&mut |ui| recoverable_ui(ui, work, state.recoverable.len(), requests));
            }
            if !state.missing.nearby.is_empty() {
                popup(&mut |ui| nearby_ui(ui, state, requests));
            }
            if !missing.is_empty() {
                popup(&mut |ui| missing_ui(ui, &missing, requests));
            }
            for group in &groups {
                popup(&mut |ui| {
                    ui.push_id(group.kind, |ui| notice_ui(ui, group, state, requests));
                });
            }
            if dismissible > 1 && ui.button("Dismiss all").clicked() {
                requests.push(Request::DismissNotices);
            }
            ui.data_mut(|data| data.insert_temp(seen_id(), ui.min_rect()));
        });
    });
}

/// Returns the part of the picture that notices may take: the lower right corner, above the
/// greeting and below the axes, and below the dial if that reaches so far to the right.
fn place(ctx: &Context, picture: Rect, width: f32, state: &State) -> Rect {
    let right = picture.right() - 8.0;
    let area = |name| ctx.memory(|memory| memory.area_rect(Id::unique(name)));
    let greeting = area("greeting").filter(|_| greeting::is_shown(state, picture));
    let bottom = greeting.map_or(picture.bottom() - PLATE, |greeting| greeting.top() - 8.0);
    let dial = area("dial").filter(|dial| state.dial.shown && dial.right() > right - width - 20.0);
    let upper = dial.map_or(0.0, |dial| dial.bottom() + 8.0).max(picture.top() + AXES);
    // In a low picture, a notice matters more than the overlays.
    let top = if bottom - upper < LEAST_HEIGHT { picture.top() + 8.0 } else { upper };
    Rect::from_x_y_ranges(right - width..=right, top..=bottom)
}

/// Returns the id of the notices' area in the previous frame.
fn seen_id() -> Id {
    Id::unique("place of the notices")
}

/// Shows the progress of tasks of one kind, as one.
#[expect(clippy::cast_possible_truncation, reason = "a fraction from 0 to 1")]
fn tasks_ui<T>(
    ui: &mut Ui,
    tasks: &[&Task<T>],
    cancel: fn(usize) -> Request,
    requests: &mut Requests,
) {
    let [first, others @ ..] = tasks else { return };
    ui.label(match others.len() {
        0 => first.label.clone(),
        count => format!("{} (and {count} more)", first.label),
    });
    ui.horizontal(|ui| {
        let fractions = tasks.iter().map(|task| task.progress.fraction() as f32);
        let mean = fractions.sum::<f32>() / tasks.iter().map(|_| 1.0).sum::<f32>();
        ui.add(egui::ProgressBar::new(mean).desired_width(220.0).show_percentage());
        if ui.button("Cancel").clicked() {
            requests.extend((0..tasks.len()).map(cancel));
        }
    });
    // The progress bar needs repaints even in an idle window.
    ui.ctx().request_repaint_after(Duration::from_millis(50));
}

/// Shows the first unsaved work that crashed programs have left behind.
fn recoverable_ui(ui: &mut Ui, work: &str, count: usize, requests: &mut Requests) {
    ui.label(match count {
        1 => work.to_owned(),
        _ => format!("{work} (1 of {count})"),
    });
    ui.horizontal(|ui| {
        let key = first_key(ui, Action::RecoverWork);
        let hint = "Opens the work in place of this scene";
        let hint = key.map_or_else(|| hint.to_owned(), |key| format!("{hint}; key {key}"));
        if ui.button("Recover").on_hover_text(hint).clicked() {
            requests.push(Request::Recover(0));
        }
        if ui
            .button("Discard")
            .on_hover_text("Discards the work; the File menu can restore it for 30 days")
            .clicked()
        {
            requests.push(Request::DiscardWork(0));
        }
    });
}

/// Reports the missing files of the scene.
fn missing_ui(ui: &mut Ui, missing: &BTreeSet<&Path>, requests: &mut Requests) {
    let names: Vec<String> = missing.iter().map(|path| file_name(path)).collect();
    let text = match &names[..] {
        [only] => format!("{only} is missing: a placeholder is shown"),
        all => {
            format!("{} files of the scene are missing: placeholders are shown", all.len())
        }
    };
    ui.label(text).on_hover_text(names.join("\n"));
    ui.horizontal(|ui| {
        if ui.button("Find...").on_hover_text("Locates the missing file").clicked() {
            requests.push(Request::Missing(MissingRequest::Find(None)));
        }
        let hint = "Hides this notice; File > Find missing files... shows it again";
        if ui.button("Dismiss").on_hover_text(hint).clicked() {
            requests.push(Request::Missing(MissingRequest::Dismiss));
        }
    });
}

/// Offers missing files in the folder of a found one.
fn nearby_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let found: Vec<String> =
        state.missing.nearby.iter().map(|[_, new]| new.display().to_string()).collect();
    let text = match &state.missing.nearby[..] {
        [[_, new]] => format!("{} was found there as well", file_name(new)),
        all => format!("{} more missing files were found there", all.len()),
    };
    ui.label(text).on_hover_text(found.join("\n"));
    ui.horizontal(|ui| {
        if ui.button("Use all").on_hover_text(found.join("\n")).clicked() {
            requests.push(Request::Missing(MissingRequest::UseNearby));
        }
        if ui.button("Dismiss").clicked() {
            requests.push(Request::Missing(MissingRequest::DismissNearby));
        }
    });
}

fn notice_ui(ui: &mut Ui, group: &NoticeGroup<'_>, state: &State, requests: &mut Requests) {
    let (text, details, offers) = (group.text(), group.details(), group.offers());
    ui.label(&text);
    let mut focused = false;
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut Ui, label: &str| {
            let button = ui.button(label);
            focused |= button.has_focus();
            button.clicked()
        };
        match &offers[..] {
            [] => {}
            [Offer::Up(_), ..] => up_axis_ui(ui, state, &offers, requests),
            [one] if button(ui, one.label()) => requests.push(Request::Accept(group.kind)),
            [first, _, ..] if button(ui, &format!("{} all", first.label())) => {
                requests.push(Request::Accept(group.kind));
            }
            [_, ..] => {}
        }
        if !details.is_empty() && button(ui, "Details") {
            requests.push(Request::Details(group.kind));
        }
        if button(ui, "Dismiss") {
            requests.push(Request::Settle(group.kind));
        }
    });
    if !group.needs_answer() {
        settle(ui, (group.kind, &text), focused, requests);
    }
}

/// Moves notices to the status line after some seconds. They stay while the pointer is over them
/// or they have the focus.
fn settle(ui: &Ui, (kind, text): (NoticeKind, &str), focused: bool, requests: &mut Requests) {
    let id = ui.scope_id().with(("since", text));
    let (now, pointer) = ui.input(|input| (input.time, input.pointer.hover_pos()));
    let pass = ui.ctx().cumulative_pass_nr();
    let place = ui.min_rect().expand(f32::from(theme::MARGIN));
    let held = focused || pointer.is_some_and(|at| place.contains(at));
    let since = ui.data_mut(|data| {
        let (since, last): (f64, u64) = data.get_temp(id).unwrap_or((now, pass));
        // After a pause, an equal notice is a new one.
        let since = if held || last + 2 < pass { now } else { since };
        data.insert_temp(id, (since, pass));
        since
    });
    let rest = SHOWN - (now - since);
    if rest <= 0.0 {
        requests.push(Request::Settle(kind));
    } else if !held {
        ui.ctx().request_repaint_after(Duration::from_secs_f64(rest.max(0.0)));
    }
}

/// Shows the choice of the up axis of opened models, between the two usual ones. An axis that is
/// not the default can be made so.
fn up_axis_ui(ui: &mut Ui, state: &State, offers: &[&Offer], requests: &mut Requests) {
    let ids: Vec<ObjectId> = offers.iter().filter_map(|offer| offer.object()).collect();
    let object = ids.iter().find_map(|id| state.scene.objects.get(*id));
    let Some(now) = object.map(|object| object.model.options.up) else { return };
    for up in [UpAxis::Y, UpAxis::Z] {
        let label = format!("{} up", up.word().to_uppercase());
        if ui.selectable_label(now == up, label).clicked() && now != up {
            requests.push(Request::TurnUp(ids.clone(), up));
        }
    }
    up_by_default_ui(ui, state, now, requests);
}
