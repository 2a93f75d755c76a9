//! Times of other renderers beside ours, from the table that a comparison in interleaved rounds has
//! left: a row a run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::tables::{brief, head};

/// How the renderer is called that all are measured against, and how ours is.
const ANCHOR: &str = "llvmpipe-host";
const OURS: &str = "marraztu";

type Times = BTreeMap<(String, String), Vec<f64>>;

/// The table: a row a job, with the median of each renderer's runs.
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
        // As many threads as there are; the others show how much threads bring.
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
        let mut median = |of: &str| {
            let all = times.get_mut(&(job.clone(), of.to_owned()))?;
            all.sort_by(f64::total_cmp);
            Some(all[all.len() / 2])
        };
        let (anchor, ours) = (median(ANCHOR), median(OURS));
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
