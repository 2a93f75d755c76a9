//! Reads the times of this renderer and others from a table with one row for each run. The runs
//! were made in interleaved rounds.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use marraztu_lab::statistics::median;

use super::tables::{brief, head};

/// The label of the baseline renderer, and our labels with the best instructions and with AVX2.
const ANCHOR: &str = "llvmpipe-host";
const OURS: &str = "marraztu";
const AVX2: &str = "marraztu-avx2";

type Times = BTreeMap<(String, String), Vec<f64>>;

/// Makes a table with a row for each job and the median of each renderer's runs.
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
        // Only rows that use all threads: the others show the gain from threads.
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
    // A missing baseline drops the row; a missing time of ours leaves its cells empty.
    let columns = ["llvmpipe", "Marraztu", "times as fast", "AVX2", "times as fast"];
    let mut text = head("mesh (triangles), mode, size", &columns);
    let mut logarithms = [Vec::new(), Vec::new()];
    for job in jobs {
        let median_of = |of: &str| median(times.get(&(job.clone(), of.to_owned()))?);
        let Some(anchor) = median_of(ANCHOR) else { continue };
        let _ = write!(text, "| {job} | {} |", brief(anchor));
        for (label, logarithms) in [OURS, AVX2].into_iter().zip(&mut logarithms) {
            let Some(ours) = median_of(label) else {
                text.push_str("  |  |");
                continue;
            };
            let _ = write!(text, " {} | **{:.1}** |", brief(ours), anchor / ours);
            logarithms.push((anchor / ours).ln());
        }
        text.push('\n');
    }
    // The geometric mean suits ratios.
    text.push_str("| geometric mean | |");
    for logarithms in logarithms {
        #[expect(clippy::cast_precision_loss, reason = "few jobs")]
        let mean = (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
        let mean = if mean.is_finite() { format!("**{mean:.1}**") } else { String::new() };
        let _ = write!(text, " | {mean} |");
    }
    text.push('\n');
    Ok(text)
}
