//! The ways in which pixels get their colours.
//!
//! All of them give the same bytes. Each is the fastest for the surfaces that it is meant for, and
//! the fragment list can do everything. `plan::color_path` chooses; rasterisation and shading match
//! on the choice and read no setting.

/// How the pixels of a draw with one pipeline are coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ColorPath {
    /// Blocks of 8 x 8 pixels that one triangle covers fully.
    pub(crate) full: FullPath,
    /// All other blocks.
    pub(crate) list: ListPath,
}

/// How blocks that one triangle covers fully are coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum FullPath {
    /// One colour fills them.
    Fill,
    /// The colours at the corners of the triangle are interpolated.
    Corners,
    /// Each block is lit in one pass, without a fragment list.
    Light,
    /// Each block has a fragment list.
    #[default]
    List,
}

/// How fragment lists are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ListPath {
    /// Each block has a list of its own.
    #[default]
    Alone,
    /// Blocks of the same surface share a list.
    Joined,
    /// As `Joined`; blocks in which nearly each pixel shows another triangle need no table of
    /// triangles.
    Tiny,
}

/// The number of pixels that each path has coloured, in whole blocks except for lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathPixels {
    /// Filled blocks.
    pub filled: u64,
    /// Blocks of interpolated corner colours.
    pub corners: u64,
    /// Blocks lit in one pass.
    pub lit: u64,
    /// Pixels of fragment lists of one block.
    pub alone: u64,
    /// Pixels of fragment lists of several blocks.
    pub joined: u64,
    /// Pixels of lists of tiny triangles.
    pub tiny: u64,
    /// Blocks that look up the colours of faces.
    pub faces: u64,
}

impl std::ops::AddAssign for PathPixels {
    fn add_assign(&mut self, other: Self) {
        let Self { filled, corners, lit, alone, joined, tiny, faces } = other;
        self.filled += filled;
        self.corners += corners;
        self.lit += lit;
        self.alone += alone;
        self.joined += joined;
        self.tiny += tiny;
        self.faces += faces;
    }
}

/// The paths of all draws of a frame. The memory is kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct ColorPaths {
    /// For each draw the index of its first entry, and the end of the last.
    starts: Vec<u32>,
    /// The paths of a draw by pipeline.
    entries: Vec<(u32, ColorPath)>,
    /// Whether colours of faces are looked up in a table of the frame.
    pub(crate) looks_up_faces: bool,
    /// Whether little is computed for a pixel, so that copying a tile would take much of its time.
    pub(crate) quick: bool,
}

impl ColorPaths {
    /// Forgets the paths of the last frame.
    pub(crate) fn clear(&mut self) {
        self.starts.clear();
        self.entries.clear();
        // The first draw starts at 0; each later call of `add` pushes an end.
        self.starts.push(0);
    }

    /// Adds the paths of the next draw, one for each of its pipelines.
    pub(crate) fn add(&mut self, paths: impl Iterator<Item = (u32, ColorPath)>) {
        let first = self.entries.len();
        for (pipeline, path) in paths {
            // Parts that share a pipeline share its path.
            if !self.entries[first..].iter().any(|(other, _)| *other == pipeline) {
                self.entries.push((pipeline, path));
            }
        }
        self.starts.push(u32::try_from(self.entries.len()).expect("fewer than 2^32 parts"));
    }

    /// Returns the path of a draw with one of its pipelines.
    #[inline]
    pub(crate) fn of(&self, draw: u32, pipeline: u32) -> ColorPath {
        let [first, end] = [draw, draw + 1].map(|at| self.starts[at as usize] as usize);
        match &self.entries[first..end] {
            // Most draws have a single pipeline, which needs no search.
            [(_, only)] => *only,
            several => {
                let found = several.iter().find(|(other, _)| *other == pipeline);
                // The default, a fragment list for each block, works for every surface.
                found.map_or_else(ColorPath::default, |(_, path)| *path)
            }
        }
    }
}
