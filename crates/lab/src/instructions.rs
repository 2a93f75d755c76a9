//! The SIMD instruction sets of this processor.

use fearless_simd::Level;
pub use marraztu_render::simd::levels;

/// Finds an instruction set by name: `best`, `avx512`, `avx2`, `sse4.2`, or `plain`, the oldest
/// that pictures are drawn with. `None` if this processor lacks it, or if the name is unknown.
pub fn named(name: &str) -> Option<Level> {
    let levels = levels();
    match name {
        "best" => levels.last().copied(),
        "plain" => levels.first().copied(),
        _ => {
            let name = name.replace('.', "_");
            levels.into_iter().find(|level| name_of(*level).eq_ignore_ascii_case(&name))
        }
    }
}

/// Returns the name of an instruction set in reports, such as "Avx2".
pub fn name_of(level: Level) -> String {
    let level = format!("{level:?}");
    level.split(['(', ' ', '{']).next().unwrap_or_default().to_owned()
}
