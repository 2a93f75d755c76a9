//! Draws the plots of a report as SVG and PNG, light and dark.
//!
//! `plotters` draws them with the window's fonts, so a plot looks the same on every machine. The
//! title and the verdict are at the top, then the overview, then a panel for each axis, all with
//! the same scales.

mod contact_sheet;
mod drag;
mod page;
mod picture_pages;
mod report_page;
mod text;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use marraztu_core::base::image::{Picture, Size};
use marraztu_lab::report::{Panel, PanelMark, Panels, Report, Scale, TextBox, place};

pub use contact_sheet::{SheetCell, contact_sheet};
pub use drag::FrontPicture;
pub use page::{page_html, page_markdown, plot_name, sections};
pub use picture_pages::{PageCell, compare_page, sheet_page};
pub use report_page::{PagePicture, report_page};

use text::{Label, size_of};

/// The error of a plot that could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the plot could not be drawn: {0}")]
pub struct PlotError(String);

/// The colour theme of a plot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// Dark ink on white.
    #[default]
    Light,
    /// Light ink on black.
    Dark,
}

/// The colours: the data have the strongest contrast, the grid the weakest.
struct Colors {
    paper: RGBColor,
    ink: RGBColor,
    faint: RGBColor,
    grid: RGBColor,
    noise: RGBColor,
    /// The choices of an axis.
    data: RGBColor,
    /// The default.
    default: RGBColor,
}

// The data use the colours of Okabe and Ito, which colour-blind readers can distinguish.
const LIGHT: Colors = Colors {
    paper: RGBColor(255, 255, 255),
    ink: RGBColor(34, 34, 40),
    faint: RGBColor(104, 104, 112),
    grid: RGBColor(236, 236, 239),
    noise: RGBColor(222, 226, 236),
    data: RGBColor(0, 114, 178),
    default: RGBColor(213, 94, 0),
};
const DARK: Colors = Colors {
    paper: RGBColor(24, 24, 28),
    ink: RGBColor(230, 230, 234),
    faint: RGBColor(160, 160, 168),
    grid: RGBColor(42, 42, 48),
    noise: RGBColor(50, 54, 66),
    data: RGBColor(86, 180, 233),
    default: RGBColor(230, 159, 0),
};

impl Look {
    const fn colors(self) -> &'static Colors {
        match self {
            Self::Light => &LIGHT,
            Self::Dark => &DARK,
        }
    }
}

const WIDTH: i32 = 1120;
const EDGE: i32 = 20;
/// The height of a line of the verdict.
const LINE: i32 = 20;
const OVERVIEW: i32 = 340;
const COLUMNS: i32 = 3;
const ROW: i32 = 250;
/// The margins of a panel for its title above and its ticks to the left and below.
const ROOM: [i32; 3] = [26, 54, 42];
/// Half the width of a mark.
const MARK: i32 = 5;

/// Draws the plot as SVG.
///
/// # Errors
/// If the plotting library fails.
pub fn svg(report: &Report, look: Look) -> Result<String, PlotError> {
    let sheet = Sheet::new(report, look);
    let size = (WIDTH.cast_unsigned(), sheet.height().cast_unsigned());
    drawn_svg(size, |area, labels| sheet.draw(area, labels))
}

/// Draws the panel of one axis as SVG, or the overview if the axis was not measured.
///
/// # Errors
/// If the plotting library fails.
pub fn panel_svg(report: &Report, key: Option<&str>, look: Look) -> Result<String, PlotError> {
    let sheet = Sheet::new(report, look);
    let (width, height) = (640, 340);
    drawn_svg((640, 340), |area, labels| {
        area.fill(&sheet.colors.paper)?;
        sheet.panel(area, labels, sheet.panels.of(key), [8, 8, width - 8, height - 8])
    })
}

/// Draws the plot as a picture.
///
/// # Errors
/// If the plotting library fails.
pub fn png(report: &Report, look: Look) -> Result<Picture, PlotError> {
    let sheet = Sheet::new(report, look);
    let (width, height) = (WIDTH.cast_unsigned(), sheet.height().cast_unsigned());
    let size = Size::new(width as usize, height as usize);
    let mut bytes = vec![255; 3 * size.area()];
    let area = BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area();
    let mut labels = Vec::new();
    let drawn = sheet.draw(&area, &mut labels).and_then(|()| area.present());
    drawn.map_err(|error| PlotError(error.to_string()))?;
    drop(area);
    labels.iter().for_each(|label| label.write(&mut bytes, size));
    let pixels = bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2], 255]).collect();
    Picture::from_pixels(size, pixels).ok_or_else(|| PlotError("its size is wrong".to_owned()))
}

/// Returns the names in the overview with their boxes in the plot.
pub fn overview_names(report: &Report) -> Vec<(String, TextBox)> {
    let sheet = Sheet::new(report, Look::Light);
    let frame = inner(sheet.overview_rect());
    let panel = &sheet.panels.overview;
    let names = panel.marks.iter().map(|mark| mark.label.clone());
    names.zip(sheet.names(panel, frame)).filter_map(|(name, at)| Some((name, at?))).collect()
}

fn drawn_svg(
    size: (u32, u32),
    draw: impl for<'a> FnOnce(
        &DrawingArea<SVGBackend<'a>, Shift>,
        &mut Vec<Label>,
    ) -> Drawn<SVGBackend<'a>>,
) -> Result<String, PlotError> {
    let (mut text, mut labels) = (String::new(), Vec::new());
    let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
    let mut drawn = draw(&area, &mut labels);
    for label in labels {
        drawn = drawn.and_then(|()| area.draw(&label.element()));
    }
    drawn.and_then(|()| area.present()).map_err(|error| PlotError(error.to_string()))?;
    drop(area);
    Ok(text)
}

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
type Rect = [i32; 4];

/// Returns the rectangle of the scales in the rectangle of a panel.
const fn inner([left, top, right, bottom]: Rect) -> Rect {
    [left + ROOM[1], top + ROOM[0], right - 6, bottom - ROOM[2]]
}

/// The content of a plot.
struct Sheet {
    title: String,
    verdict: Vec<String>,
    panels: Panels,
    colors: &'static Colors,
}

impl Sheet {
    fn new(report: &Report, look: Look) -> Self {
        let findings = &report.findings;
        let [width, height] = findings.size;
        let threads = if findings.threads == 1 { "thread" } else { "threads" };
        let title = format!(
            "What accuracy costs: {}, {width} x {height}, {} {threads}, {}",
            report.scene, findings.threads, findings.instructions
        );
        let verdict = wrapped(&report.verdict(), 14, WIDTH - 2 * EDGE);
        Self { title, verdict, panels: Panels::new(report), colors: look.colors() }
    }

    fn head(&self) -> i32 {
        52 + LINE * i32::try_from(self.verdict.len()).unwrap_or(0)
    }

    const fn overview_of(head: i32) -> Rect {
        [EDGE, head, WIDTH - EDGE, head + OVERVIEW]
    }

    fn overview_rect(&self) -> Rect {
        Self::overview_of(self.head())
    }

    fn height(&self) -> i32 {
        let panels = i32::try_from(self.panels.axes.len()).unwrap_or(0);
        self.head() + OVERVIEW + 16 + (panels + COLUMNS - 1) / COLUMNS * ROW + 34
    }

    /// Draws everything except texts, and collects these in `labels`: SVG and PNG write them in
    /// different ways.
    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        labels: &mut Vec<Label>,
    ) -> Drawn<DB> {
        let colors = self.colors;
        area.fill(&colors.paper)?;
        // The title and the verdict, line by line.
        labels.push(Label::new(&self.title, (EDGE, 14), 18, colors.ink));
        let mut y = 44;
        for line in &self.verdict {
            labels.push(Label::new(line, (EDGE, y), 14, colors.ink));
            y += LINE;
        }
        self.panel(area, labels, &self.panels.overview, self.overview_rect())?;
        let (top, width) = (self.head() + OVERVIEW + 16, (WIDTH - 2 * EDGE) / COLUMNS);
        // Panels fill the rows from left to right.
        let mut place = (0, 0);
        for panel in &self.panels.axes {
            let (x, y) = (EDGE + place.0 * width, top + place.1 * ROW);
            self.panel(area, labels, panel, [x, y, x + width - 10, y + ROW - 6])?;
            place = if place.0 + 1 == COLUMNS { (0, place.1 + 1) } else { (place.0 + 1, place.1) };
        }
        let note = format!(
            "Horizontal: {}. Vertical: {}. Orange: the default. Band: its noise. Lines through \
                marks: uncertainty of the time. All panels have one scale.",
            self.panels.x.label, self.panels.y.label
        );
        labels.push(Label::new(note, (EDGE, self.height() - 26), 13, colors.faint));
        Ok(())
    }

    fn panel<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        labels: &mut Vec<Label>,
        panel: &Panel,
        rect: Rect,
    ) -> Drawn<DB> {
        let (colors, frame) = (self.colors, inner(rect));
        labels.push(Label::new(&panel.title, (frame[0], rect[1] + 2), 15, colors.ink));
        let note = Label::new(panel.note, (frame[2], rect[1] + 5), 12, colors.faint);
        labels.push(note.aligned(HPos::Right, VPos::Top));
        self.scales(area, labels, frame)?;
        let at: Vec<(i32, i32)> =
            panel.marks.iter().map(|mark| self.place(frame, mark.at)).collect();
        area.draw(&PathElement::new(at.clone(), colors.data.stroke_width(2)))?;
        // The interval is drawn first, so the mark covers it.
        for (mark, at) in panel.marks.iter().zip(&at) {
            let color = if mark.is_default { colors.default } else { colors.data };
            let [left, _, right, _] = frame;
            let noise = mark.noise.map(|x| along(&self.panels.x, x, left, right));
            let noise = noise.map(|x| (x.clamp(left, right), at.1));
            area.draw(&PathElement::new(noise.to_vec(), color.stroke_width(1)))?;
            area.draw(&Circle::new(*at, MARK, color.filled()))?;
            if mark.current {
                area.draw(&Circle::new(*at, MARK + 4, colors.ink.stroke_width(2)))?;
            }
        }
        for (mark, text) in panel.marks.iter().zip(self.names(panel, frame)) {
            let Some(text) = text else { continue };
            let color = if mark.is_default { colors.default } else { colors.ink };
            labels.push(Label::new(&mark.label, corner(&text), 13, color));
        }
        Ok(())
    }

    /// Returns the boxes of the names in a panel.
    #[expect(clippy::cast_precision_loss, reason = "pixels of a plot")]
    fn names(&self, panel: &Panel, frame: Rect) -> Vec<Option<TextBox>> {
        let at = |mark: &PanelMark| {
            let (x, y) = self.place(frame, mark.at);
            [x as f32, y as f32]
        };
        let marks: Vec<[f32; 2]> = panel.marks.iter().map(at).collect();
        let sizes: Vec<[f32; 2]> =
            panel.marks.iter().map(|mark| size_of(&mark.label, 13)).collect();
        let [left, top, right, bottom] = frame.map(|edge| edge as f32);
        let frame = TextBox { min: [left, top], max: [right, bottom] };
        let default = panel.marks.iter().position(|mark| mark.is_default).unwrap_or(0);
        // The ring around the current choice stays clear, too. A picture has no tooltips: names may
        // lie far from their marks rather than be left out.
        place(&marks, &sizes, default, &frame, [MARK as f32 + 4.0, 240.0])
    }

    /// Converts a position on the scales to a pixel.
    fn place(&self, [left, top, right, bottom]: Rect, [x, y]: [f64; 2]) -> (i32, i32) {
        (along(&self.panels.x, x, left, right), along(&self.panels.y, y, bottom, top))
    }

    fn scales<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        labels: &mut Vec<Label>,
        frame: Rect,
    ) -> Drawn<DB> {
        let (colors, panels, [left, top, right, bottom]) = (self.colors, &self.panels, frame);
        let mut label = |text: &str, at, h, v| {
            labels.push(Label::new(text, at, 12, colors.faint).aligned(h, v));
        };
        // The noise band lies below the grid.
        let band = panels.noise.map(|x| along(&panels.x, x, left, right).clamp(left, right));
        let band = [(band[0], top), (band[1].max(band[0] + 1), bottom)];
        area.draw(&Rectangle::new(band, colors.noise.filled()))?;
        // Labels that would overlap the last one are skipped.
        let mut free = left;
        for (x, tick) in &panels.x.ticks {
            let x = along(&panels.x, *x, left, right);
            area.draw(&PathElement::new(vec![(x, top), (x, bottom)], colors.grid))?;
            if x >= free {
                label(tick, (x, bottom + 5), HPos::Center, VPos::Top);
                free = x + 34;
            }
        }
        let mut free = bottom;
        for (y, tick) in &panels.y.ticks {
            let y = along(&panels.y, *y, bottom, top);
            let line = if tick == "0" { colors.faint } else { colors.grid };
            area.draw(&PathElement::new(vec![(left, y), (right, y)], line))?;
            if y <= free {
                label(tick, (left - 7, y), HPos::Right, VPos::Center);
                free = y - 16;
            }
        }
        let middle = (i32::midpoint(left, right), bottom + 21);
        label(&panels.x.label, middle, HPos::Center, VPos::Top);
        Ok(())
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a pixel of the plot")]
fn corner(text: &TextBox) -> (i32, i32) {
    (text.min[0].round() as i32 + 2, text.min[1].round() as i32)
}

#[expect(clippy::cast_possible_truncation, reason = "a pixel of the plot")]
fn along(scale: &Scale, place: f64, from: i32, to: i32) -> i32 {
    let [first, last] = scale.range;
    let part = (place - first) / (last - first);
    (f64::from(from) + part * f64::from(to - from)).round() as i32
}

/// Wraps sentences into lines of at most `width` pixels.
#[expect(clippy::cast_precision_loss, reason = "pixels of a plot")]
fn wrapped(sentences: &[String], size: u32, width: i32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in sentences.iter().flat_map(|sentence| sentence.split_whitespace()) {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer.filter(|line| size_of(line, size)[0] <= width as f32) {
            Some(longer) => *lines.last_mut().expect("it was the last") = longer,
            None => lines.push(word.to_owned()),
        }
    }
    lines
}
