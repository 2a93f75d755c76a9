//! `marraztu lab`: measures the cost of accuracy.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use marraztu::plots::{self, FrontPicture, Look, PagePicture};
use marraztu_core::accuracy::{AXES, AccuracyPreset, Axis, Settings};
use marraztu_core::base::image::Size;
use marraztu_io::{self as io, PictureFormat};
use marraztu_lab::attribution::attribute;
use marraztu_lab::candidates::{Thoroughness, all_axes};
use marraztu_lab::error::{Measure, Region, amplified};
use marraztu_lab::pairs::Watch;
use marraztu_lab::picture_source::{PictureSource, Studio};
use marraztu_lab::report::{self, Budgets, Report};
use marraztu_lab::suite::{self, SUITE, SuiteDetail, SuiteScene};
use marraztu_lab::sweep::{Question, sweep};
use marraztu_lab::timing::WallClock;

use super::accuracy::Accuracy;
use super::arguments::SceneArguments;
use super::bar::Bar;
use super::failure::Failure;
use super::page::{self, check_page};
use super::render::staged;
use super::talk::{Talk, print};
use super::values::{Pixel, pixel, size, threads};

/// What to measure, and what to report.
#[derive(Debug, Args)]
#[command(after_help = "\
Measures each choice of each axis alternately with the default, and compares its picture with the
most exact one. Writes table.txt, table.csv, report.json, the plots (light and dark), the exact
picture, and the error of the chosen settings, amplified 1, 16 and 256 times, into the folder of
--out.

Examples:
  marraztu lab --quick
  marraztu lab bunny.obj --out bunny-lab --size 1920x1080
  marraztu lab shelf.marraztu --axes shading,filter --max-error 1
  marraztu lab --suite --out suite
  marraztu lab --shading vertex --pixel 215,430")]
pub(crate) struct Lab {
    /// Models (.obj, .stl, also .gz), and at most one scene (.marraztu) to add them to
    pub(crate) files: Vec<PathBuf>,

    /// The folder for tables, plots and pictures; created if it does not exist
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Also write one self-contained page: the verdict, a line from quick to exact that one drags,
    /// a slider between pictures, the plots, the table, the machine and the command
    #[arg(long, value_name = "FILE", conflicts_with_all = ["suite", "pixel"])]
    html: Option<PathBuf>,
    /// Width and height in pixels; one number for a square [default: 800x800; suite: 1280x720]
    #[arg(long, value_name = "WxH", allow_negative_numbers = true, value_parser = size)]
    size: Option<Size>,
    /// The scene of the suite to measure, or all of them.
    #[arg(long, value_name = "SCENE", num_args = 0..=1, require_equals = true, help = suite_help())]
    #[arg(default_missing_value = "all", value_parser = suite_words(), hide_possible_values = true)]
    #[arg(conflicts_with_all = ["files", "quick", "axes", "max_error", "budget_ms", "pixel"])]
    #[arg(conflicts_with_all = ["measure", "inside", "Reading", "Surfaces", "Seeing", "Accuracy"])]
    suite: Option<String>,
    /// The axes to measure [default: all]
    #[arg(long, value_name = "AXIS,...", value_delimiter = ',', value_parser = axis_words())]
    axes: Vec<String>,
    /// Measure fewer pairs of pictures: about 20 seconds for the first scene
    #[arg(long)]
    quick: bool,
    /// The error metric of budgets and plot: rmse*, largest, differing, flip
    #[arg(long, value_name = "MEASURE", default_value = "rmse", hide_default_value = true)]
    #[arg(hide_possible_values = true, value_parser = measure_words())]
    measure: String,
    /// Measure errors only over pixels with equal coverage
    #[arg(long)]
    inside: bool,
    /// Report the fastest choice with at most this error
    #[arg(long, value_name = "ERROR", value_parser = above_zero)]
    max_error: Option<f64>,
    /// Report the most exact choice within this time
    #[arg(long, value_name = "MILLISECONDS", value_parser = above_zero)]
    budget_ms: Option<f64>,
    /// Only attribute the error of one pixel to an axis
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    #[arg(conflicts_with_all = ["quick", "axes", "max_error", "budget_ms", "out"])]
    pixel: Option<Pixel>,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(super) threads: Option<usize>,
    #[command(flatten)]
    talk: Talk,

    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    accuracy: Accuracy,
}

/// Runs the measurement and prints the report.
pub(crate) fn lab(arguments: &Lab) -> Result<(), Failure> {
    arguments.talk.apply();
    if let Some(folder) = &arguments.out {
        io::check_scheme(folder)?;
    }
    if let Some(word) = &arguments.suite {
        return measure_suite(arguments, word);
    }
    let Lab { files, scene, accuracy, size, .. } = arguments;
    let mut stage = staged(files, scene)?;
    stage.settings = accuracy.of(&stage.settings);
    let settings = stage.settings;
    // Check all results before the measurement, which takes minutes.
    if let Some(folder) = &arguments.out {
        let sources = stage.sources(files);
        RESULTS.iter().try_for_each(|name| sources.spare(&folder.join(name)))?;
    }
    if let Some(path) = &arguments.html {
        check_page(path, &stage.sources(files))?;
    }
    let mut studio = Studio::new(stage.shot(size.unwrap_or(Size::new(800, 800))));
    if let Some(Pixel(at)) = arguments.pixel {
        return explain_pixel(&mut studio, &settings, at);
    }
    let report = measured(arguments, &mut studio, settings)?;
    print(&report::text(&report))?;
    if let Some(path) = &arguments.html {
        write_page(path, &report, &mut studio, &settings)?;
    }
    match &arguments.out {
        Some(folder) => save(folder, &report, &mut studio, &settings),
        None => Ok(()),
    }
}

/// Measures the suite, prints the tables, and writes the page into the folder.
fn measure_suite(arguments: &Lab, word: &str) -> Result<(), Failure> {
    let scenes: Vec<&SuiteScene> =
        SUITE.iter().filter(|scene| word == "all" || scene.word == word).collect();
    let tiny = word == "tiny";
    let scenes = if tiny { SUITE.iter().collect() } else { scenes };
    let detail = if tiny { SuiteDetail::TINY } else { SuiteDetail::WHOLE };
    let detail = SuiteDetail { size: arguments.size.unwrap_or(detail.size), ..detail };
    let watch = Watch::default();
    let bar = Bar::of("measuring", &watch.progress);
    let reports = suite::run(&scenes, &detail, &mut WallClock::default(), &watch, &mut |_| {})?;
    drop(bar);
    let texts: Vec<String> = reports.iter().map(report::text).collect();
    print(&texts.join("\n"))?;
    match &arguments.out {
        Some(folder) => save_suite(folder, &reports),
        None => Ok(()),
    }
}

/// Writes the page as Markdown and HTML, its plots, and the tables into the folder.
fn save_suite(folder: &Path, reports: &[Report]) -> Result<(), Failure> {
    let write = |name: &str, text: String| write(folder, name, text);
    for (axis, reports) in plots::sections(reports) {
        for (report, look) in reports.iter().flat_map(|it| [(it, Look::Light), (it, Look::Dark)]) {
            let word = if look == Look::Light { "light" } else { "dark" };
            let plot = plots::panel_svg(report, Some(axis.key), look)?;
            write(&format!("{}-{word}.svg", plots::plot_name(axis, report)), plot)?;
        }
    }
    write("page.md", plots::page_markdown(reports, &|name| format!("{name}-light.svg")))?;
    write("page.html", plots::page_html(reports)?)?;
    write("table.csv", reports.iter().map(report::csv).collect())?;
    let json: Vec<String> = reports.iter().map(Report::json).collect();
    write("report.json", format!("[{}]\n", json.join(",\n")))
}

/// Writes a text into a folder, creating it if it does not exist.
fn write(folder: &Path, name: &str, text: String) -> Result<(), Failure> {
    let fail = |path: &Path| {
        let path = path.to_owned();
        |error| Failure::Write(path, error)
    };
    std::fs::create_dir_all(folder).map_err(fail(folder))?;
    let path = folder.join(name);
    std::fs::write(&path, text).map_err(fail(&path))
}

fn measured(arguments: &Lab, studio: &mut Studio, current: Settings) -> Result<Report, Failure> {
    let named: Vec<&Axis> = arguments.axes.iter().filter_map(|key| Axis::named(key)).collect();
    let axes = if named.is_empty() { all_axes() } else { named };
    let thoroughness = match arguments.quick {
        true => Thoroughness::QUICK,
        false => Thoroughness::WHOLE,
    };
    let question = Question::new(current, axes, thoroughness);
    let watch = Watch::default();
    let bar = Bar::of("measuring", &watch.progress);
    let findings = sweep(studio, &question, &mut WallClock::default(), &watch, &mut |_| {})?;
    drop(bar);
    // clap has checked the word.
    let measure = Measure::ALL.into_iter().find(|measure| measure.word() == arguments.measure);
    Ok(Report {
        scene: scene_name(&arguments.files),
        command: command(),
        measure: measure.unwrap_or_default(),
        region: if arguments.inside { Region::Inside } else { Region::Whole },
        budgets: Budgets { error: arguments.max_error, ms: arguments.budget_ms },
        findings,
    })
}

/// Joins the names of the files: "bunny.obj, pot.obj".
fn scene_name(files: &[PathBuf]) -> String {
    let name = |file: &PathBuf| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match files {
        [] => "the first scene".to_owned(),
        files => files.iter().map(name).collect::<Vec<_>>().join(", "),
    }
}

/// Returns the command line of this process as it would be typed.
fn command() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_./,=:+".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("marraztu".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

fn explain_pixel(studio: &mut Studio, settings: &Settings, at: [usize; 2]) -> Result<(), Failure> {
    let Some(attribution) = attribute(studio, settings, at) else {
        let Size { width, height } = studio.shot().size;
        let [x, y] = at;
        let outside = format!("the picture has {width} x {height} pixels: there is no {x},{y}");
        return Err(Failure::Absent(outside));
    };
    studio.draw(settings);
    let seen = match studio.seen(at) {
        Some(seen) => format!("  shows  {seen}"),
        None => "  shows  the background".to_owned(),
    };
    let mut lines = attribution.lines();
    lines.insert(1, seen);
    print(&(lines.join("\n") + "\n"))
}

/// The files written by a measurement.
const RESULTS: [&str; 11] = [
    "table.txt",
    "table.csv",
    "report.json",
    "plots-light.svg",
    "plots-light.png",
    "plots-dark.svg",
    "plots-dark.png",
    "ideal.png",
    "error-x1.png",
    "error-x16.png",
    "error-x256.png",
];

/// Writes tables, plots and pictures into the folder.
fn save(
    folder: &Path,
    report: &Report,
    studio: &mut Studio,
    settings: &Settings,
) -> Result<(), Failure> {
    let write = |name: &str, text: String| {
        debug_assert!(RESULTS.contains(&name));
        write(folder, name, text)
    };
    let place = |name: &str| {
        debug_assert!(RESULTS.contains(&name));
        folder.join(name)
    };
    write("table.txt", report::text(report))?;
    write("table.csv", report::csv(report))?;
    write("report.json", report.json())?;
    for (look, word) in [(Look::Light, "light"), (Look::Dark, "dark")] {
        write(&format!("plots-{word}.svg"), plots::svg(report, look)?)?;
        io::save_picture(&place(&format!("plots-{word}.png")), &plots::png(report, look)?)?;
    }
    // Error pictures show the difference to the ideal, amplified to be visible.
    studio.draw(&settings.ideal());
    let ideal = studio.picture().clone();
    io::save_picture(&place("ideal.png"), &ideal)?;
    studio.draw(settings);
    for factor in [1, 16, 256] {
        let error = amplified(studio.picture(), &ideal, factor);
        io::save_picture(&place(&format!("error-x{factor}.png")), &error)?;
    }
    Ok(())
}

/// Writes the measurement as one page, with a picture of each preset and of each point of the
/// front.
fn write_page(
    path: &Path,
    report: &Report,
    studio: &mut Studio,
    settings: &Settings,
) -> Result<(), Failure> {
    let png = PictureFormat::of(Path::new("page.png")).map_err(Failure::Absent)?;
    // Each picture is drawn once.
    let mut drawn: Vec<(Settings, Vec<u8>)> = Vec::new();
    let mut encoded = |settings: &Settings| {
        if let Some((_, png)) = drawn.iter().find(|(other, _)| other == settings) {
            return Ok(png.clone());
        }
        studio.draw(settings);
        let png = png.encode(studio.picture()).map_err(Failure::Absent)?;
        drawn.push((*settings, png.clone()));
        Ok::<_, Failure>(png)
    };
    let mut pictures = Vec::new();
    for preset in AccuracyPreset::dial() {
        let settings = preset.of(settings);
        let point = report.findings.points.iter().find(|point| point.settings == settings);
        let figures = point.map_or_else(String::new, |point| {
            let error = point.ideal.map_or(0.0, |error| error.whole.rmse);
            format!("{} ms, error {}", report::brief(point.ms), report::brief(error))
        });
        let png = encoded(&settings)?;
        pictures.push(PagePicture { name: preset.label.to_owned(), figures, png });
    }
    let mut front = Vec::new();
    for point in report.front().into_iter().map(|place| &report.findings.points[place]) {
        let error = point.ideal.map_or(0.0, |error| error.whole.rmse);
        let (name, figures) = (point.settings.in_words(), String::new());
        let picture = PagePicture { name, figures, png: encoded(&point.settings)? };
        front.push(FrontPicture { ms: point.ms, error, picture });
    }
    let findings = &report.findings;
    let machine = format!(
        "Marraztu {} on {} {}, {} threads, {}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        findings.threads,
        findings.instructions
    );
    let text = plots::report_page(report, (&front, &pictures), &machine)?;
    Ok(page::write_page(path, &text)?)
}

fn axis_words() -> PossibleValuesParser {
    PossibleValuesParser::new(AXES.iter().map(|axis| axis.key))
}

/// Returns the help of `--suite`, which lists its scenes.
fn suite_help() -> String {
    let scenes: Vec<&str> = SUITE.iter().map(|scene| scene.word).collect();
    format!(
        "Measure the suite, with a scene for each axis, or one of its scenes: {}; at most 10 \
         minutes at 1280x720",
        scenes.join(", ")
    )
}

fn suite_words() -> PossibleValuesParser {
    let scenes = SUITE.iter().map(|scene| scene.word);
    PossibleValuesParser::new(scenes.chain(["all", "tiny"]))
}

fn measure_words() -> PossibleValuesParser {
    PossibleValuesParser::new(Measure::ALL.map(Measure::word))
}

fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "write a number, 0 or more".to_owned())
}
