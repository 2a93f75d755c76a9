//! The icons of the window: symbols of the Material Symbols font.

use egui::{Align2, Color32, FontId, Painter, Rect};

use crate::app::theme;
use marraztu_core::scene::{ItemId, Light, Scene};

/// An icon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Icon {
    /// An object.
    Object,
    /// A part of an object.
    Part,
    /// A camera.
    Camera,
    /// A light, by the code point of its kind.
    Light(&'static str),
    /// Visible.
    Eye,
    /// Hidden.
    EyeClosed,
    /// Locked.
    Lock,
    /// Not locked.
    LockOpen,
    /// A light that is on.
    On,
    /// A light that is off.
    Off,
    /// Add.
    Plus,
    /// Duplicate.
    Copy,
    /// Rename.
    Pen,
    /// Delete.
    Bin,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// Search.
    Search,
    /// The loupe.
    Loupe,
    /// Up.
    Up,
    /// Down.
    Down,
    /// To the left.
    Left,
    /// To the right, or folded.
    Right,
    /// On, or done.
    Tick,
    /// A refusal or an error.
    Warning,
    /// A notice.
    Info,
    /// The outline.
    List,
    /// The switches of the view.
    Switches,
    /// The properties.
    Properties,
}

impl Icon {
    /// Returns the icon of an item.
    pub(crate) fn of(scene: &Scene, id: ItemId) -> Self {
        match id {
            ItemId::Object(_) => Self::Object,
            ItemId::Camera(_) => Self::Camera,
            ItemId::Light(id) => scene.lights.get(id).map_or(Self::Off, Self::of_light),
        }
    }

    /// Returns the icon of a light.
    pub(crate) const fn of_light(light: &Light) -> Self {
        Self::Light(light.kind.info().icon)
    }

    /// Draws the icon in the middle of `rect`, `side` points wide.
    pub(crate) fn paint(self, painter: &Painter, rect: Rect, side: f32, color: Color32) {
        // Symbols fill about 3/4 of their em square.
        let font = FontId::new((side * 4.0 / 3.0).round(), theme::icon_family());
        painter.text(rect.center(), Align2::CENTER_CENTER, self.symbol(), font, color);
    }

    /// Returns the code point in the font, `assets/icons.ttf`, which `assets/icons.py` makes.
    const fn symbol(self) -> &'static str {
        match self {
            Self::Object => "\u{f720}",
            Self::Part => "\u{e86b}",
            Self::Camera => "\u{e04b}",
            Self::Light(code_point) => code_point,
            Self::Eye => "\u{e8f4}",
            Self::EyeClosed => "\u{e8f5}",
            Self::Lock => "\u{e899}",
            Self::LockOpen => "\u{e898}",
            Self::On => "\u{e837}",
            Self::Off => "\u{e836}",
            Self::Plus => "\u{e145}",
            Self::Copy => "\u{e14d}",
            Self::Pen => "\u{f097}",
            Self::Bin => "\u{e92e}",
            Self::Undo => "\u{e166}",
            Self::Redo => "\u{e15a}",
            Self::Search => "\u{ef7a}",
            Self::Loupe => "\u{e8ff}",
            Self::Up => "\u{e316}",
            Self::Down => "\u{e313}",
            Self::Left => "\u{e314}",
            Self::Right => "\u{e315}",
            Self::Tick => "\u{e668}",
            Self::Warning => "\u{f083}",
            Self::Info => "\u{e88e}",
            Self::List => "\u{e896}",
            Self::Switches => "\u{e9f6}",
            Self::Properties => "\u{e429}",
        }
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
