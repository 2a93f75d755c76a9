//! Describes a file as plain text, for `marraztu info FILE`.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::findings::Finding;
use super::loaded::Loaded;
use marraztu_core::scene::{FileMaterial, Mesh, Model, Shape, Smoothing, UpAxis, Winding};

/// Lists the shape, parts, materials and findings of a loaded file, line by line.
pub fn describe(loaded: &Loaded) -> String {
    describe_model(&loaded.model, &loaded.findings)
}

/// Lists the shape, parts and materials of a model, and findings, line by line.
pub fn describe_model(model: &Model, findings: &[Finding]) -> String {
    let mut text = Text::default();
    text.line("name", &model.name);
    if let Some(source) = &model.source {
        text.line("file", &source.display().to_string());
    }
    if let Some(shape) = Shape::of(model) {
        text.line("shape", shape.name());
    }
    describe_options(model, &mut text);
    describe_mesh(&model.mesh, &mut text);
    if let Some(color) = model.edge_color {
        let [r, g, b] = color.0;
        text.line("edges drawn in", &format!("({r}, {g}, {b})"));
    }
    describe_parts(model, &mut text);
    describe_materials(model, &mut text);
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

fn describe_options(model: &Model, text: &mut Text) {
    let mut options = Vec::new();
    let up = model.options.up;
    if up != UpAxis::default() {
        options.push(format!("{} is up", up.word().to_uppercase()));
    }
    let scale = model.options.scale.get();
    if (scale - 1.0).abs() > 0.0 && model.source.is_some() {
        options.push(format!("scaled by {scale}"));
    }
    if model.options.winding == Winding::Turned {
        options.push("winding reversed".to_owned());
    }
    if !options.is_empty() {
        text.line("read with", &options.join(", "));
    }
}

fn describe_mesh(mesh: &Mesh, text: &mut Text) {
    text.line("vertices", &grouped(mesh.positions().len()));
    text.line("faces", &faces(mesh));
    text.line("triangles", &grouped(mesh.triangle_count()));
    for (label, count) in ["lines", "points"].into_iter().zip(mesh.stroke_counts()) {
        if count > 0 {
            text.line(label, &grouped(count));
        }
    }
    match mesh.bounds() {
        None => text.line("box", "none"),
        Some(bounds) => {
            let place =
                |p: glam::DVec3| format!("({}, {}, {})", short(p.x), short(p.y), short(p.z));
            // Positions are stored relative to the offset; the box shows the file's.
            let offset = mesh.offset();
            let [min, max] = [bounds.min, bounds.max].map(|p| place(p + offset));
            text.line("box", &format!("{min} to {max}"));
            if offset != glam::DVec3::ZERO {
                text.line(
                    "offset",
                    &format!("{}, which positions are stored relative to", place(offset)),
                );
            }
            let size = bounds.extent();
            let size = [size.x, size.y, size.z].map(short).join(" x ");
            text.line("size", &size);
        }
    }
    let yes = |present: bool| if present { "yes" } else { "no" };
    text.line("normals", if mesh.has_file_normals() { "the file's" } else { "computed" });
    text.line("smoothing", &smoothing(mesh));
    let uv = mesh.corners().iter().any(|corner| corner.uv != marraztu_core::scene::NONE);
    text.line("texture coords", yes(uv));
    text.line("vertex colours", yes(!mesh.colors().is_empty()));
    text.line("closed", &closed(mesh));
}

/// Describes smoothing, such as "crease 60 degrees" or "3 groups".
fn smoothing(mesh: &Mesh) -> String {
    match mesh.smoothing() {
        _ if mesh.has_file_normals_only() => "by the file's normals".to_owned(),
        Smoothing::Crease(crease) => format!("crease {} degrees", short(crease.get())),
        Smoothing::Groups(groups) => {
            let groups: BTreeSet<u32> = groups.iter().copied().filter(|i| *i != 0).collect();
            if groups.is_empty() { "off".to_owned() } else { number_of(groups.len(), "group") }
        }
    }
}

/// Counts faces by size, such as "12,480 (480 triangles, 12,000 quads)".
fn faces(mesh: &Mesh) -> String {
    let polygons = 0..u32::try_from(mesh.polygon_count()).unwrap_or(u32::MAX);
    let sizes: Vec<usize> = polygons.map(|i| mesh.polygon(i).len()).collect();
    let of = |right: fn(usize) -> bool| sizes.iter().filter(|size| right(**size)).count();
    let counts = [
        (of(|n| n == 3), "triangle", String::new()),
        (of(|n| n == 4), "quad", String::new()),
        (
            of(|n| n > 4),
            "n-gon",
            format!(" of up to {} corners", sizes.iter().max().copied().unwrap_or(0)),
        ),
    ];
    let kinds: Vec<String> = counts
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, name, more)| format!("{}{more}", number_of(count, name)))
        .collect();
    let all = grouped(sizes.len());
    if kinds.is_empty() { all } else { format!("{all} ({})", kinds.join(", ")) }
}

/// Says whether the surface is closed, as for back-face culling, and counts the edges that do not
/// have two polygons.
fn closed(mesh: &Mesh) -> String {
    let edges = mesh.edges();
    let sides = |right: fn(usize) -> bool| {
        edges.iter().filter(|edge| right(mesh.edge_polygons(edge).len())).count()
    };
    let (borders, crowded) = (sides(|n| n == 1), sides(|n| n > 2));
    let all = number_of(edges.len(), "edge");
    if edges.is_empty() {
        return "no: there are no edges".to_owned();
    }
    let is_closed = mesh.is_closed();
    let yes = if is_closed { "yes" } else { "no" };
    if borders == 0 && crowded == 0 {
        let turned = if is_closed { "" } else { "; some neighbours have opposite windings" };
        return format!("{yes} ({all}, each of two faces{turned})");
    }
    let mut faults = Vec::new();
    if borders > 0 {
        faults.push(format!("{} of one face", grouped(borders)));
    }
    if crowded > 0 {
        faults.push(format!("{} of more than two", grouped(crowded)));
    }
    match mesh.split_edges() {
        0 => {}
        1 => faults.push("1 edge is split by corners of other faces: gaps may show".to_owned()),
        n => faults.push(format!(
            "{} edges are split by corners of other faces: gaps may show",
            grouped(n)
        )),
    }
    format!("{yes} ({all}: {})", faults.join(", "))
}

fn describe_parts(model: &Model, text: &mut Text) {
    let parts = model.mesh.parts();
    let mut counts = vec![[0; 3]; parts.len()];
    for part in model.mesh.polygon_parts() {
        counts[*part as usize][0] += 1;
    }
    for stroke in model.mesh.strokes() {
        counts[stroke.part as usize][if stroke.is_point() { 2 } else { 1 }] += 1;
    }
    text.head("parts", parts.len());
    for (part, counts) in parts.iter().zip(counts).take(MOST) {
        let [faces, lines, points] = counts;
        let strokes = [(lines, "line"), (points, "point")];
        let mut content = Vec::new();
        if faces > 0 || lines + points == 0 {
            content.push(number_of(faces, "face"));
        }
        let some = strokes.into_iter().filter(|(count, _)| *count > 0);
        content.extend(some.map(|(count, name)| number_of(count, name)));
        let content = content.join(", ");
        let material = part.material.and_then(|i| model.materials.get(i as usize));
        let material = material.map_or_else(
            || "no material: silver".to_owned(),
            |material| format!("material \"{}\"", material.name),
        );
        text.item(&format!("\"{}\": {content}, {material}", part.name));
    }
    text.more(parts.len());
}

fn describe_materials(model: &Model, text: &mut Text) {
    text.head("materials", model.materials.len());
    for material in model.materials.iter().take(MOST) {
        text.item(&describe_material(material));
    }
    text.more(model.materials.len());
}

fn describe_material(material: &FileMaterial) -> String {
    let color = |color: [f64; 3]| color.map(short).join(" ");
    let m = &material.material;
    let mut text = format!(
        "\"{}\": Ka {}, Kd {}, Ks {}, Ns {}",
        material.name,
        color(m.ambient),
        color(m.diffuse),
        color(m.specular),
        short(m.exponent)
    );
    if m.emission != [0.0; 3] {
        let _ = write!(text, ", Ke {}", color(m.emission));
    }
    if material.unlit {
        text.push_str(", not lit");
    }
    if material.opacity < 1.0 {
        let _ = write!(text, ", d {}", short(material.opacity));
        text.push_str(if material.opacity == 0.0 { " (draws nothing)" } else { " (transparent)" });
    }
    // The texture and all maps are listed alike, with file name and size.
    let maps = material.maps.iter().map(|(kind, map)| (kind.statement(), &map.texture));
    for (word, texture) in material.texture.iter().map(|it| ("texture", it)).chain(maps) {
        let size = texture.picture.size();
        let name = super::error::short_name(&texture.source);
        let _ = write!(text, ", {word} {name} ({} x {})", size.width, size.height);
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
            let mesh = &loaded.unwrap().model.mesh;
            assert_eq!(mesh.is_closed(), is_closed, "{text}");
            let yes = if is_closed { "yes (" } else { "no (" };
            assert!(closed(mesh).starts_with(yes), "{text}{}", closed(mesh));
        }
    }
}
