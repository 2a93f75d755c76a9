//! Writes tables in Markdown.

use std::fmt::Write as _;

use super::measured::Measured;

const STAGES: [&str; 6] = ["plan", "vertices", "set-up", "lines", "tiles", "tiles-lit-at-vertices"];

/// Tabulates stages by shapes.
pub(crate) fn stages(measured: &Measured) -> Result<String, String> {
    let shapes = measured.groups("stages/");
    let mut text = head("stage", &shapes);
    for stage in STAGES {
        let cell = |shape: &&str| measured.of(&format!("stages/{shape}"), stage).map(brief);
        let cells = shapes.iter().map(cell).collect::<Result<Vec<_>, _>>()?;
        let _ = writeln!(text, "| {} | {} |", stage.replace('-', " "), cells.join(" | "));
    }
    Ok(text)
}

/// Tabulates the cost of each effect, the most expensive first.
pub(crate) fn effects(measured: &Measured) -> Result<String, String> {
    let mut rows = Vec::new();
    for name in measured.groups("effects/") {
        let of = |way| measured.of(&format!("effects/{name}"), way);
        rows.push((name, of("with")?, of("without")?));
    }
    rows.sort_by(|a, b| (b.1 / b.2).total_cmp(&(a.1 / a.2)));
    let mut text = head("effect", &["with it", "without it", "it costs"]);
    for (name, with, without) in rows {
        let part = 100.0 * (with - without) / with;
        let _ = writeln!(text, "| {name} | {} | {} | {part:.0}% |", brief(with), brief(without));
    }
    Ok(text)
}

/// Tabulates textures by filter, on sheets of triangles and on a floor.
pub(crate) fn textures(measured: &Measured) -> Result<String, String> {
    const COLUMNS: [&str; 6] =
        ["none", "nearest", "bilinear", "trilinear", "nearest with holes", "trilinear with holes"];
    let mut text = head("triangles", &COLUMNS);
    for (group, name) in [("1", "1"), ("2000", "2,000"), ("100000", "100,000"), ("floor", "floor")]
    {
        let cell = |column: &&str| measured.of(&format!("textures/{group}"), column).map(brief);
        // The floor is only measured with some of the filters.
        let cells: Vec<String> =
            COLUMNS.iter().map(|column| cell(column).unwrap_or_default()).collect();
        if cells[2].is_empty() {
            return cell(&"bilinear");
        }
        let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
    }
    Ok(text)
}

/// Tabulates how frame time grows with the number of objects.
pub(crate) fn objects(measured: &Measured) -> Result<String, String> {
    let mut rows: Vec<(u32, f64)> = measured
        .group("objects")
        .filter_map(|(name, ms)| name.parse().ok().map(|count| (count, ms)))
        .collect();
    rows.sort_by_key(|row| row.0);
    if rows.is_empty() {
        return Err("no benchmark of objects".to_owned());
    }
    let mut text = head("objects", &["milliseconds"]);
    for (count, ms) in rows {
        let _ = writeln!(text, "| {count} | {} |", brief(ms));
    }
    for name in ["100 in view of 100", "100 in view of 10000", "1 knot", "20 knots"] {
        let _ = writeln!(text, "| {name} | {} |", brief(measured.of("objects", name)?));
    }
    Ok(text)
}

/// Tabulates the speed-up from more threads.
pub(crate) fn threads(measured: &Measured) -> Result<String, String> {
    let one = measured.of("threads", "1")?;
    let mut rows: Vec<(u32, f64)> = measured
        .group("threads")
        .map(|(name, ms)| {
            name.parse().map(|n| (n, ms)).map_err(|error| format!("threads {name:?}: {error}"))
        })
        .collect::<Result<_, _>>()?;
    rows.sort_by_key(|row| row.0);
    let mut text = head("threads", &["milliseconds", "times as fast as one"]);
    for (count, ms) in rows {
        let _ = writeln!(text, "| {count} | {} | {:.2} |", brief(ms), one / ms);
    }
    Ok(text)
}

/// Writes the first lines of a table of numbers.
pub(crate) fn head(first: &str, columns: &[&str]) -> String {
    format!("| {first} | {} |\n|---|{}\n", columns.join(" | "), "--:|".repeat(columns.len()))
}

/// Formats milliseconds with three digits.
pub(crate) fn brief(ms: f64) -> String {
    match ms {
        _ if ms < 0.0005 => "0".to_owned(),
        _ if ms < 0.1 => format!("{ms:.3}"),
        _ if ms < 10.0 => format!("{ms:.2}"),
        _ => format!("{ms:.1}"),
    }
}
