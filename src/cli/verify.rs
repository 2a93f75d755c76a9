//! `marraztu verify`: checks that this processor draws the listed pictures.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use fearless_simd::Level;
use marraztu_core::base::image::Picture;
use marraztu_io::{Progress, SaveError, check_scheme, save_picture};
use marraztu_lab::error::amplified;
use marraztu_lab::instructions::{levels, name_of, named};
use marraztu_lab::pictures::{self, TestPicture};

use super::bar::Bar;
use super::failure::Failure;
use super::talk::print;
use super::values::threads;

/// With which instructions and threads the pictures are drawn.
#[derive(Debug, Args)]
#[command(after_help = "\
Draws small pictures of every kind and compares their checksums with the list, which is the same for
all processors. Prints a line for each picture that differs.

Examples:
  marraztu verify                               every instruction set of this processor
  marraztu verify --instructions plain --threads 1
  marraztu verify --print                       the list, as tests/pictures.sums holds it

Exit status 1: a picture differs.")]
pub(crate) struct Verify {
    /// The instruction set: best, avx512, avx2, sse4.2, plain [default: all of this processor]
    #[arg(long, value_name = "SET", value_parser = level)]
    instructions: Option<Level>,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// Print the checksums instead of comparing them
    #[arg(long)]
    print: bool,
    /// Write pictures to this folder: all of them with --print, else those that differ, each with
    /// the expected picture if another set of instructions draws it, and their difference times 16
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

fn level(name: &str) -> Result<Level, &'static str> {
    named(name).ok_or(
        "unknown, or not supported by this processor; possible values: best, avx512, avx2, \
            sse4.2, plain",
    )
}

/// Draws the pictures, and compares or prints their hashes.
pub(crate) fn verify(arguments: &Verify) -> Result<(), Failure> {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = arguments.threads.unwrap_or(all);
    let levels = arguments.instructions.map_or_else(levels, |level| vec![level]);
    let out = arguments.out.as_deref();
    if let Some(folder) = out {
        check_scheme(folder)?;
        let failed = |error| Failure::Usage(format!("{}: {error}", folder.display()));
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    let (text, differing) = if arguments.print {
        list(&levels, threads, out)?
    } else {
        comparison(&levels, threads, &pictures::listed(), out)?
    };
    print(&text)?;
    if differing > 0 { Err(Failure::Told) } else { Ok(()) }
}

/// Visits all pictures, with a progress bar.
fn each(mut visit: impl FnMut(&TestPicture) -> Result<(), SaveError>) -> Result<(), SaveError> {
    let (pictures, progress) = (pictures::all(), Progress::new());
    let _bar = Bar::of("drawing", &progress);
    for (i, picture) in pictures.iter().enumerate() {
        // Nothing cancels this progress.
        let _ = progress.reached(i, pictures.len());
        visit(picture)?;
    }
    Ok(())
}

/// Formats the list of hashes; also returns the number that depend on the instructions.
fn list(
    levels: &[Level],
    threads: usize,
    out: Option<&Path>,
) -> Result<(String, usize), SaveError> {
    let mut text = "# What `marraztu verify --print` prints, on every processor.\n".to_owned();
    let mut differing = 0;
    each(|picture| {
        let mut first = None;
        for level in levels {
            let drawn = picture.draw(*level, threads);
            let sum = pictures::sum(&drawn);
            if let Some(folder) = out.filter(|_| first.is_none()) {
                save_picture(&folder.join(format!("{}.png", picture.file_stem())), &drawn)?;
            }
            let expected = *first.get_or_insert(sum);
            // Writing to a string cannot fail.
            if sum != expected {
                differing += 1;
                let _ = writeln!(text, "# with {}: {sum:016x}", name_of(*level));
            }
        }
        let _ = writeln!(text, "{:016x}  {}", first.unwrap_or_default(), picture.name);
        Ok(())
    })?;
    Ok((text, differing))
}

/// Formats a line for each difference and a summary; also returns the number of differences.
fn comparison(
    levels: &[Level],
    threads: usize,
    listed: &[(&str, u64)],
    out: Option<&Path>,
) -> Result<(String, usize), SaveError> {
    let (mut text, mut alike, mut differing) = (String::new(), 0, 0);
    let mut missing: BTreeMap<&str, u64> = listed.iter().copied().collect();
    each(|picture| {
        let expected = missing.remove(&*picture.name);
        for level in levels {
            let drawn = picture.draw(*level, threads);
            let sum = pictures::sum(&drawn);
            let wrong = match expected {
                Some(expected) if expected == sum => {
                    alike += 1;
                    continue;
                }
                Some(expected) => format!("{sum:016x} instead of {expected:016x}"),
                None => format!("{sum:016x}, but it is not listed"),
            };
            differing += 1;
            let _ = writeln!(text, "{}: {wrong}, with {}", picture.name, name_of(*level));
            if let Some(folder) = out {
                save_difference(folder, picture, (&drawn, *level), expected)?;
            }
        }
        Ok(())
    })?;
    // Listed pictures that were not drawn are differences, too.
    for name in missing.keys() {
        let _ = writeln!(text, "{name}: it is listed, but there is no such picture");
    }
    differing += missing.len();
    let names: Vec<String> = levels.iter().map(|level| name_of(*level)).collect();
    let all = alike + differing;
    let names = names.join(", ");
    let _ = writeln!(text, "{alike} of {all} pictures are as listed ({names}; {threads} threads)");
    Ok((text, differing))
}

/// Writes a picture that differs from the list. The expected picture and the difference are written
/// if this processor can draw the expected one: by another set of instructions, or on one thread.
fn save_difference(
    folder: &Path,
    picture: &TestPicture,
    (drawn, level): (&Picture, Level),
    expected: Option<u64>,
) -> Result<(), SaveError> {
    let stem = format!("{}-{}", picture.file_stem(), name_of(level).to_lowercase());
    save_picture(&folder.join(format!("{stem}.png")), drawn)?;
    let others = levels().into_iter().map(|level| picture.draw(level, 1));
    let is_expected = |other: &Picture| Some(pictures::sum(other)) == expected;
    if let Some(other) = others.into_iter().find(is_expected) {
        save_picture(&folder.join(format!("{stem}-expected.png")), &other)?;
        let difference = amplified(drawn, &other, 16);
        save_picture(&folder.join(format!("{stem}-difference-x16.png")), &difference)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The folder for pictures that differ; `.ci` keeps it.
    fn failed() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("target/failed-pictures")
    }

    #[test]
    fn pictures_with_a_wrong_or_missing_sum_are_reported_and_counted() {
        let best = [Level::new()];
        let listed = pictures::listed();
        std::fs::create_dir_all(failed()).unwrap();
        let (text, differing) = comparison(&best, 2, &listed, Some(&failed())).unwrap();
        assert_eq!((text.lines().count(), differing), (1, 0), "see {:?}\n{text}", failed());
        let mut wrong = listed.clone();
        wrong[3].1 ^= 1;
        let dropped = wrong.remove(0).0;
        let folder = tempfile::tempdir().unwrap();
        let (text, differing) = comparison(&best, 2, &wrong, Some(folder.path())).unwrap();
        let written = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(written, 2, "both are written, and nothing draws what is expected");
        assert_eq!((text.lines().count(), differing), (3, 2), "{text}");
        assert!(
            text.contains(&format!("{}: ", wrong[2].0)) && text.contains("instead of"),
            "{text}"
        );
        assert!(text.contains(&format!("{dropped}: ")) && text.contains("not listed"), "{text}");
        let more = [listed.as_slice(), &[("a picture that is gone", 1)]].concat();
        assert_eq!(comparison(&best, 2, &more, None).unwrap().1, 1);
    }

    #[test]
    fn the_printed_list_is_the_list() {
        let rows: Vec<String> =
            pictures::listed().iter().map(|(name, sum)| format!("{sum:016x}  {name}")).collect();
        let folder = tempfile::tempdir().unwrap();
        let (printed, differing) = list(&levels(), 2, Some(folder.path())).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), rows.len());
        assert_eq!(differing, 0);
        assert_eq!(printed.lines().skip(1).collect::<Vec<_>>(), rows);
    }
}
