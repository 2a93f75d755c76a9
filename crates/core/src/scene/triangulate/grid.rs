//! A uniform grid of corners, so a search for blocking corners visits only a few.
//!
//! The cells are as square as possible, with about four corners each. Corners that are no longer
//! needed are removed during the search. Akman, Franklin, Kankanhalli and Narayanaswami, "Geometric
//! Computing and Uniform Grid Technique", Computer-Aided Design 1989.

use glam::DVec2;

/// Corners, grouped by grid cell.
#[derive(Debug, Default)]
pub(super) struct Grid {
    origin: DVec2,
    /// Cells per unit of length.
    scale: DVec2,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
    looked_at: usize,
}

impl Grid {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "few cells; what is no number becomes 0, and then 1"
    )]
    pub(super) fn new(corners: Vec<(u32, DVec2)>) -> Self {
        let places = || corners.iter().map(|(_, place)| *place);
        let min = places().reduce(DVec2::min).unwrap_or_default();
        let max = places().reduce(DVec2::max).unwrap_or_default();
        let extent = (max - min).max(DVec2::splat(f64::MIN_POSITIVE));
        let wanted = corners.len() / 4 + 1;
        let columns = (wanted as f64 * (extent.x / extent.y)).sqrt() as usize;
        let columns = columns.clamp(1, wanted);
        let rows = (wanted / columns).max(1);
        let scale = DVec2::new(columns as f64, rows as f64) / extent;
        let cells = vec![Vec::new(); columns * rows];
        let mut grid = Self { origin: min, scale, columns, rows, cells, looked_at: 0 };
        for (corner, place) in corners {
            grid.add(corner, place);
        }
        grid
    }

    pub(super) fn add(&mut self, corner: u32, place: DVec2) {
        let [column, row] = self.cell(place);
        self.cells[row * self.columns + column].push(corner);
    }

    /// Returns whether any corner in a box matches. If `is` returns `None`, the corner is removed.
    pub(super) fn any(
        &mut self,
        [min, max]: [DVec2; 2],
        is: &mut dyn FnMut(u32) -> Option<bool>,
    ) -> bool {
        let ([left, top], [right, bottom]) = (self.cell(min), self.cell(max));
        for row in top..=bottom {
            for cell in &mut self.cells[row * self.columns..][left..=right] {
                self.looked_at += 1;
                let mut at = 0;
                while let Some(&corner) = cell.get(at) {
                    match is(corner) {
                        Some(true) => return true,
                        Some(false) => at += 1,
                        None => {
                            cell.swap_remove(at);
                        }
                    }
                }
            }
        }
        false
    }

    /// Returns the number of cells visited since the last call.
    pub(super) fn cells_looked_at(&mut self) -> usize {
        std::mem::take(&mut self.looked_at)
    }

    /// Returns the cell of a position, or the nearest cell.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "what is less than 0 or no number becomes 0"
    )]
    fn cell(&self, place: DVec2) -> [usize; 2] {
        let cell = (place - self.origin) * self.scale;
        [(cell.x as usize).min(self.columns - 1), (cell.y as usize).min(self.rows - 1)]
    }
}
