//! Draws the scatter plot of a report as SVG and PNG.
//!
//! `plotters` draws it with the fonts of the window, so that a plot does not depend on the machine.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use super::{Chart, MarkKind, Report, Scale, brief};
use crate::base::image::{Picture, Size};

/// A plot could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the plot could not be drawn: {0}")]
pub struct PlotError(String);

const WIDTH: u32 = 1060;
/// The rectangle of the scales in the picture.
const PLOT: [i32; 4] = [80, 56, 640, 560];
/// The left edge of the names.
const LEGEND: i32 = 668;
const LINE: i32 = 17;

const INK: RGBColor = RGBColor(34, 34, 40);
const GREY: RGBColor = RGBColor(104, 104, 112);
const GRID: RGBColor = RGBColor(226, 226, 230);
const FLOOR: RGBColor = RGBColor(236, 236, 240);
// Colours of Okabe and Ito, which people with colour blindness can tell apart.
const FRONT: RGBColor = RGBColor(0, 158, 115);
const PRESET: RGBColor = RGBColor(0, 114, 178);
const AXIS: RGBColor = RGBColor(213, 94, 0);
const NOW: RGBColor = RGBColor(204, 121, 167);

/// The plot as SVG.
///
/// # Errors
/// If the plotting library fails.
pub fn svg(report: &Report) -> Result<String, PlotError> {
    let mut text = String::new();
    let size = (WIDTH, height(report));
    let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
    draw(&area, report).map_err(|error| PlotError(error.to_string()))?;
    drop(area);
    Ok(text)
}

/// The plot as a picture.
///
/// # Errors
/// If the plotting library fails.
pub fn png(report: &Report) -> Result<Picture, PlotError> {
    let height = height(report);
    let size = Size::new(WIDTH as usize, height as usize);
    let mut bytes = vec![255; 3 * size.area()];
    let area = BitMapBackend::with_buffer(&mut bytes, (WIDTH, height)).into_drawing_area();
    draw(&area, report).map_err(|error| PlotError(error.to_string()))?;
    drop(area);
    let pixels = bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2], 255]).collect();
    Picture::from_pixels(size, pixels).ok_or_else(|| PlotError("its size is wrong".to_owned()))
}

/// The height that the plot and the names beside it need.
fn height(report: &Report) -> u32 {
    let names = u32::try_from(report.findings.points.len()).unwrap_or(0);
    620.max(90 + 17 * names)
}

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// A font of the window, under the name that SVG knows.
fn font(size: u32) -> TextStyle<'static> {
    // Registering a valid font cannot fail, and registering it again changes nothing.
    let _ = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    ("sans-serif", size).into_font().color(&INK)
}

fn at(h: HPos, v: VPos, style: &TextStyle<'static>) -> TextStyle<'static> {
    style.pos(Pos::new(h, v))
}

fn draw<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, report: &Report) -> Drawn<DB> {
    let chart = Chart::new(report);
    area.fill(&WHITE)?;
    let [width, height] = report.findings.size;
    let title = format!(
        "{}, {width} x {height}: what accuracy costs in time ({} threads, {})",
        report.scene, report.findings.threads, report.findings.instructions
    );
    area.draw(&Text::new(title, (PLOT[0], 16), font(17)))?;
    scales(area, &chart)?;
    let at = |mark: usize| place(&chart, chart.marks[mark].at);
    for (front, width) in [(&chart.front_apart, 1), (&chart.front, 2)] {
        let front: Vec<(i32, i32)> = front.iter().map(|mark| at(*mark)).collect();
        area.draw(&PathElement::new(steps(&front), FRONT.stroke_width(width)))?;
    }
    for mark in (0..chart.marks.len()).rev() {
        self::mark(area, &chart, mark, at(mark))?;
    }
    numbers(area, &chart)?;
    legend(area, &chart, report)?;
    area.present()
}

/// The front as steps, since nothing is measured between two points.
fn steps(front: &[(i32, i32)]) -> Vec<(i32, i32)> {
    let mut line: Vec<(i32, i32)> = Vec::new();
    for (x, y) in front {
        if let Some((_, before)) = line.last().copied() {
            line.push((*x, before));
        }
        line.push((*x, *y));
    }
    line
}

/// The pixel of a position on the scales.
fn place(chart: &Chart, [x, y]: [f64; 2]) -> (i32, i32) {
    let [left, top, right, bottom] = PLOT;
    (along(&chart.x, x, left, right), along(&chart.y, y, bottom, top))
}

#[expect(clippy::cast_possible_truncation, reason = "a pixel of the plot")]
fn along(scale: &Scale, place: f64, from: i32, to: i32) -> i32 {
    let [first, last] = scale.range;
    let part = (place - first) / (last - first);
    (f64::from(from) + part * f64::from(to - from)).round() as i32
}

fn scales<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, chart: &Chart) -> Drawn<DB> {
    let [left, top, right, bottom] = PLOT;
    let small = font(13);
    let floor = chart.floor.map(|x| along(&chart.x, x, left, right));
    let floor = [(floor[0], top), (floor[1].max(floor[0] + 1), bottom)];
    area.draw(&Rectangle::new(floor, FLOOR.filled()))?;
    for (x, label) in &chart.x.ticks {
        let x = along(&chart.x, *x, left, right);
        area.draw(&PathElement::new(vec![(x, top), (x, bottom)], GRID))?;
        let style = at(HPos::Center, VPos::Top, &small);
        area.draw(&Text::new(label.clone(), (x, bottom + 6), style))?;
    }
    for (y, label) in &chart.y.ticks {
        let y = along(&chart.y, *y, bottom, top);
        area.draw(&PathElement::new(vec![(left, y), (right, y)], GRID))?;
        let style = at(HPos::Right, VPos::Center, &small);
        area.draw(&Text::new(label.clone(), (left - 8, y), style))?;
    }
    area.draw(&Rectangle::new([(left, top), (right, bottom)], GREY))?;
    let style = at(HPos::Center, VPos::Top, &small);
    let middle = i32::midpoint(left, right);
    area.draw(&Text::new(chart.x.label.clone(), (middle, bottom + 28), style))?;
    let style = at(HPos::Left, VPos::Bottom, &small);
    area.draw(&Text::new(chart.y.label.clone(), (left, top - 4), style))
}

fn mark<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    chart: &Chart,
    mark: usize,
    (x, y): (i32, i32),
) -> Drawn<DB> {
    let mark = &chart.marks[mark];
    let ink = color(mark.kind);
    if mark.current {
        area.draw(&Circle::new((x, y), 11, NOW.stroke_width(3)))?;
    }
    match mark.kind {
        MarkKind::Default => {
            let corners = vec![(x, y - 7), (x + 7, y), (x, y + 7), (x - 7, y)];
            area.draw(&Polygon::new(corners, ink.filled()))
        }
        MarkKind::Preset => {
            area.draw(&Rectangle::new([(x - 5, y - 5), (x + 5, y + 5)], ink.filled()))
        }
        MarkKind::Axis => area.draw(&Circle::new((x, y), 5, ink.filled())),
        MarkKind::Combination => area.draw(&Circle::new((x, y), 3, ink.filled())),
        MarkKind::Apart => {
            let corners = vec![(x, y - 6), (x + 6, y + 4), (x - 6, y + 4)];
            area.draw(&Polygon::new(corners, ink.filled()))
        }
        MarkKind::Model => area.draw(&Circle::new((x, y), 5, ink.stroke_width(1))),
    }
}

const fn color(kind: MarkKind) -> RGBColor {
    match kind {
        MarkKind::Default => INK,
        MarkKind::Preset => PRESET,
        MarkKind::Axis | MarkKind::Apart => AXIS,
        MarkKind::Combination | MarkKind::Model => GREY,
    }
}

/// Draws the number of each mark beside it, if there is room.
fn numbers<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, chart: &Chart) -> Drawn<DB> {
    let style = at(HPos::Center, VPos::Center, &font(12));
    let places: Vec<(i32, i32)> = chart.marks.iter().map(|mark| place(chart, mark.at)).collect();
    let mut taken: Vec<(i32, i32)> = Vec::new();
    for (i, (x, y)) in places.iter().enumerate() {
        let around =
            [(13, -11), (-13, -11), (13, 11), (-13, 11), (0, -17), (0, 17), (22, 0), (-22, 0)];
        let free = |(px, py): &(i32, i32)| {
            let near = |other: &(i32, i32), wide, high| {
                (other.0 - px).abs() < wide && (other.1 - py).abs() < high
            };
            !taken.iter().any(|other| near(other, 16, 13))
                && !places.iter().any(|other| near(other, 12, 10))
        };
        let all = around.map(|(dx, dy)| (x + dx, y + dy));
        let best = all.into_iter().find(free).unwrap_or(all[0]);
        taken.push(best);
        area.draw(&Text::new((i + 1).to_string(), best, style.clone()))?;
    }
    Ok(())
}

/// Lists the names of the numbers.
fn legend<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    chart: &Chart,
    report: &Report,
) -> Drawn<DB> {
    let small = font(13);
    let points = report.points();
    let mut y = PLOT[1];
    for (i, mark) in chart.marks.iter().enumerate() {
        let ink = if mark.on_front { FRONT } else { color(mark.kind) };
        let style = TextStyle { color: ink.to_backend_color(), ..small.clone() };
        let number = at(HPos::Right, VPos::Top, &style);
        area.draw(&Text::new((i + 1).to_string(), (LEGEND + 14, y), number))?;
        let now = match (mark.current, mark.kind) {
            (true, _) => " (now)",
            (false, MarkKind::Model) => " (a model: not scored)",
            (false, MarkKind::Apart) => " (against 64 samples)",
            _ if !report.is_scored(mark.point) => " (other pixels)",
            _ => "",
        };
        let (ms, error) = (brief(points[i].time), brief(points[i].error));
        let name = format!("{}{now}: {ms} ms, {error}", mark.name);
        area.draw(&Text::new(name, (LEGEND + 22, y), at(HPos::Left, VPos::Top, &style)))?;
        y += LINE;
    }
    let notes = [
        "green: no other is both faster and more exact; grey band: noise",
        "triangles and thin line: against 64 samples, each lit",
    ];
    for (line, y) in notes.into_iter().zip((PLOT[3] + 44..).step_by(LINE as usize)) {
        area.draw(&Text::new(line, (PLOT[0], y), small.color(&GREY)))?;
    }
    Ok(())
}
