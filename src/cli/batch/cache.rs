//! The loaded models of a batch, within a limit of memory.
//!
//! Jobs of one model share it. If the models exceed the limit, the ones used longest ago are
//! dropped. Threads that need a model while another thread loads it wait for it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use marraztu_core::scene::{Mesh, Object, Texture};
use marraztu_io::{self as io, Progress};
use marraztu_render::accel::Accelerated as _;

use super::digest::SourceHash;
use super::outcome::Fault;
use super::report::shown;
use super::rows::Row;
use crate::cli::render::cover;
use crate::cli::stage::{Stage, Watch};

/// A scene with its surfaces, before a camera is placed.
#[derive(Debug)]
pub(super) struct LoadedStage {
    pub(super) stage: Stage,
    /// The hashes of the files, from before they were read.
    pub(super) source: SourceHash,
}

/// A scene; or the reason why it cannot be loaded.
type Loaded = Result<Arc<LoadedStage>, Fault>;

/// A file, and the options that its loaded scene depends on.
type Key = (PathBuf, String);

/// The models of a batch.
#[derive(Debug)]
pub(super) struct StageCache {
    /// The limit in bytes.
    most: usize,
    entries: Mutex<Entries>,
}

#[derive(Debug, Default)]
struct Entries {
    map: BTreeMap<Key, Entry>,
    /// The keys by the time of their last request.
    order: BTreeMap<u64, Key>,
    /// The number of requests, as a clock.
    clock: u64,
    /// The sum over all entries.
    bytes: usize,
}

#[derive(Debug, Default)]
struct Entry {
    loaded: Arc<Mutex<Option<Loaded>>>,
    /// The size of the model or of its error; 0 until it is loaded.
    bytes: usize,
    used: u64,
}

/// The size at which the error of a model that cannot be loaded is counted.
const BYTES_OF_ERROR: usize = 1024;

impl StageCache {
    pub(super) fn new(most: usize) -> Self {
        Self { most, entries: Mutex::default() }
    }

    /// Returns the scene of a row, and loads it if necessary. `stopped` says whether reading was
    /// cancelled because the batch ends; otherwise, the time limit was reached.
    pub(super) fn get(&self, row: &Row, progress: &Progress, stopped: &AtomicBool) -> Loaded {
        let key = (row.file.clone(), row.kind.parsed.model_text.clone());
        let slot = {
            let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
            entries.request(&key)
        };
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(loaded) = &*slot {
            return loaded.clone();
        }
        let mut loaded = load(row, progress);
        if matches!(loaded, Err(Fault::Cancelled)) {
            if stopped.load(Ordering::Relaxed) {
                return loaded;
            }
            // Further views of the model would take as long.
            loaded = Err(Fault::Timeout(shown(&row.file)));
        }
        *slot = Some(loaded.clone());
        drop(slot);
        let bytes = loaded.as_ref().map_or(BYTES_OF_ERROR, |loaded| bytes_of(&loaded.stage));
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        entries.keep(&key, bytes, self.most);
        drop(entries);
        loaded
    }

    /// Drops the scenes of a file. Another request loads it again.
    pub(super) fn forget(&self, done: &Path) {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner).forget(done);
    }

    /// Returns whether `count` models like this file fit within the limit.
    pub(super) fn has_room_for(&self, file: &Path, count: usize) -> bool {
        // A loaded model takes about this many times the bytes of its file.
        const GROWTH: usize = 6;
        let size = file.metadata().map_or(0, |metadata| metadata.len());
        let size = usize::try_from(size).unwrap_or(usize::MAX);
        size.saturating_mul(GROWTH).saturating_mul(count) <= self.most
    }
}

impl Entries {
    /// Returns the slot of a model, and counts the request as its last one.
    fn request(&mut self, key: &Key) -> Arc<Mutex<Option<Loaded>>> {
        self.clock += 1;
        let entry = self.map.entry(key.clone()).or_default();
        self.order.remove(&entry.used);
        entry.used = self.clock;
        self.order.insert(self.clock, key.clone());
        Arc::clone(&entry.loaded)
    }

    /// Drops the scenes of a file.
    fn forget(&mut self, done: &Path) {
        let gone: Vec<Key> = self.map.keys().filter(|(file, _)| file == done).cloned().collect();
        for entry in gone.iter().filter_map(|key| self.map.remove(key)) {
            self.order.remove(&entry.used);
            self.bytes -= entry.bytes;
        }
    }

    /// Notes the size of a new model, and drops others above the limit of `most` bytes. Models that
    /// are being loaded stay: there are at most as many as threads.
    fn keep(&mut self, new: &Key, bytes: usize, most: usize) {
        if let Some(entry) = self.map.get_mut(new) {
            entry.bytes = bytes;
            self.bytes += bytes;
        }
        while self.bytes > most {
            let is_loaded = |key: &Key| self.map.get(key).is_some_and(|entry| entry.bytes > 0);
            let mut others = self.order.iter().filter(|(_, key)| *key != new && is_loaded(key));
            let Some((&used, _)) = others.next() else { return };
            let dropped = self.order.remove(&used).and_then(|key| self.map.remove(&key));
            self.bytes -= dropped.map_or(0, |entry| entry.bytes);
        }
    }
}

/// Loads the scene of a row, with its surfaces.
fn load(row: &Row, progress: &Progress) -> Loaded {
    let options = &row.kind.parsed.options;
    let files = [row.file.clone()];
    let source = SourceHash::of(row);
    let stage = Stage::of(&files, &options.scene.reading, Watch::Progress(progress));
    let stage = stage.and_then(|mut stage| {
        cover(&mut stage, &options.scene.surfaces)?;
        // Findings about the texture of the options come last.
        stage.findings = io::joined(std::mem::take(&mut stage.findings));
        for (_, object) in stage.scene.objects.iter() {
            object.model.mesh.draw_as_filed();
        }
        Ok(stage)
    });
    let stage = stage.map_err(|failure| Fault::of(&failure))?;
    let source = source.ok_or_else(|| Fault::Input("the model cannot be read".to_owned()))?;
    Ok(Arc::new(LoadedStage { stage, source }))
}

/// Estimates the memory of a scene.
fn bytes_of(stage: &Stage) -> usize {
    let mut textures: BTreeMap<&Path, usize> = BTreeMap::new();
    let mut bytes = 0;
    for (_, object) in stage.scene.objects.iter() {
        bytes += bytes_of_mesh(&object.model.mesh);
        for texture in textures_of(object) {
            // Four bytes a texel, and a third more for the smaller copies.
            textures.insert(&texture.source, texture.picture.size().area() * 16 / 3);
        }
    }
    bytes + textures.values().sum::<usize>()
}

/// Estimates the memory of a mesh with the structures that drawing builds for it.
fn bytes_of_mesh(mesh: &Mesh) -> usize {
    const OF_VERTEX: usize = 64;
    const OF_CORNER: usize = 64;
    const OF_TRIANGLE: usize = 128;
    OF_VERTEX * mesh.positions().len()
        + OF_CORNER * mesh.corners().len()
        + OF_TRIANGLE * mesh.triangle_count()
}

fn textures_of(object: &Object) -> impl Iterator<Item = &Texture> {
    let of_material = object.model.materials.iter().flat_map(|material| {
        let maps = material.maps.values().map(|map| &*map.texture);
        material.texture.as_deref().into_iter().chain(maps)
    });
    object.texture.as_deref().into_iter().chain(of_material)
}

#[cfg(test)]
mod tests {
    use super::super::tests::jobs_of;
    use super::*;

    #[test]
    fn models_above_the_limit_are_dropped_and_a_single_large_one_is_still_loaded() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a.obj", "b.obj", "c.obj"].map(|name| folder.path().join(name));
        for file in &files {
            std::fs::write(file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        }
        let names: Vec<&str> = files.iter().map(|file| file.to_str().unwrap()).collect();
        let jobs = jobs_of(&names).unwrap();
        for (most, kept) in [(1, 1), (usize::MAX, 3)] {
            let cache = StageCache::new(most);
            for job in &jobs {
                let loaded = cache.get(&job.row, &Progress::new(), &AtomicBool::new(false));
                assert_eq!(loaded.unwrap().stage.scene.objects.len(), 1);
            }
            let entries = cache.entries.lock().unwrap();
            assert_eq!(entries.map.len(), kept, "limit {most}");
            assert_eq!(entries.order.len(), kept, "limit {most}");
            assert_eq!(entries.bytes, entries.map.values().map(|entry| entry.bytes).sum::<usize>());
        }
        // Models that are done take no memory.
        let cache = StageCache::new(usize::MAX);
        for job in &jobs {
            let loaded = cache.get(&job.row, &Progress::new(), &AtomicBool::new(false));
            assert!(loaded.is_ok());
            cache.forget(&job.row.file);
            let entries = cache.entries.lock().unwrap();
            assert_eq!((entries.map.len(), entries.order.len(), entries.bytes), (0, 0, 0));
        }
        // A model is read once: the second request does not see that the file is gone.
        let cache = StageCache::new(usize::MAX);
        let get = |stopped: bool, progress: &Progress| {
            cache.get(&jobs[0].row, progress, &AtomicBool::new(stopped)).map(drop)
        };
        assert_eq!(get(false, &Progress::new()), Ok(()));
        std::fs::remove_file(&files[0]).unwrap();
        assert_eq!(get(false, &Progress::new()), Ok(()));
        // A load that is cancelled at its limit is not repeated; one that is stopped leaves
        // nothing.
        let cancelled = Progress::new();
        cancelled.cancel();
        let other = |stopped, progress: &Progress| {
            cache.get(&jobs[1].row, progress, &AtomicBool::new(stopped)).map(drop)
        };
        let late = Fault::Timeout(shown(&files[1]));
        assert_eq!(other(true, &cancelled), Err(Fault::Cancelled));
        assert_eq!(other(false, &cancelled), Err(late.clone()));
        assert_eq!(other(false, &Progress::new()), Err(late.clone()));
    }

    #[test]
    fn models_that_cannot_be_loaded_are_dropped_like_others() {
        let folder = tempfile::tempdir().unwrap();
        let names: Vec<String> = (0..50)
            .map(|i| {
                let file = folder.path().join(format!("{i}.obj"));
                std::fs::write(&file, "f 1 2 3\n").unwrap();
                file.to_str().unwrap().to_owned()
            })
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let cache = StageCache::new(10 * BYTES_OF_ERROR);
        for job in &jobs_of(&names).unwrap() {
            std::fs::remove_file(&job.row.file).unwrap();
            // A second request is answered with the same error, without reading.
            for _ in 0..2 {
                cache.get(&job.row, &Progress::new(), &AtomicBool::new(false)).unwrap_err();
            }
        }
        let entries = cache.entries.lock().unwrap();
        assert_eq!((entries.map.len(), entries.order.len()), (10, 10));
        assert_eq!(entries.bytes, 10 * BYTES_OF_ERROR);
    }
}
