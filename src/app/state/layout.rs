//! Divides the window among the panels and the picture.
//!
//! Splitters set wishes: widths of the columns in points, and heights as shares. Each frame derives
//! the real sizes from the wishes and from the size of the window. The wishes do not change, so
//! panels recover when a small window becomes large again.

use std::collections::BTreeMap;

use egui::{Rect, pos2, vec2};

use crate::app::panels::{Dock, OpenPanels, Panel, Side};

/// Windows narrower than this show one panel at a time, next to a strip of buttons.
pub const NARROW: f32 = 900.0;

/// Windows at least this wide have room for wider columns.
const WIDE: f32 = 1200.0;

/// The width of the strip of buttons in a narrow window.
const STRIP: f32 = 30.0;

/// The least height of the picture and of a panel that shares a column.
const LEAST: f32 = 72.0;

/// A border between two panels that the user can drag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Splitter {
    /// At the right of the left column.
    Left,
    /// At the left of the properties.
    Right,
    /// Between the outline and the switches.
    Switches,
    /// Above the laboratory.
    Laboratory,
    /// Above the plan.
    Plan,
}

impl Splitter {
    /// All splitters.
    pub const ALL: [Self; 5] =
        [Self::Left, Self::Right, Self::Switches, Self::Laboratory, Self::Plan];

    /// Returns its name for screen readers.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Left => "Width of the left column",
            Self::Right => "Width of the properties",
            Self::Switches => "Height of the view switches",
            Self::Laboratory => "Height of the laboratory",
            Self::Plan => "Height of the plan",
        }
    }

    /// Returns its name in preferences.
    fn word(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Returns whether it is dragged to the left and right.
    pub const fn is_upright(self) -> bool {
        matches!(self, Self::Left | Self::Right)
    }
}

/// The sizes that the user wishes; `None` is the size that suits the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layout {
    /// The wish of each splitter: a width in points, or a height as a share from 0 to 1. The plan's
    /// is a share of the height above the laboratory.
    pub(crate) wishes: [Option<f32>; Splitter::ALL.len()],
    /// The panel that is unfolded in a narrow window.
    pub unfolded: Option<Side>,
    /// Whether the picture has the whole width: no side panel, and no buttons that unfold one.
    pub bare: bool,
}

/// The places of everything between the menus and the status line.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// The buttons that unfold panels, in a narrow window.
    pub strip: Option<Rect>,
    /// The docked panels.
    docks: BTreeMap<Dock, Rect>,
    /// The picture.
    pub picture: Rect,
}

impl Layout {
    /// Returns the sizes that the user has chosen, by the names of the splitters.
    pub fn shares(&self) -> BTreeMap<String, f32> {
        let chosen = |splitter: Splitter| Some((splitter.word(), self.wish(splitter)?));
        Splitter::ALL.into_iter().filter_map(chosen).collect()
    }

    /// Creates the layout with these sizes.
    pub fn of_shares(shares: &BTreeMap<String, f32>) -> Self {
        let wishes = Splitter::ALL.map(|splitter| shares.get(&splitter.word()).copied());
        Self { wishes, ..Self::default() }
    }

    const fn wish(&self, splitter: Splitter) -> Option<f32> {
        self.wishes[splitter as usize]
    }
}

/// Returns a part of `of` with at least `least` points, leaving at least `rest`; half if there is
/// not enough room.
fn share(of: f32, part: f32, least: f32, rest: f32) -> f32 {
    let size = if of < least + rest { of / 2.0 } else { (of * part).clamp(least, of - rest) };
    size.round()
}

impl Layout {
    /// Divides `area` among the open panels and the picture.
    pub fn divide(&self, area: Rect, panels: OpenPanels) -> Places {
        let mut places = Places::of_picture(area);
        // The laboratory spans the width of the window, so it is cut off first.
        if panels.has(Panel::Laboratory) {
            let part = self.wish(Splitter::Laboratory).unwrap_or(0.5);
            places.cut_off(Dock::Bottom, share(area.height(), part, 150.0, 150.0));
        }
        if self.bare {
            // The picture has no columns beside it.
        } else if area.width() < NARROW {
            self.one_column(&mut places);
        } else {
            self.columns(area.width(), panels, &mut places);
        }
        // The plan lies under the picture, between the columns.
        if panels.has(Panel::Plan) {
            let part = self.wish(Splitter::Plan).unwrap_or(0.34);
            let height = share(places.picture.height(), part, 90.0, LEAST);
            places.cut_off(Dock::UnderPicture, height);
        }
        places
    }

    /// Places the strip and the one panel that is unfolded.
    fn one_column(&self, places: &mut Places) {
        let Places { strip, docks, picture: rest } = places;
        *strip = Some(rest.with_max_x(rest.left() + STRIP));
        rest.min.x += STRIP;
        let Some(side) = self.unfolded else { return };
        let wish = match side {
            Side::Outline | Side::Switches => self.wish(Splitter::Left),
            Side::Properties => self.wish(Splitter::Right),
        };
        let width = share(rest.width(), wish.unwrap_or(250.0) / rest.width(), 220.0, 40.0);
        docks.insert(Dock::Beside(side), rest.with_max_x(rest.left() + width));
        rest.min.x += width;
    }

    /// Places the columns at both sides.
    fn columns(&self, width: f32, panels: OpenPanels, places: &mut Places) {
        let Places { docks, picture: rest, .. } = places;
        let mut dock = |side, place| docks.extend([(Dock::Beside(side), place)]);
        let (left, right) = if width >= WIDE { (228.0, 280.0) } else { (212.0, 256.0) };
        if panels.has(Panel::Outline) || panels.has(Panel::View) {
            let left = self.wish(Splitter::Left).unwrap_or(left).clamp(180.0, width * 0.28).round();
            let column = rest.with_max_x(rest.left() + left);
            rest.min.x += left;
            match (panels.has(Panel::Outline), panels.has(Panel::View)) {
                (true, true) => {
                    let part = self.wish(Splitter::Switches).unwrap_or(0.56);
                    let height = share(column.height(), part, LEAST, LEAST);
                    let (above, below) = cut(column, column.bottom() - height);
                    dock(Side::Outline, above);
                    dock(Side::Switches, below);
                }
                (true, false) => dock(Side::Outline, column),
                _ => dock(Side::Switches, column),
            }
        }
        if panels.has(Panel::Properties) {
            let right =
                self.wish(Splitter::Right).unwrap_or(right).clamp(232.0, width * 0.34).round();
            dock(Side::Properties, rest.with_min_x(rest.right() - right));
            rest.max.x -= right;
        }
    }

    /// Returns the layout after a splitter was dragged to `to`, given the places of the panels now.
    #[must_use]
    pub fn dragged(mut self, splitter: Splitter, to: egui::Pos2, area: Rect, now: &Places) -> Self {
        let part =
            |whole: Rect| ((whole.bottom() - to.y) / whole.height().max(1.0)).clamp(0.05, 0.95);
        let joined = |a: Option<Rect>, b: Option<Rect>| Some(a?.union(b?));
        let wish = match splitter {
            Splitter::Left => Some(to.x - area.left() - now.strip_width()),
            Splitter::Right if now.strip.is_some() => Some(to.x - area.left() - now.strip_width()),
            Splitter::Right => Some(area.right() - to.x),
            Splitter::Switches => {
                joined(now.beside(Side::Outline), now.beside(Side::Switches)).map(part)
            }
            Splitter::Laboratory => Some(part(area)),
            Splitter::Plan => joined(now.of(Dock::UnderPicture), Some(now.picture)).map(part),
        };
        self.wishes[splitter as usize] = wish.or(self.wish(splitter));
        self
    }

    /// Returns the layout with a splitter at its default place.
    #[must_use]
    pub const fn reset(mut self, splitter: Splitter) -> Self {
        self.wishes[splitter as usize] = None;
        self
    }
}

/// Splits a rectangle at a height into the parts above and below.
fn cut(rect: Rect, y: f32) -> (Rect, Rect) {
    (rect.with_max_y(y), rect.with_min_y(y))
}

impl Places {
    /// Gives everything to the picture.
    pub const fn of_picture(picture: Rect) -> Self {
        Self { strip: None, docks: BTreeMap::new(), picture }
    }

    /// Gives the lower part of the picture, of this height, to a dock.
    fn cut_off(&mut self, dock: Dock, height: f32) {
        let (above, below) = cut(self.picture, self.picture.bottom() - height);
        self.picture = above;
        self.docks.insert(dock, below);
    }

    fn strip_width(&self) -> f32 {
        self.strip.map_or(0.0, |strip| strip.width())
    }

    /// Returns the place of a dock, if it holds a panel.
    pub fn of(&self, dock: Dock) -> Option<Rect> {
        self.docks.get(&dock).copied()
    }

    fn beside(&self, side: Side) -> Option<Rect> {
        self.of(Dock::Beside(side))
    }

    /// Returns the area for grabbing a splitter, `thick` points wide, if the splitter is shown.
    pub fn grip(&self, splitter: Splitter, thick: f32) -> Option<Rect> {
        let upright = |rect: Rect, x: f32| {
            Rect::from_center_size(pos2(x, rect.center().y), vec2(thick, rect.height()))
        };
        let level = |rect: Rect| {
            Rect::from_center_size(pos2(rect.center().x, rect.top()), vec2(rect.width(), thick))
        };
        let (outline, switches) = (self.beside(Side::Outline), self.beside(Side::Switches));
        match splitter {
            Splitter::Left => {
                let column = match (outline, switches) {
                    (Some(outline), Some(switches)) => outline.union(switches),
                    (one, other) => one.or(other)?,
                };
                Some(upright(column, column.right()))
            }
            Splitter::Right => {
                let place = self.beside(Side::Properties)?;
                let x = if self.strip.is_some() { place.right() } else { place.left() };
                Some(upright(place, x))
            }
            Splitter::Switches => outline.and(switches).map(level),
            Splitter::Laboratory => self.of(Dock::Bottom).map(level),
            Splitter::Plan => self.of(Dock::UnderPicture).map(level),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [[f32; 2]; 8] = [
        [320.0, 150.0],
        [512.0, 270.0],
        [640.0, 350.0],
        [899.0, 350.0],
        [900.0, 350.0],
        [1024.0, 590.0],
        [1280.0, 750.0],
        [1920.0, 1030.0],
    ];

    fn every_layout(check: impl Fn(Layout, Rect, OpenPanels)) {
        let wishes = [Layout::default(), wished(40.0, 0.02), wished(2000.0, 0.98)];
        for [width, height] in SIZES {
            for bits in 0..32_u8 {
                let on = |bit: u8| bits >> bit & 1 == 1;
                let panels = OpenPanels::DEFAULT
                    .with(Panel::Outline, on(0))
                    .with(Panel::View, on(1))
                    .with(Panel::Properties, on(2))
                    .with(Panel::Laboratory, on(3))
                    .with(Panel::Plan, on(4));
                for wish in wishes {
                    check(wish, Rect::from_min_size(pos2(3.0, 26.0), vec2(width, height)), panels);
                }
            }
        }
    }

    fn wished(width: f32, part: f32) -> Layout {
        let wishes = [width, width, part, part, part].map(Some);
        Layout { wishes, unfolded: Some(Side::Properties), bare: false }
    }

    #[test]
    fn panels_and_picture_fill_the_area_and_share_no_point() {
        every_layout(|layout, area, panels| {
            let places = layout.divide(area, panels);
            let docks = places.docks.values().copied();
            let all: Vec<_> =
                places.strip.into_iter().chain(docks).chain([places.picture]).collect();
            let sum: f32 = all.iter().map(Rect::area).sum();
            assert!((sum - area.area()).abs() < 1.0, "{places:?}");
            for (i, a) in all.iter().enumerate() {
                assert!(area.contains_rect(*a), "{a} in {area}");
                assert!(a.width() >= 30.0 && a.height() >= 36.0, "{a} of {places:?}");
                for b in &all[i + 1..] {
                    assert!(!a.shrink(0.1).intersects(b.shrink(0.1)), "{a} and {b}");
                }
            }
        });
    }

    #[test]
    fn a_splitter_that_is_dragged_goes_where_it_is_dragged_and_back() {
        let area = Rect::from_min_size(pos2(0.0, 26.0), vec2(1280.0, 750.0));
        let panels = OpenPanels::DEFAULT.with(Panel::Plan, true).with(Panel::Laboratory, true);
        let now = Layout::default().divide(area, panels);
        for splitter in Splitter::ALL {
            let grip = now.grip(splitter, 6.0).unwrap();
            let to = grip.center() + vec2(17.0, -13.0);
            let layout = Layout::default().dragged(splitter, to, area, &now);
            let moved = layout.divide(area, panels).grip(splitter, 6.0).unwrap().center();
            let gone = if splitter.is_upright() { moved.x - to.x } else { moved.y - to.y };
            assert!(gone.abs() <= 1.0, "{splitter:?} is {gone} away");
            assert_eq!(layout.reset(splitter), Layout::default());
        }
    }

    #[test]
    fn a_window_that_was_small_has_its_panels_back() {
        let wishes = [("left".to_owned(), 300.0), ("laboratory".to_owned(), 0.6)];
        let layout = Layout::of_shares(&wishes.into());
        let panels = OpenPanels::DEFAULT.with(Panel::Laboratory, true);
        let large = Rect::from_min_size(pos2(0.0, 0.0), vec2(1920.0, 1030.0));
        let before = layout.divide(large, panels);
        let small = layout.divide(Rect::from_min_size(large.min, vec2(640.0, 350.0)), panels);
        assert!(small.beside(Side::Outline).is_none() && small.strip.is_some());
        assert_eq!(layout.divide(large, panels), before);
        assert_eq!(before.beside(Side::Outline).unwrap().width(), 300.0);
    }
}
