//! Writes a page about the suite: for each axis a panel, a table, a paragraph, and the command that
//! repeats it.

use std::fmt::Write as _;

use super::{Look, PlotError, panel_svg};
use marraztu_core::accuracy::{AXES, Axis};
use marraztu_lab::report::{Report, markdown};

/// Returns the axes of several reports, each with the reports that measured it.
pub fn sections(reports: &[Report]) -> impl Iterator<Item = (&'static Axis, Vec<&Report>)> {
    let all = AXES.iter().map(|axis| {
        let measured = |report: &&Report| report.findings.rows_of(axis).count() > 1;
        (axis, reports.iter().filter(measured).collect::<Vec<_>>())
    });
    all.filter(|(_, reports)| !reports.is_empty())
}

/// Returns the name of the plot of an axis on a scene of the suite: "depth-first".
pub fn plot_name(axis: &Axis, report: &Report) -> String {
    let scene = report.scene.split_whitespace().last().unwrap_or_default();
    format!("{}-{scene}", axis.key)
}

/// Describes the measuring method in a paragraph.
fn basis(reports: &[Report]) -> String {
    let Some(first) = reports.first() else { return String::new() };
    let findings = &first.findings;
    let [width, height] = findings.size;
    let threads = if findings.threads == 1 { "thread" } else { "threads" };
    format!(
        "Measured at {width} x {height} on {} {threads} with {}. Times are relative to the \
            default, drawn in turn: a low quantile of each, which other programs hardly disturb. \
            The uncertainty of a time is its interval (95%, by a bootstrap), or the noise of the \
            default against itself if that is larger; two times differ only if their intervals do \
            not overlap. Errors are over all pixels, in steps of 255, relative to the default with \
            this axis alone at its most exact.",
        findings.threads, findings.instructions
    )
}

/// Writes the page as Markdown. `picture` returns the URL of an axis's plot, by its name.
pub fn page_markdown(reports: &[Report], picture: &dyn Fn(&str) -> String) -> String {
    let mut text = format!("{}\n", basis(reports));
    for report in reports {
        let _ = writeln!(text, "\n- {}", report.verdict().join(" "));
    }
    for (axis, reports) in sections(reports) {
        let _ = writeln!(text, "\n### {}", axis.label);
        for report in reports {
            let _ = write!(
                text,
                "\n{}\n\n![{}: time against error]({})\n\n{}\nAgain: `{}`\n",
                report.verdict_on(axis),
                axis.label,
                picture(&plot_name(axis, report)),
                markdown(report, axis),
                report.command
            );
        }
    }
    text
}

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:60rem;margin:2rem auto;\
    padding:0 1rem}svg{max-width:100%;height:auto}\
    table{border-collapse:collapse;font-size:.85rem}td,th{padding:.2rem .6rem;text-align:right;\
    border-bottom:1px solid #8884}td:first-child,th:first-child{text-align:left}\
    .dark{display:none}@media(prefers-color-scheme:dark){body{background:#18181c;color:#e6e6ea}\
    .dark{display:block}.light{display:none}}";

/// Writes the page as HTML in one file, for light and dark themes.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn page_html(reports: &[Report]) -> Result<String, PlotError> {
    let mut text = head("What accuracy costs", "");
    let _ = writeln!(text, "<p>{}</p>\n<ul>", escaped(&basis(reports)));
    for report in reports {
        let _ = writeln!(text, "<li>{}</li>", escaped(&report.verdict().join(" ")));
    }
    text += "</ul>\n";
    for (axis, reports) in sections(reports) {
        let _ = writeln!(text, "<h2>{}</h2>", axis.label);
        for report in reports {
            // Both themes are embedded; CSS shows one.
            let [light, dark] =
                [Look::Light, Look::Dark].map(|look| panel_svg(report, Some(axis.key), look));
            let _ = write!(
                text,
                "<p>{}</p>\n<div class=\"light\">{}</div><div class=\"dark\">{}</div>\n\
                 {}<pre>{}</pre>\n",
                escaped(&report.verdict_on(axis)),
                light?,
                dark?,
                html_table(&markdown(report, axis)),
                escaped(&report.command)
            );
        }
    }
    Ok(text + "</body></html>\n")
}

/// Converts a Markdown table to HTML.
fn html_table(markdown: &str) -> String {
    let mut text = "<table>\n".to_owned();
    for (i, line) in markdown.lines().enumerate().filter(|(i, _)| *i != 1) {
        let cell = if i == 0 { "th" } else { "td" };
        let cells = line.trim_matches('|').split('|');
        let cells = cells.map(|it| format!("<{cell}>{}</{cell}>", escaped(it.trim())));
        let _ = writeln!(text, "<tr>{}</tr>", cells.collect::<String>());
    }
    text + "</table>\n"
}

/// Begins a page.
pub(super) fn head(title: &str, style: &str) -> String {
    let title = escaped(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\">\
         <title>{title}</title><style>{STYLE}{style}</style></head>\n<body>\n<h1>{title}</h1>\n"
    )
}

/// Escapes a text for HTML, also within an attribute.
pub(super) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;")
}
