//! The crease angle of an object's model.

use egui::Ui;

use super::number_row;
use super::object::Shown;
use crate::app::actions::Requests;
use crate::app::widgets::number::Number;
use marraztu_core::edit::{Gesture, items};
use marraztu_core::scene::Crease;

/// The maximum number of polygons for new normals in every frame of a drag. Larger meshes, for
/// which that would be too slow, get new normals at the end of the drag.
const MOST_WHILE_DRAGGED: usize = 200_000;

impl Shown<'_> {
    pub(super) fn crease_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let object = self.object;
        let idle = items::why_no_crease(&object.model, object.file_normals);
        let idle = idle.map(|why| format!("Off: {why}"));
        let hint = idle.as_deref().unwrap_or(
            "Edges between faces that differ by this angle or more are sharp: 0 for flat faces, \
             180 for none",
        );
        let waiting = Waiting::of(ui);
        let now = waiting.map_or(object.model.options.crease.get(), |waiting| waiting.degrees);
        let number = Number::new("Crease angle", hint).speed(0.5).range(0.0..=180.0).suffix(" deg");
        let row = |ui: &mut Ui| number_row(ui, "Crease angle", number, now);
        let mut changed = ui.add_enabled_ui(idle.is_none(), row).inner;
        if object.model.mesh.polygon_count() > MOST_WHILE_DRAGGED {
            changed = Waiting::until_let_go(ui, waiting, changed);
        }
        if let Some((crease, gesture)) = changed.and_then(|(to, by)| Some((Crease::new(to)?, by))) {
            self.change(requests, "Change the crease angle of", gesture, |scene, _, id| {
                items::set_crease(scene, id, crease)
            });
        }
    }
}

/// An angle waiting for the end of a drag.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    degrees: f64,
    /// The frame that last showed it. A drag shows it in every frame.
    frame: u64,
}

impl Waiting {
    fn of(ui: &Ui) -> Option<Self> {
        let frame = ui.ctx().cumulative_frame_nr();
        let waiting: Option<Self> = ui.data(|data| data.get_temp(Self::id(ui)));
        waiting.filter(|waiting| frame <= waiting.frame + 1)
    }

    fn id(ui: &Ui) -> egui::Id {
        ui.scope_id().with("crease angle")
    }

    /// Holds a change back until the button is released.
    fn until_let_go(
        ui: &Ui,
        waiting: Option<Self>,
        changed: Option<(f64, Gesture)>,
    ) -> Option<(f64, Gesture)> {
        let degrees = match changed {
            Some((_, Gesture::Whole)) => return changed,
            Some((degrees, Gesture::Part(_))) => degrees,
            None => waiting?.degrees,
        };
        let dragged = ui.input(|input| input.pointer.any_down());
        if dragged {
            let waiting = Self { degrees, frame: ui.ctx().cumulative_frame_nr() };
            ui.data_mut(|data| data.insert_temp(Self::id(ui), waiting));
            return None;
        }
        ui.data_mut(|data| data.remove::<Self>(Self::id(ui)));
        Some((degrees, Gesture::Whole))
    }
}
