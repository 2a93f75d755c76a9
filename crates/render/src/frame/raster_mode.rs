//! All that rasterisation reads of the settings.

use marraztu_core::accuracy::{Coverage, DepthFormat, Settings, Subpixels, VertexArithmetic};

/// How vertices get to the screen, which samples their triangles cover, and how depths are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RasterMode {
    /// The arithmetic of transforms to the screen.
    pub(crate) vertices: VertexArithmetic,
    /// The grid that corners are snapped to.
    pub(crate) grid: Grid,
    /// The number of grid steps that corners are then rounded to: a power of two.
    pub(crate) step: i32,
    /// The rule of coverage.
    pub(crate) coverage: Coverage,
    /// The format of depths.
    pub(crate) depth: DepthFormat,
}

impl RasterMode {
    /// Returns the mode that the settings choose.
    pub(crate) const fn of(settings: &Settings) -> Self {
        let Settings { vertices, subpixels, coverage, depth, .. } = *settings;
        let grid = match (subpixels, coverage) {
            // Only exact coverage supports the fine grid.
            (Subpixels::Bits12, Coverage::Exact) => Grid::Fine,
            _ => Grid::Usual,
        };
        let step = match subpixels {
            Subpixels::Bits0 => grid.parts(),
            Subpixels::Bits4 => grid.parts() / 16,
            Subpixels::Bits8 | Subpixels::Bits12 => 1,
        };
        Self { vertices, grid, step, coverage, depth }
    }

    /// Returns whether geometry may be elsewhere on the screen than by default. If so, nothing may
    /// be culled by position.
    pub(crate) fn moves_geometry(&self) -> bool {
        let Self { vertices, grid, step, coverage, depth: _ } = *self;
        (vertices, grid, step, coverage) != (VertexArithmetic::F64, Grid::Usual, 1, Coverage::Exact)
    }
}

/// The grid that corners are snapped to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grid {
    /// 1/256 pixel.
    #[default]
    Usual,
    /// 1/4096 pixel.
    Fine,
}

impl Grid {
    /// Returns the number of grid steps per pixel, in each direction.
    #[must_use]
    pub const fn parts(self) -> i32 {
        match self {
            Self::Usual => 256,
            Self::Fine => 4096,
        }
    }

    /// Converts an offset in 1/256 pixel to steps of this grid.
    #[must_use]
    pub const fn offset(self, [x, y]: [i32; 2]) -> [i32; 2] {
        // Both grids are powers of two, so the quotient is exact.
        let times = self.parts() / Self::Usual.parts();
        [x * times, y * times]
    }
}
