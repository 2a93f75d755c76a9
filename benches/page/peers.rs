//! Reads the times of other renderers and ours from the table of a comparison in interleaved
//! rounds, with one row for each run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use marraztu::lab::statistics::median;

use super::tables::{brief, head};

/// The label of the renderer that all are measured against, and ours.
const ANCHOR: &str = "llvmpipe-host";
const OURS: &str = "marraztu";

type Times = BTreeMap<(String, String), Vec<f64>>;

/// The table: a row for each job, with the median of each renderer's runs.
pub(crate) fn table(file: &Path) -> Result<String, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let mut jobs: Vec<String> = Vec::new();
    let mut times = Times::new();
    for line in lines {
        let row: BTreeMap<&str, &str> = columns.iter().copied().zip(line.split(',')).collect();
        let cell = |name: &str| {
            let missing = || format!("{}: no column {name:?} in {line:?}", file.display());
            row.get(name).copied().ok_or_else(missing)
        };
        // All threads; the other rows show what threads gain.
        if cell("threads")? == "1" {
            continue;
        }
        let samples = if cell("msaa")? == "1" { "" } else { ", 4 samples" };
        let job = format!(
            "{} ({}), {}{samples}, {}",
            cell("mesh")?,
            cell("tris")?,
            cell("mode")?,
            cell("size")?
        );
        let ms: f64 = cell("wall_ms")?.parse().map_err(|e| format!("{line:?}: {e}"))?;
        if !jobs.contains(&job) {
            jobs.push(job.clone());
        }
        times.entry((job, cell("label")?.to_owned())).or_default().push(ms);
    }
    let mut text = head("mesh (triangles), mode, size", &["llvmpipe", "Marraztu", "times as fast"]);
    for job in jobs {
        let median_of = |of: &str| median(times.get(&(job.clone(), of.to_owned()))?);
        let (anchor, ours) = (median_of(ANCHOR), median_of(OURS));
        if let (Some(anchor), Some(ours)) = (anchor, ours) {
            let _ = writeln!(
                text,
                "| {job} | {} | {} | **{:.1}** |",
                brief(anchor),
                brief(ours),
                anchor / ours
            );
        }
    }
    Ok(text)
}
