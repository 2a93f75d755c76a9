//! Reads lists of files: CSV with a header, JSON lines, or plain lines.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use marraztu_io::read_file;
use serde_json::Value as Json;

use super::options::Value;
use crate::cli::failure::Failure;
use crate::cli::values::is_standard;

/// The column of the model or scene.
pub(super) const FILE: &str = "file";

/// Why a column is refused.
pub(super) const NO_COLUMN: &str = "there is no such option of pictures; a list has the columns \
    file, out, views and the options of render";

/// A row of a list, or a file among the arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    /// The line in a list; `None` for a file among the arguments.
    pub(super) line: Option<Line>,
    /// The model or scene.
    pub(crate) file: PathBuf,
    /// The other columns that have a value, by name.
    pub(super) values: Vec<(String, Value)>,
}

/// A line of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// The name of the list, which all lines share.
    list: Arc<str>,
    number: usize,
}

/// Returns the place of an entry for messages, such as "list.csv:3".
pub(super) fn place(line: Option<&Line>, file: &Path) -> String {
    match line {
        Some(Line { list, number }) => format!("{list}:{number}"),
        None => file.display().to_string(),
    }
}

/// The format of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ListFormat {
    Csv,
    JsonLines,
    Plain,
}

/// Reads the list at `path`; "-" is standard input. The names of the columns in the header of a CSV
/// file are checked with `is_column`. Fails if it cannot be read, or a row is not valid.
pub(crate) fn read_list(
    path: &Path,
    is_column: &dyn Fn(&str) -> bool,
) -> Result<Vec<Entry>, Failure> {
    let text = read_text(path)?;
    let name = Arc::from(shown(path));
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let entries = match format_of(path, text) {
        ListFormat::Csv => from_csv(&name, text, is_column),
        ListFormat::JsonLines => from_json_lines(&name, text),
        ListFormat::Plain => Ok(from_lines(&name, text)),
    };
    entries.map_err(Failure::Usage)
}

/// Reads a file of text, or standard input for "-". Fails if it cannot be read, is a device, or is
/// not in UTF-8.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let wrong = |reason: String| Failure::Usage(reason);
    let bytes = if is_standard(path) {
        let mut bytes = Vec::new();
        let read = std::io::stdin().lock().read_to_end(&mut bytes);
        read.map_err(|error| wrong(format!("{}: {error}", shown(path))))?;
        bytes
    } else {
        read_file(path).map_err(|error| wrong(error.to_string()))?
    };
    let text = String::from_utf8(bytes);
    text.map_err(|_bytes| wrong(format!("{}: this is not text in UTF-8", shown(path))))
}

fn shown(path: &Path) -> String {
    if is_standard(path) { "standard input".to_owned() } else { path.display().to_string() }
}

/// Returns the format by the extension, or by the first line if there is none.
fn format_of(path: &Path, text: &str) -> ListFormat {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    match ending.as_deref().and_then(|ending| ending.to_str()) {
        Some("csv") => ListFormat::Csv,
        Some("jsonl" | "ndjson") => ListFormat::JsonLines,
        Some("txt") => ListFormat::Plain,
        _ => {
            let first = text.lines().next().unwrap_or_default();
            let mut columns = first.split(',').map(|column| column.trim().trim_matches('"'));
            match first.trim_start().starts_with('{') {
                true => ListFormat::JsonLines,
                false if columns.any(|column| column == FILE) => ListFormat::Csv,
                false => ListFormat::Plain,
            }
        }
    }
}

fn from_lines(name: &Arc<str>, text: &str) -> Vec<Entry> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let entry = |(i, line): (usize, &str)| Entry {
        line: Some(Line { list: Arc::clone(name), number: i + 1 }),
        file: PathBuf::from(line),
        values: Vec::new(),
    };
    lines.map(entry).collect()
}

/// Returns a column's name as an option's: options are written with hyphens.
fn column_name(column: &str) -> String {
    column.trim().to_ascii_lowercase().replace('_', "-")
}

fn from_csv(
    name: &Arc<str>,
    text: &str,
    is_column: &dyn Fn(&str) -> bool,
) -> Result<Vec<Entry>, String> {
    let mut reader = csv::ReaderBuilder::new().from_reader(text.as_bytes());
    // A row's position is before the empty lines that precede it.
    let line_of = |position: Option<&csv::Position>| {
        let (line, byte) = position.map_or((1, 0), |at| (at.line(), at.byte()));
        let rest = text.as_bytes().iter().skip(usize::try_from(byte).unwrap_or(usize::MAX));
        let empty = rest.take_while(|byte| matches!(byte, b'\r' | b'\n'));
        line + empty.filter(|byte| **byte == b'\n').count() as u64
    };
    let of_line = |error: &csv::Error| {
        let line = line_of(error.position());
        match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                format!("{name}:{line}: the row has {len} columns, but the header {expected_len}")
            }
            _ => format!("{name}:{line}: {error}"),
        }
    };
    let header = reader.headers().map_err(|error| of_line(&error))?;
    let header: Vec<String> = header.iter().map(column_name).collect();
    if !header.iter().any(|column| column == FILE) {
        return Err(format!("{name}:1: the header has no column {FILE:?}"));
    }
    if let Some(column) = header.iter().find(|column| *column != FILE && !is_column(column)) {
        return Err(format!("{name}:1: column {column}: {NO_COLUMN}"));
    }
    let mut entries = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| of_line(&error))?;
        let number = usize::try_from(line_of(record.position())).unwrap_or(usize::MAX);
        // Empty cells keep the option of the command line.
        let cells = header.iter().zip(&record).filter(|(_, cell)| !cell.is_empty());
        let values = cells.map(|(name, cell)| (name.clone(), Value::Text(cell.to_owned())));
        entries.push(entry(Line { list: Arc::clone(name), number }, values.collect())?);
    }
    Ok(entries)
}

fn from_json_lines(name: &Arc<str>, text: &str) -> Result<Vec<Entry>, String> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let row = |(i, line): (usize, &str)| {
        let place = format!("{name}:{}", i + 1);
        let object: serde_json::Map<String, Json> =
            serde_json::from_str(line).map_err(|error| format!("{place}: {error}"))?;
        let mut values = Vec::new();
        for (column, json) in &object {
            let column = column_name(column);
            if column == FILE && !json.is_string() {
                return Err(format!("{place}: column {FILE:?}: {json} is not a path in quotes"));
            }
            let value = json_value(json)
                .map_err(|reason| format!("{place}: column {column:?}: {reason}"))?;
            values.extend(value.map(|value| (column, value)));
        }
        entry(Line { list: Arc::clone(name), number: i + 1 }, values)
    };
    lines.map(row).collect()
}

/// Converts a JSON value; null is no value, and an array is a list with commas.
fn json_value(json: &Json) -> Result<Option<Value>, String> {
    let scalar = |json: &Json| match json {
        Json::String(text) => Some(text.clone()),
        Json::Number(number) => Some(number.to_string()),
        _ => None,
    };
    match json {
        Json::Null => Ok(None),
        Json::Bool(on) => Ok(Some(Value::Switch(*on))),
        Json::Array(items) => {
            let items: Option<Vec<String>> = items.iter().map(scalar).collect();
            let items = items.ok_or("a list holds texts or numbers")?;
            Ok(Some(Value::Text(items.join(","))))
        }
        Json::Object(_) => Err("an object is not a value of an option".to_owned()),
        Json::String(_) | Json::Number(_) => Ok(scalar(json).map(Value::Text)),
    }
}

/// Makes an entry from columns; one of them is the file.
fn entry(line: Line, mut values: Vec<(String, Value)>) -> Result<Entry, String> {
    let file = values.iter().position(|(name, _)| name == FILE).map(|i| values.remove(i).1);
    match file {
        Some(Value::Text(file)) => {
            Ok(Entry { line: Some(line), file: PathBuf::from(file), values })
        }
        _ => Err(format!("{}:{}: the row names no file", line.list, line.number)),
    }
}

/// Expands the patterns among the arguments, such as `models/**/*.obj`, in the order of names.
/// Existing files are taken literally. Fails if a pattern is invalid, or no file matches it.
pub(crate) fn expanded(files: &[PathBuf]) -> Result<Vec<Entry>, Failure> {
    let mut entries = Vec::new();
    for file in files {
        let text = file.to_str().filter(|text| text.contains(['*', '?', '[']));
        let Some(pattern) = text.filter(|_| !file.exists()) else {
            entries.push(Entry { line: None, file: file.clone(), values: Vec::new() });
            continue;
        };
        let found = glob::glob(pattern);
        let found = found.map_err(|error| Failure::Usage(format!("{pattern}: {error}")))?;
        let found: Vec<PathBuf> = found.flatten().filter(|path| path.is_file()).collect();
        if found.is_empty() {
            return Err(Failure::Usage(format!("no file matches {pattern}")));
        }
        let entry = |file| Entry { line: None, file, values: Vec::new() };
        entries.extend(found.into_iter().map(entry));
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Value {
        Value::Text(text.to_owned())
    }

    #[test]
    fn three_formats_give_the_same_rows() {
        let list: Arc<str> = "list".into();
        let entry = |number: usize, file: &str, values: &[(&str, Value)]| Entry {
            line: Some(Line { list: Arc::clone(&list), number }),
            file: file.into(),
            values: values
                .iter()
                .map(|(name, value)| ((*name).to_owned(), value.clone()))
                .collect(),
        };
        let csv = "file,size,flip_winding\n\"a, b.obj\",64x32,true\nc.obj,,\n";
        assert_eq!(
            from_csv(&"list".into(), csv, &|_| true).unwrap(),
            [
                entry(2, "a, b.obj", &[("size", text("64x32")), ("flip-winding", text("true"))]),
                entry(3, "c.obj", &[]),
            ]
        );
        let json = r#"{"file":"a, b.obj","from":[30,-5.5],"edges":true}

            {"file":"c.obj","size":64}"#;
        assert_eq!(
            from_json_lines(&"list".into(), json).unwrap(),
            [
                entry(1, "a, b.obj", &[("edges", Value::Switch(true)), ("from", text("30,-5.5"))]),
                entry(3, "c.obj", &[("size", text("64"))]),
            ]
        );
        let plain = from_lines(&"list".into(), "a, b.obj\n\nc.obj\n");
        assert_eq!(plain, [entry(1, "a, b.obj", &[]), entry(3, "c.obj", &[])]);
    }

    #[test]
    fn the_format_follows_the_extension_or_the_first_line() {
        for (path, text, format) in [
            ("a.csv", "", ListFormat::Csv),
            ("a.JSONL", "", ListFormat::JsonLines),
            ("a.txt", "file,size", ListFormat::Plain),
            ("-", "{\"file\": 1}", ListFormat::JsonLines),
            ("-", "size,file\n", ListFormat::Csv),
            ("-", "models/a.obj\n", ListFormat::Plain),
            ("-", "", ListFormat::Plain),
        ] {
            assert_eq!(format_of(Path::new(path), text), format, "{path} {text}");
        }
    }

    #[test]
    fn a_row_that_is_not_valid_is_named_by_its_line() {
        for (csv, reason) in [
            ("size\n64\n", "list:1: the header has no column"),
            ("file,size\na.obj\n", "list:2: the row has 1 columns, but the header 2"),
            ("file,size\n,64\n", "list:2: the row names no file"),
            ("file,size\na.obj,64\n\n\r\n,64\n", "list:5: the row names no file"),
            ("file,size\na.obj,64\n\nb.obj\n", "list:4: the row has 1 columns"),
        ] {
            assert!(
                from_csv(&"list".into(), csv, &|_| true).unwrap_err().starts_with(reason),
                "{csv}"
            );
        }
        let unknown =
            from_csv(&"list".into(), "file,colour\n", &|name| name == "size").unwrap_err();
        assert!(unknown.starts_with("list:1: column colour: there is no such option"), "{unknown}");
        let unquoted = from_json_lines(&"list".into(), "{\"file\": 3}").unwrap_err();
        assert_eq!(unquoted, "list:1: column \"file\": 3 is not a path in quotes");
        for (json, reason) in [
            ("{\"size\":64}", "list:1: the row names no file"),
            ("{\"file\":\"a\"}\n[1]", "list:2: "),
            ("{\"file\":\"a\",\"size\":{}}", "list:1: column \"size\": "),
        ] {
            assert!(
                from_json_lines(&"list".into(), json).unwrap_err().starts_with(reason),
                "{json}"
            );
        }
    }
}
