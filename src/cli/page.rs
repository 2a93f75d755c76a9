//! The files of pages: where they are written, and how they link to pictures.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Component, Path};

use marraztu_io::{NewFile, SaveError, Sources};

use super::failure::{Failure, usage};

/// The first letters of a page.
const BEGIN: &str = "<!doctype html";

/// Checks that a page may be written to `path`: the name is that of a page, and an existing file is
/// a page, or empty, and not an input. Fails if the name is another one, or the existing file.
pub(super) fn check_page(path: &Path, sources: &Sources) -> Result<(), Failure> {
    sources.spare(path)?;
    let mut begin = Vec::new();
    if let Ok(file) = std::fs::File::open(path) {
        let read = file.take(BEGIN.len() as u64).read_to_end(&mut begin);
        let is_page = begin.is_empty() || begin.eq_ignore_ascii_case(BEGIN.as_bytes());
        if read.is_err() || !is_page {
            return Err(usage(&format!(
                "{}: a file with this name exists and is not a page; choose another name",
                path.display()
            )));
        }
    }
    let ending = path.extension().unwrap_or_default();
    if !["html", "htm"].iter().any(|html| ending.eq_ignore_ascii_case(html)) {
        return Err(usage(&format!("{}: the name of a page ends with .html", path.display())));
    }
    Ok(())
}

/// Writes a page. Fails if it cannot be written; an existing file is unchanged.
pub(super) fn write_page(path: &Path, page: &str) -> Result<(), SaveError> {
    let mut file = NewFile::begin(path)?;
    file.push(page.as_bytes())?;
    file.finish()
}

/// Returns the URL of a file, relative to a page.
pub(super) fn relative_url(page: &Path, file: &Path) -> String {
    let mut url = String::new();
    for (i, part) in parts_between(page, file).iter().enumerate() {
        url += if i == 0 { "" } else { "/" };
        for byte in part.to_string_lossy().bytes() {
            // Writing to a string cannot fail.
            let _ = match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
                    write!(url, "{}", char::from(byte))
                }
                _ => write!(url, "%{byte:02X}"),
            };
        }
    }
    url
}

/// Returns the parts of the path from the folder of one file to another file.
pub(super) fn parts_between(from: &Path, to: &Path) -> Vec<OsString> {
    let (mut from, mut to) = (components(from), components(to));
    from.pop();
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n(OsString::from(".."), from.len() - common);
    up.chain(to.drain(common..)).collect()
}

/// Returns the parts of an absolute path, without the root and without "..".
fn components(path: &Path) -> Vec<OsString> {
    let mut parts = Vec::new();
    for part in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        match part {
            Component::ParentDir => _ = parts.pop(),
            Component::RootDir | Component::CurDir => {}
            Component::Prefix(_) | Component::Normal(_) => parts.push(part.as_os_str().to_owned()),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_relative_to_the_page_and_encoded() {
        for (page, file, url) in [
            ("page.html", "out/a.png", "out/a.png"),
            ("pages/page.html", "out/a b#1.png", "../out/a%20b%231.png"),
            ("out/page.html", "out/a.png", "a.png"),
            ("a/../page.html", "./b/../out/\u{e9}.png", "out/%C3%A9.png"),
            ("/x/y/page.html", "/x/z/a.png", "../z/a.png"),
        ] {
            assert_eq!(relative_url(Path::new(page), Path::new(file)), url, "{page} {file}");
        }
    }
}
