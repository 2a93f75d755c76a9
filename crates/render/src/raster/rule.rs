//! Rules of coverage, as types for which setup and the kernels of small triangles are compiled.
//!
//! * Integers on the usual grid: the default.
//! * Integers on a finer grid.
//! * Unsnapped corners: edge functions in f32. Scan lines and points are drawn by tiles only.

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
    /// Whether the rule needs corners before snapping.
    const UNSNAPPED: bool = false;
    /// The number of queues of small triangles in use.
    const QUEUES: usize = SMALL.len() - 1;
    /// Whether small triangles may wait for their tiles.
    const IN_TILES: bool = false;
    /// The edge functions of small triangles.
    type Edges<S: Simd>: Edges<S>;
    /// The edge functions of the last queue, which has larger boxes.
    type LastEdges<S: Simd>: Edges<S>;
}

/// Integers on the usual grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usual;

impl Rule for Usual {
    const QUEUES: usize = SMALL.len();
    const IN_TILES: bool = true;
    type Edges<S: Simd> = UsualEdges<S>;
    type LastEdges<S: Simd> = WholeEdges<S>;
}

/// Integers on the fine grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine;

impl Rule for Fine {
    const GRID: Grid = Grid::Fine;
    type Edges<S: Simd> = FineEdges<S>;
    type LastEdges<S: Simd> = FineEdges<S>;
}

/// Unsnapped corners, with f32 edge functions for small triangles. Because of rounding, these may
/// cover centres slightly outside. Scan lines have corners at whole pixels, and may cover centres
/// up to one and a half pixels outside.
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

/// The rules of coverage as values.
pub(crate) enum Kind {
    Usual,
    Fine,
    Unsnapped,
}

/// Returns the rule of a frame.
pub(crate) fn kind(variants: Variants) -> Kind {
    match (variants.coverage, variants.grid()) {
        (Coverage::Exact, Grid::Usual) => Kind::Usual,
        (Coverage::Exact, Grid::Fine) => Kind::Fine,
        _ => Kind::Unsnapped,
    }
}
