//! `marraztu merge`: joins the reports of the parts of a batch.
//!
//! Lines are copied, not rewritten, so the result equals the report of a single run.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use marraztu_io::NewFile;

use super::batch::Status;
use super::batch::list::read_list;
use super::batch::report::{Counts, Line, Summary, line};
use super::failure::Failure;
use super::talk::{Talk, note};

/// The reports to join.
#[derive(Debug, Args)]
#[command(after_help = "\
Pictures are joined by their number in the list. If two reports hold the same picture, as after a
retry, the one that is there is kept. Missing pictures are printed with their number, model, view
and status, separated by tabs; \"absent\" pictures are in no report.

Examples:
  marraztu merge report-*.jsonl --out report.jsonl
  marraztu merge report-*.jsonl --out report.jsonl --expect list.csv

Exit status: 0 if all pictures are there, 1 if some are missing, 2 for invalid arguments.")]
pub(crate) struct Merge {
    /// The reports of the parts
    #[arg(required = true)]
    reports: Vec<PathBuf>,
    /// The joined report
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// A list whose models all have to be in the reports
    #[arg(long, value_name = "LIST")]
    expect: Option<PathBuf>,
    #[command(flatten)]
    talk: Talk,
}

/// The lines of all reports.
#[derive(Debug, Default)]
struct Merged {
    /// The parsed lines with their text, by index.
    lines: BTreeMap<usize, (Line, String)>,
    /// The number of jobs that the reports state.
    jobs: Option<usize>,
}

/// Joins the reports, and lists missing pictures.
pub(super) fn merge(arguments: &Merge) -> Result<(), Failure> {
    arguments.talk.apply();
    let mut merged = Merged::default();
    for path in &arguments.reports {
        let text = std::fs::read_to_string(path)
            .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))?;
        merged.add(path, &text).map_err(Failure::Usage)?;
    }
    let expected = match &arguments.expect {
        Some(list) => read_list(list)?.into_iter().map(|entry| entry.file).collect(),
        None => BTreeSet::new(),
    };
    let counts = merged.counts();
    let mut out = NewFile::begin(&arguments.out)?;
    for (_, text) in merged.lines.values() {
        out.push(text.as_bytes())?;
        out.push(b"\n")?;
    }
    out.push(&line(&Summary { summary: counts }))?;
    out.finish()?;
    let missing = merged.missing(&counts, &expected);
    match std::io::stdout().lock().write_all(missing.as_bytes()) {
        // The reader has closed the pipe, like `head`.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        written => written.map_err(Failure::Output)?,
    }
    note(&format_args!("{} of {} pictures are there", counts.done, counts.jobs));
    if missing.is_empty() { Ok(()) } else { Err(Failure::Told) }
}

impl Merged {
    /// Adds the lines of a report.
    fn add(&mut self, path: &Path, text: &str) -> Result<(), String> {
        let place = |i: usize| format!("{}:{}", path.display(), i + 1);
        for (i, text) in text.lines().enumerate() {
            if let Ok(Summary { summary }) = serde_json::from_str(text) {
                if self.jobs.is_some_and(|jobs| jobs != summary.jobs) {
                    let place = place(i);
                    return Err(format!("{place}: the reports are of lists of different lengths"));
                }
                self.jobs = Some(summary.jobs);
                continue;
            }
            let line: Line = serde_json::from_str(text).map_err(|error| {
                format!("{}: this is not a line of a report: {error}", place(i))
            })?;
            match self.lines.entry(line.index) {
                Entry::Vacant(entry) => _ = entry.insert((line, text.to_owned())),
                Entry::Occupied(mut entry) => {
                    let (other, _) = entry.get();
                    let both = other.status == Status::Done && line.status == Status::Done;
                    if (&other.input, &other.out) != (&line.input, &line.out)
                        || (both && *other != line)
                    {
                        let index = line.index;
                        return Err(format!(
                            "{}: the reports disagree on picture {index}",
                            place(i)
                        ));
                    }
                    // The statuses are ordered: pictures that are there come first.
                    if line.status < other.status {
                        entry.insert((line, text.to_owned()));
                    }
                }
            }
        }
        Ok(())
    }

    fn counts(&self) -> Counts {
        let length = self.lines.last_key_value().map_or(0, |(index, _)| index + 1);
        let mut counts = Counts { jobs: self.jobs.unwrap_or(length), ..Counts::default() };
        for (line, _) in self.lines.values() {
            counts.add(line.status);
        }
        counts
    }

    /// Lists missing pictures, and expected models that are in no report.
    fn missing(&self, counts: &Counts, expected: &BTreeSet<PathBuf>) -> String {
        let mut text = String::new();
        for index in 0..counts.jobs {
            // Writing to a string cannot fail.
            let _ = match self.lines.get(&index) {
                Some((line, _)) if line.status == Status::Done => Ok(()),
                Some((line, _)) => writeln!(text, "{index}\t{line}"),
                None => writeln!(text, "{index}\t\t\tabsent"),
            };
        }
        let found: BTreeSet<&Path> =
            self.lines.values().map(|(line, _)| Path::new(&line.input)).collect();
        for file in expected.iter().filter(|file| !found.contains(file.as_path())) {
            let _ = writeln!(text, "\t{}\t\tabsent", file.display());
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line_of(index: usize, status: &str) -> String {
        format!(
            "{{\"index\":{index},\"in\":\"{index}.obj\",\"in_sha256\":null,\"view\":\"0\",\
             \"out\":\"{index}.png\",\"out_sha256\":null,\"bytes\":null,\
             \"status\":\"{status}\",\"findings\":[],\"error\":null}}"
        )
    }

    fn merged(reports: &[&[String]]) -> Result<Merged, String> {
        let mut merged = Merged::default();
        for report in reports {
            merged.add(Path::new("r"), &report.join("\n"))?;
        }
        Ok(merged)
    }

    fn summary_of(jobs: usize) -> String {
        let counts = Counts { jobs, ..Counts::default() };
        serde_json::to_string(&Summary { summary: counts }).unwrap()
    }

    #[test]
    fn a_retry_replaces_a_failure_and_absent_pictures_are_listed() {
        let summary = summary_of(4);
        let first = [line_of(0, "done"), line_of(2, "timeout"), summary.clone()];
        let retry = [line_of(2, "done"), line_of(1, "invalid"), summary];
        let merged = merged(&[&first, &retry, &first]).unwrap();
        let counts = merged.counts();
        assert_eq!((counts.jobs, counts.done, counts.invalid, counts.timeout), (4, 2, 1, 0));
        let expected = ["0.obj", "9.obj"].map(PathBuf::from).into();
        let missing = "1\t1.obj\t0\tinvalid\n3\t\t\tabsent\n\t9.obj\t\tabsent\n";
        assert_eq!(merged.missing(&counts, &expected), missing);
    }

    #[test]
    fn reports_of_different_lists_are_rejected() {
        assert!(
            merged(&[&[summary_of(3)], &[summary_of(4)]])
                .unwrap_err()
                .contains("different lengths")
        );
        let other = line_of(0, "done").replace("0.obj", "x.obj");
        assert!(merged(&[&[line_of(0, "done")], &[other]]).unwrap_err().contains("disagree"));
        assert!(merged(&[&["nonsense".to_owned()]]).unwrap_err().starts_with("r:1: "));
    }
}
