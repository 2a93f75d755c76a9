//! Reports: a line of JSON for each picture, in the order of the list, and a summary.
//!
//! Nothing in a report depends on time, threads or the shard, so the reports of shards merge to the
//! report of a single run, byte for byte. Times go to a separate file.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};
use std::iter::Peekable;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub(crate) use marraztu_io::with_slashes as shown;
use marraztu_io::{self as io, NewFile, SaveError, Sources, Spool};
use serde::{Deserialize, Serialize};

use super::jobs::{Job, Plan};
use super::outcome::{Drawn, Fault, FileSum, Outcome, Status};
use crate::cli::failure::{Failure, usage};

/// The line of a picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Line {
    /// The number in the whole list, from 0.
    pub(crate) index: usize,
    /// The model or scene, as given.
    #[serde(rename = "in")]
    pub(crate) input: String,
    in_sha256: Option<String>,
    pub(crate) view: String,
    pub(crate) out: String,
    out_sha256: Option<String>,
    bytes: Option<u64>,
    /// The further files of the picture: its layers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    layers: Vec<FileSum>,
    pub(crate) status: Status,
    findings: Vec<String>,
    pub(crate) error: Option<String>,
}

/// The counts of pictures by status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// All pictures of the list, in whatever report they are.
    pub(crate) jobs: usize,
    pub(crate) done: usize,
    pub(crate) invalid: usize,
    pub(crate) failed: usize,
    pub(crate) timeout: usize,
    pub(crate) cancelled: usize,
}

/// The last line of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Summary {
    pub(crate) summary: Counts,
}

impl Counts {
    /// Counts a picture.
    pub(crate) const fn add(&mut self, status: Status) {
        match status {
            Status::Done => self.done += 1,
            Status::Invalid => self.invalid += 1,
            Status::Failed => self.failed += 1,
            Status::Timeout => self.timeout += 1,
            Status::Cancelled => self.cancelled += 1,
        }
    }

    /// Returns the number of pictures that are missing.
    pub(crate) const fn missing(&self) -> usize {
        self.invalid + self.failed + self.timeout + self.cancelled
    }
}

impl std::fmt::Display for Line {
    /// Names the picture: its model, view and status, separated by tabs.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let status = serde_json::to_string(&self.status).unwrap_or_default();
        write!(f, "{}\t{}\t{}", self.input, self.view, status.trim_matches('"'))
    }
}

impl Line {
    /// Returns the first file that browsers show, or the first one if there is none.
    pub(crate) fn shown_file(&self) -> &str {
        const SHOWN: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
        let files = std::iter::once(&self.out).chain(self.layers.iter().map(|file| &file.out));
        let is_shown = |file: &&String| {
            let ending = Path::new(file).extension().map(|ending| ending.to_ascii_lowercase());
            ending.is_some_and(|ending| SHOWN.iter().any(|shown| ending == **shown))
        };
        files.into_iter().find(is_shown).unwrap_or(&self.out)
    }

    fn of(job: &Job, outcome: &Outcome) -> Self {
        let none = Drawn::default();
        let (drawn, status, error) = match &outcome.result {
            Ok(drawn) => (drawn, Status::Done, None),
            Err(fault) => (&none, fault.status(), Some(fault.reason())),
        };
        let first = drawn.files.first();
        Self {
            index: job.index,
            input: shown(&job.row.file),
            in_sha256: outcome.in_sha256.clone(),
            view: job.camera().name.clone(),
            out: shown(job.out()),
            out_sha256: first.and_then(|first| first.sha256.clone()),
            bytes: first.map(|first| first.bytes),
            layers: drawn.files.iter().skip(1).cloned().collect(),
            status,
            findings: drawn.findings.clone(),
            error,
        }
    }
}

/// Formats a value as a line.
pub(crate) fn line(value: &impl Serialize) -> Vec<u8> {
    let mut line = serde_json::to_vec(value).unwrap_or_default();
    line.push(b'\n');
    line
}

/// The times of a picture in milliseconds.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Times {
    index: usize,
    unchanged: bool,
    load: f64,
    draw: f64,
    encode: f64,
}

/// The longest line of a report.
const LONGEST: u64 = 1 << 24;

/// Checks that a report, or a file of times, may be written to `path`: an existing file is one, or
/// empty, and not an input. Fails if it is another file.
pub(crate) fn check_report(path: &Path, sources: &Sources) -> Result<(), Failure> {
    io::check_scheme(path)?;
    sources.spare(path)?;
    // Writing refuses what is not a file.
    if !path.is_file() {
        return Ok(());
    }
    let mut first = String::new();
    let read =
        File::open(path).and_then(|file| BufReader::new(file.take(LONGEST)).read_line(&mut first));
    let is_line = serde_json::from_str::<Line>(&first).is_ok()
        || serde_json::from_str::<Summary>(&first).is_ok()
        || serde_json::from_str::<Times>(&first).is_ok();
    if read.is_ok() && (first.is_empty() || is_line) {
        return Ok(());
    }
    Err(usage(&format!(
        "{}: a file with this name exists and is not a report; choose another name",
        path.display()
    )))
}

/// Begins a file, and creates its folder. Fails if it cannot be created.
pub(crate) fn begin(path: &Path) -> Result<NewFile, SaveError> {
    if let Some(folder) = path.parent() {
        // If this fails, so does creating the file, with the reason.
        let _ = std::fs::create_dir_all(folder);
    }
    NewFile::begin(path)
}

/// Lines that wait for earlier ones in memory. More of them wait in a file.
const MOST_WAITING: usize = 1024;

/// A line that waits for earlier ones.
#[derive(Debug)]
enum Waiting {
    Here(Vec<u8>),
    InFile(Range<u64>),
}

/// A report that is being written, in the order of the list.
struct OpenReport {
    file: NewFile,
    folder: PathBuf,
    /// The positions of the jobs that are not written yet.
    open: Peekable<Box<dyn Iterator<Item = usize>>>,
    waiting: BTreeMap<usize, Waiting>,
    spool: Option<Spool>,
}

/// Collects outcomes, and writes them in the order of the list.
pub(super) struct Reporter<'a> {
    plan: &'a Plan,
    counts: Counts,
    report: Option<OpenReport>,
    times: Option<NewFile>,
}

impl<'a> Reporter<'a> {
    /// Begins a report. Fails if a file cannot be created.
    pub(super) fn begin(
        plan: &'a Plan,
        report: Option<&Path>,
        times: Option<&Path>,
    ) -> Result<Self, SaveError> {
        Ok(Self {
            plan,
            counts: Counts { jobs: plan.all, ..Counts::default() },
            report: report.map(|path| OpenReport::begin(plan, path)).transpose()?,
            times: times.map(begin).transpose()?,
        })
    }

    /// Adds the result of a job. Fails if a file cannot be written.
    pub(super) fn add(&mut self, outcome: &Outcome) -> Result<(), SaveError> {
        let job = &outcome.job;
        if let (Some(times), false) = (&mut self.times, outcome.result == Err(Fault::Cancelled)) {
            let spent = outcome.spent;
            let [load, draw, encode] = [spent.load, spent.draw, spent.encode]
                .map(|time| (time.as_secs_f64() * 1e6).round() / 1e3);
            let unchanged = outcome.result.as_ref().is_ok_and(|drawn| drawn.unchanged);
            times.push(&line(&Times { index: job.index, unchanged, load, draw, encode }))?;
        }
        let text = Line::of(job, outcome);
        self.counts.add(text.status);
        match &mut self.report {
            Some(report) => report.add(job.position, line(&text)),
            None => Ok(()),
        }
    }

    /// Completes the report: jobs without a result are cancelled. Fails if a file cannot be
    /// written.
    pub(super) fn finish(mut self) -> Result<Counts, SaveError> {
        let results = self.counts.done + self.counts.missing();
        self.counts.cancelled += self.plan.len() - results;
        let summary = line(&Summary { summary: self.counts });
        if let Some(report) = self.report.take() {
            report.finish(self.plan, &summary)?;
        }
        if let Some(times) = self.times.take() {
            times.finish()?;
        }
        Ok(self.counts)
    }
}

impl OpenReport {
    fn begin(plan: &Plan, path: &Path) -> Result<Self, SaveError> {
        let open: Box<dyn Iterator<Item = usize>> = Box::new(plan.in_list_order());
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let (waiting, spool) = (BTreeMap::new(), None);
        Ok(Self { file: begin(path)?, folder, open: open.peekable(), waiting, spool })
    }

    /// Writes the line of the job at a position, and the ones that wait for it; or lets it wait.
    fn add(&mut self, position: usize, line: Vec<u8>) -> Result<(), SaveError> {
        if self.open.peek() != Some(&position) {
            let waiting = match self.waiting.len() {
                0..MOST_WAITING => Waiting::Here(line),
                _ => Waiting::InFile(self.spool()?.push(&line)?),
            };
            self.waiting.insert(position, waiting);
            return Ok(());
        }
        self.open.next();
        self.file.push(&line)?;
        while let Some(waiting) = self.open.peek().and_then(|next| self.waiting.remove(next)) {
            self.open.next();
            self.write(waiting)?;
        }
        Ok(())
    }

    fn spool(&mut self) -> Result<&mut Spool, SaveError> {
        let spool = match self.spool.take() {
            Some(spool) => spool,
            None => Spool::begin(&self.folder)?,
        };
        Ok(self.spool.insert(spool))
    }

    fn write(&mut self, waiting: Waiting) -> Result<(), SaveError> {
        let line = match waiting {
            Waiting::Here(line) => line,
            Waiting::InFile(place) => self.spool()?.get(&place)?,
        };
        self.file.push(&line)
    }

    /// Writes the other lines and the summary. Jobs without a line are cancelled.
    fn finish(mut self, plan: &Plan, summary: &[u8]) -> Result<(), SaveError> {
        while let Some(position) = self.open.next() {
            if let Some(waiting) = self.waiting.remove(&position) {
                self.write(waiting)?;
            } else if let Some(job) = plan.job(position) {
                let outcome = Outcome::cancelled(job);
                self.file.push(&line(&Line::of(&outcome.job, &outcome)))?;
            }
        }
        self.file.push(summary)?;
        self.file.finish()
    }
}
