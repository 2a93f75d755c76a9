//! Contact sheets of the pictures of a batch.
//!
//! Sheets are made from the files after the last picture is drawn, so they show what is there,
//! whatever run has drawn it.

use std::path::{Path, PathBuf};

use marraztu::plots::{SheetCell, contact_sheet};
use marraztu_io::{self as io, PICTURE_FORMATS, PictureFormat};

use super::jobs::{Job, Plan};
use super::template::stem;
use crate::cli::failure::Failure;

/// The columns and rows of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    columns: usize,
    rows: usize,
}

/// The stamp of a sheet.
const STAMP: &str = "contact sheet";

impl Grid {
    /// Returns the files of the sheets of this number of pictures.
    pub(super) fn files(self, folder: &Path, pictures: usize) -> impl Iterator<Item = PathBuf> {
        let count = pictures.div_ceil(self.columns * self.rows);
        (0..count).map(move |i| folder.join(format!("sheet-{i:03}.png")))
    }
}

/// Checks that sheets replace no other file, and that they can show the files of the jobs. Fails if
/// a file with the name of a sheet is none, or a job writes no picture.
pub(super) fn check_sheets(grid: Grid, folder: &Path, plan: &Plan) -> Result<(), Failure> {
    io::check_scheme(folder)?;
    if let Some(job) = plan.jobs().find(|job| PictureFormat::of(job.out()).is_err()) {
        let out = job.out().display();
        return Err(Failure::Usage(format!("--sheet shows pictures, and {out} is none")));
    }
    grid.files(folder, plan.len()).try_for_each(|path| check_sheet(&path))
}

fn check_sheet(path: &Path) -> Result<(), Failure> {
    if path.exists() && io::read_stamp(path).as_deref() != Some(STAMP) {
        return Err(Failure::Usage(format!(
            "{}: a file with this name exists and is not a contact sheet; choose another folder \
             by --sheets",
            path.display()
        )));
    }
    Ok(())
}

/// Parses columns and rows, such as "4x2".
pub(super) fn grid(text: &str) -> Result<Grid, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=100).contains(side));
    let sides = text.split_once(['x', 'X']).map(|(columns, rows)| (side(columns), side(rows)));
    match sides {
        Some((Some(columns), Some(rows))) => Ok(Grid { columns, rows }),
        _ => Err("write columns x rows, each from 1 to 100, as 4x2".to_owned()),
    }
}

/// Writes the sheets of the jobs at these positions, in their order, to numbered files in a folder,
/// as long as `wanted` returns true. Fails if a picture cannot be read, or a sheet cannot be
/// written.
pub(super) fn write_sheets(
    grid: Grid,
    folder: &Path,
    (plan, jobs): (&Plan, &[usize]),
    wanted: &dyn Fn() -> bool,
) -> Result<(), Failure> {
    let failed = |error| Failure::Write(folder.to_owned(), error);
    std::fs::create_dir_all(folder).map_err(failed)?;
    let pages = jobs.chunks(grid.columns * grid.rows);
    for (path, jobs) in grid.files(folder, jobs.len()).zip(pages).take_while(|_| wanted()) {
        let cells = jobs.iter().filter_map(|position| plan.job(*position)).map(|job| cell(&job));
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        check_sheet(&path)?;
        let sheet = contact_sheet(&cells, grid.columns, &[])?;
        let png = io::encode_stamped(&PICTURE_FORMATS[0], &sheet, STAMP);
        io::save_encoded(&path, &png.map_err(Failure::Absent)?)?;
    }
    Ok(())
}

/// Returns a picture with the name of its model and view.
fn cell(job: &Job) -> Result<SheetCell, Failure> {
    let picture = io::load_picture(job.out())?;
    let stem = stem(&job.row.file);
    let label = if job.is_only_view() { stem } else { format!("{stem} {}", job.camera().name) };
    Ok(SheetCell { picture, label })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_columns_and_rows() {
        assert_eq!(grid("4x2"), Ok(Grid { columns: 4, rows: 2 }));
        for wrong in ["", "4", "0x2", "4x101", "axb", "1x2x3"] {
            assert!(grid(wrong).is_err(), "{wrong}");
        }
    }
}
