//! What floats over the picture: files being loaded, and what was found in them.

use egui::{Align2, Area, Context, Frame, Id, Order, Ui, vec2};

use super::ask::Ask;
use super::files::Loading;
use super::state::{Notice, State};
use crate::edit::Gesture;

/// Shows them in the lower right corner; what is asked for is added to `asks`.
pub(super) fn show(ctx: &Context, state: &State, loading: &[Loading], asks: &mut Vec<Ask>) {
    if loading.is_empty() && state.notices.is_empty() {
        return;
    }
    let corner = Area::new(Id::unique("notices"))
        .order(Order::Middle)
        .anchor(Align2::CENTER_TOP, vec2(0.0, 40.0));
    corner.show(ctx, |ui| {
        ui.set_max_width(420.0);
        for (at, loading) in loading.iter().enumerate() {
            Frame::popup(ui.style()).show(ui, |ui| loading_ui(ui, at, loading, asks));
        }
        for (at, notice) in state.notices.iter().enumerate() {
            Frame::popup(ui.style()).show(ui, |ui| notice_ui(ui, at, notice, state, asks));
        }
    });
}

#[expect(clippy::cast_possible_truncation, reason = "a fraction from 0 to 1")]
fn loading_ui(ui: &mut Ui, at: usize, loading: &Loading, asks: &mut Vec<Ask>) {
    ui.label(&loading.task.label);
    ui.horizontal(|ui| {
        let fraction = loading.task.progress.fraction() as f32;
        ui.add(egui::ProgressBar::new(fraction).desired_width(220.0).show_percentage());
        if ui.button("Cancel").clicked() {
            asks.push(Ask::CancelLoading(at));
        }
    });
    // The bar has to move although nothing else does.
    ui.ctx().request_repaint_after(std::time::Duration::from_millis(50));
}

fn notice_ui(ui: &mut Ui, at: usize, notice: &Notice, state: &State, asks: &mut Vec<Ask>) {
    ui.label(&notice.text);
    ui.horizontal(|ui| {
        if let Some(offer) = notice.offer
            && ui.button(offer.label()).clicked()
        {
            asks.push(match offer.command(&state.scene, &state.view) {
                Ok((command, label)) => Ask::Change { command, gesture: Gesture::Whole, label },
                Err(refusal) => Ask::Refuse(refusal.to_string()),
            });
            asks.push(Ask::PutAway(at));
        }
        if !notice.details.is_empty() && ui.button("Details").clicked() {
            asks.push(Ask::Details(at));
        }
        if ui.button("Dismiss").clicked() {
            asks.push(Ask::PutAway(at));
        }
    });
}
