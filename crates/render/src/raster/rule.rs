//! Rules of coverage: what kernels of set-up and of small triangles are compiled for.
//!
//! * By whole numbers on the usual grid: the default.
//! * By whole numbers on a finer grid.
//! * From corners that are not snapped: edge functions in f32; and scan lines and points, which
//!   tiles draw alone.

use fearless_simd::Simd;

use super::queue::SMALL;
use super::small_edges::{Edges, FineEdges, FloatEdges, UsualEdges, WholeEdges};
use crate::frame::variants::Variants;
use crate::screen::coverage::Grid;
use marraztu_core::accuracy::Coverage;

/// A rule of coverage.
pub(crate) trait Rule: Copy {
    /// The grid of corners.
    const GRID: Grid = Grid::Usual;
    /// Whether corners are needed as they were before they were snapped.
    const UNSNAPPED: bool = false;
    /// The number of queues of small triangles that are used.
    const QUEUES: usize = SMALL.len() - 1;
    /// Whether small triangles may wait for their tiles.
    const IN_TILES: bool = false;
    /// The edge functions of small triangles.
    type Edges<S: Simd>: Edges<S>;
    /// Those of the last queue, whose boxes are larger.
    type LastEdges<S: Simd>: Edges<S>;
}

/// Whole numbers on the usual grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usual;

impl Rule for Usual {
    const QUEUES: usize = SMALL.len();
    const IN_TILES: bool = true;
    type Edges<S: Simd> = UsualEdges<S>;
    type LastEdges<S: Simd> = WholeEdges<S>;
}

/// Whole numbers on the fine grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine;

impl Rule for Fine {
    const GRID: Grid = Grid::Fine;
    type Edges<S: Simd> = FineEdges<S>;
    type LastEdges<S: Simd> = FineEdges<S>;
}

/// Corners that are not snapped: of small triangles, edge functions in f32. By rounding they may
/// cover centres that are a little outside; scan lines, whose corners are whole pixels, up to one
/// and a half.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unsnapped;

impl Rule for Unsnapped {
    const UNSNAPPED: bool = true;
    type Edges<S: Simd> = FloatEdges<S>;
    type LastEdges<S: Simd> = FloatEdges<S>;
}

/// Evaluates an expression with the rule of coverage of a frame.
macro_rules! with_rule {
    ($variants:expr, $rule:ident => $what:expr) => {
        match $crate::raster::rule::kind($variants) {
            $crate::raster::rule::Kind::Usual => {
                type $rule = $crate::raster::rule::Usual;
                $what
            }
            $crate::raster::rule::Kind::Fine => {
                type $rule = $crate::raster::rule::Fine;
                $what
            }
            $crate::raster::rule::Kind::Unsnapped => {
                type $rule = $crate::raster::rule::Unsnapped;
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
    Unsnapped,
}

/// The rule of a frame.
pub(crate) fn kind(variants: Variants) -> Kind {
    match (variants.coverage, variants.grid()) {
        (Coverage::Exact, Grid::Usual) => Kind::Usual,
        (Coverage::Exact, Grid::Fine) => Kind::Fine,
        _ => Kind::Unsnapped,
    }
}
