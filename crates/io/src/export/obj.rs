//! Exports a scene as OBJ with MTL.
//!
//! Positions are in world space, since the format has no transforms. Polygons keep their corners; a
//! mirrored object gets them in reverse order, which keeps its front faces in front. The numbers of
//! an object with the identity transform equal those of its file, bit for bit. This holds for STL
//! files, too: if all objects come from such files, z is up in the export.
//!
//! The statements `o`, `g` and `usemtl` of a file survive unchanged ([`called`]).

mod called;
mod mtl;

use std::fmt::Write;
use std::ops::Neg;

use glam::{DMat3, DMat4, DVec3};

use self::called::Names;
use super::look::{Detail, Looks, has_colors, polygons, strokes};
use super::names::companion;
use super::{Content, ExportOptions};
use crate::mark::SIGNATURE;
use crate::stl::has_stl_name;
use marraztu_core::base::math::{normal_matrix, unit};
use marraztu_core::scene::{Corner, NONE, Object, Scene, Stroke, UpAxis, View, dvec3};

/// An object counts as far if its distance from the origin exceeds this multiple of its radius.
const FAR: f64 = 256.0;

/// An OBJ file in progress.
struct Writer {
    text: String,
    looks: Looks,
    names: Names,
    /// The axis that points up in the file: Y or Z.
    up: UpAxis,
    /// The number of positions written so far; texture coordinates and normals follow.
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// Writes the files.
pub(super) fn written(
    stem: &str,
    scene: &Scene,
    view: &View,
    options: ExportOptions,
) -> Result<Content, String> {
    let objects = scene.objects.iter().map(|(_, object)| object);
    let visible: Vec<&Object> = objects.filter(|object| object.visible).collect();
    let up = up_axis(&visible);
    let turned = visible.iter().filter(|it| it.model.options.up != up).count();
    let mut writer = Writer {
        text: String::new(),
        looks: Looks::new(Detail::Mtl),
        names: Names::new(visible.len()),
        up,
        positions: 0,
        uvs: 0,
        normals: 0,
    };
    for object in visible {
        writer.object(object, view.time);
    }
    // The head comes last, since only now is it known whether there are materials.
    let mut content = Content::default();
    let mut head = String::from(SIGNATURE);
    if up != UpAxis::default() {
        let _ = writeln!(head, "# up axis: {}", up.word());
        content.notes.push(format!("{} is up in the OBJ file, as in the STL files", up.word()));
    } else if turned > 0 {
        let note =
            format!("y is up in the OBJ file: models with another up axis are turned: {turned}");
        content.notes.push(note);
    }
    if !writer.looks.all.is_empty() {
        let stem = companion(stem);
        let _ = writeln!(head, "mtllib {stem}.mtl");
        content = mtl::written(&stem, &writer.looks)?;
    }
    content.files.push((format!("{stem}.obj"), (head + &writer.text).into_bytes()));
    if options != ExportOptions::MODELS {
        content.notes.push("OBJ has no cameras or lights: they are left out".to_owned());
    }
    Ok(content)
}

impl Writer {
    fn object(&mut self, object: &Object, time: f64) {
        let mesh = &object.model.mesh;
        let turn = DMat3::from_mat4(object.world_from_object(time));
        self.names.begin(object);
        self.looks.add_file(object);
        self.names.object_without_shapes(object, &mut self.text);

        // With hidden parts, only the vertices of visible faces, lines and points are written.
        let all = object.hidden_parts.is_empty();
        let corners = || polygons(object).flat_map(|polygon| mesh.polygon(polygon));
        let point =
            |corner: &Corner| if object.file_normals { corner.filed } else { corner.smooth };
        let ends = strokes(object).flat_map(|stroke| stroke.ends);
        let used = corners().map(|it| it.position).chain(ends);
        let positions = Numbers::of(mesh.positions().len(), all, used);
        let uvs = Numbers::of(mesh.uvs().len(), all, corners().map(|it| it.uv));
        let normals = Numbers::of(mesh.points().len(), false, corners().map(point));
        self.vertices(object, time, &positions);
        for uv in &uvs.used {
            let [u, v] = mesh.uvs()[*uv as usize];
            let _ = writeln!(self.text, "vt {u} {v}");
        }
        for point in &normals.used {
            let normal = turned(&turn, mesh.points()[*point as usize].normal);
            let [x, y, z] = axes(self.up, normal);
            let _ = writeln!(self.text, "vn {x} {y} {z}");
        }

        // A mirrored object reverses its corners, which keeps its front faces in front.
        let is_mirrored = turn.determinant() < 0.0;
        for polygon in polygons(object) {
            let part = mesh.polygon_parts()[polygon as usize];
            self.names.part(object, part, &mut self.looks, &mut self.text);
            self.text.push('f');
            let text = &mut self.text;
            let mut corner = |corner: &Corner| {
                let position = self.positions + positions.number(corner.position);
                let normal = self.normals + normals.number(point(corner));
                let _ = match corner.uv {
                    NONE => write!(text, " {position}//{normal}"),
                    uv => write!(text, " {position}/{}/{normal}", self.uvs + uvs.number(uv)),
                };
            };
            let corners = mesh.polygon(polygon);
            if is_mirrored {
                corners.iter().rev().for_each(&mut corner);
            } else {
                corners.iter().for_each(&mut corner);
            }
            self.text.push('\n');
        }
        self.strokes(object, &positions);
        self.positions += positions.used.len();
        self.uvs += uvs.used.len();
        self.normals += normals.used.len();
    }

    /// Writes lines and points: a statement for each polyline, and for each run of points.
    fn strokes(&mut self, object: &Object, positions: &Numbers) {
        let mut last: Option<&Stroke> = None;
        for stroke in strokes(object) {
            let goes_on = last.is_some_and(|last| {
                last.leads_to(stroke)
                    || (last.is_point() && stroke.is_point() && last.part == stroke.part)
            });
            let [from, to] = stroke.ends.map(|end| self.positions + positions.number(end));
            if !goes_on {
                if last.is_some() {
                    self.text.push('\n');
                }
                self.names.part(object, stroke.part, &mut self.looks, &mut self.text);
                let _ = match stroke.is_point() {
                    true => write!(self.text, "p"),
                    false => write!(self.text, "l {from}"),
                };
            }
            let _ = write!(self.text, " {to}");
            last = Some(stroke);
        }
        if last.is_some() {
            self.text.push('\n');
        }
    }

    /// Writes positions, with vertex colours if they are shown.
    fn vertices(&mut self, object: &Object, time: f64, positions: &Numbers) {
        let mesh = &object.model.mesh;
        let colors = if has_colors(object) { mesh.colors() } else { &[] };
        let world_from_mesh = object.world_from_mesh(time);
        let is_far = is_far(object, time);
        for position in &positions.used {
            let place = mesh.positions()[*position as usize];
            place_to(&mut self.text, &world_from_mesh, (place, is_far), self.up);
            let _ = match colors.get(*position as usize) {
                Some([r, g, b]) => writeln!(self.text, " {r} {g} {b}"),
                None => writeln!(self.text),
            };
        }
    }
}

/// The rows of a list that are written, and their numbers in the file.
struct Numbers {
    used: Vec<u32>,
    /// The number of each row, from 1; 0 if it is not written.
    numbers: Vec<usize>,
}

impl Numbers {
    /// Numbers all rows of a list of `count`, or only the used ones. [`NONE`] is skipped.
    fn of(count: usize, all: bool, used: impl Iterator<Item = u32>) -> Self {
        let mut numbers = vec![usize::from(all); count];
        if !all {
            for row in used.filter(|row| *row != NONE) {
                numbers[row as usize] = 1;
            }
        }
        let mut used = Vec::new();
        for (row, number) in (0..).zip(&mut numbers) {
            if *number > 0 {
                used.push(row);
                *number = used.len();
            }
        }
        Self { used, numbers }
    }

    fn number(&self, row: u32) -> usize {
        self.numbers[row as usize]
    }
}

/// Returns whether an object is so far from the origin that its positions need more than f32
/// precision.
fn is_far(object: &Object, time: f64) -> bool {
    let sphere = object.bounding_sphere(time);
    object.model.mesh.offset() != DVec3::ZERO
        || sphere.is_some_and(|(centre, radius)| centre.length() > FAR * radius)
}

/// Returns the axis that points up in the file: Z if all objects come from STL files with Z up, or
/// else Y.
fn up_axis(objects: &[&Object]) -> UpAxis {
    let is_stl = |object: &&Object| {
        let model = &object.model;
        model.options.up == UpAxis::Z && model.source.as_deref().is_some_and(has_stl_name)
    };
    let are_all = !objects.is_empty() && objects.iter().all(is_stl);
    if are_all { UpAxis::Z } else { UpAxis::Y }
}

/// Returns the numbers in the file of a position or direction of the world.
fn axes<T: Copy + Neg<Output = T>>(up: UpAxis, [x, y, z]: [T; 3]) -> [T; 3] {
    // The inverse of UpAxis::upright, which turns (x, y, z) of the file to (x, z, -y).
    if up == UpAxis::Z { [x, -z, y] } else { [x, y, z] }
}

/// Writes a position in world space. The identity transform keeps the bits of the file.
fn place_to(
    text: &mut String,
    world_from_mesh: &DMat4,
    (position, is_far): ([f32; 3], bool),
    up: UpAxis,
) {
    let place = world_from_mesh.transform_point3(dvec3(position));
    let _ = if *world_from_mesh == DMat4::IDENTITY {
        let [x, y, z] = axes(up, position);
        write!(text, "v {x} {y} {z}")
    } else if is_far {
        let [x, y, z] = axes(up, place.to_array());
        write!(text, "v {x} {y} {z}")
    } else {
        let [x, y, z] = axes(up, place.as_vec3().to_array());
        write!(text, "v {x} {y} {z}")
    };
}

/// Returns a unit normal in world space.
fn turned(turn: &DMat3, normal: [f32; 3]) -> [f32; 3] {
    if *turn == DMat3::IDENTITY {
        return normal;
    }
    let placed = normal_matrix(*turn) * dvec3(normal);
    unit(placed).unwrap_or(placed).as_vec3().to_array()
}
