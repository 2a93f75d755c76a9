//! The icons of the window: symbols of the Material Symbols font.

use egui::{Align2, Color32, FontId, Painter, Rect};

use crate::app::theme;
use marraztu_core::scene::{ItemId, Light, Scene};

/// An icon: the code point of a symbol in `assets/icons.ttf`, which `assets/icons.py` makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Icon(&'static str);

impl Icon {
    pub(crate) const OBJECT: Self = Self("\u{f720}");
    pub(crate) const PART: Self = Self("\u{e86b}");
    pub(crate) const CAMERA: Self = Self("\u{e04b}");
    /// Visible.
    pub(crate) const EYE: Self = Self("\u{e8f4}");
    /// Hidden.
    pub(crate) const EYE_CLOSED: Self = Self("\u{e8f5}");
    pub(crate) const LOCK: Self = Self("\u{e899}");
    /// Not locked.
    pub(crate) const LOCK_OPEN: Self = Self("\u{e898}");
    /// A light that is on.
    pub(crate) const ON: Self = Self("\u{e837}");
    /// A light that is off.
    pub(crate) const OFF: Self = Self("\u{e836}");
    /// Add.
    pub(crate) const PLUS: Self = Self("\u{e145}");
    /// Duplicate.
    pub(crate) const COPY: Self = Self("\u{e14d}");
    /// Rename.
    pub(crate) const PEN: Self = Self("\u{f097}");
    /// Delete.
    pub(crate) const BIN: Self = Self("\u{e92e}");
    pub(crate) const UNDO: Self = Self("\u{e166}");
    pub(crate) const REDO: Self = Self("\u{e15a}");
    pub(crate) const SEARCH: Self = Self("\u{ef7a}");
    pub(crate) const LOUPE: Self = Self("\u{e8ff}");
    pub(crate) const UP: Self = Self("\u{e316}");
    pub(crate) const DOWN: Self = Self("\u{e313}");
    pub(crate) const LEFT: Self = Self("\u{e314}");
    /// To the right, or folded.
    pub(crate) const RIGHT: Self = Self("\u{e315}");
    /// On, or done.
    pub(crate) const TICK: Self = Self("\u{e668}");
    /// A refusal or an error.
    pub(crate) const WARNING: Self = Self("\u{f083}");
    /// A notice.
    pub(crate) const INFO: Self = Self("\u{e88e}");
    /// The outline.
    pub(crate) const LIST: Self = Self("\u{e896}");
    /// The switches of the view.
    pub(crate) const SWITCHES: Self = Self("\u{e9f6}");
    pub(crate) const PROPERTIES: Self = Self("\u{e429}");

    pub(crate) fn of(scene: &Scene, id: ItemId) -> Self {
        match id {
            ItemId::Object(_) => Self::OBJECT,
            ItemId::Camera(_) => Self::CAMERA,
            ItemId::Light(id) => scene.lights.get(id).map_or(Self::OFF, Self::of_light),
        }
    }

    /// Returns the icon of a light.
    pub(crate) const fn of_light(light: &Light) -> Self {
        Self(light.kind.info().icon)
    }

    /// Draws the icon in the middle of `rect`, `side` points wide.
    pub(crate) fn paint(self, painter: &Painter, rect: Rect, side: f32, color: Color32) {
        // Symbols fill about 3/4 of their em square.
        let font = FontId::new((side * 4.0 / 3.0).round(), theme::icon_family());
        painter.text(rect.center(), Align2::CENTER_CENTER, self.0, font, color);
    }
}

#[cfg(test)]
mod tests {
    use ttf_parser::Face;

    #[test]
    fn the_font_has_every_icon() {
        let font = Face::parse(include_bytes!("../../../assets/icons.ttf"), 0).unwrap();
        let lights = include_str!("../../../crates/core/src/scene/light_kind.rs");
        let written = include_str!("icons.rs").split("#[cfg(test)]").next().unwrap();
        let parts = written.split("\\u{").skip(1).chain(lights.split("\\u{").skip(1));
        let codes: Vec<&str> = parts.filter_map(|part| Some(part.split_once('}')?.0)).collect();
        assert!(codes.len() > 30);
        for code in codes {
            let icon = char::from_u32(u32::from_str_radix(code, 16).unwrap()).unwrap();
            assert!(font.glyph_index(icon).is_some(), "{code}: run assets/icons.py");
        }
    }
}
