//! Paths in scene files: relative to the file's folder, with slashes.

use std::path::{Component, Path, PathBuf, Prefix};

/// Removes `.` and resolves `..` in a path, without disk access. On Windows, the prefix `\\?\` of
/// canonical paths is removed, since few programs understand it.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::Prefix(prefix) => match prefix.kind() {
                Prefix::VerbatimDisk(letter) => plain.push(format!("{}:", char::from(letter))),
                Prefix::VerbatimUNC(server, share) => {
                    plain.push(Path::new(r"\\").join(server).join(share));
                }
                _ => plain.push(part),
            },
            Component::ParentDir
                if matches!(plain.components().next_back(), Some(Component::Normal(_))) =>
            {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// Makes `path` relative to `folder`, both absolute; `path` itself if they have no common root.
/// `None` if it is not UTF-8.
pub(super) fn relative(folder: &Path, path: &Path) -> Option<String> {
    let (folder, path) = (plain(folder), plain(path));
    let ours: Vec<Component<'_>> = folder.components().collect();
    let theirs: Vec<Component<'_>> = path.components().collect();
    let common = ours.iter().zip(&theirs).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path.to_str().map(|text| text.replace('\\', "/"));
    }
    let up = ours[common..].iter().map(|_| Some(".."));
    let down = theirs[common..].iter().map(|part| part.as_os_str().to_str());
    let parts: Option<Vec<&str>> = up.chain(down).collect();
    parts.map(|parts| parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_seen_from_a_folder_leads_back_to_it() {
        for (folder, path, text) in [
            ("/a/b", "/a/b/c.obj", "c.obj"),
            ("/a/b", "/a/c/d e.obj", "../c/d e.obj"),
            ("/a/b", "/x/c.obj", "../../x/c.obj"),
            ("/a/./b/../c", "/a/c/d.obj", "d.obj"),
        ] {
            let relative = relative(Path::new(folder), Path::new(path)).unwrap();
            assert_eq!(relative, text);
            assert_eq!(plain(&Path::new(folder).join(relative)), Path::new(path));
        }
    }

    #[cfg(windows)]
    #[test]
    fn paths_of_windows_have_slashes_in_scene_files_and_no_verbatim_prefix() {
        for (folder, path, text) in [
            (r"C:\a\b", r"c:\a\c\d e.obj", "../c/d e.obj"),
            (r"C:\a", r"\\?\C:\a\c.obj", "c.obj"),
            (r"C:\a", r"D:\c.obj", "D:/c.obj"),
            (r"\\server\all\a", r"\\?\UNC\server\all\c.obj", "../c.obj"),
            (r"C:\a", r"\\server\all\c.obj", "//server/all/c.obj"),
        ] {
            assert_eq!(relative(Path::new(folder), Path::new(path)).unwrap(), text);
        }
    }
}
