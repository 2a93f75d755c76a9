//! The choice of a material: the nineteen presets as spheres, the file's, or the user's own.

use egui::{Id, Rect, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::number_row;
use crate::app::theme;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{self, row};
use crate::app::widgets::mixed::is_mixed;
use crate::app::widgets::number::Number;
use crate::app::widgets::regions;
use crate::app::widgets::spheres::{self, Sphere};
use marraztu_core::base::color::Color;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{
    Material, MaterialChoice, Object, Optics, PresetId, Reflection, Transmission,
};

/// The number of spheres per row: 21 spheres, with the file's and the user's own, fill three rows.
const COLUMNS: u8 = 7;

/// Shows the choice. `object` is the object with the material, if it is one. Returns the choice
/// that was made.
pub(crate) fn choice_ui(
    ui: &mut Ui,
    choice: &MaterialChoice,
    object: Option<&Object>,
) -> Option<(MaterialChoice, Gesture)> {
    let own = coefficients(choice, object);
    let mut cells: Vec<(MaterialChoice, Sphere, String)> = PresetId::all()
        .map(|id| (MaterialChoice::Preset(id), Sphere::Preset(id), id.get().name.to_owned()))
        .collect();
    // The last two cells show the file's material and the user's own.
    let file = coefficients(&MaterialChoice::File, object);
    cells.push((MaterialChoice::File, Sphere::File(file), "the file's own".to_owned()));
    cells.push((MaterialChoice::Own(own), Sphere::Own(own), "your own".to_owned()));
    let mixed = is_mixed(ui.ctx(), "Material");
    let on = cells.iter().position(|(to, ..)| !mixed && same_kind(choice, to));
    let mut chosen = None;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = vec2(theme::GAP, theme::GAP);
        let gaps = f32::from(COLUMNS - 1) * theme::GAP;
        let side = ((ui.available_width() - gaps) / f32::from(COLUMNS)).floor();
        let columns = usize::from(COLUMNS);
        let ids: Vec<Id> = (0..cells.len()).map(|i| ui.scope_id().with(("material", i))).collect();
        let stop = regions::stop(ui, &ids, on, columns);
        for (row, cells) in cells.chunks(columns).enumerate() {
            ui.horizontal(|ui| {
                for (column, (to, sphere, name)) in cells.iter().enumerate() {
                    let i = row * columns + column;
                    let cell = Cell { id: ids[i], is_stop: i == stop, side };
                    let on = on == Some(i);
                    if cell.ui(ui, *sphere, name, on) && !on {
                        chosen = Some((to.clone(), Gesture::Whole));
                    }
                }
            });
        }
    });
    ui.label(on.map_or("mixed", |on| cells[on].2.as_str()));
    if let MaterialChoice::Own(material) = choice {
        let edited = own_ui(ui, *material);
        chosen = chosen.or(edited.map(|(to, gesture)| (MaterialChoice::Own(to), gesture)));
    }
    chosen
}

/// Returns the coefficients of a choice; for the file's material, the coefficients of its first
/// part.
fn coefficients(choice: &MaterialChoice, object: Option<&Object>) -> Material {
    match choice {
        MaterialChoice::Preset(id) => id.get().material,
        MaterialChoice::Own(material) => *material,
        MaterialChoice::File => object.map_or_else(Material::default, |object| {
            let object = Object { material: MaterialChoice::File, ..object.clone() };
            object.part_look(0).material
        }),
    }
}

fn same_kind(a: &MaterialChoice, b: &MaterialChoice) -> bool {
    match a {
        MaterialChoice::Own(_) => matches!(b, MaterialChoice::Own(_)),
        MaterialChoice::Preset(_) | MaterialChoice::File => a == b,
    }
}

/// The position of a sphere for the keyboard, and its size.
struct Cell {
    id: Id,
    is_stop: bool,
    side: f32,
}

impl Cell {
    fn ui(&self, ui: &mut Ui, sphere: Sphere, name: &str, on: bool) -> bool {
        let size = vec2(self.side, self.side);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let response = ui.interact(rect, self.id, regions::sense(Sense::click(), self.is_stop));
        let label = format!("Material: {name}");
        response.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, on, &label));
        let visuals = ui.visuals();
        if on {
            ui.painter().rect_filled(rect, 4.0, visuals.selection.bg_fill);
            let ring = Stroke::new(1.5, theme::accent(visuals));
            ui.painter().rect_stroke(rect, 4.0, ring, StrokeKind::Inside);
        } else if response.hovered() {
            ui.painter().rect_filled(rect, 4.0, visuals.widgets.hovered.bg_fill);
        }
        spheres::paint(ui, rect.shrink(3.0), sphere);
        // Materials other than presets have a label.
        let letter = match sphere {
            Sphere::Preset(_) => "",
            Sphere::File(_) => "file",
            Sphere::Own(_) => "own",
        };
        if !letter.is_empty() {
            corner_text(ui, rect, letter);
        }
        controls::focus_ring(ui, rect, &response);
        let hint = match sphere {
            Sphere::Preset(_) => name.to_owned(),
            Sphere::File(_) => "The materials of the model's file, part by part".to_owned(),
            Sphere::Own(_) => "Your own: begins with the current material".to_owned(),
        };
        response.on_hover_text(hint).clicked()
    }
}

fn corner_text(ui: &Ui, rect: Rect, letter: &str) {
    let galley = controls::text(ui, letter, TextStyle::Small, rect.width());
    let size = galley.size() + vec2(4.0, 0.0);
    let ground = Rect::from_min_max(rect.max - size, rect.max);
    ui.painter().rect_filled(ground, 2.0, ui.visuals().panel_fill);
    let at = pos2(ground.left() + 2.0, ground.top());
    ui.painter().galley_with_override_text_color(at, galley, ui.visuals().text_color());
}

/// Shows Ka, Kd, Ks, Ns and the optics of the user's material.
fn own_ui(ui: &mut Ui, material: Material) -> Option<(Material, Gesture)> {
    let mut changed = None;
    let rows: [(&str, &str, [f64; 3]); 4] = [
        ("Ambient", "Ka: the fraction of ambient light that is reflected", material.ambient),
        ("Diffuse", "Kd: the fraction of a light's colour that is scattered", material.diffuse),
        ("Specular", "Ks: the fraction of a light's colour in the highlight", material.specular),
        ("Emission", "Ke: light that the surface emits", material.emission),
    ];
    for (i, (name, hint, factors)) in rows.into_iter().enumerate() {
        if let Some((to, gesture)) = factors_ui(ui, name, hint, factors) {
            let mut own = material;
            let Material { ambient, diffuse, specular, emission, .. } = &mut own;
            *[ambient, diffuse, specular, emission][i] = to;
            changed = Some((own, gesture));
        }
    }
    let number =
        Number::new("Exponent", "Ns: larger values make the highlight smaller").range(0.0..=1000.0);
    if let Some((exponent, gesture)) = number_row(ui, "Exponent", number, material.exponent) {
        changed = Some((Material { exponent, ..material }, gesture));
    }
    let edited = optics_ui(ui, material.optics);
    changed.or(edited.map(|(optics, gesture)| (Material { optics, ..material }, gesture)))
}

/// Shows what the user's material mirrors, and what light it lets through.
fn optics_ui(ui: &mut Ui, optics: Optics) -> Option<(Optics, Gesture)> {
    let mirrors = [
        ("None", Reflection::None, "Mirrors nothing"),
        ("Ks", Reflection::Constant, "Mirrors the fraction Ks in all directions"),
        ("Fresnel", Reflection::Fresnel, "Mirrors Ks head-on and more at grazing angles"),
    ];
    if let Some(reflection) =
        row(ui, "Mirror", |ui| controls::choose(ui, "Mirror", optics.reflection, &mirrors))
    {
        return Some((Optics { reflection, ..optics }, Gesture::Whole));
    }
    let filter = match optics.transmission {
        Transmission::Filter(filter) => filter,
        Transmission::None | Transmission::Opacity => [1.0; 3],
    };
    let ways = [
        ("None", Transmission::None, "Lets no light through"),
        ("Opacity", Transmission::Opacity, "Lets through what the opacity leaves"),
        ("Tf", Transmission::Filter(filter), "Lets through a fraction of each colour"),
    ];
    if let Some(transmission) =
        row(ui, "Refract", |ui| controls::choose(ui, "Refract", optics.transmission, &ways))
    {
        return Some((Optics { transmission, ..optics }, Gesture::Whole));
    }
    let mut changed = None;
    if let Transmission::Filter(filter) = optics.transmission {
        let hint = "Tf: the fraction of a colour that passes through the surface";
        if let Some((filter, gesture)) = factors_ui(ui, "Filter", hint, filter) {
            let transmission = Transmission::Filter(filter);
            changed = Some((Optics { transmission, ..optics }, gesture));
        }
    }
    // The index bends light, and decides how much a surface mirrors head-on.
    if optics.transmission != Transmission::None || optics.reflection == Reflection::Fresnel {
        let number = Number::new("Index", "Ni: the index of refraction; 1.33 water, 1.5 glass")
            .speed(0.005)
            .range(Optics::INDICES);
        if let Some((index, gesture)) = number_row(ui, "Index", number, optics.index) {
            changed = Some((Optics { index, ..optics }, gesture));
        }
    }
    changed
}

fn factors_ui(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    factors: [f64; 3],
) -> Option<([f64; 3], Gesture)> {
    row(ui, name, |ui| {
        let mut changed = None;
        let color = Color::from_factors(factors);
        if let Some((to, gesture)) = swatch(ui, &format!("{name} colour"), hint, color) {
            changed = Some((to.factors(), gesture));
        }
        let width = (ui.available_width() - 2.0 * theme::GAP) / 3.0;
        for (i, channel) in ["red", "green", "blue"].iter().enumerate() {
            let number = Number::new(format!("{name} {channel}"), hint);
            let number = number.speed(0.005).range(0.0..=1.0);
            if let Some((to, gesture)) = number.ui(ui, width, factors[i]) {
                let mut factors = factors;
                factors[i] = to;
                changed = Some((factors, gesture));
            }
        }
        changed
    })
}
