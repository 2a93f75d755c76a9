//! The theme of the window: colours, sizes, spacing.
//!
//! The interface is grey so the picture stands out; one accent colour marks the selection and the
//! focus. The light and the dark palette have the same entries. All text has a contrast of at least
//! 4.5 to 1 on its background (WCAG 2.1, success criterion 1.4.3).

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::style::{HandleShape, ScrollStyle, WidgetVisuals, Widgets};
use egui::{
    Color32, Context, CornerRadius, FontData, FontFamily, FontId, Margin, Shadow, Stroke, Style,
    TextStyle, Theme, Visuals, vec2,
};

use marraztu_core::base::math::Axis;

/// The height of rows, buttons and fields, in points.
pub const ROW: f32 = 22.0;
/// The space between related controls.
pub const GAP: f32 = 4.0;
/// The distance from the border of a panel to its contents.
pub const MARGIN: i8 = 10;
/// The margin at the right of scrollable contents, for the scroll bar.
pub const SCROLL_MARGIN: Margin = Margin { left: 0, right: MARGIN, top: 0, bottom: 0 };
/// The width of the labels in the rows of a panel.
pub const LABEL: f32 = 72.0;
/// The size of small text: keys, units, details.
pub const SMALL: f32 = 11.0;
/// The size of body text.
pub const BODY: f32 = 12.5;
/// The size of panel names.
pub const HEADING: f32 = 15.0;

/// The colours of one theme.
#[derive(Clone, Copy, Debug)]
struct Palette {
    panel: Color32,
    /// Text fields.
    field: Color32,
    /// Buttons at rest, under the pointer, pressed.
    control: Color32,
    hovered: Color32,
    pressed: Color32,
    line: Color32,
    text: Color32,
    weak: Color32,
    accent: Color32,
    selected: Color32,
    selected_text: Color32,
    error: Color32,
    axes: [Color32; 3],
}

const DARK: Palette = Palette {
    panel: gray(0x2a),
    field: gray(0x1b),
    control: gray(0x3a),
    hovered: gray(0x46),
    pressed: gray(0x50),
    line: gray(0x40),
    text: gray(0xe4),
    weak: gray(0xb4),
    accent: Color32::from_rgb(0x7d, 0xb8, 0xf7),
    selected: Color32::from_rgb(0x2c, 0x50, 0x7c),
    selected_text: Color32::WHITE,
    error: Color32::from_rgb(0xff, 0xa2, 0x9a),
    axes: [
        Color32::from_rgb(0xff, 0x9d, 0x94),
        Color32::from_rgb(0xa5, 0xdd, 0x8a),
        Color32::from_rgb(0x92, 0xbf, 0xff),
    ],
};

const LIGHT: Palette = Palette {
    panel: gray(0xf2),
    field: gray(0xff),
    control: gray(0xe2),
    hovered: gray(0xd6),
    pressed: gray(0xca),
    line: gray(0xcc),
    text: gray(0x1c),
    weak: gray(0x50),
    accent: Color32::from_rgb(0x17, 0x5c, 0xb0),
    selected: Color32::from_rgb(0xc6, 0xdc, 0xf6),
    selected_text: Color32::from_rgb(0x0b, 0x2a, 0x50),
    error: Color32::from_rgb(0x9c, 0x1c, 0x16),
    axes: [
        Color32::from_rgb(0xa0, 0x1f, 0x18),
        Color32::from_rgb(0x1d, 0x5c, 0x0c),
        Color32::from_rgb(0x17, 0x55, 0xa4),
    ],
};

const fn gray(level: u8) -> Color32 {
    Color32::from_gray(level)
}

pub(crate) fn icon_family() -> FontFamily {
    FontFamily::Name("icons".into())
}

fn icon_font() -> FontInsert {
    let mut data = FontData::from_static(include_bytes!("../../assets/icons.ttf"));
    // Without this, the symbols are a little too high.
    data.tweak.y_offset_factor = 0.05;
    let (family, priority) = (icon_family(), FontPriority::Highest);
    FontInsert::new("icons", data, vec![InsertFontFamily { family, priority }])
}

/// Installs the styles of both themes and the font of the icons.
pub fn install(ctx: &Context) {
    ctx.add_font(icon_font());
    ctx.set_style_of(Theme::Dark, style(Visuals::dark(), &DARK));
    ctx.set_style_of(Theme::Light, style(Visuals::light(), &LIGHT));
}

/// Returns the colour of the selection and of the focus.
pub(crate) fn accent(visuals: &Visuals) -> Color32 {
    palette(visuals).accent
}

/// Returns the colour of the selection over the picture, on a dark edge. It is the same in both
/// themes, since the picture is too.
pub(crate) const fn accent_on_dark() -> Color32 {
    DARK.accent
}

/// Returns the colour of warnings over the picture.
pub(crate) const fn warning_on_dark() -> Color32 {
    DARK.error
}

pub(crate) fn error(visuals: &Visuals) -> Color32 {
    palette(visuals).error
}

/// Returns the colour of an axis's letter.
pub(crate) fn axis(visuals: &Visuals, axis: Axis) -> Color32 {
    palette(visuals).axes[axis.index()]
}

/// Returns the colour of an axis over the picture, on a dark background.
pub(crate) const fn axis_on_dark(axis: Axis) -> Color32 {
    DARK.axes[axis.index()]
}

/// Returns the colour of lines between panels and around fields.
pub(crate) fn line(visuals: &Visuals) -> Color32 {
    palette(visuals).line
}

/// Returns the ring around the control with keyboard focus.
pub(crate) fn ring(visuals: &Visuals) -> Stroke {
    Stroke::new(2.0, palette(visuals).accent)
}

const fn palette(visuals: &Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

fn style(visuals: Visuals, palette: &Palette) -> Style {
    let mut style = Style { visuals: colors(visuals, palette), ..Style::default() };
    let font = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(SMALL)),
        (TextStyle::Body, font(BODY)),
        (TextStyle::Button, font(BODY)),
        (TextStyle::Heading, font(HEADING)),
        (TextStyle::Monospace, FontId::new(SMALL, FontFamily::Monospace)),
    ]
    .into();
    style.compact_menu_style = false;
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.4;
    style.animation_time = 0.08;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(GAP, GAP);
    spacing.button_padding = vec2(8.0, 2.0);
    spacing.interact_size = vec2(ROW, ROW);
    spacing.indent = 14.0;
    spacing.icon_width = 14.0;
    spacing.icon_spacing = 6.0;
    spacing.window_margin = Margin::same(MARGIN);
    spacing.menu_margin = Margin::same(6);
    spacing.tooltip_width = 300.0;
    spacing.slider_rail_height = 4.0;
    spacing.scroll = ScrollStyle {
        floating_allocated_width: 0.0,
        bar_width: 6.0,
        floating_width: 4.0,
        ..ScrollStyle::floating()
    };
    style
}

fn colors(base: Visuals, palette: &Palette) -> Visuals {
    let shadow =
        Shadow { offset: [0, 4], blur: 16, spread: 0, color: Color32::from_black_alpha(80) };
    Visuals {
        weak_text_color: Some(palette.weak),
        widgets: widgets(palette),
        selection: egui::style::Selection {
            bg_fill: palette.selected,
            stroke: Stroke::new(1.0, palette.selected_text),
        },
        hyperlink_color: palette.accent,
        faint_bg_color: palette.panel.lerp_to_gamma(palette.control, 0.4),
        extreme_bg_color: palette.field,
        code_bg_color: palette.field,
        warn_fg_color: palette.error,
        error_fg_color: palette.error,
        window_fill: palette.panel,
        window_stroke: Stroke::new(1.0, palette.line),
        window_shadow: shadow,
        popup_shadow: shadow,
        window_highlight_topmost: false,
        panel_fill: palette.panel,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        // Disabled controls remain readable.
        disabled_alpha: 0.6,
        ..base
    }
}

fn widgets(palette: &Palette) -> Widgets {
    let Palette { panel, control, hovered, pressed, line, text, .. } = *palette;
    let visuals = |fill, stroke| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: stroke,
        corner_radius: CornerRadius::same(4),
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    Widgets {
        noninteractive: visuals(panel, Stroke::new(1.0, line)),
        inactive: visuals(control, Stroke::NONE),
        hovered: visuals(hovered, Stroke::NONE),
        // egui uses these for the focused control: the stroke is the focus ring.
        active: visuals(pressed, Stroke::new(2.0, palette.accent)),
        open: visuals(hovered, Stroke::NONE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the contrast ratio of WCAG 2.1: (L1 + 0.05) / (L2 + 0.05), L the relative
    /// luminance.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let luminance = |color: Color32| {
            let linear = |byte: u8| {
                let c = f64::from(byte) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
            };
            let [r, g, b, _] = color.to_array();
            0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_has_enough_contrast_with_its_backgrounds() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        for palette in [&DARK, &LIGHT] {
            let Palette { panel, field, control, hovered, pressed, .. } = *palette;
            for ground in [panel, field, control, hovered, pressed] {
                assert!(contrast(palette.text, ground) >= 4.5, "text on {ground:?}");
            }
            for ground in [panel, field, control] {
                let texts = [palette.weak, palette.error];
                for text in texts.iter().chain(&palette.axes) {
                    assert!(contrast(*text, ground) >= 4.5, "{text:?} on {ground:?}");
                }
            }
            assert!(contrast(palette.selected_text, palette.selected) >= 4.5);
        }
    }

    #[test]
    fn the_focus_ring_contrasts_with_every_background() {
        for palette in [&DARK, &LIGHT] {
            for ground in [palette.panel, palette.pressed, palette.field, palette.selected] {
                assert!(contrast(palette.accent, ground) >= 3.0, "on {ground:?}");
            }
        }
    }
}
