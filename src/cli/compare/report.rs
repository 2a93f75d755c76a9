//! Reports on a comparison: text, and JSON with the form that `docs/json.md` describes.

use std::path::Path;

use marraztu_io::short_number;
use serde::Serialize;

use super::measure::{Difference, Limits};
use super::pairs::{Inputs, Pair};
use crate::cli::batch::report::shown;
use crate::cli::talk;

/// The result of a pair.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Compared {
    pub(super) pair: Pair,
    pub(super) verdict: Verdict,
    /// The picture of the differences, if one was written.
    pub(super) picture: Option<String>,
}

/// The verdict on a pair.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// The differences are within the limits.
    Same(Difference),
    /// The differences exceed the limits of these options.
    Differs(Difference, Vec<&'static str>),
    /// The picture is in the first folder alone.
    Missing,
    /// The picture is in the second folder alone.
    Extra,
    /// The pictures cannot be compared, for this reason.
    Error(String),
}

/// The verdict as a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Word {
    Same,
    Differs,
    Missing,
    Extra,
    Error,
}

impl Word {
    const fn text(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Differs => "differs",
            Self::Missing => "missing",
            Self::Extra => "extra",
            Self::Error => "error",
        }
    }
}

impl Verdict {
    pub(super) const fn word(&self) -> Word {
        match self {
            Self::Same(_) => Word::Same,
            Self::Differs(..) => Word::Differs,
            Self::Missing => Word::Missing,
            Self::Extra => Word::Extra,
            Self::Error(_) => Word::Error,
        }
    }

    const fn difference(&self) -> Option<&Difference> {
        match self {
            Self::Same(difference) | Self::Differs(difference, _) => Some(difference),
            Self::Missing | Self::Extra | Self::Error(_) => None,
        }
    }

    /// Describes the verdict in a sentence, without the name of the pair.
    pub(super) fn sentence(&self, inputs: &Inputs<'_>) -> String {
        match self {
            Self::Same(difference) => measures(difference),
            Self::Differs(difference, exceeded) => {
                let options: Vec<String> =
                    exceeded.iter().map(|name| format!("--{name}")).collect();
                format!("{} (beyond {})", measures(difference), options.join(", "))
            }
            Self::Missing => format!("not in {}", inputs.b.display()),
            Self::Extra => format!("not in {}", inputs.a.display()),
            Self::Error(reason) => reason.clone(),
        }
    }
}

fn measures(difference: &Difference) -> String {
    let Difference { largest, differing, pixels, rmse, flip, .. } = difference;
    let [largest, rmse] = [*largest, *rmse].map(short_number);
    let flip = flip.map_or_else(String::new, |flip| format!(", FLIP {flip:.4}"));
    format!("{differing} of {pixels} pixels differ by up to {largest}, RMSE {rmse}{flip}")
}

/// The numbers of pairs by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Counts {
    pub(super) pairs: usize,
    pub(super) same: usize,
    pub(super) differs: usize,
    pub(super) missing: usize,
    pub(super) extra: usize,
    pub(super) errors: usize,
}

impl Counts {
    pub(super) fn of(results: &[Compared]) -> Self {
        let mut counts = Self { pairs: results.len(), ..Self::default() };
        for result in results {
            *match result.verdict.word() {
                Word::Same => &mut counts.same,
                Word::Differs => &mut counts.differs,
                Word::Missing => &mut counts.missing,
                Word::Extra => &mut counts.extra,
                Word::Error => &mut counts.errors,
            } += 1;
        }
        counts
    }
}

/// Lists the pairs of two folders that are not the same, and the numbers of pairs.
pub(super) fn text(results: &[Compared], inputs: &Inputs<'_>) -> String {
    let mut text = String::new();
    for Compared { pair, verdict, .. } in results {
        let word = verdict.word();
        if word != Word::Same {
            text += &format!("{:<9}{}: {}\n", word.text(), pair.name, verdict.sentence(inputs));
        }
    }
    let Counts { same, differs, missing, extra, errors, .. } = Counts::of(results);
    text + &format!(
        "{same} same, {differs} different, {missing} missing, {extra} extra, {errors} not \
         comparable\n"
    )
}

/// A comparison as JSON.
#[derive(Serialize)]
struct Report<'a> {
    same: bool,
    limits: &'a Limits,
    summary: Counts,
    pairs: Vec<PairReport<'a>>,
}

/// A pair as JSON. Infinite differences are null.
#[derive(Serialize)]
struct PairReport<'a> {
    name: &'a str,
    a: Option<String>,
    b: Option<String>,
    mask: Option<String>,
    status: Word,
    exceeded: &'a [&'static str],
    measures: Option<&'a Difference>,
    picture: Option<&'a str>,
    error: Option<&'a str>,
}

impl<'a> PairReport<'a> {
    fn of(result: &'a Compared) -> Self {
        let Compared { pair, verdict, picture } = result;
        let file = |i: usize| pair.files[i].as_deref().map(shown);
        let (exceeded, error) = match verdict {
            Verdict::Differs(_, exceeded) => (exceeded.as_slice(), None),
            Verdict::Error(reason) => (&[][..], Some(reason.as_str())),
            Verdict::Same(_) | Verdict::Missing | Verdict::Extra => (&[][..], None),
        };
        Self {
            name: &pair.name,
            a: file(0),
            b: file(1),
            mask: pair.mask.as_deref().map(|mask: &Path| shown(mask)),
            status: verdict.word(),
            exceeded,
            measures: verdict.difference(),
            picture: picture.as_deref(),
            error,
        }
    }
}

/// Formats a comparison as a JSON object.
pub(super) fn json(results: &[Compared], limits: &Limits) -> String {
    let summary = Counts::of(results);
    let report = Report {
        same: summary.same == summary.pairs,
        limits,
        summary,
        pairs: results.iter().map(PairReport::of).collect(),
    };
    talk::json(&report)
}
