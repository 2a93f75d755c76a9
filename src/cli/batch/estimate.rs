//! Estimates a batch before it begins: pictures, bytes, time, and the number of shards.
//!
//! A few pictures, spread over the list, are drawn and encoded on one thread, but not written. The
//! time of the batch is that of all pictures at this mean, plus the time to read all models,
//! divided by the number of threads. Writing the files is not included.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use indicatif::DecimalBytes;
use marraztu_render::Renderer;

use super::jobs::Plan;
use super::meter::time_text;
use super::outcome::{Fault, Spent};
use super::studio::Studio;
use crate::cli::talk::note;

/// The number of pictures in the sample.
const SAMPLE: usize = 20;

/// The time after which the sample ends.
const PATIENCE: Duration = Duration::from_secs(10);

/// The longest batch for which one process is recommended, in seconds.
const LONG: f64 = 3600.0;

/// The recommended time of a shard, in seconds.
const SHARD: f64 = 1800.0;

/// A picture of the sample.
#[derive(Debug)]
pub(super) struct Rehearsed {
    /// The bytes of its files; 0 if it is up to date.
    pub(super) bytes: Result<u64, Fault>,
    pub(super) spent: Spent,
    /// Whether all threads draw it, as a large picture.
    pub(super) is_large: bool,
}

/// The estimate of a batch.
#[derive(Debug, Default, PartialEq)]
struct Estimate {
    pictures: usize,
    models: usize,
    /// The number of pictures that were drawn, and of those that cannot be.
    drawn: usize,
    faults: usize,
    /// The first reason why a picture cannot be drawn.
    reason: Option<String>,
    /// All files together.
    bytes: f64,
    seconds: f64,
}

/// Draws a sample, and prints the estimate as notes. `threads` draw the batch; `is_shard` says that
/// it is a shard already.
pub(super) fn print_estimate(studio: &Studio, threads: usize, is_shard: bool) {
    let plan = studio.plan();
    if plan.len() == 0 {
        return note(&"there are no pictures");
    }
    let mut sample = Vec::new();
    let mut models = BTreeSet::new();
    let (mut renderer, begin) = (Renderer::default(), Instant::now());
    for position in positions(plan.len()) {
        let Some(job) = plan.job(position) else { break };
        models.insert(job.row.file.clone());
        sample.push(studio.rehearse(&job, &mut renderer));
        if begin.elapsed() > PATIENCE {
            break;
        }
    }
    let all = (plan.len(), models_of(plan));
    let estimate = Estimate::of(&sample, models.len(), all, threads);
    estimate.sentences(threads, is_shard).iter().for_each(|sentence| note(sentence));
}

/// Returns the positions of the sample: the middles of equal parts.
fn positions(pictures: usize) -> impl Iterator<Item = usize> {
    let count = pictures.min(SAMPLE);
    (0..count).map(move |i| (2 * i + 1) * pictures / (2 * count))
}

/// Returns the number of models.
fn models_of(plan: &Plan) -> usize {
    let ends = std::iter::successors(Some(0), |at| Some(plan.end_of_model(*at)));
    ends.take_while(|at| *at < plan.len()).count()
}

#[expect(clippy::cast_precision_loss, reason = "an estimate")]
impl Estimate {
    /// Extrapolates a sample with this number of models to all pictures and models.
    fn of(
        sample: &[Rehearsed],
        models: usize,
        (all_pictures, all_models): (usize, usize),
        threads: usize,
    ) -> Self {
        let mut estimate = Self { pictures: all_pictures, models: all_models, ..Self::default() };
        let (mut bytes, mut drawing, mut loading) = (0.0, 0.0, 0.0);
        let threads = threads as f64;
        for Rehearsed { bytes: result, spent, is_large } in sample {
            let draw = spent.draw.as_secs_f64();
            loading += spent.load.as_secs_f64() / threads;
            drawing += if *is_large { draw } else { draw / threads };
            drawing += spent.encode.as_secs_f64() / threads;
            match result {
                Ok(size) => {
                    estimate.drawn += 1;
                    bytes += *size as f64;
                }
                Err(fault) => {
                    estimate.faults += 1;
                    estimate.reason.get_or_insert_with(|| fault.reason());
                }
            }
        }
        let per_picture = all_pictures as f64 / sample.len().max(1) as f64;
        estimate.bytes = bytes * per_picture;
        estimate.seconds =
            drawing * per_picture + loading * all_models as f64 / models.max(1) as f64;
        estimate
    }

    /// Describes the estimate, the faults, and the shards.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
    fn sentences(&self, threads: usize, is_shard: bool) -> Vec<String> {
        let Self { pictures, models, drawn, faults, bytes, seconds, .. } = *self;
        let (bytes, time) = (DecimalBytes(bytes as u64), time_text(seconds));
        let [all, of_models, on_threads] =
            [(pictures, "picture"), (models, "model"), (threads, "thread")]
                .map(|(n, name)| if n == 1 { format!("1 {name}") } else { format!("{n} {name}s") });
        let mut sentences = vec![format!(
            "{all} of {of_models}: about {bytes} and {time} on {on_threads}, by a sample of {}",
            drawn + faults
        )];
        if let Some(reason) = &self.reason {
            sentences.push(format!("{faults} of the sample cannot be drawn, such as: {reason}"));
        }
        if is_shard || drawn == 0 {
            return sentences;
        }
        sentences.push(match (seconds / SHARD).ceil() as usize {
            _ if seconds <= LONG => {
                "shards are not needed: one process takes an hour at most".into()
            }
            _ if models == 1 => "one model cannot be divided into shards".to_owned(),
            count => {
                let count = count.min(models);
                let each = time_text(seconds / count as f64);
                format!("use {count} shards of about {each}: --shard 0/{count} and so on")
            }
        });
        sentences
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rehearsed(bytes: Result<u64, Fault>, seconds: [u64; 3], is_large: bool) -> Rehearsed {
        let [load, draw, encode] = seconds.map(Duration::from_secs);
        Rehearsed { bytes, spent: Spent { load, draw, encode }, is_large }
    }

    #[test]
    fn the_sample_is_spread_over_the_list_and_has_each_picture_once() {
        for pictures in [1, 2, 19, 20, 21, 1000, 10_000_000] {
            let positions: Vec<usize> = positions(pictures).collect();
            assert_eq!(positions.len(), pictures.min(SAMPLE));
            assert!(positions.windows(2).all(|two| two[0] < two[1]), "{pictures}");
            let (before, after) = (positions[0], pictures - 1 - positions.last().unwrap());
            assert!(before.abs_diff(after) <= 1, "{pictures}: {before} {after}");
        }
    }

    #[test]
    fn pictures_are_counted_by_picture_and_models_by_model() {
        // One model is read in 6 s; two pictures take 4 + 2 and 2 + 0 s; there are 100 and 10.
        let sample = [rehearsed(Ok(300), [6, 4, 2], false), rehearsed(Ok(100), [0, 2, 0], false)];
        let estimate = Estimate::of(&sample, 1, (100, 10), 2);
        assert_eq!((estimate.drawn, estimate.faults), (2, 0));
        assert_eq!((estimate.bytes, estimate.seconds), (20_000.0, 50.0 * 4.0 + 10.0 * 3.0));
        // All threads draw a large picture, so they do not share the others.
        let large = [rehearsed(Ok(1), [0, 4, 2], true)];
        assert_eq!(Estimate::of(&large, 1, (1, 1), 2).seconds, 4.0 + 1.0);
    }

    #[test]
    fn shards_are_proposed_for_a_batch_of_hours_and_never_more_than_models() {
        let base = Estimate { pictures: 5000, models: 50, drawn: 20, ..Estimate::default() };
        let last = |seconds: f64, models: usize, is_shard: bool| {
            let estimate = Estimate { seconds, models, reason: None, ..base };
            estimate.sentences(2, is_shard).pop().unwrap()
        };
        assert!(last(3600.0, 50, false).starts_with("shards are not needed"));
        let ten = "use 10 shards of about 30 min: --shard 0/10 and so on";
        assert_eq!(last(18_000.0, 50, false), ten);
        assert!(last(18_000.0, 3, false).starts_with("use 3 shards of about 1 h 40 min"));
        assert!(last(18_000.0, 1, false).starts_with("one model"));
        let all =
            "5000 pictures of 50 models: about 0 B and 5 h 0 min on 2 threads, by a sample of 20";
        assert_eq!(last(18_000.0, 50, true), all);
    }

    #[test]
    fn pictures_that_cannot_be_drawn_are_counted_with_a_reason() {
        let fault = || Err(Fault::Input("a.obj: no".to_owned()));
        let sample = [rehearsed(fault(), [0; 3], false), rehearsed(fault(), [0; 3], false)];
        let sentences = Estimate::of(&sample, 2, (2, 2), 1).sentences(1, false);
        assert_eq!(sentences[1..], ["2 of the sample cannot be drawn, such as: a.obj: no"]);
    }
}
