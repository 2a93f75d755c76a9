//! Writes one measurement as a single self-contained page: the verdict, the front that one drags, a
//! slider between pictures, the plots, the table, the machine and the command. A teacher can put it
//! on a website as it is.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use super::drag::{FrontPicture, drag};
use super::page::{escaped, head};
use super::{Look, PlotError, svg};
use marraztu_lab::report::{Report, brief, heading};
use marraztu_lab::sweep::Verdict;

/// A picture of the page.
#[derive(Clone, Debug)]
pub struct PagePicture {
    /// Its name: "Default".
    pub name: String,
    /// What it costs and gives: "1.9 ms, error 0.48".
    pub figures: String,
    /// The picture as PNG.
    pub png: Vec<u8>,
}

/// Writes the page. `front` goes from the quickest picture to the most exact one. The last of the
/// pictures is the one that others are compared with; `machine` describes the computer.
///
/// # Errors
/// If a plot cannot be drawn.
pub fn report_page(
    report: &Report,
    (front, pictures): (&[FrontPicture], &[PagePicture]),
    machine: &str,
) -> Result<String, PlotError> {
    let title = format!("What accuracy costs: {}", report.scene);
    let mut text = head(&title, PICTURE_STYLE);
    for sentence in report.verdict() {
        let _ = writeln!(text, "<p>{}</p>", escaped(&sentence));
    }
    text += &drag(front);
    text += &slider(pictures);
    let [light, dark] = [Look::Light, Look::Dark].map(|look| svg(report, look));
    let _ = writeln!(
        text,
        "<h2>Time against error</h2>\n<div class=\"light\">{}</div><div class=\"dark\">{}</div>",
        light?, dark?
    );
    text += "<h2>Every choice</h2>\n";
    text += &table(report);
    let [width, height] = report.findings.size;
    let _ = writeln!(
        text,
        "<h2>How it was measured</h2>\n<p>{}, {width} x {height} pixels. Errors of an axis are \
         relative to the default with this axis alone at its most exact; all others, to the ideal: \
         256 samples per pixel, each lit in 64 bits.</p>\n<pre>{}</pre>\n</body></html>",
        escaped(machine),
        escaped(&report.command)
    );
    Ok(text)
}

pub(super) const PICTURE_STYLE: &str = ".pair{position:relative;line-height:0}.pair img{width:100%;\
    image-rendering:pixelated}.pair img+img{position:absolute;left:0;top:0;\
    clip-path:inset(0 0 0 var(--cut,50%))}input[type=range]{width:100%}";

/// Writes two pictures, one over the other, a slider for the border between them, and a choice of
/// the left one.
pub(super) fn slider(pictures: &[PagePicture]) -> String {
    let [others @ .., last] = pictures else { return String::new() };
    let mut text = "<h2>Compare</h2>\n<p><label>Left: <select id=\"left\">".to_owned();
    for picture in others {
        let _ = write!(
            text,
            "<option value=\"{}\">{} ({})</option>",
            data(picture),
            escaped(&picture.name),
            escaped(&picture.figures)
        );
    }
    // The script shows the first picture, which is thus in the page once.
    let _ = write!(
        text,
        "</select></label> Right: {} ({})</p>\n<div class=\"pair\"><img id=\"a\" alt=\"left\">\
         <img id=\"b\" alt=\"right\" src=\"{}\"></div>\n<input type=\"range\" \
         id=\"cut\" min=\"0\" max=\"100\" value=\"50\" \
         aria-label=\"Border between the pictures\">\n\
         <script>const e=i=>document.getElementById(i);\
         e('cut').oninput=()=>e('b').style.setProperty('--cut',e('cut').value+'%');\
         const show=()=>e('a').src=e('left').value;e('left').onchange=show;show();</script>\n",
        escaped(&last.name),
        escaped(&last.figures),
        data(last)
    );
    text
}

/// Returns the URL of a picture that is part of the page.
pub(super) fn data(picture: &PagePicture) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&picture.png))
}

/// Writes the rows of the report as a table.
fn table(report: &Report) -> String {
    let mut text = "<table>\n<tr><th>choice</th><th>time</th><th>ms</th><th>maximum</th>\
                    <th>RMSE</th><th>bytes</th><th>FLIP</th></tr>\n"
        .to_owned();
    let mut last = String::new();
    for row in report.rows() {
        let heading = heading(row);
        if heading != last {
            let _ = writeln!(text, "<tr><th colspan=\"7\">{}</th></tr>", escaped(&heading));
            last = heading;
        }
        let point = &report.findings.points[row.point];
        let (whole, flip) = (&row.error.whole, row.error.flip);
        let time = match point.verdict {
            _ if row.error.is_incomplete() => {
                format!("lacks surfaces</td><td>{}", brief(point.ms))
            }
            Verdict::Busy => "too busy to tell".to_owned(),
            Verdict::Faster | Verdict::Slower | Verdict::Alike => {
                format!("{:.2}x</td><td>{}", point.ratio.quartiles.median, brief(point.ms))
            }
        };
        let is_busy = point.verdict == Verdict::Busy && !row.error.is_incomplete();
        let columns = if is_busy { 2 } else { 1 };
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td colspan=\"{columns}\">{time}</td><td>{}</td><td>{}</td><td>{}%</td>\
             <td>{}</td></tr>",
            escaped(&row.name),
            whole.largest,
            brief(whole.rmse),
            brief(whole.differing * 100.0),
            brief(flip)
        );
    }
    text + "</table>\n"
}
