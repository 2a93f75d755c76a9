//! What scene files and preferences keep of the window.

use serde::{Deserialize, Serialize};

/// What a scene file keeps of the window in which the scene was saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowState {
    /// Whether pictures may be coarser while something moves, if they would come too late
    /// otherwise.
    pub coarse_while_moving: bool,
    /// Which panels are open.
    pub panels: Panels,
}

impl WindowState {
    /// That of the first start.
    pub const DEFAULT: Self = Self { coarse_while_moving: true, panels: Panels::DEFAULT };
}

/// Which panels are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Panels {
    /// The list of objects, cameras and lights.
    pub outline: bool,
    /// The properties of the selected item.
    pub properties: bool,
    /// The switches of the view.
    pub view: bool,
    /// The plan of the frame.
    pub statistics: bool,
    /// The settings of accuracy.
    pub plan: bool,
    /// The list of keys.
    pub cheat_sheet: bool,
    /// The laboratory.
    pub laboratory: bool,
}

impl Panels {
    /// The panels of the first start.
    pub const DEFAULT: Self = Self {
        outline: true,
        properties: true,
        view: true,
        statistics: false,
        plan: false,
        cheat_sheet: false,
        laboratory: false,
    };
}

impl Default for Panels {
    fn default() -> Self {
        Self::DEFAULT
    }
}
