//! Describes a file as plain text, for `marraztu info FILE`: [`ModelFacts`] in words.

use std::fmt::Write;

use super::facts::{EdgeFacts, FaceFacts, MaterialFacts, ModelFacts, PartFacts, SmoothingFacts};
use super::findings::Finding;
use super::loaded::Loaded;
use marraztu_core::scene::{Model, UpAxis};

/// Lists the shape, parts, materials and findings of a loaded file, line by line.
pub fn describe(loaded: &Loaded) -> String {
    describe_model(&loaded.model, &loaded.findings)
}

/// Lists the shape, parts and materials of a model, and findings, line by line.
pub fn describe_model(model: &Model, findings: &[Finding]) -> String {
    let facts = ModelFacts::of(model, findings);
    let mut text = Text::default();
    text.line("name", &facts.name);
    if let Some(source) = &model.source {
        text.line("file", &source.display().to_string());
    }
    if let Some(shape) = facts.shape {
        text.line("shape", shape);
    }
    describe_options(&facts, &mut text);
    describe_mesh(&facts, &mut text);
    if let Some([r, g, b]) = facts.edge_color {
        text.line("edges drawn in", &format!("({r}, {g}, {b})"));
    }
    text.head("parts", facts.parts.len());
    facts.parts.iter().take(MOST).for_each(|part| text.item(&describe_part(part)));
    text.more(facts.parts.len());
    text.head("materials", facts.materials.len());
    facts.materials.iter().take(MOST).for_each(|it| text.item(&describe_material(it)));
    text.more(facts.materials.len());
    if findings.is_empty() {
        text.line("findings", "none");
    } else {
        text.head("findings", findings.len());
        for finding in findings {
            text.item(&finding.to_string());
        }
    }
    text.0
}

/// Lines of a label and its value.
#[derive(Default)]
struct Text(String);

/// The width of the labels.
const LABEL: usize = 16;

/// The most parts and materials that are listed; `MakeHuman`'s body alone has 139 parts.
const MOST: usize = 200;

impl Text {
    fn line(&mut self, label: &str, value: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{label:LABEL$}{value}");
    }

    fn head(&mut self, label: &str, count: usize) {
        self.line(label, &grouped(count));
    }

    fn item(&mut self, value: &str) {
        let _ = writeln!(self.0, "  {value}");
    }

    fn more(&mut self, all: usize) {
        if all > MOST {
            self.item(&format!("... and {} more", grouped(all - MOST)));
        }
    }
}

fn describe_options(facts: &ModelFacts, text: &mut Text) {
    let mut options = Vec::new();
    let read_with = &facts.read_with;
    if read_with.up != UpAxis::default().word() {
        options.push(format!("{} is up", read_with.up.to_uppercase()));
    }
    let scale = read_with.scale;
    if (scale - 1.0).abs() > 0.0 && facts.file.is_some() {
        options.push(format!("scaled by {scale}"));
    }
    if read_with.flip_winding {
        options.push("winding reversed".to_owned());
    }
    if !options.is_empty() {
        text.line("read with", &options.join(", "));
    }
}

fn describe_mesh(facts: &ModelFacts, text: &mut Text) {
    text.line("vertices", &grouped(facts.vertices));
    text.line("faces", &faces(&facts.faces));
    text.line("triangles", &grouped(facts.faces.drawn_triangles));
    for (label, count) in [("lines", facts.lines), ("points", facts.points)] {
        if count > 0 {
            text.line(label, &grouped(count));
        }
    }
    let place = |[x, y, z]: [f64; 3]| format!("({}, {}, {})", short(x), short(y), short(z));
    match &facts.bounds {
        None => text.line("box", "none"),
        Some(bounds) => {
            text.line("box", &format!("{} to {}", place(bounds.min), place(bounds.max)));
            if facts.offset != [0.0; 3] {
                let offset = place(facts.offset);
                text.line("offset", &format!("{offset}, which positions are stored relative to"));
            }
            text.line("size", &bounds.size.map(short).join(" x "));
        }
    }
    let yes = |present: bool| if present { "yes" } else { "no" };
    text.line("normals", if facts.file_normals { "the file's" } else { "computed" });
    text.line("smoothing", &smoothing(&facts.smoothing));
    text.line("texture coords", yes(facts.texture_coordinates));
    text.line("vertex colours", yes(facts.vertex_colors));
    text.line("closed", &closed(&facts.edges));
}

/// Describes smoothing, such as "crease 60 degrees" or "3 groups".
fn smoothing(smoothing: &SmoothingFacts) -> String {
    match smoothing {
        SmoothingFacts::FileNormals => "by the file's normals".to_owned(),
        SmoothingFacts::Crease(crease) => format!("crease {} degrees", short(*crease)),
        SmoothingFacts::Groups(0) => "off".to_owned(),
        SmoothingFacts::Groups(count) => number_of(*count, "group"),
    }
}

/// Counts faces by size, such as "12,480 (480 triangles, 12,000 quads)".
fn faces(faces: &FaceFacts) -> String {
    let counts = [
        (faces.triangles, "triangle", String::new()),
        (faces.quads, "quad", String::new()),
        (faces.larger, "n-gon", format!(" of up to {} corners", faces.most_corners)),
    ];
    let kinds: Vec<String> = counts
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, name, more)| format!("{}{more}", number_of(count, name)))
        .collect();
    let all = grouped(faces.all);
    if kinds.is_empty() { all } else { format!("{all} ({})", kinds.join(", ")) }
}

/// Says whether the surface is closed, as for back-face culling, and counts the edges that do not
/// have two polygons.
fn closed(edges: &EdgeFacts) -> String {
    let EdgeFacts { closed, all, of_one_face, of_more_than_two, split } = *edges;
    if all == 0 {
        return "no: there are no edges".to_owned();
    }
    let all = number_of(all, "edge");
    let yes = if closed { "yes" } else { "no" };
    if of_one_face == 0 && of_more_than_two == 0 {
        let turned = if closed { "" } else { "; some neighbours have opposite windings" };
        return format!("{yes} ({all}, each of two faces{turned})");
    }
    let mut faults = Vec::new();
    if of_one_face > 0 {
        faults.push(format!("{} of one face", grouped(of_one_face)));
    }
    if of_more_than_two > 0 {
        faults.push(format!("{} of more than two", grouped(of_more_than_two)));
    }
    match split {
        0 => {}
        1 => faults.push("1 edge is split by corners of other faces: gaps may show".to_owned()),
        n => faults.push(format!(
            "{} edges are split by corners of other faces: gaps may show",
            grouped(n)
        )),
    }
    format!("{yes} ({all}: {})", faults.join(", "))
}

fn describe_part(part: &PartFacts) -> String {
    let PartFacts { name, faces, lines, points, material } = part;
    let mut content = Vec::new();
    if *faces > 0 || lines + points == 0 {
        content.push(number_of(*faces, "face"));
    }
    let strokes = [(*lines, "line"), (*points, "point")];
    let some = strokes.into_iter().filter(|(count, _)| *count > 0);
    content.extend(some.map(|(count, name)| number_of(count, name)));
    let material = material.as_ref().map_or_else(
        || "no material: silver".to_owned(),
        |material| format!("material \"{material}\""),
    );
    format!("\"{name}\": {}, {material}", content.join(", "))
}

fn describe_material(material: &MaterialFacts) -> String {
    let MaterialFacts { name, ambient, diffuse, specular, exponent, emission, .. } = material;
    let color = |color: &[f64; 3]| color.map(short).join(" ");
    let mut text = format!(
        "\"{name}\": Ka {}, Kd {}, Ks {}, Ns {}",
        color(ambient),
        color(diffuse),
        color(specular),
        short(*exponent)
    );
    if *emission != [0.0; 3] {
        let _ = write!(text, ", Ke {}", color(emission));
    }
    if material.unlit {
        text.push_str(", not lit");
    }
    if material.opacity < 1.0 {
        let _ = write!(text, ", d {}", short(material.opacity));
        text.push_str(if material.opacity == 0.0 { " (draws nothing)" } else { " (transparent)" });
    }
    for map in &material.maps {
        let _ = write!(text, ", {} {} ({} x {})", map.kind, map.file, map.width, map.height);
    }
    text
}

/// Formats a count with its noun, such as "1 face" or "2,000 faces".
fn number_of(count: usize, name: &str) -> String {
    format!("{} {name}{}", grouped(count), if count == 1 { "" } else { "s" })
}

/// Formats a count with a comma before each three digits.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Formats a number with at most six significant digits.
pub fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let exact: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    if (1e-4..1e7).contains(&exact.abs()) { exact.to_string() } else { format!("{exact:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Progress, parse};
    use marraztu_core::scene::LoadOptions;

    #[test]
    fn numbers_are_short_and_counts_are_grouped() {
        assert_eq!(
            [0.1 + 0.2, -1234.5678, 0.000_05, 2e9].map(short),
            ["0.3", "-1234.57", "5e-5", "2e9"]
        );
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn a_pyramid_is_described_line_by_line() {
        let pyramid = "v 0 2 0\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -1 0 1\ng sides\nf 1 5 2\nf 1 2 3\n\
                       f 1 3 4\nf 1 4 5\ng base\nf 2 5 4 3\nf 1 2 99\n";
        let options = LoadOptions::default();
        let loaded = parse(pyramid.as_bytes(), "pyramid.obj", None, &options, &Progress::new());
        let expected = "\
name            pyramid
vertices        5
faces           5 (4 triangles, 1 quad)
triangles       6
box             (-1, 0, -1) to (1, 2, 1)
size            2 x 2 x 2
normals         computed
smoothing       crease 60 degrees
texture coords  no
vertex colours  no
closed          yes (8 edges, each of two faces)
parts           2
  \"sides\": 4 faces, no material: silver
  \"base\": 1 face, no material: silver
materials       0
findings        1
  pyramid.obj: a face refers to a vertex that the file does not have and is skipped (line 13)
";
        assert_eq!(describe(&loaded.unwrap()), expected);
    }

    #[test]
    fn a_model_is_called_closed_if_its_back_faces_are_left_out() {
        let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
        let sides = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n";
        let split = "v 0 0 0\nv 0 0 1\nv 0 1 1\nv 0 1 0\n";
        for (text, is_closed) in [
            (format!("{cube}{sides}f 4 1 5 8\n"), true),
            // The last side has its own vertices, as in files that split them at seams.
            (format!("{cube}{sides}{split}f -1 -4 -3 -2\n"), true),
            (format!("{cube}{sides}"), false),
            // One side is turned: each edge has two faces, but they disagree.
            (format!("{cube}{sides}f 8 5 1 4\n"), false),
            // A wall in two directions inside the cube: some edges have four faces.
            (format!("{cube}{sides}f 4 1 5 8\nf 1 2 7 8\nf 8 7 2 1\n"), true),
        ] {
            let options = LoadOptions::default();
            let loaded = parse(text.as_bytes(), "a.obj", None, &options, &Progress::new());
            let model = loaded.unwrap().model;
            assert_eq!(model.mesh.is_closed(), is_closed, "{text}");
            let yes = if is_closed { "yes (" } else { "no (" };
            let closed = closed(&ModelFacts::of(&model, &[]).edges);
            assert!(closed.starts_with(yes), "{text}{closed}");
        }
    }
}
