//! `marraztu prove`: claims that are proved by trying, on as many scenes as one has time for.

use std::io::Write;
use std::process::Command;
use std::time::Instant;

use clap::{Args, ValueEnum};
use marraztu::lab::proof::instructions::{self, Frame};
use marraztu::lab::proof::{absent, plan};
use marraztu::render::plan::rules::Rules;

use super::failure::Failure;

/// Which claims are tried, and for how long.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  marraztu prove                          list the proofs
  marraztu prove all
  marraztu prove plan --scenes 100000

Exit status: 0 where every claim held, 1 where one did not.")]
pub(crate) struct Prove {
    /// The proofs, by name, or \"all\"; without a name they are listed
    names: Vec<String>,
    /// How many scenes are tried
    #[arg(long, default_value_t = 10_000, value_name = "N")]
    scenes: u64,
    /// The first scene
    #[arg(long, default_value_t = 0, value_name = "N")]
    from: u64,
    /// Threads; all cores where it is not said
    #[arg(long)]
    threads: Option<usize>,
    /// Draw one of the frames whose instructions are counted, and nothing else
    #[arg(long, hide = true, value_enum)]
    draw_counted: Option<Counted>,
}

/// See [`instructions`].
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Counted {
    Plain,
    LightsOff,
}

/// A claim.
struct Proof {
    name: &'static str,
    /// The claim, as a sentence.
    claim: &'static str,
    /// Tries it: what was seen, or what speaks against it.
    run: fn(&Prove) -> Result<String, String>,
}

/// The proofs. A new one is a row here.
const PROOFS: &[Proof] = &[
    Proof {
        name: "plan",
        claim: "What a plan leaves out changes no bit of the picture.",
        run: plan_is_full,
    },
    Proof {
        name: "rules",
        claim: "Each rule by which something is left out, made wrong, changes pictures.",
        run: rules_matter,
    },
    Proof {
        name: "faint",
        claim: "Light that is left out as too faint changes a byte by one step at most.",
        run: faint,
    },
    Proof {
        name: "absent",
        claim: "Lights that are off, hidden objects and unused materials change no byte.",
        run: unseen,
    },
    Proof {
        name: "instructions",
        claim: "A frame takes as many instructions with 100 lights that are off as with none.",
        run: same_instructions,
    },
];

/// Tries the claims that are asked for, or lists them.
pub(crate) fn prove(arguments: &Prove) -> Result<(), Failure> {
    if let Some(counted) = arguments.draw_counted {
        let frame = match counted {
            Counted::Plain => Frame::Plain,
            Counted::LightsOff => Frame::WithLightsOff,
        };
        return instructions::draw(frame).map_err(|error| Failure::Absent(error.to_string()));
    }
    let all = arguments.names.iter().any(|name| name == "all");
    if let Some(unknown) = arguments
        .names
        .iter()
        .find(|name| *name != "all" && !PROOFS.iter().any(|proof| proof.name == **name))
    {
        let names: Vec<&str> = PROOFS.iter().map(|proof| proof.name).collect();
        let names = names.join(", ");
        return Err(Failure::Absent(format!("there is no proof \"{unknown}\": there are {names}")));
    }
    if let Some(threads) = arguments.threads {
        // Fails only where the threads are there already, and this comes first.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let mut out = std::io::stdout().lock();
    let mut failed = false;
    for proof in PROOFS {
        if arguments.names.is_empty() {
            writeln!(out, "{:14}{}", proof.name, proof.claim).map_err(Failure::Output)?;
        }
        if !all && !arguments.names.iter().any(|name| name == proof.name) {
            continue;
        }
        writeln!(out, "{}: {}", proof.name, proof.claim).map_err(Failure::Output)?;
        let begun = Instant::now();
        let result = (proof.run)(arguments);
        let seconds = begun.elapsed().as_secs_f64();
        let (word, text) = match &result {
            Ok(text) => ("held", text),
            Err(text) => ("DOES NOT HOLD", text),
        };
        failed |= result.is_err();
        writeln!(out, "  {word} ({seconds:.1} s): {text}").map_err(Failure::Output)?;
    }
    if failed { Err(Failure::Told) } else { Ok(()) }
}

impl Prove {
    fn seeds(&self) -> std::ops::Range<u64> {
        self.from..self.from.saturating_add(self.scenes)
    }
}

fn plan_is_full(arguments: &Prove) -> Result<String, String> {
    let tally = plan::plan_is_full(&Rules::sound(), arguments.seeds());
    tally
        .map(|tally| format!("{} scenes, {} pixels, no bit differs", tally.scenes, tally.pixels))
        .map_err(|difference| difference.to_string())
}

fn rules_matter(arguments: &Prove) -> Result<String, String> {
    let mut lines = Vec::new();
    let mut passed = Vec::new();
    for breakage in plan::breakages() {
        let what = format!("{}, which {}", breakage.rule, breakage.fault);
        match plan::caught_by(&breakage, arguments.seeds()) {
            Some(difference) => {
                lines.push(format!("{what}: seen in scene {}", difference.seed));
            }
            None => passed.push(what),
        }
    }
    if passed.is_empty() {
        Ok(format!("{} breakages\n    {}", lines.len(), lines.join("\n    ")))
    } else {
        Err(format!("not seen: {}", passed.join("; ")))
    }
}

fn faint(arguments: &Prove) -> Result<String, String> {
    plan::faint_is_within_a_step(arguments.seeds())
        .map(|tally| {
            let bytes = 3 * tally.pixels;
            format!("{} scenes, {} of {bytes} bytes one step off", tally.scenes, tally.steps)
        })
        .map_err(|difference| difference.to_string())
}

fn unseen(arguments: &Prove) -> Result<String, String> {
    match absent::seen_after_all(arguments.seeds()) {
        None => Ok(format!("{} scenes, no byte differs", arguments.scenes)),
        Some(seed) => Err(format!("the picture of scene {seed} changes")),
    }
}

fn same_instructions(_: &Prove) -> Result<String, String> {
    let (plain, off) = (counted("plain")?, counted("lights-off")?);
    if plain == off {
        Ok(format!("{plain} instructions for each of the two frames"))
    } else {
        Err(format!("{plain} instructions with none, {off} with {}", instructions::LIGHTS_OFF))
    }
}

/// How many instructions a frame takes, by callgrind.
fn counted(frame: &str) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={}", instructions::COUNTED))
        .arg(program)
        .args(["prove", "--draw-counted", frame])
        .output()
        .map_err(|error| format!("valgrind, which counts, cannot be run: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said.lines().find_map(|line| line.split_once("Collected : "));
    let count =
        collected.and_then(|(_, count)| count.trim().parse().ok()).filter(|count| *count > 0);
    count.ok_or_else(|| format!("callgrind counted nothing; it said:\n{said}"))
}
