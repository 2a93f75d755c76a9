//! Explains a pixel in words and numbers: the visible surface, and the terms of its colour.
//!
//! There is one row per term. A new term of the renderer appears here automatically.

use glam::DVec3;

use marraztu_core::accuracy::LightAt;
use marraztu_core::scene::{LightId, Scene};
use marraztu_render::{LightRay, PixelColor, SurfacePoint, Term};

/// A row of the sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The label, such as "sun, diffuse".
    pub label: String,
    /// Red, green and blue, in byte steps.
    pub value: [f64; 3],
}

/// Returns rows that add up to the colour of the pixel, as written with this number of decimals:
/// the terms, and the rounding error if it shows.
pub fn rows(scene: &Scene, explained: &PixelColor, decimals: i32) -> Vec<Row> {
    let unit = 10.0_f64.powi(decimals);
    // Adding 0 removes negative zeros.
    let written = |x: f64| (x * unit).round() / unit + 0.0;
    let steps = |value: [f64; 3]| value.map(|x| written(x * 255.0));
    let label = |term: &Term| {
        let part = match term.light {
            Some(id) => format!("{}, {}", light_name(scene, id), term.part.name()),
            None => term.part.name().to_owned(),
        };
        if term.layer == 0 { part } else { format!("behind: {part}") }
    };
    let row = |term: &Term| Row { label: label(term), value: steps(term.value) };
    let mut rows: Vec<Row> = explained.terms.iter().map(row).collect();
    let sum = steps(explained.color);
    let rest = [0, 1, 2].map(|i| {
        let terms: f64 = rows.iter().map(|row| row.value[i]).sum();
        written(sum[i] - terms)
    });
    if rest != [0.0; 3] {
        rows.push(Row { label: "rounding".to_owned(), value: rest });
    }
    rows
}

/// Returns the name of a light.
pub fn light_name(scene: &Scene, id: LightId) -> &str {
    scene.lights.get(id).map_or("a light", |light| &light.name)
}

/// Returns facts about the surface as pairs of name and value.
pub fn facts(scene: &Scene, point: &SurfacePoint) -> Vec<[String; 2]> {
    let side = if point.back { "back" } else { "front" };
    let light = match point.light_at {
        None => "not lit",
        Some(LightAt::Face) => "at the face",
        Some(LightAt::Vertex) => "at the corners",
        Some(LightAt::Pixel | LightAt::Sample) => "at the pixel",
    };
    // Numbers count from 1, as in the layer and in polygon mode.
    let [polygon, triangle] = [point.polygon, point.triangle].map(|index| index + 1);
    let mut facts = vec![
        ["shows".to_owned(), format!("{}, {side}", scene.name(point.item).unwrap_or("nothing"))],
        ["polygon".to_owned(), format!("{polygon}, triangle {triangle}")],
        ["barycentrics".to_owned(), vector(point.weights)],
        ["distance".to_owned(), number(point.distance)],
        ["position".to_owned(), vector(point.position)],
        ["N".to_owned(), direction(point.normal)],
        ["V".to_owned(), direction(point.to_eye)],
        ["light".to_owned(), light.to_owned()],
    ];
    // A factor of 1 changes nothing, so it is omitted.
    if point.own != [1.0; 3] {
        facts.push(["texture and tint".to_owned(), vector(DVec3::from_array(point.own))]);
    }
    facts
}

/// Describes the path of a light to the point, in one line.
pub fn ray_line(ray: &LightRay) -> String {
    let cosine = if ray.half_vector { "N.H" } else { "R.V" };
    let mut line = format!(
        "L {}  R {}  N.L {}  {cosine} {}",
        direction(ray.to_light),
        direction(ray.reflected),
        number(ray.n_l),
        number(ray.highlight)
    );
    if let Some(distance) = ray.distance {
        line += &format!("  d {}  att {}", number(distance), number(ray.attenuation));
    }
    // Factors of 1 are omitted.
    if ray.shadow != 1.0 {
        line += "  in shadow";
    }
    if ray.cone != 1.0 {
        line += &format!("  spot {}", number(ray.cone));
    }
    line
}

/// Says which pixel was drawn, if the picture was enlarged.
pub fn drawn_line(explained: &PixelColor) -> Option<String> {
    let [x, y] = explained.drawn?;
    Some(format!("Drawn at half the size: this is the light of its pixel {x},{y}."))
}

/// Writes the whole explanation as text, line by line.
pub fn lines(scene: &Scene, explained: &PixelColor) -> Vec<String> {
    let [x, y] = explained.at;
    let mut lines = vec![format!("pixel {x},{y}")];
    lines.extend(drawn_line(explained).map(|line| format!("  {line}")));
    if let Some(point) = &explained.surface {
        let facts = facts(scene, point);
        lines.extend(facts.iter().map(|[name, value]| format!("  {name:<17}{value}")));
    }
    // The vectors of each light come before the sum that uses them.
    for term in &explained.terms {
        if let (Some(ray), Some(id)) = (&term.ray, term.light) {
            lines.push(format!("  {:<17}{}", light_name(scene, id), ray_line(ray)));
        }
    }
    lines.push(format!("  {:<34}{:>10}{:>10}{:>10}", "in steps of a byte", "red", "green", "blue"));
    let line = |label: &str, value: [f64; 3]| {
        let [r, g, b] = value.map(|x| format!("{x:.4}"));
        format!("  {label:<34}{r:>10}{g:>10}{b:>10}")
    };
    lines.extend(rows(scene, explained, 4).iter().map(|row| line(&row.label, row.value)));
    lines.push(line("sum", explained.color.map(|x| x * 255.0)));
    if explained.linear {
        lines.push("  linear light: encoded in sRGB before it is rounded".to_owned());
    }
    let [r, g, b] = explained.bytes;
    lines.push(format!("  {:<34}{r:>10}{g:>10}{b:>10}", "clamped and rounded"));
    lines
}

/// Formats a number with up to four decimals.
pub fn number(x: f64) -> String {
    let text = if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e6) {
        format!("{x:.3e}")
    } else {
        format!("{x:.4}")
    };
    if text == "-0.0000" { "0.0000".to_owned() } else { text }
}

fn vector(v: DVec3) -> String {
    format!("({}, {}, {})", number(v.x), number(v.y), number(v.z))
}

/// Formats a unit vector; components that round to 0 at four decimals become 0.
fn direction(v: DVec3) -> String {
    vector(v.map(|x| if x.abs() < 5e-5 { 0.0 } else { x }))
}
