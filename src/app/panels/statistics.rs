//! Statistics over the picture: triangles drawn, times, and redrawn parts.

use egui::{Align2, Ui};

use crate::app::actions::Requests;
use crate::app::state::{Shrink, State};
use crate::app::widgets::plate::plate_ui;
use crate::app::widgets::text::{counted, grouped};
use marraztu_core::scene::{ItemId, Mesh};
use marraztu_render::{Change, Damage, DamageCause};

/// The height of the panel.
pub(super) const HEIGHT: f32 = 120.0;

/// The height of the name of the object under the pointer.
const NAME: f32 = 26.0;

/// Shows the panel in a corner of the picture; it makes no requests.
pub(crate) fn show(ui: &mut Ui, state: &State, _: &mut Requests) {
    let statistics = &state.statistics;
    let shown = || state.scene.objects.iter().filter(|(_, object)| object.visible);
    let sum = |count: fn(&Mesh) -> usize| -> usize {
        shown().map(|(_, object)| count(&object.model.mesh)).sum()
    };
    let text = format!(
        "{} in the last second, {:.1} ms each\n{} x {} pixels{}\n{}\n\
        {}, {}, {}\n{} of {} drawn",
        counted(statistics.rate as usize, "picture", "pictures"),
        statistics.time.as_secs_f64() * 1e3,
        statistics.size.width,
        statistics.size.height,
        shown_as(statistics.reduction.shrink),
        statistics.changes.as_ref().map_or_else(String::new, |changes| redrawn(state, changes)),
        counted(shown().count(), "object", "objects"),
        counted(sum(|mesh| mesh.positions().len()), "vertex", "vertices"),
        counted(sum(Mesh::polygon_count), "face", "faces"),
        grouped(statistics.triangles),
        counted(sum(|mesh| mesh.triangle_count()), "triangle", "triangles"),
    );
    // The dial has the corner above, and the name of the object under the pointer the one below.
    let picture = ui.max_rect();
    let above = picture.with_max_y(picture.bottom() - NAME);
    plate_ui(ui, above, Align2::LEFT_BOTTOM, text);
}

/// Describes the enlargement of pixels in a smaller picture.
const fn shown_as(shrink: Shrink) -> &'static str {
    match shrink {
        Shrink::Whole => "",
        Shrink::Half => ", each shown as four",
        Shrink::Quarter => ", each shown as sixteen",
    }
}

/// The maximum number of names in a reason.
const NAMES: usize = 2;

/// Describes the redrawn part of the last picture: "14 of 169 tiles drawn: teapot moved".
fn redrawn(state: &State, changes: &Damage) -> String {
    let why = match changes.cause() {
        DamageCause::First => "first picture".to_owned(),
        DamageCause::Size => "size changed".to_owned(),
        DamageCause::Camera => "camera moved".to_owned(),
        DamageCause::Background => "background changed".to_owned(),
        DamageCause::Settings => "settings changed".to_owned(),
        DamageCause::Shadows => "shadows changed".to_owned(),
        DamageCause::Surroundings => "what mirrors show changed".to_owned(),
        DamageCause::Order => "order changed".to_owned(),
        DamageCause::Items(items) => reasons(items, |item| state.name(item)),
    };
    let all = counted(changes.tiles_in_all(), "tile", "tiles");
    format!("{} of {all} drawn: {why}", changes.tiles())
}

/// Describes changes of items by kind: "teapot moved, cube and 2 more look different".
fn reasons<'a>(items: &[(ItemId, Change)], name: impl Fn(ItemId) -> Option<&'a str>) -> String {
    let all = [
        (Change::Moved, "moved"),
        (Change::Shape, "changed in shape"),
        (Change::Look, "changed in colour or light"),
        (Change::Came, "came"),
        (Change::Went, "went"),
    ];
    let reason = |(change, verb): (Change, &str)| {
        let alike: Vec<ItemId> =
            items.iter().filter(|(_, other)| *other == change).map(|(item, _)| *item).collect();
        let named = |item: &ItemId| name(*item).unwrap_or("a removed item").to_owned();
        let mut names: Vec<String> = alike.iter().take(NAMES).map(named).collect();
        if alike.len() > NAMES {
            names.truncate(NAMES - 1);
            names.push(format!("{} more", alike.len() + 1 - NAMES));
        }
        (!names.is_empty()).then(|| format!("{} {verb}", names.join(" and ")))
    };
    all.into_iter().filter_map(reason).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::scene::ObjectId;

    #[test]
    fn a_reason_names_at_most_two_items_and_groups_equal_changes() {
        let object = |id| ItemId::Object(ObjectId(id));
        let names = ["teapot", "cube", "ball"];
        let name = |item| match item {
            ItemId::Object(ObjectId(id)) => names.get(id as usize).copied(),
            ItemId::Camera(_) | ItemId::Light(_) => None,
        };
        let items = |changes: &[Change]| -> Vec<(ItemId, Change)> {
            (0..).map(object).zip(changes.iter().copied()).collect()
        };
        let moved = items(&[Change::Look, Change::Moved, Change::Look]);
        let reason = "cube moved, teapot and ball changed in colour or light";
        assert_eq!(reasons(&moved, name), reason);
        assert_eq!(
            reasons(&items(&[Change::Look; 3]), name),
            "teapot and 2 more changed in colour or light"
        );
        assert_eq!(reasons(&[(object(9), Change::Went)], name), "a removed item went");
    }
}
