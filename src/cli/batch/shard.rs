//! Shards: parts of a list that different processes draw.
//!
//! All pictures of one model belong to one shard, so it is loaded once. Models are sorted by a hash
//! of their path and dealt like cards, which spreads neighbours in the list, often of equal cost.

use std::path::Path;

use sha2::{Digest as _, Sha256};

/// The part of a list that this process draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    /// The number of the part, from 0.
    pub(super) index: usize,
    /// The number of parts.
    pub(super) count: usize,
}

/// Environment variables with the number of a task, the number of tasks, and the numbers of the
/// first and the last task.
const ENGINES: [[&str; 4]; 3] = [
    [
        "SLURM_ARRAY_TASK_ID",
        "SLURM_ARRAY_TASK_COUNT",
        "SLURM_ARRAY_TASK_MIN",
        "SLURM_ARRAY_TASK_MAX",
    ],
    ["JOB_COMPLETION_INDEX", "JOB_COMPLETIONS", "", ""],
    ["AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE", "", ""],
];

impl Shard {
    /// The whole list.
    pub(super) const WHOLE: Self = Self { index: 0, count: 1 };

    /// Returns the numbers of the files that are in this shard, in any order. Equal files are in
    /// one shard.
    pub(super) fn of_files<'a>(self, files: impl Iterator<Item = &'a Path>) -> Vec<usize> {
        let key = |file: &Path| -> [u8; 32] {
            Sha256::digest(file.as_os_str().as_encoded_bytes()).into()
        };
        let mut keys: Vec<([u8; 32], usize)> =
            files.enumerate().map(|(number, file)| (key(file), number)).collect();
        keys.sort_unstable();
        let models = keys.chunk_by(|a, b| a.0 == b.0).skip(self.index).step_by(self.count);
        models.flatten().map(|(_, number)| *number).collect()
    }
}

/// Parses the value of `--shard`: "3/64", counted from 0, or "auto". Fails with the reason if it is
/// invalid, or the environment names no task.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
    shard_in(text, &|name| std::env::var(name).ok())
}

fn shard_in(text: &str, variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard, String> {
    let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
    if text != "auto" {
        let parts = text.split_once('/').map(|(index, count)| (index.parse(), count.parse()));
        let Some((Ok(index), Ok(count))) = parts else {
            return Err("write the number of the part, from 0, and the number of parts, as 3/64; \
                        or auto"
                .to_owned());
        };
        return checked(index, count);
    }
    for [index, count, first, last] in ENGINES {
        let Some(text) = variable(index) else { continue };
        let task = text.trim().parse::<usize>();
        let task = task.map_err(|error| format!("{index} is {text:?}: {error}"))?;
        let count = number(count).ok_or_else(|| {
            format!("{index} is {task}, but {count} does not say of how many; write {task}/COUNT")
        })?;
        let first = number(first).unwrap_or_default();
        // An array such as 3,7 or 0-15:4 does not say of how many parts its tasks are.
        if number(last).is_some_and(|last| last.checked_sub(first) != count.checked_sub(1)) {
            return Err(format!("the task array has gaps; write {task}/COUNT instead of auto"));
        }
        let task = task.checked_sub(first).ok_or("the task number is below the first one")?;
        return checked(task, count);
    }
    let names: Vec<&str> = ENGINES.iter().map(|[index, ..]| *index).collect();
    Err(format!("auto needs one of the variables {}", names.join(", ")))
}

fn checked(index: usize, count: usize) -> Result<Shard, String> {
    if index < count {
        return Ok(Shard { index, count });
    }
    match count {
        0 => Err("there is at least one part".to_owned()),
        _ => Err(format!("parts are counted from 0: the last of {count} is {}/{count}", count - 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_is_in_one_shard_and_shards_have_equal_sizes() {
        let names: Vec<String> = (0..100).map(|i| format!("models/{i}.obj")).collect();
        for count in (1..=17).chain([64]) {
            let mut seen = [0; 200];
            for index in 0..count {
                let twice = names.iter().chain(&names).map(Path::new);
                let files = Shard { index, count }.of_files(twice);
                let size = files.len() / 2;
                assert!(size.abs_diff(100 / count) <= 1, "{index}/{count}: {size}");
                assert!(files.iter().all(|file| files.contains(&((file + 100) % 200))));
                files.into_iter().for_each(|file| seen[file] += 1);
            }
            assert_eq!(seen, [1; 200]);
        }
    }

    #[test]
    fn shards_are_written_or_found_in_the_environment() {
        let none = |_: &str| None;
        assert_eq!(shard_in("3/64", &none), Ok(Shard { index: 3, count: 64 }));
        assert_eq!(shard_in("0/1", &none), Ok(Shard::WHOLE));
        for (wrong, reason) in [
            ("1/1", "from 0"),
            ("0/0", "at least one"),
            ("x/3", "as 3/64"),
            ("3", "as 3/64"),
            ("-1/3", "as 3/64"),
            ("auto", "SLURM_ARRAY_TASK_ID"),
        ] {
            assert!(shard_in(wrong, &none).unwrap_err().contains(reason), "{wrong}");
        }
        let environment = |pairs: &'static [(&str, &str)]| {
            move |name: &str| {
                let found = pairs.iter().find(|(other, _)| *other == name);
                found.map(|(_, value)| (*value).to_owned())
            }
        };
        let slurm = environment(&[
            ("SLURM_ARRAY_TASK_ID", "3"),
            ("SLURM_ARRAY_TASK_COUNT", "8"),
            ("SLURM_ARRAY_TASK_MIN", "1"),
            ("SLURM_ARRAY_TASK_MAX", "8"),
        ]);
        assert_eq!(shard_in("auto", &slurm), Ok(Shard { index: 2, count: 8 }));
        // Parts 3 and 7 of an earlier array, submitted again.
        let gaps = environment(&[
            ("SLURM_ARRAY_TASK_ID", "3"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
            ("SLURM_ARRAY_TASK_MIN", "3"),
            ("SLURM_ARRAY_TASK_MAX", "7"),
        ]);
        assert!(shard_in("auto", &gaps).unwrap_err().contains("3/COUNT"));
        let kubernetes = environment(&[("JOB_COMPLETION_INDEX", "5"), ("JOB_COMPLETIONS", "6")]);
        assert_eq!(shard_in("auto", &kubernetes), Ok(Shard { index: 5, count: 6 }));
        let unknown = environment(&[("JOB_COMPLETION_INDEX", "5")]);
        assert!(shard_in("auto", &unknown).unwrap_err().contains("5/COUNT"));
        let broken = environment(&[("JOB_COMPLETION_INDEX", "x"), ("JOB_COMPLETIONS", "6")]);
        assert!(
            shard_in("auto", &broken).unwrap_err().starts_with("JOB_COMPLETION_INDEX is \"x\"")
        );
        let aws =
            environment(&[("AWS_BATCH_JOB_ARRAY_INDEX", "9"), ("AWS_BATCH_JOB_ARRAY_SIZE", "10")]);
        assert_eq!(shard_in("auto", &aws), Ok(Shard { index: 9, count: 10 }));
    }
}
