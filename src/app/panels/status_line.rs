//! What the next key would do, and the last word to the user.

use crate::app::ask::Ask;
use crate::app::state::State;

/// Shows it; what is asked for is added to `asks`.
pub(super) fn show(ui: &mut egui::Ui, state: &State, asks: &mut Vec<Ask>) {
    let _ = (ui, state, asks);
}
