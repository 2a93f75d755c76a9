//! `marraztu merge`: joins the reports of the parts of a batch.
//!
//! Lines are copied, not rewritten, so the result equals the report of a single run.

use std::collections::btree_map::Entry::{Occupied, Vacant};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use marraztu::plots::{PageCell, sheet_page};
use marraztu_io::Sources;

use super::batch::Status;
use super::batch::list::{Entry, expanded, read_list, read_text};
use super::batch::report::{Counts, Line, Summary, begin, check_report, line};
use super::failure::{Failure, usage};
use super::page::{check_page, relative_url, write_page};
use super::talk::{Talk, note, print};

/// The reports to join.
#[derive(Debug, Args)]
#[command(after_help = "\
Pictures are joined by their number in the list. If two reports hold the same picture, as after a
retry, the one that is there is kept. Missing pictures are printed with their number, model, view
and status, separated by tabs; \"absent\" pictures are in no report.

The file of --out is never read, even if a pattern names it.

Examples:
  marraztu merge \"report-*.jsonl\" --out report.jsonl --sheet page.html
  marraztu merge report-*.jsonl --out report.jsonl --expect list.csv

Exit status: 0 if all pictures are there, 1 if some are missing, 2 for invalid arguments.")]
pub(crate) struct Merge {
    /// The reports of the parts; patterns such as "report-*.jsonl" are expanded
    #[arg(required = true)]
    reports: Vec<PathBuf>,
    /// The joined report
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// A list whose models all have to be in the reports
    #[arg(long, value_name = "LIST")]
    expect: Option<PathBuf>,
    /// A page to write, with all pictures, and the missing ones first
    #[arg(long, value_name = "PAGE")]
    sheet: Option<PathBuf>,
    #[command(flatten)]
    talk: Talk,
}

/// The most pictures of a list. A larger number is a mistake in the file, and would fill memory.
const MOST_JOBS: usize = 100_000_000;

/// The lines of all reports.
#[derive(Debug, Default)]
struct Merged {
    /// The parsed lines with their text and their report, by index.
    lines: BTreeMap<usize, (Line, String, PathBuf)>,
    /// The number of jobs that the reports state.
    jobs: Option<usize>,
}

/// Joins the reports, and lists missing pictures.
pub(super) fn merge(arguments: &Merge) -> Result<(), Failure> {
    arguments.talk.apply();
    let mut merged = Merged::default();
    let reports = reports(arguments)?;
    let inputs = Sources::default().with(reports.iter().chain(&arguments.expect));
    check_report(&arguments.out, &inputs)?;
    if let Some(sheet) = &arguments.sheet {
        if *sheet == arguments.out {
            return Err(usage("--sheet and --out name the same file"));
        }
        check_page(sheet, &inputs.with([&arguments.out]))?;
    }
    for path in &reports {
        let text = read_text(path)?;
        merged.add(path, &text).map_err(Failure::Usage)?;
    }
    let expected = match &arguments.expect {
        Some(list) => read_list(list, &|_| true)?.into_iter().map(|entry| entry.file).collect(),
        None => BTreeSet::new(),
    };
    let counts = merged.counts();
    let mut out = begin(&arguments.out)?;
    for (_, text, _) in merged.lines.values() {
        out.push(text.as_bytes())?;
        out.push(b"\n")?;
    }
    out.push(&line(&Summary { summary: counts }))?;
    out.finish()?;
    if let Some(sheet) = &arguments.sheet {
        let title = format!("{} of {} pictures", counts.done, counts.jobs);
        write_page(sheet, &sheet_page(&title, &merged.cells(sheet, &counts, &expected)))?;
    }
    let missing = merged.missing(&counts, &expected);
    print(&missing)?;
    note(&format_args!("{} of {} pictures are there", counts.done, counts.jobs));
    if missing.is_empty() { Ok(()) } else { Err(Failure::Told) }
}

/// Returns the reports, without the file that the joined report is written to.
fn reports(arguments: &Merge) -> Result<Vec<PathBuf>, Failure> {
    let out = arguments.out.canonicalize().ok();
    let mut reports = Vec::new();
    for Entry { file, .. } in expanded(&arguments.reports)? {
        if out.is_some() && file.canonicalize().ok() == out {
            note(&format_args!("{} is the output, so it is not read", file.display()));
        } else {
            reports.push(file);
        }
    }
    if reports.is_empty() {
        return Err(usage("there are no reports besides the output"));
    }
    Ok(reports)
}

impl Merged {
    /// Adds the lines of a report, which ends with its summary.
    fn add(&mut self, path: &Path, text: &str) -> Result<(), String> {
        let place = |i: usize| format!("{}:{}", path.display(), i + 1);
        let mut jobs = None;
        for (i, text) in text.lines().enumerate() {
            if jobs.is_some() {
                return Err(format!("{}: a report ends with its summary", place(i)));
            }
            if let Ok(Summary { summary }) = serde_json::from_str(text) {
                if self.jobs.is_some_and(|jobs| jobs != summary.jobs) {
                    return Err(format!(
                        "{}: the reports are of lists of different lengths; leave out reports of \
                         earlier runs",
                        place(i)
                    ));
                }
                if summary.jobs > MOST_JOBS {
                    return Err(format!("{}: more than {MOST_JOBS} pictures", place(i)));
                }
                jobs = Some(summary.jobs);
                continue;
            }
            let line: Line = serde_json::from_str(text).map_err(|error| {
                format!("{}: this is not a line of a report: {error}", place(i))
            })?;
            match self.lines.entry(line.index) {
                Vacant(entry) => _ = entry.insert((line, text.to_owned(), path.to_owned())),
                Occupied(mut entry) => {
                    let (other, _, report) = entry.get();
                    let both = other.status == Status::Done && line.status == Status::Done;
                    if (&other.input, &other.out) != (&line.input, &line.out)
                        || (both && *other != line)
                    {
                        let (index, place, report) = (line.index, place(i), report.display());
                        return Err(format!(
                            "{place}: picture {index} differs from the one in {report}; leave out \
                             reports of earlier runs"
                        ));
                    }
                    // The statuses are ordered: pictures that are there come first.
                    if line.status < other.status {
                        entry.insert((line, text.to_owned(), path.to_owned()));
                    }
                }
            }
        }
        self.jobs = jobs;
        let Some(jobs) = jobs else {
            return Err(format!("{}: the report is cut off: it has no summary", path.display()));
        };
        match self.lines.last_key_value() {
            Some((index, _)) if *index >= jobs => {
                Err(format!("{}: there is no picture {index} of {jobs}", path.display()))
            }
            _ => Ok(()),
        }
    }

    fn counts(&self) -> Counts {
        let mut counts = Counts { jobs: self.jobs.unwrap_or(0), ..Counts::default() };
        for (line, ..) in self.lines.values() {
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
                Some((line, ..)) if line.status == Status::Done => Ok(()),
                Some((line, ..)) => writeln!(text, "{index}\t{line}"),
                None => writeln!(text, "{index}\t\t\tabsent"),
            };
        }
        for file in self.absent(expected) {
            let _ = writeln!(text, "\t{}\t\tabsent", file.display());
        }
        text
    }

    /// Returns the expected models that are in no report.
    fn absent<'a>(&self, expected: &'a BTreeSet<PathBuf>) -> impl Iterator<Item = &'a PathBuf> {
        let lines = self.lines.values();
        let found: BTreeSet<PathBuf> = lines.map(|(line, ..)| line.input.clone().into()).collect();
        expected.iter().filter(move |file| !found.contains(*file))
    }

    /// Returns the pictures of a page at `page`.
    fn cells(&self, page: &Path, counts: &Counts, expected: &BTreeSet<PathBuf>) -> Vec<PageCell> {
        let cell = |index: usize| {
            let Some((line, ..)) = self.lines.get(&index) else {
                let label = format!("picture {index}");
                return PageCell { label, picture: Err("absent".to_owned()) };
            };
            let picture = match (line.status, &line.error) {
                (Status::Done, _) => Ok(relative_url(page, Path::new(line.shown_file()))),
                (_, Some(error)) => Err(error.clone()),
                (_, None) => Err("missing".to_owned()),
            };
            PageCell { label: format!("{}, view {}", line.input, line.view), picture }
        };
        let absent = self.absent(expected).map(|file| PageCell {
            label: file.display().to_string(),
            picture: Err("absent".to_owned()),
        });
        (0..counts.jobs).map(cell).chain(absent).collect()
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
        assert!(
            merged(&[&[line_of(0, "done"), summary_of(1)], &[other]])
                .unwrap_err()
                .contains("differs from the one in r")
        );
        assert!(merged(&[&["nonsense".to_owned()]]).unwrap_err().starts_with("r:1: "));
    }

    #[test]
    fn reports_that_are_cut_off_or_impossible_are_rejected() {
        let (done, huge) = (line_of(1, "done"), summary_of(usize::MAX));
        for (report, reason) in [
            (vec![], "r: the report is cut off"),
            (vec![done.clone()], "r: the report is cut off"),
            (vec![done.clone(), summary_of(2)[..20].to_owned()], "r:2: this is not a line"),
            (vec![done.clone(), huge], "r:2: more than 100000000 pictures"),
            (vec![done.clone(), summary_of(1)], "r: there is no picture 1 of 1"),
            (vec![summary_of(2), done], "r:2: a report ends with its summary"),
        ] {
            let error = merged(&[&report]).unwrap_err();
            assert!(error.starts_with(reason), "{error}");
        }
    }
}
