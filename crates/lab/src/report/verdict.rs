//! Summarises the figures of a sweep in sentences, by rules.
//!
//! Each choice is compared with the default of its axis: its time by the verdict on their ratio
//! ([`Findings::noise_of`](crate::sweep::Findings::noise_of) defines the noise), its error by the
//! RMSE over all pixels. The verdict on a scene quotes errors against the ideal, as the overview
//! and the dial do; the verdict on an axis quotes errors against the reference of the axis, as its
//! plot does. An error counts as cut or raised if it changes by 5%. The rules cover every choice
//! that differs in time or error beyond the noise, so none is omitted.

use super::Report;
use crate::sweep::{Against, Findings, Measured, Row, TOO_BUSY, Verdict};
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Choice, uncapitalized};

/// Changes of the error below this fraction are ignored.
const MARGIN: f64 = 0.05;

/// The most choices that a list names.
const LISTED: usize = 3;

/// A choice worth mentioning.
struct Said<'a> {
    axis: &'static Axis,
    row: &'a Row,
    point: &'a Measured,
    /// The error of the choice, and the default's.
    error: f64,
    before: f64,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Slower, and reduces the error.
    Buys,
    /// Slower and finer, but without a gain.
    NotWorth,
    /// Slower, coarser, and no more exact.
    Wasted,
    /// Faster, and raises the error.
    Saves,
    /// Faster without more error, or finer and more exact at no cost.
    Free,
    /// No faster, but less exact.
    Worse,
    /// Lacks surfaces, whatever its time.
    Lacks,
}

impl Report {
    /// Summarises the figures in sentences.
    pub fn verdict(&self) -> Vec<String> {
        let has_ideal = self.findings.points.first().is_some_and(|it| it.ideal.is_some());
        let against = if has_ideal { Against::Ideal } else { Against::Axis };
        let said = said(self, against);
        let mut sentences = told(&said);
        let is_faster =
            |it: &Said<'_>| it.point.verdict == Verdict::Faster && it.kind != Kind::Lacks;
        let nothing = if said.iter().any(is_faster) { "nothing else" } else { "nothing" };
        let noise = noise(self, self.findings.rows.iter().map(|row| row.point));
        sentences.push(match (self.findings.complete, noise) {
            (true, Some(noise)) => format!("{nothing} saves more than the noise ({noise})."),
            (true, None) => "this machine is too busy to tell times.".to_owned(),
            (false, _) => "other choices are not measured yet.".to_owned(),
        });
        sentences.extend(busy(self));
        if let Some(first) = sentences.first_mut() {
            let errors = match against {
                Against::Ideal => "errors against the ideal",
                Against::Axis => "errors against the picture that is exact in it",
            };
            *first = format!("{}, each choice alone, {errors}: {first}", place(self));
        }
        // The first sentence continues after a colon.
        sentences.iter_mut().skip(1).for_each(|sentence| *sentence = capitalized(sentence));
        sentences
    }

    /// Summarises the figures on one axis in a paragraph.
    pub fn verdict_on(&self, axis: &Axis) -> String {
        if axis.kind == AxisKind::Model {
            return "A model: none of its choices is an error of another.".to_owned();
        }
        let said: Vec<Said<'_>> =
            said(self, Against::Axis).into_iter().filter(|it| it.axis.key == axis.key).collect();
        let noise = noise(self, self.findings.rows_of(axis).map(|row| row.point));
        let mut sentences = told(&said);
        if sentences.is_empty() {
            sentences.push("No choice differs from the default beyond the noise here.".to_owned());
        }
        sentences.extend(reasons(self, axis));
        let capital: Vec<String> = sentences.iter().map(|sentence| capitalized(sentence)).collect();
        let noise = noise.map_or_else(
            || "this machine is too busy to tell times".to_owned(),
            |noise| format!("noise {noise}"),
        );
        let exact = uncapitalized(axis.label);
        format!(
            "{} ({}, errors against the exact {exact}; {noise}.)",
            capital.join(" "),
            place(self)
        )
    }

    /// Describes a choice of an axis in a line: its time and error against the default's. `None` if
    /// the choice was not measured.
    pub fn verdict_on_choice(&self, axis: &Axis, choice: &Choice) -> Option<String> {
        let Findings { points, .. } = &self.findings;
        let rows = || self.findings.rows_of(axis);
        let row =
            rows().find(|row| axis.chosen(&points[row.point].settings).word == choice.word)?;
        let before = rows().find(|row| row.point == 0)?;
        let [error, usual] = [row, before].map(|row| digits(row.error.whole.rmse));
        let name = capitalized(&axis.in_words(choice));
        // A model is measured against the chosen one, which may not be the default.
        let is_model = axis.kind == AxisKind::Model;
        if row.point == 0 {
            // A model tells what its other choice costs.
            let others = rows().filter(|row| is_model && row.point != 0);
            let other = others.map(|row| axis.chosen(&points[row.point].settings)).next();
            if let Some(said) = other.and_then(|other| self.verdict_on_choice(axis, other)) {
                return Some(said);
            }
            return Some(match is_model {
                true => format!("{name}: no choice of a model is an error of another."),
                // The picture at rest has more samples.
                false if axis.key == "samples" => {
                    format!("{name}, the default while something moves: error {error} of 255.")
                }
                false => format!("{name}, the default: error {error} of 255."),
            });
        }
        let point = &points[row.point];
        if row.error.is_incomplete() {
            let part = digits(row.error.lost * 100.0);
            return Some(format!(
                "{name}: {part}% of the surfaces are lost, error {error} of 255."
            ));
        }
        let default = axis.in_words(axis.chosen(&points[0].settings));
        let noise = percent(self.findings.noises([row.point].into_iter()));
        let time = match point.verdict {
            Verdict::Alike => format!("the same time as {default} (noise {noise})"),
            Verdict::Busy => format!("the machine is too busy to compare its time with {default}"),
            Verdict::Faster | Verdict::Slower => {
                let ratio = times(point.ratio.quartiles.median);
                format!("{ratio} the time of {default} (noise {noise})")
            }
        };
        Some(match is_model {
            // One of both is the reference.
            true => {
                let error = digits(row.error.whole.rmse.max(before.error.whole.rmse));
                format!("{name}: {time}; the pictures differ by {error} of 255.")
            }
            false => format!("{name}: {time}; error {error} of 255 instead of {usual}."),
        })
    }
}

/// Explains why choices take longer than more exact ones, if this happens here.
fn reasons(report: &Report, axis: &Axis) -> Vec<String> {
    // Choices in the order of the table, from coarse to exact.
    let rows = report.findings.rows_of(axis);
    let mut measured: Vec<(usize, [f64; 2])> = rows
        .filter_map(|row| {
            let point = &report.findings.points[row.point];
            let word = axis.chosen(&point.settings).word;
            let place = axis.choices.iter().position(|choice| choice.word == word)?;
            Some((place, report.findings.noise_of(row.point)))
        })
        .collect();
    measured.sort_by_key(|(place, _)| *place);
    // Slower than a later, more exact choice, beyond the noise of both.
    let is_slower = |i: usize| {
        let mut others = measured[i + 1..].iter();
        others.any(|(_, other)| Verdict::between(measured[i].1, *other) == Verdict::Slower)
    };
    let reason = |i: usize| {
        let choice = &axis.choices[measured[i].0];
        let because = choice.slower_because.filter(|_| is_slower(i))?;
        Some(format!("{} takes longer than a more exact choice: {because}.", axis.in_words(choice)))
    };
    (0..measured.len()).filter_map(reason).collect()
}

/// Names the measured picture: its size, its samples and its scene.
fn place(report: &Report) -> String {
    let Findings { size: [width, height], points, .. } = &report.findings;
    let samples = match points.first().map_or(1, |default| default.settings.samples.count()) {
        1 => "1 sample".to_owned(),
        count => format!("{count} samples"),
    };
    format!("At {width}x{height}, {samples} per pixel, on {}", report.scene)
}

/// Counts the choices with times that cannot be told; `None` if there are none.
fn busy(report: &Report) -> Option<String> {
    let is_busy = |row: &&Row| report.findings.points[row.point].verdict == Verdict::Busy;
    Some(match report.findings.rows.iter().filter(is_busy).count() {
        0 => return None,
        1 => "for 1 choice, this machine is too busy to tell.".to_owned(),
        count => format!("for {count} choices, this machine is too busy to tell."),
    })
}

/// Formats the noise of the points with times that can be told, in per cent. `None` if there are
/// none.
fn noise(report: &Report, points: impl Iterator<Item = usize>) -> Option<String> {
    let is_told = |point: &usize| report.findings.points[*point].verdict == Verdict::Alike;
    let noises = report.findings.noises(points.filter(is_told));
    (noises[1] <= TOO_BUSY).then(|| percent(noises))
}

/// Formats noises in per cent: "1.2%", or "1.2 to 4.5%" if they differ.
fn percent(noises: [f64; 2]) -> String {
    let [least, most] = noises.map(|it| digits((it * 100.0).max(0.1)));
    if least == most { format!("{most}%") } else { format!("{least} to {most}%") }
}

/// Writes the sentences on some choices.
fn told(said: &[Said<'_>]) -> Vec<String> {
    let of = |kind: Kind| -> Vec<&Said<'_>> { said.iter().filter(|it| it.kind == kind).collect() };
    let mut sentences = Vec::new();
    sentences.extend(bought(&of(Kind::Buys)));
    sentences.extend(of(Kind::NotWorth).into_iter().map(not_worth));
    sentences.extend(of(Kind::Free).into_iter().map(free));
    let saves = of(Kind::Saves);
    sentences.extend(saves.iter().map(|it| saved(it)));
    let wasted: Vec<String> = sorted(of(Kind::Wasted), |it| it.ratio())
        .map(|it| format!("{} ({})", it.name(), times(it.ratio())))
        .collect();
    sentences.extend(listed("slower and no more exact here", &wasted));
    let worse: Vec<String> = sorted(of(Kind::Worse), |it| it.error)
        .map(|it| format!("{} ({})", it.name(), digits(it.error)))
        .collect();
    sentences.extend(listed("less exact and no faster here, with the error in brackets", &worse));
    sentences.extend(of(Kind::Lacks).into_iter().map(lacking));
    sentences
}

/// Returns every choice that differs from the default of its axis in time or error.
fn said(report: &Report, against: Against) -> Vec<Said<'_>> {
    let mut said = Vec::new();
    for axis in AXES.iter().filter(|axis| axis.kind != AxisKind::Model) {
        let finer = |word: &str| axis.choices.iter().position(|choice| choice.word == word);
        let default = finer(axis.default_choice().word);
        for row in report.findings.rows_of(axis).filter(|row| row.point != 0) {
            let point = &report.findings.points[row.point];
            // The default of an axis is one of its rows.
            let default_row = report.findings.rows_of(axis).find(|row| row.point == 0);
            let rmse = |row: &Row| match (against, report.findings.points[row.point].ideal) {
                (Against::Ideal, Some(error)) => error.whole.rmse,
                (Against::Ideal, None) | (Against::Axis, _) => row.error.whole.rmse,
            };
            let (error, before) = (rmse(row), default_row.map_or(0.0, rmse));
            let is_finer = finer(axis.chosen(&point.settings).word) > default;
            let kind = match row.error.is_incomplete() {
                true => Some(Kind::Lacks),
                false => kind(point, [error, before], is_finer),
            };
            let Some(kind) = kind else { continue };
            said.push(Said { axis, row, point, error, before, kind });
        }
    }
    said
}

fn kind(point: &Measured, [error, before]: [f64; 2], is_finer: bool) -> Option<Kind> {
    let cut = error < before * (1.0 - MARGIN);
    let raised = error > before * (1.0 + MARGIN);
    // A single byte step is invisible.
    let seen = point.change.largest > 1;
    Some(match (point.verdict, cut, raised) {
        (Verdict::Slower, true, _) if seen => Kind::Buys,
        (Verdict::Slower, _, false) if is_finer => Kind::NotWorth,
        (Verdict::Slower, ..) => Kind::Wasted,
        (Verdict::Faster, _, true) => Kind::Saves,
        (Verdict::Faster, ..) => Kind::Free,
        // If a coarser choice is closer to the reference, then only in a few pixels.
        (Verdict::Busy, ..) => return None,
        (Verdict::Alike, true, _) if seen && is_finer => Kind::Free,
        (Verdict::Alike, _, true) => Kind::Worse,
        (Verdict::Alike, ..) => return None,
    })
}

impl Said<'_> {
    fn name(&self) -> String {
        self.axis.in_words(self.axis.chosen(&self.point.settings))
    }

    fn ratio(&self) -> f64 {
        self.point.ratio.quartiles.median
    }

    /// Adds an s to a verb for a singular name: "cost" or "costs".
    fn verb(&self, verb: &str) -> String {
        let name = self.name();
        let several = name.starts_with(|c: char| c.is_ascii_digit()) && !name.starts_with("1 ");
        let several = several || ["vertices", "normals"].iter().any(|word| name.starts_with(word));
        if several { verb.to_owned() } else { format!("{verb}s") }
    }

    /// Describes the effect on the error: "cuts the error from 2 to 1 of 255", if `verb` is "cut".
    fn effect(&self, verb: &str) -> String {
        let [before, after] = [self.before, self.error].map(digits);
        match before == after {
            true => format!("hardly {} the error of {after}", self.verb("change")),
            false => format!("{} the error from {before} to {after} of 255", self.verb(verb)),
        }
    }
}

/// Writes about finer choices that are worth their time. The first of each axis gets a sentence,
/// the others follow in brackets.
fn bought(all: &[&Said<'_>]) -> Vec<String> {
    let mut sentences = Vec::new();
    for axis in AXES {
        let mut own = all.iter().filter(|it| it.axis.key == axis.key);
        let Some(first) = own.next() else { continue };
        let (cost, cut) = (first.verb("cost"), first.effect("cut"));
        let mut text = format!("{} {cost} {} and {cut}", first.name(), times(first.ratio()));
        let more = |it: &&Said<'_>| {
            format!("{}: {}, {}", it.row.name, times(it.ratio()), digits(it.error))
        };
        // Finer choices of the same axis follow in brackets.
        let others: Vec<String> = own.map(more).collect();
        if !others.is_empty() {
            text += &format!(" ({})", others.join("; "));
        }
        sentences.push(text + ".");
    }
    // Samples per pixel change the picture most, so they come first.
    sentences.sort_by_key(|text| !text.contains("samples"));
    sentences
}

fn not_worth(it: &Said<'_>) -> String {
    let (name, cost, change) = (it.name(), it.verb("cost"), &it.point.change);
    let changes = match change.largest {
        0 => format!("{} no byte", it.verb("change")),
        largest => {
            let by =
                if largest == 1 { "one step".to_owned() } else { format!("up to {largest} steps") };
            let part = digits(change.differing * 100.0);
            format!("{} {part}% of the bytes by {by}", it.verb("change"))
        }
    };
    format!("{name} {cost} {} and {changes}: not worth it here.", times(it.ratio()))
}

fn free(it: &Said<'_>) -> String {
    let name = it.name();
    match it.point.verdict {
        Verdict::Faster => {
            let saves = it.verb("save");
            let effect = match it.point.change.largest {
                0 => format!("{} no byte", it.verb("change")),
                _ if it.error < it.before => it.effect("cut"),
                _ => it.effect("raise"),
            };
            format!("{name} {saves} {}% and {effect}.", less(it))
        }
        Verdict::Slower | Verdict::Alike | Verdict::Busy => {
            format!("{name} {} in the same time.", it.effect("cut"))
        }
    }
}

fn saved(it: &Said<'_>) -> String {
    format!("{} {} {}% and {}.", it.name(), it.verb("save"), less(it), it.effect("raise"))
}

/// Writes about a choice that leaves out surfaces, with a time that says nothing.
fn lacking(it: &Said<'_>) -> String {
    let (loses, part) = (it.verb("lose"), digits(it.row.error.lost * 100.0));
    format!("{} {loses} {part}% of the surfaces here: no time is saved by that.", it.name())
}

/// Returns the saved part of the time, in per cent.
fn less(it: &Said<'_>) -> String {
    digits((1.0 - it.ratio()) * 100.0)
}

fn sorted<'a, 'b>(
    mut all: Vec<&'a Said<'b>>,
    by: fn(&Said<'b>) -> f64,
) -> impl Iterator<Item = &'a Said<'b>> {
    all.sort_by(|a, b| by(b).total_cmp(&by(a)));
    all.into_iter()
}

/// Lists choices: "Slower and no more exact here: this, that and 4 others."
fn listed(what: &str, all: &[String]) -> Option<String> {
    let (named, others) = all.split_at(all.len().min(LISTED));
    let more = match others.len() {
        0 => String::new(),
        1 => " and one other".to_owned(),
        count => format!(" and {count} others"),
    };
    (!all.is_empty()).then(|| format!("{what}: {}{more}.", named.join(", ")))
}

/// Formats a ratio as "2.1x".
fn times(ratio: f64) -> String {
    match ratio {
        10.0.. => format!("{ratio:.0}x"),
        1.2.. => format!("{ratio:.1}x"),
        _ => format!("{ratio:.2}x"),
    }
}

/// Formats a number with two significant digits.
fn digits(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let decimals = 1.0 - libm::floor(libm::log10(number.abs()));
    let decimals = if decimals > 0.0 { decimals.min(9.0) } else { 0.0 };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 9")]
    let text = format!("{number:.*}", decimals as usize);
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns a text that begins with a capital letter.
pub fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_two_digits() {
        let all = [(2.345, "2.3"), (0.0042, "0.0042"), (12.6, "13"), (6.0, "6"), (0.0, "0")];
        for (number, text) in all {
            assert_eq!(digits(number), text);
        }
        assert_eq!([1.04, 2.13, 16.4].map(times), ["1.04x", "2.1x", "16x"]);
    }

    #[test]
    fn a_long_list_names_three_and_counts_the_rest() {
        let names = ["a", "b", "c", "d", "e"].map(str::to_owned);
        assert_eq!(listed("Slow", &names[..2]).unwrap(), "Slow: a, b.");
        assert_eq!(listed("Slow", &names).unwrap(), "Slow: a, b, c and 2 others.");
        assert_eq!(listed("Slow", &[]), None);
    }
}
