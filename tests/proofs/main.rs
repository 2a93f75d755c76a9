//! Checks the program's guarantees on random cases: a quick round of each proof in every test run,
//! and any number of cases on request.
//!
//! ```text
//! cargo test --test proofs                                      a quick round of each
//! cargo test --release --test proofs -- fans --count 1000000    a million cases of one
//! cargo test --release --test proofs -- --whole                 the numbers of docs/stability.md
//! cargo test --profile profiling --test proofs -- instructions  count by callgrind
//! cargo test --profile profiling --test proofs -- choices       the same for each choice
//! ```

mod claims;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::Parser;
use marraztu_lab::suite::SuiteScene;

use self::claims::choices;
use self::claims::instructions::{self, Frame};
use self::claims::{PROOFS, Proof, Tally};

/// Checks the program's guarantees on random cases.
#[derive(Debug, Parser)]
#[command(after_help = "\
Cases come in batches; the number of a batch alone decides what is in it. A counterexample is named
by its batch, and --from BATCH --count 1 checks it again.")]
struct Arguments {
    /// The proofs with this text in their name, \"instructions\" or \"choices\" [default: all
    /// proofs]
    name: Option<String>,
    /// The number of cases to check [default: a quick round]
    #[arg(long, value_name = "N", conflicts_with = "whole")]
    count: Option<u64>,
    /// Check as many cases as docs/stability.md reports
    #[arg(long)]
    whole: bool,
    /// The first batch
    #[arg(long, visible_alias = "seed", value_name = "BATCH")]
    from: Option<u64>,
    /// List the proofs
    #[arg(long)]
    list: bool,
    /// Also write the result of each proof into a file in this folder, for tools/stability.sh
    #[arg(long, value_name = "FOLDER")]
    figures: Option<PathBuf>,
    /// Draw one of the counted frames, then exit
    #[arg(long, hide = true, value_enum)]
    draw_counted: Option<Frame>,
    /// Draw a scene of the laboratory's suite with one of the counted choices
    #[arg(long, hide = true)]
    draw_choice: Option<String>,
    /// The number of that choice
    #[arg(long, hide = true, default_value_t = 0)]
    which: usize,
    /// Count the choices of the scenes with this text in their name
    #[arg(long, value_name = "SCENE", default_value = "", hide_default_value = true)]
    scene: String,
    #[command(flatten)]
    libtest: Libtest,
}

/// Options of Rust's own tests, which `cargo test -- OPTIONS` passes to every test target.
#[derive(Debug, clap::Args)]
struct Libtest {
    #[arg(long, hide = true)]
    ignored: bool,
    #[arg(long, hide = true)]
    include_ignored: bool,
    #[arg(long, hide = true)]
    exact: bool,
    #[arg(long, hide = true, alias = "nocapture")]
    no_capture: bool,
    #[arg(short, long, hide = true)]
    quiet: bool,
    #[arg(long, hide = true)]
    test_threads: Option<usize>,
    #[arg(long, hide = true)]
    skip: Vec<String>,
    #[arg(long, hide = true)]
    color: Option<String>,
}

/// The reason for a failed run.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{0}")]
    Wrong(String),
    #[error("standard output or a file of figures: {0}")]
    Output(#[from] std::io::Error),
    #[error("{0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let _ = writeln!(std::io::stderr().lock(), "error: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(frame) = arguments.draw_counted {
        return Ok(instructions::draw(frame)?);
    }
    if let Some(word) = &arguments.draw_choice {
        let scene = SuiteScene::named(word);
        let scene = scene.ok_or_else(|| Failure::Wrong(format!("no scene is named {word}")))?;
        return Ok(choices::draw(scene, arguments.which)?);
    }
    if arguments.list {
        return list();
    }
    if arguments.libtest.ignored {
        return Ok(());
    }
    let name = arguments.name.as_deref().unwrap_or_default();
    if name == "instructions" {
        return same_instructions();
    }
    if name == "choices" {
        return count_choices(arguments);
    }
    let skipped = |proof: &Proof| arguments.libtest.skip.iter().any(|s| proof.name.contains(s));
    let chosen: Vec<&Proof> =
        PROOFS.iter().filter(|proof| proof.name.contains(name) && !skipped(proof)).collect();
    let at_length = arguments.count.is_some() || arguments.whole || arguments.from.is_some();
    if chosen.is_empty() && at_length {
        return Err(Failure::Wrong(format!("no proof is named \"{name}\"; --list lists them")));
    }
    for proof in &chosen {
        let cases = if arguments.whole { proof.whole } else { proof.quick };
        let tally = check(proof, arguments.from.unwrap_or(0), arguments.count.unwrap_or(cases))?;
        if let Some(folder) = &arguments.figures {
            write(folder, proof, &tally)?;
        }
        if !at_length {
            proof.regressions.iter().try_for_each(|batch| check(proof, *batch, 1).map(drop))?;
        }
    }
    if arguments.name.is_none() && !at_length {
        begins_on_many_threads()?;
    }
    // A test name of another target selects no proof, which is not an error.
    tell(&format!("{} of {} proofs checked", chosen.len(), PROOFS.len()))
}

fn list() -> Result<(), Failure> {
    for proof in PROOFS {
        tell(&format!("{:<9} {} {}: {}", proof.name, proof.whole, proof.unit, proof.claim))?;
    }
    tell("instructions  two frames: 100 lights that are off cost no instruction of drawing")?;
    tell("choices       a coarser choice takes no more instructions, unless its axis says why")
}

/// Checks cases of one proof, and prints its counts.
fn check(proof: &Proof, from: u64, cases: u64) -> Result<Tally, Failure> {
    let batches = proof.batches(cases);
    let bar = indicatif::ProgressBar::new(batches);
    bar.set_message(proof.name);
    let begun = Instant::now();
    let checked = proof.run(from..from.saturating_add(batches), &|_| bar.inc(1));
    bar.finish_and_clear();
    let tally = checked.map_err(|counterexample| {
        let again = format!(
            "cargo test --test proofs -- {} --from {} --count 1",
            proof.name, counterexample.batch
        );
        let Proof { name, claim, .. } = proof;
        Failure::Wrong(format!(
            "{name}: {counterexample}\n\"{claim}\" does not hold; again: {again}"
        ))
    })?;
    if let Some(missing) = proof.missing(&tally, cases) {
        return Err(Failure::Wrong(format!("{}: {missing}: {tally}", proof.name)));
    }
    tell(&format!("{}: {tally}; holds ({:.0} s)", proof.name, begun.elapsed().as_secs_f64()))?;
    Ok(tally)
}

/// Writes the counts of a proof as one line of a table.
fn write(folder: &Path, proof: &Proof, tally: &Tally) -> Result<(), Failure> {
    let row = format!("{}\t{}\t{tally}\n", proof.name, proof.claim);
    Ok(std::fs::write(folder.join(format!("proof-{}.tsv", proof.name)), row)?)
}

fn tell(text: &str) -> Result<(), Failure> {
    Ok(writeln!(std::io::stdout().lock(), "{text}")?)
}

/// The number of processes started on many threads.
const PROCESSES: usize = 100;

/// The time limit of a process; a longer run counts as a hang.
const PATIENCE: Duration = Duration::from_secs(120);

/// Runs a few cases in new processes, in which many threads request every cached value at the same
/// time.
fn begins_on_many_threads() -> Result<(), Failure> {
    for process in 0..PROCESSES {
        let mut child = Command::new(std::env::current_exe()?)
            .args(["plan", "--count", "40"])
            .env("RAYON_NUM_THREADS", "8")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let begun = Instant::now();
        while child.try_wait()?.is_none() && begun.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(5));
        }
        if !succeeded(&mut child)? {
            return Err(Failure::Wrong(format!("process {process} on 8 threads failed or hung")));
        }
    }
    tell(&format!("{PROCESSES} processes began on 8 threads and came to their end"))
}

/// Kills a process if it still runs, and returns whether it succeeded.
fn succeeded(child: &mut Child) -> Result<bool, Failure> {
    if child.try_wait()?.is_none() {
        child.kill()?;
    }
    Ok(child.wait()?.success())
}

/// The number of runs per frame. Memory has other addresses in every process, and copying from them
/// takes a few instructions more or less.
const COUNTS: usize = 5;

/// The largest difference from that: less than one instruction per hundred pixels.
const SPREAD: u64 = 160;

/// Counts the instructions of each choice of accuracy on the laboratory's suite.
fn count_choices(arguments: &Arguments) -> Result<(), Failure> {
    let mut written = Ok(());
    let mut each = |table: &str| written = tell(table);
    let tables = choices::count(&arguments.scene, &mut each).map_err(Failure::Wrong)?;
    written?;
    match &arguments.figures {
        Some(folder) => Ok(std::fs::write(folder.join("choices.md"), tables)?),
        None => Ok(()),
    }
}

/// Counts the instructions of two frames that should take the same number.
fn same_instructions() -> Result<(), Failure> {
    let least = |frame| {
        (0..COUNTS).try_fold(u64::MAX, |least, _| {
            let count = instructions::count(instructions::COUNTED, &["--draw-counted", frame]);
            count.map(|count| least.min(count)).map_err(Failure::Wrong)
        })
    };
    let (plain, off) = (least("plain")?, least("lights-off")?);
    tell(&format!(
        "instructions: {plain} for a frame, {off} with {} lights that are off",
        instructions::LIGHTS_OFF
    ))?;
    if plain.abs_diff(off) <= SPREAD {
        return Ok(());
    }
    Err(Failure::Wrong("lights that are off cost instructions".to_owned()))
}
