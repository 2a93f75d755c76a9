//! Rules of coverage, as types for which setup and the kernels of small triangles are compiled.
//!
//! * Integers on the usual grid: the default.
//! * Integers on a finer grid.
//! * Unsnapped corners: edge functions in f32. Scan lines and points are drawn by tiles only.

use fearless_simd::Simd;

use super::queue::SMALL;
use super::small_edges::{Edges, FineEdges, FloatEdges, UsualEdges, WholeEdges};
use crate::screen::coverage::Grid;

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
    // In boxes of 16 x 16 pixels, edge functions may exceed 2^24, the limit of exact f32.
    type LastEdges<S: Simd> = WholeEdges<S>;
}

/// Integers on the fine grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fine;

impl Rule for Fine {
    const GRID: Grid = Grid::Fine;
    type Edges<S: Simd> = FineEdges<S>;
    // The last queue is unused: edge functions in its boxes would exceed 32 bits.
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
    ($mode:expr, $rule:ident => $what:expr) => {
        match ($mode.coverage, $mode.grid) {
            (marraztu_core::accuracy::Coverage::Exact, $crate::screen::coverage::Grid::Usual) => {
                type $rule = $crate::raster::rule::Usual;
                $what
            }
            (marraztu_core::accuracy::Coverage::Exact, $crate::screen::coverage::Grid::Fine) => {
                type $rule = $crate::raster::rule::Fine;
                $what
            }
            _ => {
                type $rule = $crate::raster::rule::Unsnapped;
                $what
            }
        }
    };
}
pub(crate) use with_rule;
