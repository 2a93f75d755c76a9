//! Plots how frame time grows, on log-log axes.

use std::error::Error;

use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::measured::Measured;

const SIZE: (u32, u32) = (520, 340);
const INK: RGBColor = RGBColor(34, 34, 40);
const GRID: RGBColor = RGBColor(226, 226, 230);
const LINE: RGBColor = RGBColor(0, 114, 178);
const LINEAR: RGBColor = RGBColor(160, 160, 168);

/// The quantity that grows, and the function that reads its value from a benchmark's name.
struct Growth {
    group: &'static str,
    title: &'static str,
    number: fn(&str) -> Option<f64>,
}

const GROWTHS: [Growth; 3] = [
    Growth { group: "triangles", title: "triangles, the same picture", number: |n| n.parse().ok() },
    Growth {
        group: "pixels",
        title: "pixels, 70,000 triangles",
        number: |name| {
            let (width, height) = name.split_once('x')?;
            Some(width.parse::<f64>().ok()? * height.parse::<f64>().ok()?)
        },
    },
    Growth { group: "lights", title: "lights, 70,000 triangles", number: |n| n.parse().ok() },
];

/// Returns the plots with their file names.
pub(crate) fn all(measured: &Measured) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    // Registering the font again has no effect.
    let _ = register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    GROWTHS
        .iter()
        .map(|growth| Ok((format!("{}.svg", growth.group), plot(growth, measured)?)))
        .collect()
}

fn plot(growth: &Growth, measured: &Measured) -> Result<String, Box<dyn Error>> {
    let number = |(name, ms)| Some(((growth.number)(name)?, ms));
    let mut points: Vec<(f64, f64)> = measured.group(growth.group).filter_map(number).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return Err(format!("{} was not measured", growth.group).into());
    };
    // The axis of times spans whole decades.
    let times = points.iter().map(|point| point.1);
    let least = times.clone().fold(f64::INFINITY, f64::min);
    let most = times.fold(0.0, f64::max);
    let [low, high] = [least.log10().floor(), most.log10().ceil()].map(|n| 10_f64.powf(n));
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let text = |size: u32| ("sans-serif", size).into_font().color(&INK);
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .caption(format!("Milliseconds by {}", growth.title), text(17))
        .x_label_area_size(26)
        .y_label_area_size(46)
        .build_cartesian_2d((first.0 * 0.8..last.0 * 1.25).log_scale(), (low..high).log_scale())?;
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(WHITE)
        .axis_style(INK)
        .label_style(text(13))
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .draw()?;
    // A reference line: linear growth from the last point, at its cost per unit.
    let begin = first.0.max(last.0 * low / last.1);
    let linear = [(begin, last.1 * begin / last.0), last];
    chart.draw_series([PathElement::new(linear, LINEAR.stroke_width(1))])?;
    chart.draw_series([PathElement::new(points.clone(), LINE.stroke_width(2))])?;
    chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, LINE.filled())))?;
    area.present()?;
    drop(chart);
    drop(area);
    Ok(svg)
}

/// Formats a number without trailing zeros: 0.5, 20, 3k, 1M.
fn short(number: f64) -> String {
    match number {
        _ if number >= 999_999.0 => format!("{}M", tidy(number / 1e6)),
        _ if number >= 1_000.0 => format!("{}k", tidy(number / 1e3)),
        _ => tidy(number),
    }
}

fn tidy(number: f64) -> String {
    let text = format!("{number:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
