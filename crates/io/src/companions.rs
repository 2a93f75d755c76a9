//! Lists the files that a model refers to, without loading it.
//!
//! A batch needs to know whether a picture is up to date before it loads the model. Searching the
//! text for `mtllib` takes a small part of the time of parsing it. Names without a file are listed,
//! too: the picture changes if the file appears later.
//!
//! The list may name more files than loading reads, such as the MTL file with the model's name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use memchr::memmem;

use super::error::{LoadError, shown};
use super::locate::{Locator, of_model};
use super::mtl::map_names;
use super::obj::lines::{Lines, unmarked};
use super::packed::{model_name, unpacked};
use super::progress::Progress;
use super::read::{MOST_WORDS, read, utf_8};

/// A file that a model refers to.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Companion {
    /// The name, as the model or its MTL file gives it.
    pub name: String,
    /// The file, if it was found.
    pub path: Option<PathBuf>,
    /// The folders that were searched, in this order.
    pub folders: Vec<PathBuf>,
}

/// Lists the MTL files and textures of the model at `path`, in the order of their names.
///
/// # Errors
/// If the model cannot be read.
pub fn companions(path: &Path) -> Result<Vec<Companion>, LoadError> {
    let file = shown(path);
    let text = unpacked(path, &file, &Progress::new())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders = vec![folder.to_owned()];
    let mut locator = Locator::default();
    // Files of one name may lie in several folders.
    let mut found = BTreeMap::new();
    for names in libraries(&utf_8(text)) {
        let all = locator.locate_all(folder, &names, ".mtl").into_iter();
        found.extend(all.map(|named| (named, folders.clone())));
    }
    // Loading falls back to the MTL file with the model's name.
    let stem = model_name(&file);
    let own_path = of_model(folder, &stem, "mtl");
    found.entry((format!("{stem}.mtl"), own_path)).or_insert(folders);
    let libraries: Vec<PathBuf> = found.keys().filter_map(|(_, path)| path.clone()).collect();
    for library in libraries {
        // An unreadable MTL file is a finding of the model, which has no further files then.
        let Ok(text) = read(&library, MOST_WORDS, &Progress::new()) else { continue };
        let folders = [library.parent().unwrap_or(Path::new("")), folder];
        for name in map_names(&utf_8(text)) {
            let path = folders.into_iter().find_map(|folder| locator.locate(folder, &name));
            found.insert((name, path), folders.map(Path::to_owned).to_vec());
        }
    }
    let companion = |((name, path), folders)| Companion { name, path, folders };
    Ok(found.into_iter().map(companion).collect())
}

/// Returns the names in `mtllib` statements, once each.
fn libraries(text: &[u8]) -> Vec<String> {
    let (text, mut names) = (unmarked(text), Vec::new());
    for at in memmem::find_iter(text, b"mtllib") {
        // A statement starts its line, possibly after blanks.
        let begin = text[..at].iter().rposition(|byte| !matches!(byte, b' ' | b'\t'));
        if begin.is_some_and(|last| !matches!(text[last], b'\n' | b'\r')) {
            continue;
        }
        if let Some(line) = Lines::new(&text[at..]).next() {
            let name = line.name();
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mtl_files_and_textures_are_listed_whether_they_exist_or_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let text =
            "# mtllib no.mtl\nmtllib a.mtl b.mtl\nv 0 0 0\n  mtllib c.mtl\nmtllib a.mtl b.mtl\n";
        std::fs::write(at("m.obj"), text).unwrap();
        std::fs::write(at("a.mtl"), "newmtl a\nmap_Kd -s 1 1 1 wood.png\nbump gone.png\n").unwrap();
        std::fs::write(at("m.mtl"), "newmtl m\n").unwrap();
        std::fs::write(at("wood.png"), "").unwrap();
        let listed = companions(&at("m.obj")).unwrap();
        let listed: Vec<_> = listed.into_iter().map(|it| (it.name, it.path)).collect();
        let found = |name: &str| (name.to_owned(), Some(at(name)));
        let missing = |name: &str| (name.to_owned(), None);
        let expected = [
            found("a.mtl"),
            missing("b.mtl"),
            missing("c.mtl"),
            missing("gone.png"),
            found("m.mtl"),
            found("wood.png"),
        ];
        assert_eq!(listed, expected);
        assert!(companions(&at("absent.obj")).is_err());
    }

    #[test]
    fn a_byte_order_mark_hides_no_statement_and_files_of_one_name_are_all_listed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("m.obj"), "\u{feff}mtllib a/a.mtl\nmtllib b/b.mtl\n").unwrap();
        for name in ["a", "b"] {
            std::fs::create_dir(at(name)).unwrap();
            std::fs::write(at(&format!("{name}/{name}.mtl")), "newmtl m\nmap_Kd t.png\n").unwrap();
            std::fs::write(at(&format!("{name}/t.png")), "").unwrap();
        }
        let listed = companions(&at("m.obj")).unwrap();
        let found: Vec<_> = listed.into_iter().filter_map(|it| it.path).collect();
        assert_eq!(found, ["a/a.mtl", "b/b.mtl", "a/t.png", "b/t.png"].map(at));
    }

    #[test]
    fn a_texture_is_searched_in_the_folder_of_its_mtl_file_first() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("looks")).unwrap();
        std::fs::write(at("m.obj"), "mtllib looks/a.mtl\n").unwrap();
        std::fs::write(at("looks/a.mtl"), "newmtl a\nmap_Kd gone.png\n").unwrap();
        let listed = companions(&at("m.obj")).unwrap();
        let texture = listed.into_iter().find(|it| it.name == "gone.png").unwrap();
        assert_eq!(texture.folders, [at("looks"), folder.path().to_owned()]);
    }
}
