//! The list of a file browser: names, sizes and dates, sorted by a click on a column.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use egui::{Align2, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::{Browser, Entry};
use crate::app::theme;
use crate::app::widgets::controls::{focus_ring, put_text, text};
use crate::app::widgets::icons::Icon;

const HEIGHT: f32 = 264.0;

/// The widths of the columns for size and date.
const SIZE: f32 = 70.0;
const DATE: f32 = 90.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Column {
    #[default]
    Name,
    Size,
    Date,
}

impl Column {
    const ALL: [Self; 3] = [Self::Name, Self::Size, Self::Date];

    const fn label(self) -> &'static str {
        match self {
            Self::Name => "Name",
            Self::Size => "Size",
            Self::Date => "Date",
        }
    }

    /// Returns the part of a line that the column occupies.
    fn within(self, line: Rect) -> Rect {
        let date = (line.right() - DATE).max(line.left());
        let size = (date - SIZE).max(line.left());
        match self {
            Self::Name => line.with_max_x(size),
            Self::Size => line.with_min_x(size).with_max_x(date),
            Self::Date => line.with_min_x(date),
        }
    }
}

/// The display of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Look {
    /// Whether to list files with names that begin with a dot.
    pub(crate) hidden: bool,
    pub(crate) by: Column,
    pub(crate) reversed: bool,
}

impl Look {
    /// Sorts entries, folders before files.
    pub(super) fn sort(self, entries: &mut [Entry]) {
        let name = |entry: &Entry| entry.name.to_lowercase();
        entries.sort_by(|a, b| {
            let order = match self.by {
                Column::Name => name(a).cmp(&name(b)),
                // The largest and the latest come first, which users look for most.
                Column::Size => b.bytes.cmp(&a.bytes).then_with(|| name(a).cmp(&name(b))),
                Column::Date => b.modified.cmp(&a.modified).then_with(|| name(a).cmp(&name(b))),
            };
            let order = if self.reversed { order.reverse() } else { order };
            b.is_folder.cmp(&a.is_folder).then(order)
        });
    }
}

impl Browser {
    /// Lists the entries that match the typed name. Returns the path that was clicked. If the
    /// selection has `moved`, its line is scrolled into view.
    pub(super) fn list_ui(&mut self, ui: &mut Ui, moved: bool) -> Option<PathBuf> {
        ui.spacing_mut().item_spacing.y = 0.0;
        // A second click on a column reverses its order.
        if let Some(column) = self.header_ui(ui) {
            self.look.reversed = self.look.by == column && !self.look.reversed;
            self.look.by = column;
            self.look.sort(&mut self.entries);
        }
        let (rows, typed) = (self.rows(), self.typed());
        let now = SystemTime::now();
        let mut list = egui::ScrollArea::vertical()
            .max_height(HEIGHT)
            .min_scrolled_height(HEIGHT)
            .auto_shrink([false, false])
            .content_margin(theme::SCROLL_MARGIN);
        if let Some(at) = rows.iter().position(|(path, _)| *path == typed).filter(|_| moved) {
            let at = u16::try_from(at).unwrap_or(u16::MAX);
            list = list.vertical_scroll_offset((f32::from(at) + 0.5) * theme::ROW - HEIGHT / 2.0);
        }
        let mut clicked = None;
        list.show_rows(ui, theme::ROW, rows.len(), |ui, range| {
            for (path, entry) in &rows[range] {
                if row_ui(ui, *entry, *path == typed, now) {
                    clicked = Some(path.clone());
                }
            }
        });
        clicked
    }

    /// Shows the names of the columns. Returns the column that was clicked.
    fn header_ui(&self, ui: &mut Ui) -> Option<Column> {
        let width = ui.available_width() - f32::from(theme::MARGIN);
        let (line, _) = ui.allocate_exact_size(vec2(width, theme::ROW), Sense::hover());
        let mut clicked = None;
        for column in Column::ALL {
            let rect = column.within(line);
            let name = format!("Sort by {}", column.label().to_lowercase());
            let response = ui.interact(rect, ui.scope_id().with(&name), Sense::click());
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            let by = self.look.by == column;
            let visuals = ui.visuals();
            let color = match by || response.hovered() {
                true => visuals.strong_text_color(),
                false => visuals.weak_text_color(),
            };
            let label = text(ui, column.label(), TextStyle::Body, rect.width() - 20.0);
            let end = rect.left() + theme::GAP + label.size().x;
            put_text(ui, rect.with_min_x(rect.left() + theme::GAP), label, color);
            if by {
                let icon = if self.look.reversed { Icon::UP } else { Icon::DOWN };
                let place =
                    Rect::from_center_size(pos2(end + 9.0, rect.center().y), vec2(12.0, 12.0));
                icon.paint(ui.painter(), place, 10.0, color);
            }
            focus_ring(ui, rect, &response);
            if response.on_hover_text(&name).clicked() {
                clicked = Some(column);
            }
        }
        ui.painter().hline(line.x_range(), line.bottom(), (1.0, theme::line(ui.visuals())));
        clicked
    }
}

/// Shows a line of the list. Returns whether it was clicked.
fn row_ui(ui: &mut Ui, entry: Option<&Entry>, chosen: bool, now: SystemTime) -> bool {
    let (line, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::click());
    let name = match entry {
        Some(entry) if entry.is_folder => format!("{}/", entry.name),
        Some(entry) => entry.name.clone(),
        None => "..".to_owned(),
    };
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    let visuals = ui.visuals();
    let (mut color, mut weak) = (visuals.text_color(), visuals.weak_text_color());
    if chosen {
        ui.painter().rect_filled(line, 4.0, visuals.selection.bg_fill);
        color = visuals.selection.stroke.color;
        weak = color;
    } else if response.hovered() {
        ui.painter().rect_filled(line, 4.0, visuals.widgets.inactive.bg_fill);
    }
    let put = |column: Column, words: &str, color| {
        let rect = column.within(line).shrink2(vec2(theme::GAP, 0.0));
        let galley = text(ui, words, TextStyle::Body, rect.width());
        let rect = match column {
            // Numbers are right-aligned to compare them.
            Column::Size => Align2::RIGHT_CENTER.align_size_within_rect(galley.size(), rect),
            Column::Name | Column::Date => rect,
        };
        put_text(ui, rect, galley, color);
    };
    put(Column::Name, &name, color);
    if let Some(entry) = entry {
        if !entry.is_folder {
            put(Column::Size, &size(entry.bytes), weak);
        }
        let age = entry.modified.map(|modified| age(modified, now));
        put(Column::Date, &age.unwrap_or_default(), weak);
    }
    focus_ring(ui, line, &response);
    response.clicked()
}

/// Formats a size: "812 B", "4.3 KB", "12 MB", with at least two digits.
#[expect(clippy::cast_precision_loss, reason = "two digits are shown")]
fn size(bytes: u64) -> String {
    let mut rest = bytes as f64;
    for unit in ["B", "KB", "MB", "GB"] {
        if rest < 999.5 {
            let digits = usize::from(rest < 9.95 && unit != "B");
            return format!("{rest:.digits$} {unit}");
        }
        rest /= 1000.0;
    }
    format!("{rest:.0} TB")
}

/// Formats an age: "5 min ago", "3 h ago", "2 days ago". Older files show their date in UTC.
fn age(modified: SystemTime, now: SystemTime) -> String {
    const MINUTE: u64 = 60;
    const HOUR: u64 = 60 * MINUTE;
    const DAY: u64 = 24 * HOUR;
    let seconds = now.duration_since(modified).unwrap_or_default().as_secs();
    match seconds {
        0..MINUTE => "just now".to_owned(),
        MINUTE..HOUR => format!("{} min ago", seconds / MINUTE),
        HOUR..DAY => format!("{} h ago", seconds / HOUR),
        _ if seconds < 2 * DAY => "1 day ago".to_owned(),
        _ if seconds < 7 * DAY => format!("{} days ago", seconds / DAY),
        _ => {
            let since = modified.duration_since(SystemTime::UNIX_EPOCH);
            day(since.unwrap_or(Duration::ZERO).as_secs() / DAY)
        }
    }
}

/// Formats a day, counted from 1 January 1970, as "2026-11-27".
///
/// Years begin in March here, which makes the leap day the last day of a year. After H. Hinnant,
/// "chrono-compatible low-level date algorithms", 2013.
fn day(days: u64) -> String {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_two_digits_and_ages_a_unit() {
        let sizes = [0, 999, 1000, 4321, 99_999, 12_345_678].map(size);
        assert_eq!(sizes, ["0 B", "999 B", "1.0 KB", "4.3 KB", "100 KB", "12 MB"]);
        let now = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_737_600);
        let ages = [5, 300, 7200, 100_000, 500_000, 5_000_000]
            .map(|seconds| age(now - Duration::from_secs(seconds), now));
        let expected =
            ["just now", "5 min ago", "2 h ago", "1 day ago", "5 days ago", "2026-09-30"];
        assert_eq!(ages, expected);
        assert_eq!(
            [0, 59, 11_016, 19_782].map(day),
            ["1970-01-01", "1970-03-01", "2000-02-29", "2024-02-29"]
        );
    }

    #[test]
    fn folders_come_first_in_every_order() {
        let entry = |name: &str, is_folder, bytes| {
            let modified = Some(SystemTime::UNIX_EPOCH + Duration::from_secs(bytes));
            Entry { path: PathBuf::from(name), name: name.to_owned(), is_folder, bytes, modified }
        };
        let mut entries = [entry("b", false, 9), entry("A", false, 1), entry("z", true, 5)];
        let mut sorted = |by, reversed| {
            Look { hidden: false, by, reversed }.sort(&mut entries);
            entries.each_ref().map(|entry| entry.name.clone()).concat()
        };
        assert_eq!(sorted(Column::Name, false), "zAb");
        assert_eq!(sorted(Column::Name, true), "zbA");
        assert_eq!(sorted(Column::Size, false), "zbA");
        assert_eq!(sorted(Column::Date, true), "zAb");
    }
}
