//! The jobs of a batch: one for each picture.
//!
//! Jobs are numbered over the whole list, whatever part of it this process draws. They are computed
//! from their position in the order of drawing, so a list of millions of pictures takes no more
//! memory than its rows.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use marraztu_core::base::image::Size;

use super::dataset::Dataset;
use super::options::PictureOptions;
use super::rows::Row;
use super::shard::Shard;
use super::views::CameraView;
use crate::cli::layers::LayerFile;

/// The size of pictures without `--size`.
const SIZE: Size = Size::new(800, 800);

/// A picture to draw.
#[derive(Clone, Debug)]
pub(super) struct Job {
    /// The number in the whole list, from 0.
    pub(super) index: usize,
    /// The number in the order of drawing, from 0.
    pub(super) position: usize,
    pub(super) row: Arc<Row>,
    /// The number of the view in its row.
    view: usize,
    /// The files of the picture and its layers: at least one.
    pub(super) files: Vec<LayerFile>,
}

impl Job {
    /// Returns the first file.
    pub(super) fn out(&self) -> &Path {
        &self.files[0].path
    }

    /// Returns the folder of the file of cameras.
    pub(super) fn cameras_folder(&self, dataset: Option<Dataset>) -> &Path {
        let folder = self.out().parent().unwrap_or(Path::new(""));
        match dataset {
            // The layers have folders of their own.
            Some(Dataset::Nerf) => folder.parent().unwrap_or(folder),
            Some(Dataset::Bop | Dataset::Coco) | None => folder,
        }
    }

    /// Names the formats of all files.
    pub(super) fn encodings(&self) -> String {
        let names: Vec<&str> = self.files.iter().map(|file| file.encoding.name()).collect();
        names.join(" ")
    }

    /// Returns the camera.
    pub(super) fn camera(&self) -> &CameraView {
        &self.row.kind.views[self.view]
    }

    /// Returns the number of the view in its row.
    pub(super) const fn view(&self) -> usize {
        self.view
    }

    /// Returns whether its row has no other view.
    pub(super) fn is_only_view(&self) -> bool {
        self.row.kind.views.len() == 1
    }

    /// Returns the options.
    pub(super) fn options(&self) -> &PictureOptions {
        &self.row.kind.parsed.options
    }

    /// Returns the size of the picture.
    pub(super) fn size(&self) -> Size {
        self.options().size.or(self.camera().size).unwrap_or(SIZE)
    }
}

/// The pictures that a process draws, in the order of drawing.
#[derive(Debug)]
pub(super) struct Plan {
    /// The rows: all rows of a model follow each other, in the order in which models first occur in
    /// the list.
    rows: Vec<Arc<Row>>,
    /// The number of pictures up to the end of each row.
    ends: Vec<usize>,
    /// The number of pictures in the whole list.
    pub(super) all: usize,
}

impl Plan {
    /// Selects the pictures of a shard. `all` are the rows of the whole list.
    pub(super) fn of(all: &[Arc<Row>], shard: Shard) -> Self {
        let numbers = match shard {
            Shard::WHOLE => (0..all.len()).collect(),
            _ => shard.of_files(all.iter().map(|row| &*row.file)),
        };
        let mut rows: Vec<Arc<Row>> = numbers.into_iter().map(|i| Arc::clone(&all[i])).collect();
        rows.sort_unstable_by_key(|row| row.number);
        let mut groups: HashMap<&Path, usize> = HashMap::new();
        let mut keys = HashMap::new();
        for row in &rows {
            keys.insert(row.number, *groups.entry(row.file.as_path()).or_insert(row.number));
        }
        drop(groups);
        rows.sort_by_key(|row| (keys[&row.number], row.number));
        let pictures = |row: &Arc<Row>| row.kind.views.len();
        let ends = rows.iter().scan(0, |end, row| {
            *end += pictures(row);
            Some(*end)
        });
        let ends = ends.collect();
        Self { rows, ends, all: all.iter().map(pictures).sum() }
    }

    /// Returns the number of pictures.
    pub(super) fn len(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Returns the rows.
    pub(super) fn rows(&self) -> &[Arc<Row>] {
        &self.rows
    }

    /// Returns the job at a position in the order of drawing.
    pub(super) fn job(&self, position: usize) -> Option<Job> {
        let at = self.ends.partition_point(|end| *end <= position);
        let row = Arc::clone(self.rows.get(at)?);
        let begin = self.ends[at] - row.kind.views.len();
        let view = position - begin;
        let files = row.files(view).expect("names are checked with the rows");
        Some(Job { index: row.first + view, position, row, view, files })
    }

    /// Iterates over all jobs, in the order of drawing.
    pub(super) fn jobs(&self) -> impl Iterator<Item = Job> {
        (0..self.len()).map_while(move |position| self.job(position))
    }

    /// Iterates over the positions of all jobs, in the order of the list.
    pub(super) fn in_list_order(&self) -> impl Iterator<Item = usize> + use<> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        let spans = begins.zip(self.ends.iter().copied());
        let mut rows: Vec<_> = self.rows.iter().map(|row| row.number).zip(spans).collect();
        rows.sort_unstable();
        rows.into_iter().flat_map(|(_, (begin, end))| begin..end)
    }

    /// Returns the position after the pictures of a model, from the position of one of them.
    pub(super) fn end_of_model(&self, position: usize) -> usize {
        let at = self.ends.partition_point(|end| *end <= position);
        let Some(row) = self.rows.get(at) else { return self.len() };
        let same = self.rows[at..].iter().take_while(|other| other.file == row.file).count();
        self.ends[at + same - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::jobs_of;
    use super::*;

    #[test]
    fn the_jobs_of_a_model_follow_each_other_and_keep_their_numbers() {
        let arguments = ["a.obj", "b.obj", "a.obj", "--out", "{index}.png", "--views", "2"];
        let jobs = jobs_of(&arguments).unwrap();
        let order: Vec<usize> = jobs.iter().map(|job| job.index).collect();
        assert_eq!(order, [0, 1, 4, 5, 2, 3]);
        let size = |arguments: &[&str]| jobs_of(arguments).unwrap()[0].size();
        assert_eq!(size(&["a.obj"]), SIZE);
        assert_eq!(size(&["a.obj", "--size", "32x16"]), Size::new(32, 16));
    }
}
