//! `marraztu compare`: compares two pictures, or the pictures of two folders.
//!
//! ```text
//! two paths  ->  pairs  ->  differences  ->  text or JSON, JUnit, pictures, page  ->  status
//! ```

mod junit;
mod measure;
mod pairs;
mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use marraztu::plots::{self, PagePicture};
use marraztu_core::base::image::Picture;
use marraztu_io::{self as io, PICTURE_FORMATS, PictureContent, PictureFormat, SaveError, Sources};
use marraztu_lab::error::amplified;
use rayon::prelude::*;

use self::measure::{Difference, Limits, colors, measure, selected};
use self::pairs::{Inputs, Pair};
use self::report::{Compared, Counts, Verdict, json, text};
use super::batch::report::shown;
use super::failure::Failure;
use super::page::{check_page, write_page};
use super::say;
use super::talk::print;

/// The exit status if pictures cannot be compared.
const INCOMPARABLE: u8 = 2;

/// The factor of differences in the picture of differences.
const AMPLIFIED: u16 = 16;

/// The pictures to compare.
#[derive(Debug, Args)]
#[command(after_help = "\
Prints the largest difference of a channel in steps of 1/255 (with alpha), the number of pixels that
differ, the root of the mean square error in steps, and FLIP: the difference that a viewer sees when
flipping between the pictures, from 0 to 1 (Andersson and others, 2020). If a picture has 16 bits
per channel, as depths and ids have, steps are 1/65535. FLIP and the picture of differences are of
the colours in 8 bits, without alpha.

The numbers of OpenEXR files and of NumPy arrays (.npy) are compared in their own unit, channel by
channel, without FLIP. Equal infinities and NaN do not differ.

Pictures of two folders are compared if they have the same path within the folders. Pictures that
only one folder has are listed as missing (from the second folder) or extra. Other files are
ignored.

All limits that are given hold at the same time, and --max 0 is one of them: to limit only FLIP or
the root of the mean square error, add --max 255, or --max inf for numbers.

Examples:
  marraztu compare a.png b.png                  equal pixels
  marraztu compare a.png b.png --max 2          no channel differs by more than 2 steps
  marraztu compare a.png b.png --max 2 --pixels 0.1%
  marraztu compare a.png b.png --max 255 --flip 0.05
  marraztu compare a.png b.png --out diff.png   write the difference, times 16
  marraztu compare a.png b.png --html page.html
  marraztu compare a-depth.npy b-depth.npy --max 1e-4 --mask object.png
  marraztu compare golden new --junit report.xml --out differences

Exit status: 0 if all differences are within the limits, 1 if one is not or a picture is missing or
extra, 2 if pictures cannot be compared.")]
pub(crate) struct Compare {
    /// The first picture, or folder of pictures
    a: PathBuf,
    /// The second picture, or folder of pictures
    b: PathBuf,
    /// The largest difference of a channel that counts as the same: in steps, or in the unit of the
    /// numbers
    #[arg(long, value_name = "DIFFERENCE", default_value_t = 0.0, value_parser = largest)]
    max: f64,
    /// The largest share of pixels that may differ by more than --max: 0.001 or 0.1%
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pixels: Option<f64>,
    /// The largest root of the mean square error that counts as the same, in the unit of --max
    #[arg(long, value_name = "LIMIT", value_parser = largest)]
    rmse: Option<f64>,
    /// The largest FLIP that counts as the same, from 0 to 1
    #[arg(long, value_name = "LIMIT", value_parser = flip)]
    flip: Option<f64>,
    /// A picture of the pixels that count: all but black, transparent and 0. For folders also a
    /// folder of masks with the names of the pictures, or with .png instead of their extension
    #[arg(long, value_name = "MASK")]
    mask: Option<PathBuf>,
    /// The picture of differences to write, amplified 16 times; for folders a folder, with a
    /// picture for each pair that differs
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// A page to write, with the measures, a slider between the pictures, and their difference
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Print a JSON object
    #[arg(long)]
    json: bool,
    /// A report to write in the format of JUnit, with a test for each pair
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

/// Compares two pictures, or the pictures of two folders.
pub(super) fn compare(arguments: &Compare) -> Result<(), Failure> {
    let Compare { a, b, mask, junit, .. } = arguments;
    let inputs = Inputs { a, b, mask: mask.as_deref() };
    let pairs = inputs.pairs().map_err(|reason| incomparable(&reason))?;
    let are_folders = a.is_dir();
    let files = pairs.iter().flat_map(|pair| pair.files.iter().flatten().chain(&pair.mask));
    let sources = Sources::default().with(files);
    let comparison = Comparison { arguments, sources, are_folders };
    comparison.check_outputs().map_err(|failure| incomparable(&failure))?;
    let results: Vec<Compared> =
        pairs.into_par_iter().map(|pair| comparison.compared(pair)).collect();
    let limits = arguments.limits();
    print(&match (arguments.json, are_folders, &results[..]) {
        (true, ..) => json(&results, &limits),
        (false, true, _) => text(&results, &inputs),
        (false, false, results) => results.iter().map(|one| table(one, &limits)).collect(),
    })?;
    let errors = results.iter().filter_map(|result| match &result.verdict {
        Verdict::Error(reason) => Some(reason),
        _ => None,
    });
    // The text about folders has the errors already.
    errors.filter(|_| arguments.json || !are_folders).for_each(|reason| say("error", reason));
    if let Some(junit) = junit {
        junit::write(junit, &results, &inputs).map_err(|error| incomparable(&error))?;
    }
    match Counts::of(&results) {
        Counts { errors: 1.., .. } => Err(Failure::Status(INCOMPARABLE)),
        Counts { pairs, same, .. } if pairs == same => Ok(()),
        _ => Err(Failure::Told),
    }
}

impl Compare {
    const fn limits(&self) -> Limits {
        let Self { max, pixels, rmse, flip, .. } = *self;
        Limits { max, pixels, rmse, flip }
    }
}

/// Returns whether a path, which may not exist yet, lies in a folder, links resolved.
fn lies_in(path: &Path, folder: &Path) -> bool {
    let resolved = |path: &Path| {
        let path = std::path::absolute(path).ok()?;
        let of =
            |above: &Path| Some(above.canonicalize().ok()?.join(path.strip_prefix(above).ok()?));
        path.ancestors().find_map(of)
    };
    resolved(path).zip(resolved(folder)).is_some_and(|(path, folder)| path.starts_with(folder))
}

/// A comparison of pictures or folders.
struct Comparison<'a> {
    arguments: &'a Compare,
    /// The pictures and masks.
    sources: Sources,
    are_folders: bool,
}

impl Comparison<'_> {
    /// Checks that no output would replace an input or a file of another kind. The pictures of
    /// differences in a folder are checked one by one.
    fn check_outputs(&self) -> Result<(), Failure> {
        let Compare { out, html, junit, .. } = self.arguments;
        if let Some(out) = out.as_ref().filter(|_| !self.are_folders) {
            self.check_picture(out)?;
        }
        let Compare { a, b, .. } = self.arguments;
        if self.are_folders && out.as_ref().is_some_and(|out| lies_in(out, a) || lies_in(out, b)) {
            let reason = "--out lies in a folder that is compared: its pictures would be compared \
                          next time";
            return Err(Failure::Absent(reason.to_owned()));
        }
        match html {
            Some(_) if self.are_folders => {
                let reason = "--html is a page about two pictures; for folders, use --out";
                return Err(Failure::Absent(reason.to_owned()));
            }
            Some(html) => check_page(html, &self.sources)?,
            None => {}
        }
        junit.as_ref().map_or(Ok(()), |junit| junit::check(junit, &self.sources))
    }

    fn check_picture(&self, out: &Path) -> Result<(), SaveError> {
        self.sources.spare(out)?;
        io::check_picture_target(out)
    }

    /// Compares a pair, and writes the picture of its differences.
    fn compared(&self, pair: Pair) -> Compared {
        let [Some(a), Some(b)] = &pair.files else {
            let verdict = if pair.files[0].is_some() { Verdict::Missing } else { Verdict::Extra };
            return Compared { pair, verdict, picture: None };
        };
        let out = match &self.arguments.out {
            Some(folder) if self.are_folders => Some(picture_in(folder, &pair.name)),
            out => out.clone(),
        };
        let measured = self.measured([a, b], pair.mask.as_deref());
        let compared = measured.and_then(|(contents, difference)| {
            let exceeded = self.arguments.limits().exceeded(&difference);
            let is_wanted = !self.are_folders || !exceeded.is_empty();
            let out = out.as_deref().filter(|_| is_wanted);
            let picture = self.write([a, b], &contents, &difference, out)?;
            let verdict = match exceeded.is_empty() {
                true => Verdict::Same(difference),
                false => Verdict::Differs(difference, exceeded),
            };
            Ok((verdict, picture))
        });
        let (verdict, picture) = compared.unwrap_or_else(|reason| (Verdict::Error(reason), None));
        Compared { pair, verdict, picture }
    }

    /// Loads two pictures, and measures their differences.
    fn measured(
        &self,
        files: [&PathBuf; 2],
        mask: Option<&Path>,
    ) -> Result<([PictureContent; 2], Difference), String> {
        let [a, b] = files.map(|file| load(file));
        let contents = [a?, b?];
        let mask = mask.map(|mask| mask_for(mask, files[0], &contents[0])).transpose()?;
        let names = files.map(PathBuf::as_path);
        let [a, b] = &contents;
        let difference = measure(names, [a, b], mask.as_deref(), self.arguments.max)?;
        if self.arguments.flip.is_some() && difference.flip.is_none() {
            return Err(format!("--flip: {} has numbers, not colours", files[0].display()));
        }
        Ok((contents, difference))
    }

    /// Writes the picture of differences and the page. Returns the name of the picture. Numbers
    /// have no picture: for folders it is left out, otherwise this is an error.
    fn write(
        &self,
        files: [&PathBuf; 2],
        contents: &[PictureContent; 2],
        difference: &Difference,
        out: Option<&Path>,
    ) -> Result<Option<String>, String> {
        let html = self.arguments.html.as_deref();
        if out.is_none() && html.is_none() {
            return Ok(None);
        }
        let [Some(first), Some(second)] = [&contents[0], &contents[1]].map(colors) else {
            let file = files[0].display();
            let reason = format!("{file} has numbers, and --out and --html show colours");
            return if self.are_folders { Ok(None) } else { Err(reason) };
        };
        let amplified = amplified(first, second, AMPLIFIED);
        if let Some(out) = out {
            if let Some(folder) = out.parent().filter(|_| self.are_folders) {
                std::fs::create_dir_all(folder)
                    .map_err(|error| format!("{}: {error}", folder.display()))?;
            }
            self.check_picture(out).map_err(|error| error.to_string())?;
            io::save_picture(out, &amplified).map_err(|error| error.to_string())?;
        }
        if let Some(html) = html {
            let rows = difference.rows(&self.arguments.limits());
            let page = page(files, [first, second], &amplified, &rows)?;
            write_page(html, &page).map_err(|error| error.to_string())?;
        }
        Ok(out.map(shown))
    }
}

/// Returns the file of the picture of differences of a pair in a folder.
fn picture_in(folder: &Path, name: &str) -> PathBuf {
    let is_png = PictureFormat::of(Path::new(name)).is_ok_and(|format| format.name == "PNG");
    folder.join(if is_png { name.to_owned() } else { format!("{name}.png") })
}

/// Loads the mask for a picture. Fails if it cannot be read, has another size, or selects nothing.
fn mask_for(mask: &Path, picture: &Path, content: &PictureContent) -> Result<Vec<bool>, String> {
    let loaded = load(mask)?;
    let [own, other] =
        [&loaded, content].map(|it| format!("{}x{}", it.size().width, it.size().height));
    if own != other {
        let (mask, picture) = (mask.display(), picture.display());
        return Err(format!("the mask {mask} has {own} pixels, but {picture} has {other}"));
    }
    let selected = selected(&loaded);
    match selected.contains(&true) {
        true => Ok(selected),
        false => Err(format!("the mask {} selects no pixel", mask.display())),
    }
}

/// Formats the measures of two pictures.
fn table(result: &Compared, limits: &Limits) -> String {
    let rows = match &result.verdict {
        Verdict::Same(difference) | Verdict::Differs(difference, _) => difference.rows(limits),
        Verdict::Missing | Verdict::Extra | Verdict::Error(_) => Vec::new(),
    };
    rows.iter().map(|[name, value]| format!("{name:<20}{value}\n")).collect()
}

/// Makes a page about two pictures.
fn page(
    files: [&PathBuf; 2],
    [a, b]: [&Picture; 2],
    amplified: &Picture,
    rows: &[[String; 2]],
) -> Result<String, String> {
    let size = format!("{} x {}", a.size().width, a.size().height);
    let part = |name: &str, picture: &Picture| -> Result<PagePicture, String> {
        let png = PICTURE_FORMATS[0].encode(picture)?;
        Ok(PagePicture { name: name.to_owned(), figures: size.clone(), png })
    };
    let names = files.map(|file| file.display().to_string());
    let pictures = [part(&names[0], a)?, part(&names[1], b)?];
    let amplified = part(&format!("Difference, times {AMPLIFIED}"), amplified)?;
    let title = format!("{} and {}", names[0], names[1]);
    Ok(plots::compare_page(&title, rows, &pictures, &amplified))
}

fn load(path: &Path) -> Result<PictureContent, String> {
    io::load_content(path).map_err(|error| error.to_string())
}

fn incomparable(reason: &dyn std::fmt::Display) -> Failure {
    say("error", reason);
    Failure::Status(INCOMPARABLE)
}

fn largest(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|limit| *limit >= 0.0);
    limit.ok_or_else(|| "write a number from 0, or inf".to_owned())
}

fn share(text: &str) -> Result<f64, String> {
    let (text, unit) = text.strip_suffix('%').map_or((text, 1.0), |text| (text, 100.0));
    let share = text.trim().parse().ok().map(|share: f64| share / unit);
    let share = share.filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "write a share from 0 to 1, or from 0% to 100%".to_owned())
}

fn flip(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|limit| (0.0..=1.0).contains(limit));
    limit.ok_or_else(|| "write a number from 0 to 1".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_or_rejected() {
        assert_eq!((share("0.1%"), share("1"), share("100 %")), (Ok(0.001), Ok(1.0), Ok(1.0)));
        assert!(["1.1", "-0.1", "101%", "", "NaN", "%"].iter().all(|wrong| share(wrong).is_err()));
        assert_eq!((largest("1e-4"), largest("inf")), (Ok(1e-4), Ok(f64::INFINITY)));
        assert!(["-1", "NaN", "two"].iter().all(|wrong| largest(wrong).is_err()));
    }

    #[test]
    fn pictures_of_differences_have_names_of_their_own() {
        let folder = Path::new("d");
        assert_eq!(picture_in(folder, "x/a.png"), Path::new("d/x/a.png"));
        assert_eq!(picture_in(folder, "x/a.webp"), Path::new("d/x/a.webp.png"));
    }
}
