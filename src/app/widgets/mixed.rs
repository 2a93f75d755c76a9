//! Controls whose value differs between the selected items: fields show "mixed", and no option is
//! on.
//!
//! A mixed control takes the value that one of the items already has, since the others change.

use egui::{Context, Id};

/// Marks controls by their names as mixed from now on.
pub(crate) fn set_mixed(ctx: &Context, names: Vec<String>) {
    ctx.data_mut(|data| data.insert_temp(id(), names));
}

/// Returns whether the control with this name is mixed.
pub(crate) fn is_mixed(ctx: &Context, name: &str) -> bool {
    let is_it = |names: Vec<String>| names.iter().any(|other| other == name);
    ctx.data(|data| data.get_temp(id())).is_some_and(is_it)
}

fn id() -> Id {
    Id::unique("mixed controls")
}
