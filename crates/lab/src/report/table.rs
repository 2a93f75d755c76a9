//! Writes the table of a sweep for users and for other programs.

use std::fmt::Write as _;

use super::Report;
use crate::candidates::Group;
use crate::error::Region;
use crate::sweep::{Measured, Row, TOO_BUSY, Verdict};
use marraztu_core::accuracy::{ACCURACY_PRESETS, AXES, Axis, AxisKind};

/// Formats a number with three significant digits: "0", "0.0123", "4.57", "137", "1.2e-5".
pub fn brief(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{number:.1e}");
    }
    // Decimals for three significant digits.
    let text = match size {
        100.0.. => format!("{number:.0}"),
        10.0.. => format!("{number:.1}"),
        1.0.. => format!("{number:.2}"),
        0.1.. => format!("{number:.3}"),
        0.01.. => format!("{number:.4}"),
        _ => format!("{number:.5}"),
    };
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns the heading of a row's group.
pub fn heading(row: &Row) -> String {
    match row.group {
        Group::Preset => "presets".to_owned(),
        Group::Axis(key) => {
            let Some(axis) = Axis::named(key) else { return key.to_owned() };
            let scored = match axis.kind {
                AxisKind::Scored => "",
                AxisKind::Model => " (a model: not scored)",
            };
            format!("{}{scored}, --{key}", axis.label)
        }
        Group::Current => "now".to_owned(),
        Group::Combination => "combinations".to_owned(),
    }
}

/// Writes the table as text, with the verdict above and a legend of the marks below.
pub fn text(report: &Report) -> String {
    let mut text = head(report);
    for sentence in report.verdict() {
        let _ = writeln!(text, "{}", wrapped(&sentence, 92));
    }
    let _ = writeln!(
        text,
        "\n  {:30} {:>8} {:>15} {:>8} {:>5} {:7} {:>7} {:>8} {:>7} {:>7} {:>8} {:>8}",
        "",
        "time",
        "spread",
        "ms",
        "pairs",
        "",
        "largest",
        "RMSE",
        "PSNR",
        "bytes",
        "coverage",
        "FLIP"
    );
    let front = report.front();
    // Print a heading wherever the group changes.
    let mut last = String::new();
    for row in report.rows() {
        let heading = heading(row);
        if heading != last {
            let _ = writeln!(text, "{heading}");
            last = heading;
        }
        // The marks are explained below the table.
        let marks = [
            if row.point == 0 { '*' } else { ' ' },
            if report.is_current(row) { '>' } else { ' ' },
            match row.error.is_incomplete() {
                true => '!',
                false if front.contains(&row.point) => '+',
                false => ' ',
            },
        ];
        let marks: String = marks.iter().collect();
        let name = format!("{marks} {}", row.name);
        let _ = writeln!(text, "  {name:30} {}", figures(report, row));
    }
    let _ = writeln!(
        text,
        "\n* the default  > now  + nothing is both faster and more exact against the ideal.\n\
         ! lacks surfaces that the reference shows: its time is no gain.\n\
         Errors are over {}. Rows of an axis: against the default with this axis\n\
         alone at its most exact. All others: against the ideal, 256 samples per pixel, each lit.",
        match report.region {
            Region::Whole => "all pixels",
            Region::Inside => "pixels with equal coverage",
        }
    );
    foot(&mut text, report);
    text
}

fn head(report: &Report) -> String {
    let findings = &report.findings;
    let [width, height] = findings.size;
    let quartiles = &findings.control.quartiles;
    let threads = if findings.threads == 1 { "thread" } else { "threads" };
    let mut text = format!(
        "{}: {width} x {height} pixels, {} {threads}, {}, {}\n",
        report.scene, findings.threads, findings.instructions, findings.thoroughness
    );
    let _ = writeln!(
        text,
        "The default takes {} ms. Against itself it took {:.3} times as long ({} pairs).",
        brief(findings.control.a_ms),
        quartiles.median,
        findings.control.pairs,
    );
    let _ = match findings.floor {
        floor if floor > TOO_BUSY => writeln!(text, "This machine is too busy to tell times."),
        floor => writeln!(
            text,
            "Differences of less than {:.1} % are noise, and so are those within the interval of\n\
             a row (95 %).",
            floor * 100.0
        ),
    };
    text
}

/// Returns the verdict on a row's time: none on a picture that lacks surfaces.
fn verdict_word(row: &Row, point: &Measured) -> &'static str {
    if row.error.is_incomplete() { "lacking" } else { point.verdict.word() }
}

fn figures(report: &Report, row: &Row) -> String {
    let point = &report.findings.points[row.point];
    let (ratio, error) = (&point.ratio, &row.error);
    let figures = error.over(report.region);
    let quartiles = &ratio.quartiles;
    let psnr = figures.psnr.map_or_else(|| "exact".to_owned(), |psnr| format!("{psnr:.1}"));
    format!(
        "{:>7.3}x {:>15} {:>8} {:>5} {:7} {:>7} {:>8} {:>7} {:>6}% {:>8} {:>8}",
        quartiles.median,
        format!("{:.3} - {:.3}", quartiles.lower, quartiles.upper),
        brief(point.ms),
        ratio.pairs,
        verdict_word(row, point),
        figures.largest,
        brief(figures.rmse),
        psnr,
        brief(figures.differing * 100.0),
        error.coverage,
        brief(error.flip)
    )
}

/// Lists what was not measured in one line, with the reasons; empty if everything was.
pub fn left_out_in_words(report: &Report) -> String {
    let all = report.findings.left_out.iter();
    let all: Vec<String> = all.map(|it| format!("{} ({})", it.what, it.reason)).collect();
    if all.is_empty() { String::new() } else { format!("Not measured here: {}.", all.join("; ")) }
}

fn foot(text: &mut String, report: &Report) {
    for preset in ACCURACY_PRESETS.iter().filter(|preset| !preset.faults.is_empty()) {
        let _ = writeln!(text, "{}, --preset {}: {}", preset.label, preset.word, preset.in_words());
    }
    let left_out = left_out_in_words(report);
    if !left_out.is_empty() {
        let _ = writeln!(text, "{}", wrapped(&left_out, 92));
    }
    if !report.findings.kernels.is_empty() {
        let _ = writeln!(text, "\narithmetic on one thread: SIMD against the plain loop");
    }
    for kernel in &report.findings.kernels {
        let quartiles = &kernel.ratio.quartiles;
        let middle = format!("{:.3} - {:.3}", quartiles.lower, quartiles.upper);
        let _ = writeln!(
            text,
            "      {:26} {:>7.3}x {middle:>15} {:>8} {:>5} {}",
            kernel.name,
            quartiles.median,
            brief(kernel.ratio.a_ms * quartiles.median),
            kernel.ratio.pairs,
            if kernel.equal { "equal results" } else { "DIFFERENT RESULTS" }
        );
    }
    // The answers to budgets follow, if the user set any.
    let answers = report.answers();
    if !answers.is_empty() {
        let _ = writeln!(text);
    }
    for answer in answers {
        let _ = writeln!(text, "{answer}");
    }
    let _ = writeln!(text, "\nagain: {}", report.command);
}

/// Wraps a sentence into lines of at most `width` characters.
fn wrapped(sentence: &str, width: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in sentence.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                *line += &format!(" {word}");
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

/// Writes the rows of one axis as a Markdown table, with figures over all pixels.
pub fn markdown(report: &Report, axis: &Axis) -> String {
    let mut text = "| choice | time | interquartile range | maximum | RMSE | PSNR | differing \
                    bytes | pixels whose coverage differs | FLIP |\n\
                    |---|--:|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in report.findings.rows_of(axis) {
        let (point, error) = (&report.findings.points[row.point], &row.error);
        let quartiles = &point.ratio.quartiles;
        // The default is exactly 1x by definition; its own measurement is the control.
        let star = if row.point == 0 { " (default)" } else { "" };
        let time = match (row.point, point.verdict) {
            (0, _) => "1x".to_owned(),
            _ if error.is_incomplete() => format!(
                "{:.2}x, but {}% of the surfaces are lost",
                quartiles.median,
                brief(error.lost * 100.0)
            ),
            (_, Verdict::Busy) => "too busy to tell".to_owned(),
            (_, Verdict::Alike) => format!("{:.2}x (noise)", quartiles.median),
            _ => format!("{:.2}x", quartiles.median),
        };
        let _ = writeln!(
            text,
            "| {}{star} | {time} | {:.2} to {:.2} | {} | {} | {} | {}% | {} | {} |",
            row.name,
            quartiles.lower,
            quartiles.upper,
            error.whole.largest,
            brief(error.whole.rmse),
            error.whole.psnr.map_or_else(|| "exact".to_owned(), |psnr| format!("{psnr:.1}")),
            brief(error.whole.differing * 100.0),
            error.coverage,
            brief(error.flip)
        );
    }
    text
}

/// Writes the table as comma-separated values, with the choice of every axis in each row.
pub fn csv(report: &Report) -> String {
    joined(report, ",", quoted)
}

/// Writes the table separated by tabs, for pasting into a spreadsheet.
pub fn tabs(report: &Report) -> String {
    joined(report, "\t", |field| field.replace(['\t', '\n'], " "))
}

fn joined(report: &Report, separator: &str, field: fn(&str) -> String) -> String {
    let line = |row: Vec<String>| {
        let fields: Vec<String> = row.iter().map(|text| field(text)).collect();
        fields.join(separator) + "\n"
    };
    cells(report).into_iter().map(line).collect()
}

/// A row of the table, with what its columns need.
struct Cells<'a> {
    row: &'a Row,
    point: &'a Measured,
    noise: [f64; 2],
    front: bool,
    current: bool,
}

/// The name of a column, and its value in a row.
type Column = (&'static str, fn(&Cells<'_>) -> String);

/// The columns of figures. Errors refer to the row's own reference, which the column `against`
/// names.
const FIGURES: [Column; 24] = [
    ("ms", |it| it.point.ms.to_string()),
    ("ratio", |it| it.point.ratio.quartiles.median.to_string()),
    ("ratio_lower", |it| it.point.ratio.quartiles.lower.to_string()),
    ("ratio_upper", |it| it.point.ratio.quartiles.upper.to_string()),
    ("noise_lower", |it| it.noise[0].to_string()),
    ("noise_upper", |it| it.noise[1].to_string()),
    ("pairs", |it| it.point.ratio.pairs.to_string()),
    ("thrown_away", |it| it.point.ratio.thrown.to_string()),
    ("verdict", |it| verdict_word(it.row, it.point).to_owned()),
    ("against", |it| it.row.against.word().to_owned()),
    ("largest", |it| it.row.error.whole.largest.to_string()),
    ("rmse", |it| it.row.error.whole.rmse.to_string()),
    ("psnr", |it| it.row.error.whole.psnr.unwrap_or(f64::INFINITY).to_string()),
    ("differing", |it| it.row.error.whole.differing.to_string()),
    ("coverage", |it| it.row.error.coverage.to_string()),
    ("flip", |it| it.row.error.flip.to_string()),
    ("lost", |it| it.row.error.lost.to_string()),
    ("inside_largest", |it| it.row.error.inside.largest.to_string()),
    ("inside_rmse", |it| it.row.error.inside.rmse.to_string()),
    ("inside_differing", |it| it.row.error.inside.differing.to_string()),
    ("rmse_against_256_samples", |it| {
        it.point.ideal.map(|error| error.whole.rmse.to_string()).unwrap_or_default()
    }),
    ("hash", |it| it.point.hash.clone()),
    ("front", |it| it.front.to_string()),
    ("current", |it| it.current.to_string()),
];

/// Returns the cells of the table; the first row contains the column names.
fn cells(report: &Report) -> Vec<Vec<String>> {
    let front = report.front();
    // One column per axis lets spreadsheets filter by choice.
    let axes = AXES.iter().map(|axis| axis.key);
    let head = ["group", "name"].into_iter().chain(axes).chain(FIGURES.map(|(name, _)| name));
    let mut cells = vec![head.map(str::to_owned).collect()];
    for row in &report.findings.rows {
        let point = &report.findings.points[row.point];
        let of_row = Cells {
            row,
            point,
            noise: report.findings.noise_of(row.point),
            front: front.contains(&row.point),
            current: report.is_current(row),
        };
        let names = [heading(row), row.name.clone()].into_iter();
        let axes = AXES.iter().map(|axis| axis.chosen(&point.settings).word.to_owned());
        cells.push(names.chain(axes).chain(FIGURES.map(|(_, value)| value(&of_row))).collect());
    }
    cells
}

/// Returns a text as a field of CSV (RFC 4180).
pub fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_the_three_digits_that_count() {
        let pairs = [
            (0.0, "0"),
            (1.0, "1"),
            (0.012_345, "0.0123"),
            (4.567, "4.57"),
            (136.6, "137"),
            (0.000_012, "1.2e-5"),
            (0.5, "0.5"),
            (1200.0, "1200"),
            (0.1, "0.1"),
        ];
        for (number, text) in pairs {
            assert_eq!(brief(number), text);
        }
    }

    #[test]
    fn a_field_with_a_comma_is_quoted() {
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
        assert_eq!(quoted("a b"), "a b");
    }
}
