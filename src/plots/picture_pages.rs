//! Pages of pictures: two pictures with their difference, and the pictures of a batch.
//!
//! The page of a comparison holds its pictures, so it can be sent or kept as an artifact. A batch
//! may have thousands, so its page links to them.

use std::fmt::Write as _;

use super::page::{escaped, head};
use super::report_page::{PICTURE_STYLE, PagePicture, data, slider};

/// A picture of a batch on its page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageCell {
    /// The model, and the view if it has several.
    pub label: String,
    /// The URL of the picture, relative to the page; or the reason why there is none.
    pub picture: Result<String, String>,
}

/// Writes a page about two pictures with a slider between them, the measures as rows of a table,
/// and the picture of their differences.
pub fn compare_page(
    title: &str,
    rows: &[[String; 2]],
    pictures: &[PagePicture; 2],
    difference: &PagePicture,
) -> String {
    let mut text = head(title, PICTURE_STYLE);
    text += "<table>\n";
    for [name, value] in rows {
        let _ = writeln!(text, "<tr><td>{}</td><td>{}</td></tr>", escaped(name), escaped(value));
    }
    let _ = write!(
        text,
        "</table>\n{}<h2>{}</h2>\n<div class=\"pair\"><img alt=\"difference\" \
         src=\"{}\"></div>\n</body></html>\n",
        slider(pictures),
        escaped(&difference.name),
        data(difference)
    );
    text
}

/// Writes a page with the pictures of a batch in rows, the missing ones first.
pub fn sheet_page(title: &str, cells: &[PageCell]) -> String {
    let mut text = head(title, SHEET_STYLE);
    let missing = cells.iter().filter_map(|cell| Some((&cell.label, cell.picture.as_ref().err()?)));
    let missing: Vec<(&String, &String)> = missing.collect();
    if !missing.is_empty() {
        text += "<h2>Missing</h2>\n<table>\n";
    }
    for (label, reason) in &missing {
        let _ = writeln!(text, "<tr><td>{}</td><td>{}</td></tr>", escaped(label), escaped(reason));
    }
    text += if missing.is_empty() { "<main>\n" } else { "</table>\n<main>\n" };
    for PageCell { label, picture } in cells {
        // Browsers load pictures of hidden rows only when the reader scrolls to them.
        let Ok(url) = picture else { continue };
        let (url, label) = (escaped(url), escaped(label));
        let _ = writeln!(
            text,
            "<figure><a href=\"{url}\"><img loading=\"lazy\" alt=\"\" src=\"{url}\"></a>\
             <figcaption>{label}</figcaption></figure>"
        );
    }
    text + "</main>\n</body></html>\n"
}

const SHEET_STYLE: &str = "body{max-width:none}main{display:grid;gap:1rem;margin:1rem 0;\
    grid-template-columns:repeat(auto-fill,minmax(12rem,1fr))}figure{margin:0}\
    img{width:100%;aspect-ratio:1;object-fit:contain}\
    figcaption{font-size:.8rem;overflow-wrap:anywhere}td{text-align:left}";
