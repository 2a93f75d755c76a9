//! `marraztu plan`: explains the effects that a frame uses.

use std::fmt::Write as _;
use std::ops::Range;
use std::time::Duration;

use clap::{Args, ValueEnum};
use marraztu_lab::cost::{self, Costs, Explained, Group};
use marraztu_lab::dial::error_in_words;
use marraztu_lab::estimate::Estimate;
use marraztu_lab::report::quoted;
use marraztu_render::{EffectUse, PathPixels};
use serde::Serialize;

use super::arguments::PictureArguments;
use super::bar::Bar;
use super::failure::Failure;
use super::render;
use super::talk::{self, print};

/// A picture whose effects are listed.
#[derive(Debug, Args)]
#[command(after_help = "\
Takes the files and options of `render`. Lists each effect of the renderer as on or left out, with
the reason. Effects that are on are counted in pixels and, with --measure, in milliseconds. Then
follows what each is worth: the error without it, and whether anybody would see that.
For surfaces, the reason is how pixels are coloured: one colour for each triangle, corners
(interpolated), blocks (lit at once), or lists of pixels, which may be joined, or tiny triangles.

Examples:
  marraztu plan
  marraztu plan teapot.obj --lights 0,1 --measure
  marraztu plan room.marraztu --shading vertex --json")]
pub(crate) struct Plan {
    #[command(flatten)]
    pub(super) picture: PictureArguments,

    /// Measure the time of each effect, with pairs of frames with and without it
    #[arg(long)]
    measure: bool,
    /// Approximate measuring time
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, requires = "measure")]
    seconds: f64,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// Print a JSON object, as with "--format json"
    #[arg(long, conflicts_with = "format")]
    json: bool,
}

/// How the list is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Aligned columns
    Table,
    /// Comma-separated values, one line per effect and object
    Csv,
    /// A JSON object
    Json,
}

/// Lists the effects of the picture described by the arguments.
pub(crate) fn plan(arguments: &Plan) -> Result<(), Failure> {
    let stage = render::stage(&arguments.picture)?;
    let shot = stage.shot(arguments.picture.size);
    let explained = cost::explain(&shot);
    let costs = arguments.measure.then(|| {
        let _bar = Bar::unmeasured("measuring");
        let budget = Duration::try_from_secs_f64(arguments.seconds).unwrap_or(Duration::MAX);
        cost::measure(&shot, budget, || false)
    });
    let text = match arguments.format {
        _ if arguments.json => json(&explained, costs.as_ref()),
        Format::Table => table(&explained, costs.as_ref()),
        Format::Csv => csv(&explained, costs.as_ref()),
        Format::Json => json(&explained, costs.as_ref()),
    };
    print(&text)
}

fn table(explained: &Explained, costs: Option<&Costs>) -> String {
    let mut rows = vec![["Effect", "Item", "", "Reason", "Pixels", "ms"].map(str::to_owned)];
    for group in explained.groups() {
        let cost = costs.and_then(|costs| Some((costs, costs.of(group.effect)?)));
        let time = cost.map_or(String::new(), |(costs, cost)| match costs.is_clear(cost) {
            true => format!("{:.3}", cost.milliseconds),
            false => "noise".to_owned(),
        });
        rows.push(row(&group.uses[0].name, &group.of(), &group, time));
        // Uses that differ are listed one by one below the group.
        if group.is_alike() {
            continue;
        }
        for one in group.uses {
            let of = one.on.as_ref().map_or("the frame", |thing| &thing.name);
            let uses = std::slice::from_ref(one);
            rows.push(row("", &format!("  {of}"), &Group { uses, ..group }, String::new()));
        }
    }
    let mut text = columns(&rows, 4..6);
    let size = explained.size;
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "\n{} x {} pixels. Leaving effects out does not change a single bit.",
        size.width, size.height
    );
    if let Some(paths) = explained.paths {
        text += &path_table(&paths);
    }
    if let Some(costs) = costs {
        let (frame, noise) = (costs.frame, costs.noise);
        let _ = writeln!(text, "A frame takes {frame:.3} ms; less than {noise:.3} ms is noise.");
        text += &worth(explained, costs);
    }
    text
}

/// Lists how the pixels got their colours.
fn path_table(paths: &PathPixels) -> String {
    let head = ["Path", "For", "Pixels"].map(str::to_owned);
    let rows = paths
        .rows()
        .map(|(name, reason, pixels)| [name.to_owned(), reason.to_owned(), pixels.to_string()]);
    let rows: Vec<[String; 3]> = std::iter::once(head).chain(rows).collect();
    format!("\n{}\n", columns(&rows, 2..3))
}

/// Lists what is lost without each effect, in the order of the error that a millisecond saves.
fn worth(explained: &Explained, costs: &Costs) -> String {
    let all = costs.by_worth();
    if all.is_empty() {
        return String::new();
    }
    let head = ["Without", "ms less", "error of 255", ""].map(str::to_owned);
    let rows = all.iter().map(|cost| {
        let name = explained.groups().find(|group| group.effect == cost.effect);
        let time = match costs.is_clear(cost) {
            true => format!("{:.3}", cost.milliseconds),
            false => "noise".to_owned(),
        };
        let seen = if cost.missed.is_seen() { "" } else { "no one sees that" };
        let error = error_in_words(&Estimate::exact(cost.missed.rmse)).unwrap_or_default();
        [name.map_or_else(String::new, |it| it.uses[0].name.clone()), time, error, seen.to_owned()]
    });
    let rows: Vec<[String; 4]> = std::iter::once(head).chain(rows).collect();
    format!("\n{}", columns(&rows, 1..3))
}

fn row(name: &str, of: &str, group: &Group<'_>, time: String) -> [String; 6] {
    let state = if group.on() > 0 { "on" } else { "left out" };
    let why = if group.is_alike() { group.uses[0].state.to_string() } else { String::new() };
    let pixels = group.pixels().map_or_else(String::new, |pixels| pixels.to_string());
    [name.to_owned(), of.to_owned(), state.to_owned(), why, pixels, time]
}

/// Aligns the columns of rows, columns of numbers to the right.
fn columns<const N: usize>(rows: &[[String; N]], numbers: Range<usize>) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: [usize; N] = std::array::from_fn(|column| width(column).unwrap_or(0));
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (i, (cell, width)) in row.iter().zip(widths).enumerate() {
            let _ = match numbers.contains(&i) {
                true => write!(line, "{cell:>width$}  "),
                false => write!(line, "{cell:width$}  "),
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// One effect on one item, as a row of CSV and an object of JSON.
#[derive(Serialize)]
struct Row<'a> {
    effect: &'static str,
    name: &'a str,
    on: &'a str,
    state: &'static str,
    why: &'a str,
    pixels: Option<u64>,
    milliseconds: Option<f64>,
    spread: Option<f64>,
    rmse_without: Option<f64>,
    flip_without: Option<f64>,
}

impl<'a> Row<'a> {
    fn new(one: &'a EffectUse, costs: Option<&Costs>) -> Self {
        let cost = costs.and_then(|costs| costs.of(one.effect));
        Self {
            effect: one.effect.label(),
            name: &one.name,
            on: one.on.as_ref().map_or("", |thing| &thing.name),
            state: if one.state.is_on() { "on" } else { "left out" },
            why: one.state.why(),
            pixels: one.pixels,
            milliseconds: cost.map(|cost| cost.milliseconds),
            spread: cost.map(|cost| cost.spread),
            rmse_without: cost.map(|cost| cost.missed.rmse),
            flip_without: cost.map(|cost| cost.missed.flip),
        }
    }
}

fn csv(explained: &Explained, costs: Option<&Costs>) -> String {
    let head = "effect,name,on,state,why,pixels,milliseconds,spread,rmse_without,flip_without\n";
    let mut text = head.to_owned();
    for one in &explained.uses {
        let row = Row::new(one, costs);
        let words = [row.effect, row.name, row.on, row.state, row.why].map(quoted);
        let measured = [row.milliseconds, row.spread, row.rmse_without, row.flip_without];
        let measured = measured.map(|x| x.map_or_else(String::new, |x| x.to_string()));
        let pixels = row.pixels.map_or_else(String::new, |x| x.to_string());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{},{pixels},{}", words.join(","), measured.join(","));
    }
    text
}

/// The effects of a picture, as JSON.
#[derive(Serialize)]
struct PlanReport<'a> {
    width: usize,
    height: usize,
    frame_milliseconds: Option<f64>,
    noise_milliseconds: Option<f64>,
    /// How the pixels got their colours, if all were drawn at once.
    paths: Option<PathPixels>,
    effects: Vec<Row<'a>>,
}

fn json(explained: &Explained, costs: Option<&Costs>) -> String {
    talk::json(&PlanReport {
        width: explained.size.width,
        height: explained.size.height,
        frame_milliseconds: costs.map(|costs| costs.frame),
        noise_milliseconds: costs.map(|costs| costs.noise),
        paths: explained.paths,
        effects: explained.uses.iter().map(|one| Row::new(one, costs)).collect(),
    })
}
