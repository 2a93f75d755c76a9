//! How long drawing takes: by stage and shape, by effect, and how it grows.
//!
//! `cargo bench --bench drawing`, with a part of a name for some of it. Figures are of this machine
//! at this moment: what means something is their ratios. `tools/speed.sh` makes a page of them.

mod effects;
mod growth;
mod objects;
mod shapes;
mod stage;
mod stages;

use std::time::Duration;

use criterion::Criterion;

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    stages::measure(&mut criterion);
    effects::measure(&mut criterion);
    growth::measure(&mut criterion);
    objects::measure(&mut criterion);
    criterion.final_summary();
}
