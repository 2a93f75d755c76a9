//! `marraztu prove`: checks the program's guarantees.

use std::io::Write;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use clap::Args;
use marraztu::lab::prove::pictures::{levels, samples};
use marraztu::lab::prove::plan::instructions::{self, Frame};
use marraztu::lab::prove::{PROOFS, Proof, Tally};

use super::failure::Failure;
use super::say;

/// Which claims, and in how many cases.
#[derive(Debug, Args)]
#[command(after_help = "\
Cases are generated in lots, each from its number alone. A counterexample is named by its lot;
--from LOT --count 1 checks it again.

Examples:
  marraztu prove                          every claim, in the number of cases that is promised
  marraztu prove fans --count 1000000     one claim, in a million cases
  marraztu prove instructions             count a frame's instructions with and without unlit lights
  marraztu prove pictures                 checksums of a dozen pictures, to compare processors")]
pub(crate) struct Prove {
    /// The claim, by its name in `marraztu prove --list` [default: all]
    pub(crate) name: Option<String>,
    /// How many cases to check [default: the promised number]
    #[arg(long, value_name = "N")]
    pub(crate) count: Option<u64>,
    /// The first lot
    #[arg(long, value_name = "LOT", default_value_t = 0)]
    pub(crate) from: u64,
    /// Draw one of the frames whose instructions are counted, and nothing else
    #[arg(long, hide = true, value_enum)]
    pub(crate) draw_counted: Option<Counted>,
    /// List the claims
    #[arg(long)]
    pub(crate) list: bool,
    /// Also write the result of each claim into a file in this folder, for docs/stability.sh
    #[arg(long, value_name = "FOLDER")]
    pub(crate) figures: Option<PathBuf>,
}

/// See [`instructions`].
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Counted {
    Plain,
    LightsOff,
}

/// Looks at the cases of one claim, or of all.
pub(crate) fn prove(arguments: &Prove) -> Result<(), Failure> {
    if arguments.list {
        let rows = PROOFS.iter().map(|proof| {
            format!("{:<9} {} {}: {}", proof.name, proof.whole, proof.unit, proof.claim)
        });
        let others = [
            "instructions  two frames: 100 lights that are off cost no instruction of drawing",
            "pictures  the sums of a dozen pictures",
        ];
        let rows = rows.chain(others.map(str::to_owned));
        return tell(&rows.collect::<Vec<_>>().join("\n"));
    }
    if let Some(counted) = arguments.draw_counted {
        return draw_counted(counted);
    }
    match arguments.name.as_deref() {
        Some("pictures") => pictures(),
        Some("instructions") => same_instructions(),
        Some(name) => {
            let Some(proof) = Proof::named(name) else {
                say("error", &format_args!("there is no claim \"{name}\"; --list lists them"));
                return Err(Failure::Told);
            };
            look(proof, arguments)
        }
        None => PROOFS.iter().try_for_each(|proof| look(proof, arguments)),
    }
}

/// Looks at the cases of one claim, and says what was seen.
fn look(proof: &Proof, arguments: &Prove) -> Result<(), Failure> {
    let lots = proof.lots(arguments.count.unwrap_or(proof.whole));
    let bar = indicatif::ProgressBar::new(lots);
    bar.set_message(proof.name);
    let begin = Instant::now();
    let seen = proof.run(arguments.from..arguments.from.saturating_add(lots), &|_| bar.inc(1));
    bar.finish_and_clear();
    match seen {
        Ok(tally) => {
            let seconds = begin.elapsed().as_secs_f64();
            tell(&format!("{}: {tally}; holds ({seconds:.0} s)", proof.name))?;
            arguments.figures.as_ref().map_or(Ok(()), |folder| write(folder, proof, &tally))
        }
        Err(counterexample) => {
            tell(&format!("{}: {counterexample}", proof.name))?;
            let again =
                format!("marraztu prove {} --from {} --count 1", proof.name, counterexample.lot);
            say("error", &format_args!("the claim does not hold: {}; {again}", proof.claim));
            Err(Failure::Told)
        }
    }
}

/// What was seen of a claim, as a line of a table.
fn write(folder: &std::path::Path, proof: &Proof, tally: &Tally) -> Result<(), Failure> {
    let row = format!("{}\t{}\t{tally}\n", proof.name, proof.claim);
    std::fs::write(folder.join(format!("proof-{}.tsv", proof.name)), row).map_err(Failure::Output)
}

/// The list that `tests/pictures.sums` is on this machine.
fn pictures() -> Result<(), Failure> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut rows = vec!["# What `marraztu prove pictures` prints, on every processor.".to_owned()];
    for sample in samples() {
        let sums: Vec<u64> = levels().into_iter().map(|level| sample.sum(level, threads)).collect();
        if sums.windows(2).any(|pair| pair[0] != pair[1]) {
            say("error", &format_args!("instructions show in \"{}\": {sums:x?}", sample.name));
            return Err(Failure::Told);
        }
        rows.push(format!("{:016x}  {}", sums[0], sample.name));
    }
    tell(&rows.join("\n"))
}

fn tell(text: &str) -> Result<(), Failure> {
    writeln!(std::io::stdout().lock(), "{text}").map_err(Failure::Output)
}

fn draw_counted(counted: Counted) -> Result<(), Failure> {
    let frame = match counted {
        Counted::Plain => Frame::Plain,
        Counted::LightsOff => Frame::WithLightsOff,
    };
    instructions::draw(frame).map_err(|error| Failure::Absent(error.to_string()))
}

/// How often each frame is counted: memory lies elsewhere in every process, and what is copied from
/// there takes a few instructions more or less.
const COUNTS: usize = 5;

/// How many instructions that makes at the most: less than one for a hundred pixels.
const SPREAD: u64 = 160;

/// Counts the instructions of two frames that should have as many.
fn same_instructions() -> Result<(), Failure> {
    let least = |frame| {
        (0..COUNTS).try_fold(u64::MAX, |least, _| counted(frame).map(|count| least.min(count)))
    };
    let (plain, off) = (least("plain")?, least("lights-off")?);
    tell(&format!(
        "instructions: {plain} for a frame, {off} with {} lights that are off",
        instructions::LIGHTS_OFF
    ))?;
    if plain.abs_diff(off) <= SPREAD {
        return Ok(());
    }
    say("error", &"lights that are off cost instructions");
    Err(Failure::Told)
}

/// How many instructions a frame takes, by callgrind.
fn counted(frame: &str) -> Result<u64, Failure> {
    let program = std::env::current_exe().map_err(Failure::Output)?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={}", instructions::COUNTED))
        .arg(program)
        .args(["prove", "--draw-counted", frame])
        .output()
        .map_err(|error| {
            Failure::Absent(format!("valgrind, which counts, does not run: {error}"))
        })?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said.lines().find_map(|line| line.split_once("Collected : "));
    let count = collected.and_then(|(_, count)| count.trim().parse().ok()).filter(|n| *n > 0);
    count.ok_or_else(|| Failure::Absent(format!("callgrind counted nothing; it said:\n{said}")))
}
