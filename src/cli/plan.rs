//! `marraztu plan`: explains the effects that a frame uses.

use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;

use clap::{Args, ValueEnum};
use marraztu_lab::cost::{self, Costs, Explained, Group};
use marraztu_render::{Class, EffectState, EffectUse};

use super::arguments::PictureArguments;
use super::bar::Bar;
use super::failure::Failure;
use super::render;

/// A picture whose effects are listed.
#[derive(Debug, Args)]
#[command(after_help = "\
Takes the files and options of `render`. Lists each effect of the renderer as on or left out, with
the reason. Effects that are on are counted in pixels and, with --measure, in milliseconds.

Examples:
  marraztu plan
  marraztu plan teapot.obj --lights 0,1 --measure
  marraztu plan room.marraztu --faint left-out --format csv")]
pub(crate) struct Plan {
    #[command(flatten)]
    picture: PictureArguments,

    /// Measure what each effect costs in time, by pairs of frames with it and without it
    #[arg(long)]
    measure: bool,
    /// How long to measure, roughly
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, requires = "measure")]
    seconds: f64,
    /// The format of the list
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// How the list is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Columns, for people
    Table,
    /// Comma-separated, a line for each effect on each object
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
        Format::Table => table(&explained, costs.as_ref()),
        Format::Csv => csv(&explained, costs.as_ref()),
        Format::Json => json(&explained, costs.as_ref()),
    };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(Failure::Output)
}

fn table(explained: &Explained, costs: Option<&Costs>) -> String {
    let mut rows = vec![["Effect", "Of", "", "Why", "Pixels", "ms"].map(str::to_owned)];
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
    let mut text = columns(&rows);
    let off_by = explained.off_by;
    let size = explained.size;
    let bound = if off_by == 0.0 {
        "changes no bit".to_owned()
    } else {
        format!("changes a channel by {off_by:.3} of a byte's step at most")
    };
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n{} x {} pixels. What is left out {bound}.", size.width, size.height);
    if let Some(costs) = costs {
        let (frame, noise) = (costs.frame, costs.noise);
        let _ = writeln!(text, "A frame takes {frame:.3} ms; less than {noise:.3} ms is noise.");
    }
    text
}

fn row(name: &str, of: &str, group: &Group<'_>, time: String) -> [String; 6] {
    let state = if group.on() > 0 { "on" } else { "left out" };
    let why = if group.is_alike() { group.uses[0].state.to_string() } else { String::new() };
    let pixels = group.pixels().map_or_else(String::new, |pixels| pixels.to_string());
    [name.to_owned(), of.to_owned(), state.to_owned(), why, pixels, time]
}

/// Aligns the columns of rows, the last two to the right.
fn columns(rows: &[[String; 6]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: [usize; 6] = std::array::from_fn(|column| width(column).unwrap_or(0));
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (i, (cell, width)) in row.iter().zip(widths).enumerate() {
            let _ = if i < 4 {
                write!(line, "{cell:width$}  ")
            } else {
                write!(line, "{cell:>width$}  ")
            };
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Returns the cells of one effect on one item, for CSV and JSON.
fn cells(one: &EffectUse, costs: Option<&Costs>) -> [(&'static str, Cell); 9] {
    // Only bounded omissions change the picture; exact ones change nothing.
    let bound = match one.state {
        EffectState::LeftOut { class: Class::Bounded(steps), .. } => steps,
        _ => 0.0,
    };
    let cost = costs.and_then(|costs| costs.of(one.effect));
    let text = |text: &str| Cell::Text(text.to_owned());
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels")]
    let pixels = one.pixels.map(|pixels| pixels as f64);
    [
        ("effect", text(one.effect.label())),
        ("name", text(&one.name)),
        ("on", text(one.on.as_ref().map_or("", |thing| &thing.name))),
        ("state", text(if one.state.is_on() { "on" } else { "left out" })),
        ("why", text(one.state.why())),
        ("steps", Cell::Number(Some(bound))),
        ("pixels", Cell::Number(pixels)),
        ("milliseconds", Cell::Number(cost.map(|cost| cost.milliseconds))),
        ("spread", Cell::Number(cost.map(|cost| cost.spread))),
    ]
}

/// The content of a cell.
enum Cell {
    Text(String),
    Number(Option<f64>),
}

fn csv(explained: &Explained, costs: Option<&Costs>) -> String {
    let mut text = String::new();
    for (i, one) in explained.uses.iter().enumerate() {
        let cells = cells(one, costs);
        if i == 0 {
            let names: Vec<&str> = cells.iter().map(|(name, _)| *name).collect();
            let _ = writeln!(text, "{}", names.join(","));
        }
        // Names come from files, so they are quoted if needed (RFC 4180).
        let line: Vec<String> = cells
            .iter()
            .map(|(_, cell)| match cell {
                Cell::Text(text) if text.contains(['"', ',', '\n']) => {
                    format!("\"{}\"", text.replace('"', "\"\""))
                }
                Cell::Text(text) => text.clone(),
                Cell::Number(number) => number.map_or_else(String::new, |x| x.to_string()),
            })
            .collect();
        let _ = writeln!(text, "{}", line.join(","));
    }
    text
}

fn json(explained: &Explained, costs: Option<&Costs>) -> String {
    let object = |one: &EffectUse| {
        let members: Vec<String> = cells(one, costs)
            .into_iter()
            .map(|(name, cell)| match cell {
                Cell::Text(text) => format!("{}: {}", quoted(name), quoted(&text)),
                Cell::Number(Some(number)) => format!("{}: {number}", quoted(name)),
                Cell::Number(None) => format!("{}: null", quoted(name)),
            })
            .collect();
        format!("    {{{}}}", members.join(", "))
    };
    let effects: Vec<String> = explained.uses.iter().map(object).collect();
    let number = |number: Option<f64>| number.map_or_else(|| "null".to_owned(), |x| x.to_string());
    format!(
        "{{\n  \"width\": {}, \"height\": {}, \"off_by_steps\": {}, \"frame_milliseconds\": {}, \
        \"noise_milliseconds\": {},\n  \"effects\": [\n{}\n  ]\n}}\n",
        explained.size.width,
        explained.size.height,
        explained.off_by,
        number(costs.map(|costs| costs.frame)),
        number(costs.map(|costs| costs.noise)),
        effects.join(",\n"),
    )
}

/// Quotes a text for JSON (RFC 8259, section 7).
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if u32::from(letter) < 0x20 => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_and_csv_hold_any_name() {
        assert_eq!(quoted("a\"b\\c\nd"), "\"a\\\"b\\\\c\\u000ad\"");
    }
}
