//! Notices over the picture: files being loaded, and findings about them. Notices that need no
//! answer move to the status line after some seconds.

use std::time::Duration;

use std::collections::BTreeSet;
use std::path::Path;

use egui::{Align2, Area, Context, Frame, Id, Order, Rect, Ui, vec2};

use crate::app::actions::{Action, MissingRequest, Request, Requests};
use crate::app::documents::loading::Loading;
use crate::app::input::buttons::first_key;
use crate::app::state::{Notice, Offer, State};
use crate::app::tasks::Task;
use crate::app::theme;
use crate::app::widgets::regions;
use crate::app::widgets::text::file_name;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{ObjectId, UpAxis};

/// The time, in seconds, for which a notice without a question is shown.
const SHOWN: f64 = 8.0;

/// Shows the notices at the top of the picture; their requests are added to `requests`.
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
    if loading.is_empty()
        && making.is_empty()
        && state.notices.is_empty()
        && state.recoverable.is_empty()
        && state.missing.nearby.is_empty()
        && missing.is_empty()
    {
        return;
    }
    let corner = Area::new(Id::unique("notices"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(picture.center_top() + vec2(0.0, 14.0));
    corner.show(ctx, |ui| {
        ui.set_max_width(420.0_f32.min(picture.width() - 16.0).max(200.0));
        // Notices overlap other regions, so their region is limited to the controls among them.
        let column = Rect::from_min_size(ui.cursor().min, ui.available_size());
        let seen: Option<Rect> = ui.data(|data| data.get_temp(seen_id()));
        regions::begin_in(ui, "notices", seen.unwrap_or(column));
        // Tasks in progress come first, then offers, then findings.
        for (at, loading) in loading.iter().enumerate() {
            let cancel = Request::CancelLoading(at);
            Frame::popup(ui.style()).show(ui, |ui| task_ui(ui, &loading.task, cancel, requests));
        }
        for (at, task) in making.iter().enumerate() {
            let cancel = Request::CancelMaking(at);
            Frame::popup(ui.style()).show(ui, |ui| task_ui(ui, task, cancel, requests));
        }
        for (at, work) in state.recoverable.iter().enumerate() {
            Frame::popup(ui.style()).show(ui, |ui| recoverable_ui(ui, at, work, requests));
        }
        if !state.missing.nearby.is_empty() {
            Frame::popup(ui.style()).show(ui, |ui| nearby_ui(ui, state, requests));
        }
        if !missing.is_empty() {
            Frame::popup(ui.style()).show(ui, |ui| missing_ui(ui, &missing, requests));
        }
        for (at, notice) in state.notices.iter().enumerate() {
            // Ids depend on the notice, not on its index: a press on one notice never becomes a
            // click on another that has moved to its place.
            ui.push_id((&notice.text, notice.offer.map(Offer::object)), |ui| {
                Frame::popup(ui.style()).show(ui, |ui| notice_ui(ui, at, notice, state, requests));
            });
        }
        ui.data_mut(|data| data.insert_temp(seen_id(), ui.min_rect()));
    });
}

/// Returns the id of the notices' area in the previous frame.
fn seen_id() -> Id {
    Id::unique("place of the notices")
}

#[expect(clippy::cast_possible_truncation, reason = "a fraction from 0 to 1")]
fn task_ui<T>(ui: &mut Ui, task: &Task<T>, cancel: Request, requests: &mut Requests) {
    ui.label(&task.label);
    ui.horizontal(|ui| {
        let fraction = task.progress.fraction() as f32;
        ui.add(egui::ProgressBar::new(fraction).desired_width(220.0).show_percentage());
        if ui.button("Cancel").clicked() {
            requests.push(cancel);
        }
    });
    // The progress bar needs repaints even in an idle window.
    ui.ctx().request_repaint_after(Duration::from_millis(50));
}

/// Shows unsaved work that a crashed program has left behind.
fn recoverable_ui(ui: &mut Ui, at: usize, work: &str, requests: &mut Requests) {
    ui.label(work);
    ui.horizontal(|ui| {
        let key = first_key(ui, Action::RecoverWork).filter(|_| at == 0);
        let hint = "Opens the work in place of this scene";
        let hint = key.map_or_else(|| hint.to_owned(), |key| format!("{hint}; key {key}"));
        if ui.button("Recover").on_hover_text(hint).clicked() {
            requests.push(Request::Recover(at));
        }
        if ui
            .button("Discard")
            .on_hover_text("Discards the work; the File menu can restore it for 30 days")
            .clicked()
        {
            requests.push(Request::DiscardWork(at));
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

fn notice_ui(ui: &mut Ui, at: usize, notice: &Notice, state: &State, requests: &mut Requests) {
    ui.label(&notice.text);
    let buttons = ui.horizontal(|ui| {
        let mut focused = false;
        let mut button = |ui: &mut Ui, label: &str| {
            let button = ui.button(label);
            focused |= button.has_focus();
            button.clicked()
        };
        match notice.offer {
            Some(Offer::Up(id)) => up_axis_ui(ui, state, id, requests),
            Some(offer) if button(ui, offer.label()) => {
                requests.extend(accepted(offer, state));
                requests.push(Request::PutAway(at));
            }
            Some(_) | None => {}
        }
        if !notice.details.is_empty() && button(ui, "Details") {
            requests.push(Request::Details(at));
        }
        if button(ui, "Dismiss") {
            requests.push(Request::PutAway(at));
        }
        focused
    });
    if !notice.needs_answer() {
        settle(ui, at, buttons.inner, requests);
    }
}

fn accepted(offer: Offer, state: &State) -> Option<Request> {
    let gesture = Gesture::Whole;
    match offer.command(&state.scene, &state.view) {
        Ok(None) => None,
        Ok(Some((command, _))) if matches!(offer, Offer::Frame(_)) => {
            Some(Request::Navigate { command, gesture })
        }
        Ok(Some((command, label))) => Some(Request::Change { command, gesture, label }),
        Err(refusal) => Some(Request::Refuse(refusal.to_string())),
    }
}

/// Moves a notice to the status line after some seconds. The notice stays while the pointer is over
/// it or it has the focus.
fn settle(ui: &Ui, at: usize, focused: bool, requests: &mut Requests) {
    let id = ui.scope_id().with("since");
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
    // Only one per frame, since the indices of the others change with it.
    let moves = |request: &Request| matches!(request, Request::Settle(_) | Request::PutAway(_));
    if rest <= 0.0 && !requests.iter().any(moves) {
        requests.push(Request::Settle(at));
    } else if !held {
        ui.ctx().request_repaint_after(Duration::from_secs_f64(rest.max(0.0)));
    }
}

/// Shows the choice of the up axis of an opened model, between the two usual ones.
fn up_axis_ui(ui: &mut Ui, state: &State, id: ObjectId, requests: &mut Requests) {
    let Some(object) = state.scene.objects.get(id) else { return };
    let now = object.model.options.up;
    for up in [UpAxis::Y, UpAxis::Z] {
        let label = format!("{} up", up.word().to_uppercase());
        if ui.selectable_label(now == up, label).clicked() && now != up {
            requests.push(Request::TurnUp(vec![id], up));
        }
    }
}
