//! Counts the instructions of each choice of accuracy on the scenes of the laboratory's suite. A
//! coarser choice takes no more than a more exact one, unless its axis states a reason. Draft never
//! takes more than the default, and much less where shading dominates.
//!
//! Times are noisy, and an approximation that seems slower than the exact method would mislead.
//! callgrind counts the same number in every run. It lacks AVX-512, so frames are drawn with AVX2,
//! on one thread.

use std::fmt::Write as _;
use std::hint::black_box;

use marraztu_core::accuracy::{AXES, AccuracyPreset, Axis, AxisKind, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Scene, View};
use marraztu_lab::candidates::{Group, Thoroughness, candidates};
use marraztu_lab::suite::{SUITE, SuiteScene};
use marraztu_lab::sweep::Question;
use marraztu_render::{FramePlan, Renderer, plan_frame};
use rayon::prelude::*;

use super::instructions::level;

/// The callgrind pattern for the counted function.
const COUNTED: &str = "*counted_choice*";

/// The size of the pictures.
const SIZE: Size = Size::new(640, 360);

/// The share of the scenes' triangles, in thousandths; like the pixels, a quarter of the
/// laboratory's.
const DETAIL: u32 = 250;

/// The tolerance for a coarser choice, relative. Sorting and memory cause differences of this size.
const MARGIN: f64 = 0.01;

/// The scenes in which light, textures, transparent layers or shadows take most of the time, and
/// the least gain of Draft there.
const SHADED: [&str; 6] = ["pixels", "highlights", "textures", "layers", "bumps", "shadows"];
const GAIN: f64 = 1.5;

/// The settings counted on a scene, in order: the default, Draft, then every other choice of the
/// scene's axes.
fn counted(suite: &SuiteScene, scene: &Scene, view: &View) -> Vec<Settings> {
    let default = Settings::default();
    let draft = draft();
    let question = Question::new(default, suite.measured(), Thoroughness::AXIS);
    let mut found = candidates(scene, view, &question).all;
    found.retain(|candidate| matches!(candidate.group, Group::Axis(_)));
    let others = found.into_iter().map(|it| it.settings);
    let others = others.filter(|settings| ![default, draft].contains(settings));
    [default, draft].into_iter().chain(others).collect()
}

fn draft() -> Settings {
    AccuracyPreset::dial()[0].of(&Settings::default())
}

/// Draws a scene twice with one of its settings: a warm-up, then the counted call.
///
/// # Errors
/// If this thread already belongs to a thread pool.
pub(crate) fn draw(suite: &SuiteScene, which: usize) -> Result<(), rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let (scene, view) = suite.open(DETAIL);
    let settings = counted(suite, &scene, &view)[which];
    let plan = plan_frame(&Shot::new(&scene, &view, &settings, SIZE));
    let mut renderer = Renderer::new(level());
    pool.install(|| {
        black_box(renderer.render(&plan));
        counted_choice(&mut renderer, &plan);
    });
    Ok(())
}

/// See [`COUNTED`].
#[inline(never)]
fn counted_choice(renderer: &mut Renderer, plan: &FramePlan) {
    black_box(renderer.render(black_box(plan)));
}

/// Counts all choices on the scenes with names that contain `word`, and returns Markdown tables.
///
/// # Errors
/// The failure, or the choices that take more than a more exact one without a reason.
pub(crate) fn count(word: &str, tell: &mut dyn FnMut(&str)) -> Result<String, String> {
    let (mut tables, mut wrong) = (String::new(), Vec::new());
    for suite in SUITE.iter().filter(|suite| suite.word.contains(word)) {
        let (scene, view) = suite.open(DETAIL);
        let settings = counted(suite, &scene, &view);
        let counts: Result<Vec<u64>, String> =
            (0..settings.len()).into_par_iter().map(|which| callgrind(suite, which)).collect();
        let counts: Vec<(Settings, u64)> = settings.into_iter().zip(counts?).collect();
        let [(_, usual), (_, draft), ..] = &counts[..] else { continue };
        let share = *draft as f64 / *usual as f64;
        tell(&format!(
            "\nDraft takes {share:.3} of the default's instructions on {}.\n",
            suite.word
        ));
        let most = if SHADED.contains(&suite.word) { 1.0 / GAIN } else { 1.0 + MARGIN };
        if share > most {
            let word = suite.word;
            wrong.push(format!("{word}: Draft takes {share:.3} of the default, not {most:.3}"));
        }
        for axis in suite.measured() {
            let own = choices_of(axis, &counts);
            let table = table(suite, axis, &own);
            tell(&table);
            tables += &table;
            wrong.extend(unexplained(suite, axis, &own));
        }
    }
    if wrong.is_empty() { Ok(tables) } else { Err(wrong.join("\n")) }
}

/// The counts of an axis, from the coarsest choice to the most exact one.
fn choices_of(axis: &Axis, counts: &[(Settings, u64)]) -> Vec<(usize, u64)> {
    let default = Settings::default();
    let mut own: Vec<(usize, u64)> = Vec::new();
    for (settings, count) in counts {
        let chosen = axis.chosen(settings);
        let others_are_usual = AXES
            .iter()
            .filter(|other| other.key != axis.key)
            .all(|other| other.chosen(settings).word == other.chosen(&default).word);
        let place = axis.choices.iter().position(|choice| choice.word == chosen.word);
        own.extend(place.filter(|_| others_are_usual).map(|place| (place, *count)));
    }
    own.sort_unstable();
    own
}

/// Lists the choices that take more than a more exact one without stating a reason.
fn unexplained(suite: &SuiteScene, axis: &Axis, own: &[(usize, u64)]) -> Vec<String> {
    if axis.kind == AxisKind::Model {
        return Vec::new();
    }
    let mut wrong = Vec::new();
    for (i, (place, count)) in own.iter().enumerate() {
        let finer = own[i + 1..].iter().min_by_key(|(_, count)| *count);
        let Some((finer, least)) = finer else { continue };
        let (choice, more) = (&axis.choices[*place], *count as f64 / *least as f64 - 1.0);
        if more > MARGIN && choice.slower_because.is_none() {
            wrong.push(format!(
                "{}: {} takes {:.1}% more instructions than {}",
                suite.word,
                axis.in_words(choice),
                more * 100.0,
                axis.in_words(&axis.choices[*finer])
            ));
        }
    }
    wrong
}

/// Formats the counts of an axis on a scene as a Markdown table.
fn table(suite: &SuiteScene, axis: &Axis, own: &[(usize, u64)]) -> String {
    let default = axis.default_choice().word;
    let usual = own.iter().find(|(place, _)| axis.choices[*place].word == default);
    let usual = usual.map_or(f64::NAN, |(_, count)| *count as f64);
    let mut text =
        format!("\n| {} ({}) | instructions | times |\n|---|--:|--:|\n", axis.label, suite.word);
    for (place, count) in own {
        let choice = &axis.choices[*place];
        let name = if choice.word == default {
            format!("{} (default)", choice.label)
        } else {
            choice.label.to_owned()
        };
        let millions = *count as f64 / 1e6;
        let _ = writeln!(text, "| {name} | {millions:.1} M | {:.3} |", *count as f64 / usual);
    }
    text
}

/// Returns the number of instructions of the counted call.
fn callgrind(suite: &SuiteScene, which: usize) -> Result<u64, String> {
    let which = which.to_string();
    let draw = ["--draw-choice", suite.word, "--which", which.as_str()];
    super::instructions::count(COUNTED, &draw)
}
