//! The SIMD instruction sets of this processor.

use fearless_simd::Level;

/// Returns the instruction sets of this processor, the oldest first and the best last.
#[must_use]
pub fn levels() -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for level in ["plain", "sse4.2", "avx2", "best"].into_iter().filter_map(named) {
        if levels.iter().all(|other| name_of(*other) != name_of(level)) {
            levels.push(level);
        }
    }
    levels
}

/// Finds an instruction set by name: `best`, `avx512`, `avx2`, `sse4.2`, or `plain`, the baseline
/// of the architecture. `None` if this processor lacks it, or if the name is unknown.
#[must_use]
pub fn named(name: &str) -> Option<Level> {
    let best = Level::new();
    match name {
        "best" => Some(best),
        "plain" => Some(Level::baseline()),
        #[cfg(target_arch = "x86_64")]
        "avx512" => best.as_avx512().map(Level::Avx512),
        #[cfg(target_arch = "x86_64")]
        "avx2" => best.as_avx2().map(Level::Avx2),
        #[cfg(target_arch = "x86_64")]
        "sse4.2" => best.as_sse4_2().map(Level::Sse4_2),
        _ => None,
    }
}

/// Returns the name of an instruction set in reports, such as "Avx2".
#[must_use]
pub fn name_of(level: Level) -> String {
    let level = format!("{level:?}");
    level.split(['(', ' ', '{']).next().unwrap_or_default().to_owned()
}
