//! Reads criterion's results: one folder for each benchmark, with its name and its estimates.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use serde::Deserialize;

/// Median milliseconds, by a benchmark's group and its name in the group.
pub(crate) struct Measured(BTreeMap<(String, String), f64>);

#[derive(Deserialize)]
struct Benchmark {
    group_id: String,
    function_id: Option<String>,
    value_str: Option<String>,
}

#[derive(Deserialize)]
struct Estimates {
    median: Estimate,
}

#[derive(Deserialize)]
struct Estimate {
    point_estimate: f64,
}

impl Measured {
    /// Reads all results under a folder.
    pub(crate) fn read(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let mut all = BTreeMap::new();
        let mut folders = vec![folder.to_owned()];
        while let Some(folder) = folders.pop() {
            let entries = std::fs::read_dir(&folder).map_err(|error| {
                format!("{}: {error}; run `cargo bench --bench drawing` first", folder.display())
            })?;
            for entry in entries {
                let path = entry?.path();
                // criterion keeps the last run in `new` and the one before in `base`.
                if path.ends_with("new") {
                    let benchmark: Benchmark = json(&path.join("benchmark.json"))?;
                    let estimates: Estimates = json(&path.join("estimates.json"))?;
                    let name = benchmark.function_id.or(benchmark.value_str).unwrap_or_default();
                    all.insert((benchmark.group_id, name), estimates.median.point_estimate / 1e6);
                } else if path.is_dir() {
                    folders.push(path);
                }
            }
        }
        Ok(Self(all))
    }

    /// Returns the milliseconds of one benchmark.
    pub(crate) fn of(&self, group: &str, name: &str) -> Result<f64, String> {
        let key = (group.to_owned(), name.to_owned());
        self.0.get(&key).copied().ok_or_else(|| format!("{group}/{name} was not measured"))
    }

    /// Returns all benchmarks of a group, by name.
    pub(crate) fn group<'a>(&'a self, group: &'a str) -> impl Iterator<Item = (&'a str, f64)> {
        let all = self.0.iter().filter(move |((of, _), _)| of == group);
        all.map(|((_, name), ms)| (name.as_str(), *ms))
    }

    /// Returns the names of groups that begin with `beginning`, without that prefix.
    pub(crate) fn groups<'a>(&'a self, beginning: &'a str) -> Vec<&'a str> {
        let mut names: Vec<&str> =
            self.0.keys().filter_map(|(group, _)| group.strip_prefix(beginning)).collect();
        names.dedup();
        names
    }
}

fn json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?)
}
