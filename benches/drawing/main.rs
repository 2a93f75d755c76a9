//! Benchmarks of drawing: by stage and shape, by effect, by size, by texture, and of transparent
//! surfaces.
//!
//! `cargo bench --bench drawing` runs them all; part of a name selects some. Times depend on the
//! machine and the moment, so only their ratios are meaningful. `tools/speed.sh` turns them into a
//! page.

mod effects;
mod growth;
mod objects;
mod redraw;
mod shadows;
mod shapes;
mod stage;
mod stages;
mod textures;
mod transparent;

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
    textures::measure(&mut criterion);
    transparent::measure(&mut criterion);
    shadows::measure(&mut criterion);
    redraw::measure(&mut criterion);
    criterion.final_summary();
}
