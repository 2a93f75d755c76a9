//! Compares the listed pictures with those of this processor.

use std::collections::BTreeMap;

use serde::Serialize;

use marraztu_lab::pictures;

/// How many pictures are as listed, and the names of the others.
#[derive(Debug, Serialize)]
pub(crate) struct Verified {
    all: usize,
    differing: Vec<String>,
}

impl Verified {
    /// Draws all pictures.
    pub(crate) fn now() -> Self {
        let listed: BTreeMap<&str, u64> = pictures::listed().into_iter().collect();
        let all = pictures::all();
        let level = marraztu_render::simd::levels().pop();
        let is_listed = |picture: &pictures::TestPicture| {
            let drawn = level.map(|level| pictures::sum(&picture.draw(level, 1)));
            drawn.is_some() && drawn == listed.get(&*picture.name).copied()
        };
        let differing = all.iter().filter(|picture| !is_listed(picture));
        let differing = differing.map(|picture| picture.name.clone()).collect();
        Self { all: all.len(), differing }
    }
}
