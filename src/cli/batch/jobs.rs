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
use super::tars::TarNames;
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
    /// the list. For archives, all rows in the order of the list.
    rows: Vec<Arc<Row>>,
    /// The number of pictures up to the end of each row.
    ends: Vec<usize>,
    /// The number of pictures in the whole list.
    pub(super) all: usize,
    /// The archives that are written, if there are any.
    tars: Option<TarOrder>,
}

/// The order of pictures in archives: that of the list, with each archive in one shard.
#[derive(Debug)]
struct TarOrder {
    names: Arc<TarNames>,
    shard: Shard,
}

impl TarOrder {
    /// Returns the number in the whole list of the picture at a position.
    fn index(&self, position: usize) -> usize {
        let per_tar = self.names.per_tar();
        let tar = position / per_tar * self.shard.count + self.shard.index;
        tar * per_tar + position % per_tar
    }

    /// Returns the number of pictures of the shard, of this number in all.
    fn len(&self, all: usize) -> usize {
        let per_tar = self.names.per_tar();
        let whole = all / per_tar;
        let Shard { index, count } = self.shard;
        let own = (whole + count - 1 - index) / count;
        // The last archive may be a shorter one.
        own * per_tar + if whole % count == index { all % per_tar } else { 0 }
    }

    /// Returns the number of pictures from a position on that follow each other in the list.
    fn run(&self, position: usize) -> usize {
        let per_tar = self.names.per_tar();
        if self.shard == Shard::WHOLE { usize::MAX } else { per_tar - position % per_tar }
    }
}

impl Plan {
    /// Selects the pictures of a shard. `all` are the rows of the whole list.
    pub(super) fn of(all: &[Arc<Row>], shard: Shard) -> Self {
        let names = all.first().and_then(|row| row.kind.names.tars());
        if let Some(names) = names.map(Arc::clone) {
            let order = TarOrder { names, shard };
            return Self::in_order(all.to_vec(), all, Some(order));
        }
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
        Self::in_order(rows, all, None)
    }

    /// Makes a plan of these rows. `all` are the rows of the whole list.
    fn in_order(rows: Vec<Arc<Row>>, all: &[Arc<Row>], tars: Option<TarOrder>) -> Self {
        let pictures = |row: &Arc<Row>| row.kind.views.len();
        let ends = rows.iter().scan(0, |end, row| {
            *end += pictures(row);
            Some(*end)
        });
        let ends = ends.collect();
        Self { rows, ends, all: all.iter().map(pictures).sum(), tars }
    }

    /// Returns the number of pictures.
    pub(super) fn len(&self) -> usize {
        let all = self.ends.last().copied().unwrap_or(0);
        self.tars.as_ref().map_or(all, |tars| tars.len(all))
    }

    /// Returns the names of the archives that are written, if there are any.
    pub(super) fn tars(&self) -> Option<&Arc<TarNames>> {
        self.tars.as_ref().map(|tars| &tars.names)
    }

    /// Iterates over the numbers of all pictures in the whole list, in the order of drawing. They
    /// are in archives.
    pub(super) fn indexes(&self) -> impl Iterator<Item = usize> {
        (0..self.len()).map(|position| self.place(position))
    }

    /// Returns the place of a picture among those of all rows of this plan.
    fn place(&self, position: usize) -> usize {
        self.tars.as_ref().map_or(position, |tars| tars.index(position))
    }

    /// Returns the rows.
    pub(super) fn rows(&self) -> &[Arc<Row>] {
        &self.rows
    }

    /// Returns the job at a position in the order of drawing.
    pub(super) fn job(&self, position: usize) -> Option<Job> {
        let place = self.place(position);
        let at = self.ends.partition_point(|end| *end <= place);
        let row = Arc::clone(self.rows.get(at)?);
        let begin = self.ends[at] - row.kind.views.len();
        let view = place - begin;
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
        let mut rows: Vec<_> = match &self.tars {
            Some(_) => vec![(0, (0, self.len()))],
            None => self.rows.iter().map(|row| row.number).zip(spans).collect(),
        };
        rows.sort_unstable();
        rows.into_iter().flat_map(|(_, (begin, end))| begin..end)
    }

    /// Returns the position after the pictures of a model, from the position of one of them.
    pub(super) fn end_of_model(&self, position: usize) -> usize {
        let place = self.place(position);
        let at = self.ends.partition_point(|end| *end <= place);
        let Some(row) = self.rows.get(at) else { return self.len() };
        let same = self.rows[at..].iter().take_while(|other| other.file == row.file).count();
        let run = self.tars.as_ref().map_or(usize::MAX, |tars| tars.run(position));
        position + (self.ends[at + same - 1] - place).min(run)
    }

    /// Returns whether no job after a position needs its model.
    pub(super) fn is_last_of_model(&self, position: usize) -> bool {
        // In archives, a model may come again.
        self.tars.is_none() && self.end_of_model(position) == position + 1
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

    #[test]
    fn shards_have_whole_archives_in_the_order_of_the_list_and_each_picture_once() {
        let list = ["a.obj", "b.obj", "a.obj", "--views", "7", "--out", "{shard}.tar"];
        for (per_tar, count) in (1..=22).flat_map(|per_tar| (1..=5).map(move |it| (per_tar, it))) {
            let mut all = Vec::new();
            for index in 0..count {
                let (per_tar, shard) = (per_tar.to_string(), format!("{index}/{count}"));
                let more = ["--per-tar", &*per_tar, "--shard", &*shard];
                let jobs = jobs_of(&[&list[..], &more].concat()).unwrap();
                let own: Vec<usize> = jobs.iter().map(|job| job.index).collect();
                assert!(own.is_sorted(), "{per_tar} {shard}");
                assert!(
                    own.iter().all(|it| it / per_tar.parse::<usize>().unwrap() % count == index)
                );
                assert!(jobs.iter().enumerate().all(|(position, job)| job.position == position));
                all.extend(own);
            }
            all.sort_unstable();
            assert!(all.into_iter().eq(0..21), "{per_tar} {count}");
        }
    }
}
