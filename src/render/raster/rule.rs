//! Rules of coverage: what kernels of set-up and of small triangles are compiled for.
//!
//! * By whole numbers on the usual grid: the default.
//! * By whole numbers on a finer grid.
//! * By edge functions in f32, of corners that are not snapped.
//! * By something that tiles do alone: scan lines, points.

use fearless_simd::Simd;

use super::small_edges::{Edges, FineEdges, FloatEdges, UsualEdges};
use crate::accuracy::Coverage;
use crate::render::frame::variants::Variants;
use crate::render::screen::coverage::Grid;

/// A rule of coverage.
pub(crate) trait Rule: Copy {
    /// The grid of corners.
    const GRID: Grid = Grid::Usual;
    /// How far beyond its bounding box a triangle may cover centres, in 1/256 pixel.
    const BEYOND: i32 = 0;
    /// Whether corners are needed as they were before they were snapped.
    const UNSNAPPED: bool = false;
    /// Whether small triangles are drawn sixteen at a time.
    const SMALL: bool = true;
    /// The edge functions of small triangles.
    type Edges<S: Simd>: Edges<S>;

    /// The least and the largest offsets of samples, with those of centres beyond the box.
    #[inline(always)]
    fn reach([least, most]: [[i32; 2]; 2]) -> [[i32; 2]; 2] {
        let by = Self::BEYOND;
        [[least[0] - by, least[1] - by], [most[0] + by, most[1] + by]]
    }
}

/// Whole numbers on the usual grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usual;

impl Rule for Usual {
    type Edges<S: Simd> = UsualEdges<S>;
}

/// Whole numbers on the fine grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine;

impl Rule for Fine {
    const GRID: Grid = Grid::Fine;
    type Edges<S: Simd> = FineEdges<S>;
}

/// Edge functions in f32. By rounding they may cover centres that are a little outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floats;

impl Rule for Floats {
    const BEYOND: i32 = 16;
    const UNSNAPPED: bool = true;
    type Edges<S: Simd> = FloatEdges<S>;
}

/// What tiles do alone. Rounded to whole pixels, corners are up to half a pixel off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InTiles;

impl Rule for InTiles {
    const BEYOND: i32 = 384;
    const UNSNAPPED: bool = true;
    const SMALL: bool = false;
    type Edges<S: Simd> = UsualEdges<S>;
}

/// Evaluates an expression with the rule of coverage of a frame.
macro_rules! with_rule {
    ($variants:expr, $rule:ident => $what:expr) => {
        match $crate::render::raster::rule::kind($variants) {
            $crate::render::raster::rule::Kind::Usual => {
                type $rule = $crate::render::raster::rule::Usual;
                $what
            }
            $crate::render::raster::rule::Kind::Fine => {
                type $rule = $crate::render::raster::rule::Fine;
                $what
            }
            $crate::render::raster::rule::Kind::Floats => {
                type $rule = $crate::render::raster::rule::Floats;
                $what
            }
            $crate::render::raster::rule::Kind::InTiles => {
                type $rule = $crate::render::raster::rule::InTiles;
                $what
            }
        }
    };
}
pub(crate) use with_rule;

/// The kinds of rules.
pub(crate) enum Kind {
    Usual,
    Fine,
    Floats,
    InTiles,
}

/// The rule of a frame.
pub(crate) fn kind(variants: Variants) -> Kind {
    match (variants.coverage, variants.grid()) {
        (Coverage::Exact, Grid::Usual) => Kind::Usual,
        (Coverage::Exact, Grid::Fine) => Kind::Fine,
        (Coverage::F32Edges, _) => Kind::Floats,
        (Coverage::ScanLines | Coverage::Points, _) => Kind::InTiles,
    }
}
