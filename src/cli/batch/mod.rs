//! `marraztu batch`: draws many pictures.
//!
//! ```text
//! list  ->  rows  ->  shard  ->  jobs  ->  threads  ->  report
//! ```
//!
//! Everything that can be checked is checked before the first picture: the list, its options, the
//! cameras ([`rows`]) and the names of the outputs ([`outputs`]). Then each thread draws one
//! picture at a time ([`studio`]), and the main thread collects the [`results`]. Rows and hashes of
//! names are held in memory, but neither pictures nor results, so the number of pictures has no
//! limit.

mod cache;
mod camera_file;
mod dataset;
mod digest;
mod estimate;
mod jobs;
pub(super) mod list;
mod masks;
mod meter;
mod models;
mod options;
mod outcome;
mod outputs;
pub(super) mod report;
mod results;
mod rows;
mod seeds;
mod shard;
mod sheets;
mod studio;
mod tables;
mod tars;
mod template;
pub(super) mod views;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use clap::Args;
use marraztu_core::base::threads::{self, Caller};
use marraztu_io::{PICTURE_FORMATS, Sources};
use signal_hook::consts::{SIGINT, SIGTERM};

use self::dataset::{Dataset, check_used_folder};
use self::estimate::print_estimate;
use self::jobs::Plan;
use self::options::OptionTexts;
use self::outcome::Outcome;
pub(super) use self::outcome::Status;
use self::outputs::{check_inputs, check_outputs};
use self::report::{Counts, check_report};
use self::results::Results;
use self::rows::{Row, Rows};
use self::shard::{Shard, shard};
use self::sheets::{Grid, check_sheets, grid, write_sheets};
use self::studio::{Studio, silence_panics};
use self::tables::Tables;
use self::tars::{TarNames, Tars};
use super::arguments::choice;
use super::budget::Budget;
use super::cameras::{CAMERAS, check_cameras, part_name};
use super::failure::{Failure, usage};
use super::layers::NUMBER_ENDINGS;
use super::split::{Split, split};
use super::talk::{Talk, is_quiet, note, print};
use super::values::threads;

/// The exit status if every missing picture is caused by its input.
const INVALID: u8 = 4;

/// The time that threads have to end after a signal.
const GRACE: Duration = Duration::from_millis(1500);

/// The time between two looks at signals and limits.
const PERIOD: Duration = Duration::from_millis(20);

/// The most results that wait to be written.
const MOST_WAITING: usize = 64;

/// The stack of a thread that draws.
const STACK: usize = 16 << 20;

/// The pictures to draw.
#[derive(Debug, Args)]
#[command(after_help = "\
A list has one model or scene per row: .csv with a header, .jsonl, or plain lines. The column
\"file\" names the model; further columns are options of the pictures, \"views\" and \"out\", and
override the options of the command line for their row. Everything is checked before the first
picture is drawn.

Names in --out have the fields {dir} {stem} {name} {index} {view} {view_name} {layer} {ext};
{index:06} and {view:03} have leading zeros, and {{ is a brace.

If --out ends with .tar, archive K has the pictures K * N to (K + 1) * N - 1 of the list, each with
a description of its camera: 000000012.png and 000000012.json, or with --layers
000000012.depth.npy and so on. --format says the format. --shard then deals archives, not models.

Examples:
  marraztu batch \"models/**/*.obj\" --views 8 --size 256 --out \"out/{dir}/{stem}-{view:02}.png\"
  marraztu batch --list list.csv --out \"out/{index:06}.png\" --report report.jsonl --resume
  marraztu batch --list list.csv --shard 3/64 --report report-3.jsonl
  marraztu batch --list list.csv --views 100 --out \"shards/{shard:06}.tar\" --shard 3/64 --resume
  find . -name \"*.obj\" | marraztu batch --list - --views front,right,top,iso

Exit status: 0 if all pictures are there, 1 if some are missing, 2 for invalid arguments, 4 with
--strict-exit if all missing pictures are caused by their input, 130 after SIGINT, 143 after
SIGTERM.")]
pub(crate) struct Batch {
    /// Models (.obj, .stl, also .gz) and scenes (.marraztu), one picture or set of views each;
    /// patterns such as "models/**/*.obj" are expanded
    #[arg(required_unless_present = "list")]
    files: Vec<PathBuf>,
    /// A list of models: .csv, .jsonl, or plain lines; "-" is standard input
    #[arg(long, value_name = "LIST")]
    list: Option<PathBuf>,
    /// The views of each model: a number of views around it, names (front, right, back, left, top,
    /// bottom, iso), fibonacci:COUNT[:SEED] for directions on a sphere, or a file of cameras as of
    /// NeRF (.json) [default: the view of the other options]
    #[arg(long, value_name = "VIEWS", allow_negative_numbers = true)]
    views: Option<String>,
    /// The names of the pictures; of archives for WebDataset, such as "shards/{shard:06}.tar"; or
    /// the folder of a data set [default: {stem}.{ext}, or {stem}-{view:03}.{ext} for several
    /// views, in the current folder]
    #[arg(short, long, value_name = "TEMPLATE")]
    out: Option<String>,
    /// Number of pictures in an archive
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = per_tar)]
    per_tar: usize,
    #[arg(long, value_name = "FORMAT", help = format_help(), default_value = "png")]
    #[arg(hide_default_value = true, value_parser = format)]
    format: &'static str,
    /// Write a data set for training into the folder of --out: nerf (nerfstudio), bop, coco
    /// (panoptic). A unit of the models is a metre
    #[arg(long, value_name = "KIND", hide_possible_values = true, requires = "out")]
    #[arg(value_parser = choice(&Dataset::ALL))]
    #[arg(conflicts_with_all = ["layers", "ids", "format", "sheet"])]
    dataset: Option<Dataset>,
    /// With "--dataset nerf", share the pictures of each model out to train, val and test, such as
    /// 80,10,10: in transforms_train.json and so on, as of NeRF's synthetic scenes, for Gaussian
    /// splatting
    #[arg(long, value_name = "TRAIN,VAL,TEST", value_parser = split, requires = "dataset")]
    split: Option<Split>,
    /// With "--dataset nerf", write this many points on the surfaces of each model to
    /// points3d.ply, from which Gaussian splatting starts: 100000 is usual
    #[arg(long, value_name = "N", requires = "dataset")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    seed_points: Option<u32>,
    /// Place the lights of a data set for each view [default: the same lights in all views of a
    /// model, since training assumes light that stays]
    #[arg(long, requires = "dataset")]
    lights_follow_camera: bool,
    /// Also write contact sheets with labels, of these columns and rows
    #[arg(long, value_name = "COLSxROWS", value_parser = grid, conflicts_with = "shard")]
    sheet: Option<Grid>,
    /// The folder of contact sheets
    #[arg(long, value_name = "FOLDER", default_value = ".", requires = "sheet")]
    sheets: PathBuf,
    /// Print the jobs, one per line: number, file, view and output, separated by tabs; and an
    /// estimate of bytes, time and shards, by a sample of 20 pictures that are drawn but not
    /// written
    #[arg(long)]
    dry_run: bool,
    /// Skip pictures that an earlier run has drawn from the same files with the same options
    #[arg(long)]
    resume: bool,
    /// Draw a part of the list: 3/64 is the part with number 3, counted from 0, of 64; "auto" asks
    /// Slurm, Kubernetes or AWS Batch. All views of a model are in one part
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Number of pictures that are drawn at a time [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// The most memory for loaded models, such as 500M or 4G
    #[arg(long, value_name = "SIZE", default_value = "2G", value_parser = bytes)]
    memory: usize,
    /// The time limit of a picture in seconds, including reading its model
    #[arg(long, value_name = "SECONDS", value_parser = limit)]
    timeout: Option<Duration>,
    /// Write a line of JSON for each picture, in the order of the list, and a summary
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write the times of each picture in milliseconds, as lines of JSON
    #[arg(long, value_name = "FILE")]
    times: Option<PathBuf>,
    /// Draw the other pictures if one fails (the default)
    #[arg(long, conflicts_with = "stop")]
    keep_going: bool,
    /// End at the first picture that fails
    #[arg(long)]
    stop: bool,
    /// Exit with status 4 if all missing pictures are caused by their input, so a retry is useless
    #[arg(long)]
    strict_exit: bool,
    #[command(flatten)]
    budget: Budget,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    options: OptionTexts,
}

/// Draws the pictures that the arguments describe.
pub(super) fn batch(arguments: Box<Batch>) -> Result<(), Failure> {
    arguments.talk.apply();
    let arguments = Arc::new(within_budget(*arguments)?);
    let rows = Rows::of(&arguments)?;
    check_outputs(&rows, &arguments)?;
    let plan = Plan::of(&rows.rows, arguments.shard.unwrap_or(Shard::WHOLE));
    check_inputs(&plan, &rows)?;
    if arguments.dry_run {
        print_jobs(&plan)?;
        rehearse(plan, arguments);
        return Ok(());
    }
    let name = cameras_name(&arguments);
    check_files(&arguments, &name, &plan, &rows)?;
    drop(rows);
    let studio = Arc::new(Studio::new(plan, Arc::clone(&arguments)));
    let mut results = Results::begin(&arguments, name, &studio)?;
    let signal = watched_signals();
    silence_panics();
    let outcomes = start(&studio, arguments.threads())?;
    let ended = collect(&studio, &outcomes, &signal, &mut |outcome| {
        results.meter.tick();
        outcome.map_or(Ok(true), |outcome| results.add(outcome))
    });
    let Results { meter, reporter, cameras, tables, tars, mut done, repaired, .. } = results;
    meter.finish();
    tars.map_or(Ok(()), Tars::finish)?;
    let counts = reporter.finish()?;
    tables.map_or(Ok(()), Tables::write)?;
    cameras.write()?;
    ended?;
    if let Some(grid) = arguments.sheet {
        done.sort_unstable();
        let jobs: Vec<usize> = done.into_iter().map(|(_, position)| position).collect();
        let wanted = || signal.load(Ordering::Relaxed) == 0;
        write_sheets(grid, &arguments.sheets, (studio.plan(), &jobs), &wanted)?;
    }
    tell(&counts, meter.unchanged(), meter.rate());
    if arguments.has_fixed_lights() {
        note(&"the lights are the same in all views: --lights-follow-camera lights each view");
    }
    if repaired > 0 {
        let list = if arguments.report.is_some() { "the report" } else { "--report" };
        note(&format_args!("{repaired} of the pictures have findings: {list} lists them"));
    }
    status(&counts, signal.load(Ordering::Relaxed), arguments.strict_exit)
}

/// Returns arguments with the settings that their budget asks for: those of the first picture, as
/// options for all of them.
fn within_budget(arguments: Batch) -> Result<Batch, Failure> {
    if !arguments.budget.is_given() {
        return Ok(arguments);
    }
    if is_part(&arguments) || arguments.resume {
        return Err(usage(
            "the settings for a budget depend on the machine, so parts would differ: draw one \
             picture with the budget, and give all parts the options that it prints",
        ));
    }
    let (rows, arguments) = (Rows::of(&arguments)?, Arc::new(arguments));
    let studio = Studio::new(Plan::of(&rows.rows, Shard::WHOLE), Arc::clone(&arguments));
    let chosen = studio.within_budget(&arguments.budget)?;
    drop((studio, rows));
    let mut arguments = Arc::try_unwrap(arguments).expect("the studio is gone");
    for (axis, choice) in chosen {
        arguments.options = arguments.options.and(axis, choice);
    }
    Ok(arguments)
}

impl Batch {
    /// Returns the template of `--out`, if it names archives.
    fn tar_template(&self) -> Option<&str> {
        let out = self.out.as_deref().filter(|_| self.dataset.is_none());
        out.filter(|out| TarNames::are_in(out))
    }

    /// Returns whether the lights of a model stay in all of its views.
    const fn has_fixed_lights(&self) -> bool {
        self.dataset.is_some() && !self.lights_follow_camera
    }

    /// Returns the number of pictures that are drawn at a time.
    fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.unwrap_or_else(cores)
    }
}

/// Returns whether only a part of the list is drawn.
fn is_part(arguments: &Batch) -> bool {
    arguments.shard.is_some_and(|shard| shard != Shard::WHOLE)
}

/// Returns the name of the file of cameras.
fn cameras_name(arguments: &Batch) -> String {
    match arguments.shard {
        // All views of a model, which has a folder of its own, are in one part.
        _ if arguments.dataset == Some(Dataset::Nerf) => "transforms.json".to_owned(),
        Some(shard) if is_part(arguments) => {
            format!("cameras-{}-of-{}.json", shard.index, shard.count)
        }
        _ => CAMERAS.to_owned(),
    }
}

/// Checks that no report, sheet or file of cameras would replace an input or a file of another
/// program, and that a data set does not mix with an earlier one.
fn check_files(arguments: &Batch, cameras: &str, plan: &Plan, rows: &Rows) -> Result<(), Failure> {
    let reports: Vec<&PathBuf> = arguments.report.iter().chain(&arguments.times).collect();
    let mut folders = BTreeSet::new();
    let has_layers = |row: &Arc<Row>| row.kind.parsed.options.layers.are_given();
    let has_tables =
        matches!(arguments.dataset, Some(Dataset::Bop | Dataset::Coco)) || plan.tars().is_some();
    if !has_tables && plan.rows().iter().any(has_layers) {
        let with_layers = plan.jobs().filter(|job| job.options().layers.are_given());
        folders.extend(with_layers.map(|job| job.cameras_folder(arguments.dataset).to_owned()));
    }
    let parts = arguments.split.into_iter().flat_map(Split::parts).map(part_name);
    let names: Vec<String> = parts.chain([cameras.to_owned()]).collect();
    let in_folder = |folder: PathBuf| names.iter().map(move |name| folder.join(name));
    let cameras: Vec<PathBuf> = folders.into_iter().flat_map(in_folder).collect();
    // Collecting the inputs takes long, and a file that does not exist is none.
    let inputs = match reports.iter().copied().chain(&cameras).any(|path| path.exists()) {
        true => rows.inputs(),
        false => Sources::default(),
    };
    reports.into_iter().try_for_each(|path| check_report(path, &inputs))?;
    if let Some(grid) = arguments.sheet {
        if plan.tars().is_some() {
            return Err(usage("--sheet shows files, and --out names archives"));
        }
        check_sheets(grid, &arguments.sheets, plan)?;
    }
    if arguments.split.is_some() && arguments.dataset != Some(Dataset::Nerf) {
        return Err(usage("--split is for --dataset nerf"));
    }
    if arguments.seed_points.is_some() && arguments.dataset != Some(Dataset::Nerf) {
        return Err(usage("--seed-points is for --dataset nerf"));
    }
    if let Some(dataset) = arguments.dataset {
        let folder = Path::new(arguments.out.as_deref().unwrap_or_default());
        check_used_folder(dataset, folder, rows)?;
    }
    cameras.iter().try_for_each(|path| {
        inputs.spare(path)?;
        check_cameras(path)
    })
}

/// Prints a line for each job.
fn print_jobs(plan: &Plan) -> Result<(), Failure> {
    /// The size of a piece of the text.
    const PIECE: usize = 1 << 16;
    let mut text = String::new();
    for job in plan.jobs() {
        let (file, out) = (job.row.file.display(), job.out().display());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}\t{file}\t{}\t{out}", job.index, job.camera().name);
        if text.len() > PIECE {
            print(&std::mem::take(&mut text))?;
        }
    }
    print(&text)
}

/// Prints an estimate of the batch, unless only errors are wanted.
fn rehearse(plan: Plan, arguments: Arc<Batch>) {
    if !is_quiet() {
        silence_panics();
        let (threads, is_shard) = (arguments.threads(), arguments.shard.is_some());
        print_estimate(&Studio::new(plan, arguments), threads, is_shard);
    }
}

/// Returns a cell that holds the number of the last signal to end.
fn watched_signals() -> Arc<AtomicUsize> {
    let cell = Arc::new(AtomicUsize::new(0));
    for signal in [SIGINT, SIGTERM] {
        let number = usize::try_from(signal).unwrap_or_default();
        // Without the handler, the signal ends the process as usual.
        let _ = signal_hook::flag::register_usize(signal, Arc::clone(&cell), number);
    }
    cell
}

/// Starts the threads, or as many as the system allows. The channel closes when all have ended.
fn start(studio: &Arc<Studio>, threads: usize) -> Result<Receiver<Outcome>, Failure> {
    let (sender, results) = sync_channel(MOST_WAITING);
    let named = |name: String| Builder::new().name(name).stack_size(STACK);
    for i in 0..threads {
        let (studio, sender) = (Arc::clone(studio), sender.clone());
        match named(format!("draw {i}")).spawn(move || studio.work(&sender)) {
            Ok(_) => {}
            Err(_limit) if i > 0 => break,
            Err(error) => {
                let reason = format!("a thread to draw cannot be started: {error}");
                return Err(Failure::Absent(reason));
            }
        }
    }
    let studio = Arc::clone(studio);
    let read = move || {
        // This thread is a member, so there is a pool, however many threads the system allows.
        let _pool = threads::pool(threads, Caller::Joins, "load");
        studio.read_ahead();
    };
    // Without this thread, each model is read by the first thread that draws it.
    let _ = named("read".to_owned()).spawn(read);
    Ok(results)
}

/// Passes the results to `take` until all jobs are done, and `None` from time to time. The batch
/// ends early after a signal, an error, or if `take` returns false.
fn collect(
    studio: &Studio,
    results: &Receiver<Outcome>,
    signal: &AtomicUsize,
    take: &mut dyn FnMut(Option<Outcome>) -> Result<bool, Failure>,
) -> Result<(), Failure> {
    let mut end: Option<Instant> = None;
    let mut result = Ok(());
    loop {
        let taken = match results.recv_timeout(PERIOD) {
            Ok(outcome) => take(Some(outcome)),
            Err(RecvTimeoutError::Timeout) => take(None),
            Err(RecvTimeoutError::Disconnected) => return result,
        };
        studio.enforce_limits();
        let goes_on = taken.unwrap_or_else(|failure| {
            result = Err(failure);
            false
        });
        if end.is_none() && (!goes_on || signal.load(Ordering::Relaxed) != 0) {
            studio.stop();
            end = Some(Instant::now() + GRACE);
        }
        // Threads that are still busy end with the process.
        if end.is_some_and(|end| end < Instant::now()) {
            return result;
        }
    }
}

/// Prints a summary.
fn tell(counts: &Counts, unchanged: usize, rate: f64) {
    let drawn = counts.done - unchanged;
    let missing = counts.missing();
    let of_earlier = match unchanged {
        0 => String::new(),
        count => format!(", {count} unchanged"),
    };
    note(&format_args!(
        "{drawn} drawn{of_earlier}, {missing} missing; {rate:.1} pictures a second"
    ));
}

/// Returns the exit status.
fn status(counts: &Counts, signal: usize, strict: bool) -> Result<(), Failure> {
    if let Ok(signal @ 1..) = u8::try_from(signal) {
        return Err(Failure::Status(128 + signal));
    }
    match counts.missing() {
        0 => Ok(()),
        missing if strict && missing == counts.invalid => Err(Failure::Status(INVALID)),
        _ => Err(Failure::Told),
    }
}

/// Returns the usual extension of a format.
fn format(text: &str) -> Result<&'static str, String> {
    let ending = text.trim_start_matches('.').to_ascii_lowercase();
    let found = PICTURE_FORMATS.iter().find(|format| format.endings.contains(&&*ending));
    let found = found.map(|format| format.endings[0]);
    let found = found.or_else(|| NUMBER_ENDINGS.into_iter().find(|other| *other == ending));
    found.ok_or_else(|| format!("possible values: {}", endings()))
}

fn format_help() -> String {
    format!("The format of names with {{ext}}, or of default names: {}", endings())
}

/// Lists the usual extensions: "png*, jpg, webp, ppm, exr, npy".
fn endings() -> String {
    let endings = PICTURE_FORMATS.iter().map(|format| format.endings[0]);
    let endings: Vec<&str> = endings.chain(NUMBER_ENDINGS).collect();
    endings.join(", ").replacen("png", "png*", 1)
}

fn per_tar(text: &str) -> Result<usize, String> {
    let pictures = text.parse().ok().filter(|pictures| (1..=1_000_000).contains(pictures));
    pictures.ok_or_else(|| "write a number of pictures from 1 to 1000000".to_owned())
}

fn limit(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|it: &f64| (0.001..=1e6).contains(it));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "write seconds, from 0.001".to_owned())
}

/// Parses a number of bytes, such as 500M.
fn bytes(text: &str) -> Result<usize, String> {
    const UNITS: [(char, u32); 4] = [('K', 10), ('M', 20), ('G', 30), ('T', 40)];
    let text = text.trim().to_ascii_uppercase();
    let text = text.strip_suffix("IB").or_else(|| text.strip_suffix('B')).unwrap_or(&text);
    let unit = UNITS.iter().find(|(unit, _)| text.ends_with(*unit));
    let (number, shift) = unit.map_or((text, 0), |(_, shift)| (&text[..text.len() - 1], *shift));
    let bytes = number.parse::<u64>().ok().and_then(|number| number.checked_mul(1 << shift));
    let bytes = bytes.and_then(|bytes| usize::try_from(bytes).ok());
    bytes.ok_or_else(|| "write a number of bytes, such as 500M or 4G".to_owned())
}

#[cfg(test)]
mod tests {
    use super::jobs::Job;
    use super::*;

    /// Returns the jobs of a command line.
    pub(super) fn jobs_of(arguments: &[&str]) -> Result<Vec<Job>, Failure> {
        let command = Batch::augment_args(clap::Command::new("batch").no_binary_name(true));
        let matches = command.get_matches_from(arguments);
        let batch = <Batch as clap::FromArgMatches>::from_arg_matches(&matches).unwrap();
        let rows = Rows::of(&batch)?;
        check_outputs(&rows, &batch)?;
        Ok(Plan::of(&rows.rows, batch.shard.unwrap_or(Shard::WHOLE)).jobs().collect())
    }

    #[test]
    fn sizes_and_formats_are_read_or_rejected() {
        assert_eq!(bytes("500M"), Ok(500 << 20));
        assert_eq!((bytes("4g"), bytes("1KiB"), bytes("12")), (Ok(4 << 30), Ok(1024), Ok(12)));
        for wrong in ["", "G", "-1", "1.5G", "1X", "99999999999T"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
        assert_eq!((format(".JPEG"), format("exr")), (Ok("jpg"), Ok("exr")));
        assert!(format("gif").unwrap_err().contains("png*, jpg"));
        assert!(limit("0").is_err() && limit("1.5").is_ok());
    }

    #[test]
    fn the_exit_status_tells_why_pictures_are_missing() {
        let code = |counts: Counts, signal, strict| match status(&counts, signal, strict) {
            Ok(()) => 0,
            Err(Failure::Status(status)) => status,
            Err(_) => 1,
        };
        let none = Counts { jobs: 9, done: 9, ..Counts::default() };
        let invalid = Counts { invalid: 2, ..none };
        let mixed = Counts { failed: 1, ..invalid };
        assert_eq!([code(none, 0, true), code(invalid, 0, true), code(mixed, 0, true)], [0, 4, 1]);
        assert_eq!(
            [code(invalid, 0, false), code(none, 15, false), code(mixed, 2, true)],
            [1, 143, 130]
        );
    }
}
