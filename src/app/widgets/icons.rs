//! The icons of the window: symbols of the Material Symbols font.

use egui::{Align2, Color32, FontId, Painter, Rect};
use egui_material_icons::{MaterialIcon, icons};

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
        let symbol = self.symbol();
        // Symbols fill about 3/4 of their em square.
        let font = FontId::new((side * 4.0 / 3.0).round(), symbol.font_family());
        painter.text(rect.center(), Align2::CENTER_CENTER, symbol.codepoint, font, color);
    }

    const fn symbol(self) -> MaterialIcon {
        match self {
            Self::Object => icons::ICON_DEPLOYED_CODE,
            Self::Part => icons::ICON_CHANGE_HISTORY,
            Self::Camera => icons::ICON_VIDEOCAM,
            Self::Light(code_point) => MaterialIcon::new(code_point),
            Self::Eye => icons::ICON_VISIBILITY,
            Self::EyeClosed => icons::ICON_VISIBILITY_OFF,
            Self::Lock => icons::ICON_LOCK,
            Self::LockOpen => icons::ICON_LOCK_OPEN,
            Self::On => icons::ICON_RADIO_BUTTON_CHECKED,
            Self::Off => icons::ICON_RADIO_BUTTON_UNCHECKED,
            Self::Plus => icons::ICON_ADD,
            Self::Copy => icons::ICON_CONTENT_COPY,
            Self::Pen => icons::ICON_EDIT,
            Self::Bin => icons::ICON_DELETE,
            Self::Undo => icons::ICON_UNDO,
            Self::Redo => icons::ICON_REDO,
            Self::Search => icons::ICON_SEARCH,
            Self::Loupe => icons::ICON_ZOOM_IN,
            Self::Up => icons::ICON_KEYBOARD_ARROW_UP,
            Self::Down => icons::ICON_KEYBOARD_ARROW_DOWN,
            Self::Left => icons::ICON_KEYBOARD_ARROW_LEFT,
            Self::Right => icons::ICON_KEYBOARD_ARROW_RIGHT,
            Self::Tick => icons::ICON_CHECK,
            Self::Warning => icons::ICON_WARNING,
            Self::Info => icons::ICON_INFO,
            Self::List => icons::ICON_LIST,
            Self::Switches => icons::ICON_TOGGLE_ON,
            Self::Properties => icons::ICON_TUNE,
        }
    }
}
