//! Lists the files that a page has to fetch.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use marraztu_io::{Progress, SCENE_ENDING, companions, is_example, open};

/// Lists the files that a model or a scene refers to and that do not exist: for each one, the paths
/// at which it may be.
pub(crate) fn missing(path: &Path) -> Vec<Vec<PathBuf>> {
    if path.extension().is_none_or(|ending| ending != SCENE_ENDING) {
        return of_model(path);
    }
    // The editor reports a file that cannot be read.
    let Ok(opened) = open(path, &Progress::new()) else { return Vec::new() };
    let scene = opened.scene;
    let lost = scene.missing_files().into_iter().map(|path| vec![path.to_owned()]);
    let models = scene.objects.iter().map(|(_, object)| &object.model);
    let read = models.filter(|model| !model.is_placeholder());
    let sources: BTreeSet<&Path> = read.filter_map(|model| model.source.as_deref()).collect();
    let own = sources.into_iter().filter(|source| !is_example(source));
    lost.chain(own.flat_map(of_model)).collect()
}

/// Lists the MTL files and textures of a model that do not exist.
fn of_model(path: &Path) -> Vec<Vec<PathBuf>> {
    let missing = companions(path).into_iter().flatten().filter(|it| it.path.is_none());
    let places = missing.map(|companion| {
        // Folders of another computer are unknown here, but the file may be without them.
        let name = companion.name.replace('\\', "/");
        let last = name.rsplit('/').next().unwrap_or(&name);
        let in_folder = |folder: &PathBuf| [folder.join(&name), folder.join(last)];
        companion.folders.iter().flat_map(in_folder).collect::<Vec<_>>()
    });
    places.collect()
}
