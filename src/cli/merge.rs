//! `marraztu merge`: joins the reports of the parts of a batch.
//!
//! Lines are copied, not rewritten, so the result equals the report of a single run.

use std::collections::btree_map::Entry::{Occupied, Vacant};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;
use marraztu::plots::{PageCell, sheet_page};
use marraztu_io::Sources;

use super::batch::Status;
use super::batch::list::{expanded, read_list, read_text};
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

/// The most pictures of a list for each picture in a report. A larger number is a mistake in the
/// file: a batch has at most about a thousand parts, and one of them is in a report.
const MOST_JOBS: usize = 1000;

/// A part of the list.
enum Entry<'a> {
    /// A picture with its number.
    Reported(usize, &'a Line),
    /// The numbers of pictures that are in no report.
    Absent(Range<usize>),
}

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
    merged.check().map_err(Failure::Usage)?;
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
    let mut is_whole = true;
    merged.each_missing(&counts, &expected, &mut |line| {
        is_whole = false;
        print(line)
    })?;
    note(&format_args!("{} of {} pictures are there", counts.done, counts.jobs));
    if is_whole { Ok(()) } else { Err(Failure::Told) }
}

/// Returns the reports, without the file that the joined report is written to.
fn reports(arguments: &Merge) -> Result<Vec<PathBuf>, Failure> {
    let out = arguments.out.canonicalize().ok();
    let mut reports = Vec::new();
    for file in expanded(&arguments.reports)?.into_iter().map(|entry| entry.file) {
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

    /// Checks that the number of pictures that the reports state fits the pictures in them.
    fn check(&self) -> Result<(), String> {
        let (jobs, lines) = (self.jobs.unwrap_or(0), self.lines.len());
        if jobs > MOST_JOBS.saturating_mul(lines.max(1)) {
            return Err(format!(
                "the reports state {jobs} pictures, but have {lines}: a summary is damaged, or \
                 most reports are missing"
            ));
        }
        Ok(())
    }

    /// Iterates over the pictures of the list: the ones in reports, and runs of absent ones.
    fn entries(&self, jobs: usize) -> impl Iterator<Item = Entry<'_>> {
        let ends = self.lines.iter().map(|(index, (line, ..))| (*index, Some(line)));
        let ends = ends.chain([(jobs, None)]);
        let spans = ends.scan(0, |next, (index, line)| {
            let absent = *next..index;
            *next = index + 1;
            Some((absent, line.map(|line| Entry::Reported(index, line))))
        });
        spans.flat_map(|(absent, reported)| {
            let absent = (!absent.is_empty()).then_some(Entry::Absent(absent));
            absent.into_iter().chain(reported)
        })
    }

    /// Passes on a line for each missing picture, and for each expected model that is in no report.
    fn each_missing(
        &self,
        counts: &Counts,
        expected: &BTreeSet<PathBuf>,
        take: &mut dyn FnMut(&str) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for entry in self.entries(counts.jobs) {
            match entry {
                Entry::Reported(_, line) if line.status == Status::Done => {}
                Entry::Reported(index, line) => take(&format!("{index}\t{line}\n"))?,
                Entry::Absent(mut absent) => {
                    absent.try_for_each(|index| take(&format!("{index}\t\t\tabsent\n")))?;
                }
            }
        }
        self.absent(expected)
            .try_for_each(|file| take(&format!("\t{}\t\tabsent\n", file.display())))
    }

    /// Returns the expected models that are in no report.
    fn absent<'a>(&self, expected: &'a BTreeSet<PathBuf>) -> impl Iterator<Item = &'a PathBuf> {
        let lines = self.lines.values();
        let found: BTreeSet<PathBuf> = lines.map(|(line, ..)| line.input.clone().into()).collect();
        expected.iter().filter(move |file| !found.contains(*file))
    }

    /// Returns the pictures of a page at `page`.
    fn cells(&self, page: &Path, counts: &Counts, expected: &BTreeSet<PathBuf>) -> Vec<PageCell> {
        let cell = |entry: Entry<'_>| {
            let line = match entry {
                Entry::Reported(_, line) => line,
                Entry::Absent(absent) => {
                    let label = match absent.len() {
                        1 => format!("picture {}", absent.start),
                        _ => format!("pictures {} to {}", absent.start, absent.end - 1),
                    };
                    return PageCell { label, picture: Err("absent".to_owned()) };
                }
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
        self.entries(counts.jobs).map(cell).chain(absent).collect()
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
        let mut told = String::new();
        let mut tell = |line: &str| {
            told += line;
            Ok(())
        };
        merged.each_missing(&counts, &expected, &mut tell).unwrap();
        assert_eq!(told, missing);
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
        let done = line_of(1, "done");
        for (report, reason) in [
            (vec![], "r: the report is cut off"),
            (vec![done.clone()], "r: the report is cut off"),
            (vec![done.clone(), summary_of(2)[..20].to_owned()], "r:2: this is not a line"),
            (vec![done.clone(), summary_of(1)], "r: there is no picture 1 of 1"),
            (vec![summary_of(2), done], "r:2: a report ends with its summary"),
        ] {
            let error = merged(&[&report]).unwrap_err();
            assert!(error.starts_with(reason), "{error}");
        }
    }

    #[test]
    fn a_summary_states_no_more_pictures_than_a_thousand_parts_of_those_in_the_reports() {
        let (zero, done) = (line_of(0, "done"), line_of(1, "done"));
        for (lines, jobs, is_right) in [
            (&[][..], 1000, true),
            (&[], 1001, false),
            (std::slice::from_ref(&done), 1000, true),
            (std::slice::from_ref(&done), 2_000_000, false),
            (std::slice::from_ref(&done), usize::MAX, false),
            (&[zero, done.clone()], 2000, true),
        ] {
            let report = [lines, &[summary_of(jobs)]].concat();
            let checked = merged(&[&report]).unwrap().check();
            assert_eq!(checked.is_ok(), is_right, "{jobs}");
            let stated = format!("the reports state {jobs} pictures, but have {}", lines.len());
            assert!(checked.err().is_none_or(|error| error.starts_with(&stated)));
        }
    }

    #[test]
    fn absent_pictures_are_one_entry_of_a_page_however_many_they_are() {
        let report = [line_of(1, "done"), line_of(500, "done"), summary_of(900)];
        let merged = merged(&[&report]).unwrap();
        let cells = merged.cells(Path::new("page.html"), &merged.counts(), &BTreeSet::new());
        let labels: Vec<&str> = cells.iter().map(|cell| &*cell.label).collect();
        let expected = [
            "picture 0",
            "1.obj, view 0",
            "pictures 2 to 499",
            "500.obj, view 0",
            "pictures 501 to 899",
        ];
        assert_eq!(labels, expected);
    }
}
