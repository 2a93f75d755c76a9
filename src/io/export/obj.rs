//! Exports a scene as OBJ with MTL.
//!
//! Positions are those of the world, since the format knows no placement; polygons keep their
//! corners, and a mirrored object has them in the opposite order, so that its front stays its
//! front. If an object is not moved, its numbers are those of its file, bit for bit.

use std::collections::BTreeMap;
use std::fmt::Write;

use glam::{DMat3, DMat4};

use super::look::{Look, Looks, polygons};
use super::{Content, SIGNATURE};
use crate::base::math::normal_matrix;
use crate::scene::{Corner, MapKind, NONE, Object, Scene, Texture, View, Wrap, dvec3};

/// How many positions, texture coordinates and normals have been written.
#[derive(Clone, Copy, Default)]
struct Counts {
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// The files.
pub(super) fn written(stem: &str, scene: &Scene, view: &View) -> Result<Content, String> {
    let mut looks = Looks::default();
    let mut obj = format!("{SIGNATURE}mtllib {stem}.mtl\n");
    let mut counts = Counts::default();
    let mut hidden = 0;
    for (_, object) in scene.objects.iter() {
        if object.visible {
            counts = object_to(&mut obj, object, view.time, &mut looks, counts);
        } else {
            hidden += 1;
        }
    }
    let mut mtl = String::from(SIGNATURE);
    for number in 0..looks.all.len() {
        let look = looks.all[number].clone();
        material_to(&mut mtl, number, &look);
        if let Some(texture) = &look.texture {
            let number = looks.texture_number(texture);
            map_to(&mut mtl, "map_Kd", texture, &texture_name(stem, number));
        }
        for (kind, map) in &look.maps {
            let number = looks.texture_number(&map.texture);
            let statement = if *kind == MapKind::Bump && map.gain != 1.0 {
                format!("bump -bm {}", map.gain)
            } else {
                kind.statement().to_owned()
            };
            map_to(&mut mtl, &statement, &map.texture, &texture_name(stem, number));
        }
    }
    let mut content = Content::default();
    for (i, bytes) in looks.encoded()?.into_iter().enumerate() {
        content.files.push((texture_name(stem, i + 1), bytes));
    }
    content.files.push((format!("{stem}.mtl"), mtl.into_bytes()));
    content.files.push((format!("{stem}.obj"), obj.into_bytes()));
    content.notes.push("OBJ has no cameras and no lights: they are left out".to_owned());
    if hidden > 0 {
        content.notes.push(format!("hidden objects are left out: {hidden}"));
    }
    let any = |is: fn(&Look) -> bool| looks.all.iter().any(is);
    if any(|look| look.tint != [1.0; 3]) {
        content.notes.push("MTL has no tint of textures: it is left out".to_owned());
    }
    Ok(content)
}

fn texture_name(stem: &str, number: usize) -> String {
    format!("{stem}-texture-{number}.png")
}

/// Writes an object. Returns the counts after it.
fn object_to(
    obj: &mut String,
    object: &Object,
    time: f64,
    looks: &mut Looks,
    before: Counts,
) -> Counts {
    let mesh = &object.model.mesh;
    let world = object.world_from_object(time);
    let _ = writeln!(obj, "o {}", object.name.replace(['\n', '\r'], " "));
    for (i, position) in mesh.positions().iter().enumerate() {
        let [x, y, z] = placed(&world, *position);
        let _ = match mesh.colors().get(i) {
            Some([r, g, b]) => writeln!(obj, "v {x} {y} {z} {r} {g} {b}"),
            None => writeln!(obj, "v {x} {y} {z}"),
        };
    }
    for [u, v] in mesh.uvs() {
        let _ = writeln!(obj, "vt {u} {v}");
    }
    let point = |corner: &Corner| if object.file_normals { corner.filed } else { corner.smooth };
    let mut normals: BTreeMap<u32, usize> = BTreeMap::new();
    for corner in polygons(object).flat_map(|polygon| mesh.polygon(polygon)) {
        normals.entry(point(corner)).or_default();
    }
    let turn = DMat3::from_mat4(world);
    for (place, (point, number)) in normals.iter_mut().enumerate() {
        *number = before.normals + place + 1;
        let [x, y, z] = turned(&turn, mesh.points()[*point as usize].normal);
        let _ = writeln!(obj, "vn {x} {y} {z}");
    }
    let is_mirrored = turn.determinant() < 0.0;
    let mut last = None;
    for polygon in polygons(object) {
        let look = looks.number(object, mesh.polygon_parts()[polygon as usize]);
        if last.replace(look) != Some(look) {
            let _ = writeln!(obj, "usemtl material-{}", look + 1);
        }
        obj.push('f');
        let corners = mesh.polygon(polygon);
        let mut write = |corner: &Corner| {
            let position = before.positions + corner.position as usize + 1;
            let normal = normals[&point(corner)];
            let _ = match corner.uv {
                NONE => write!(obj, " {position}//{normal}"),
                uv => write!(obj, " {position}/{}/{normal}", before.uvs + uv as usize + 1),
            };
        };
        if is_mirrored {
            corners.iter().rev().for_each(&mut write);
        } else {
            corners.iter().for_each(&mut write);
        }
        obj.push('\n');
    }
    Counts {
        positions: before.positions + mesh.positions().len(),
        uvs: before.uvs + mesh.uvs().len(),
        normals: before.normals + normals.len(),
    }
}

/// A position in the world; unchanged, bit for bit, if the object is not moved.
fn placed(world: &DMat4, position: [f32; 3]) -> [f32; 3] {
    if *world == DMat4::IDENTITY {
        return position;
    }
    world.transform_point3(dvec3(position)).as_vec3().to_array()
}

/// A normal in the world, of length 1.
fn turned(turn: &DMat3, normal: [f32; 3]) -> [f32; 3] {
    if *turn == DMat3::IDENTITY {
        return normal;
    }
    let placed = normal_matrix(*turn) * dvec3(normal);
    crate::base::math::unit(placed).unwrap_or(placed).as_vec3().to_array()
}

fn material_to(mtl: &mut String, number: usize, look: &Look) {
    let material = &look.material;
    let _ = writeln!(mtl, "\nnewmtl material-{}", number + 1);
    let colors = [("Ka", material.ambient), ("Kd", material.diffuse), ("Ks", material.specular)];
    for (word, [r, g, b]) in colors {
        let _ = writeln!(mtl, "{word} {r} {g} {b}");
    }
    let illumination = if look.unlit { 0 } else { 2 };
    let _ = writeln!(mtl, "Ns {}\nd {}", material.exponent, look.opacity);
    if material.emission != [0.0; 3] {
        let [r, g, b] = material.emission;
        let _ = writeln!(mtl, "Ke {r} {g} {b}");
    }
    let _ = writeln!(mtl, "illum {illumination}");
}

/// A statement of a map: how its picture is laid, and its file.
fn map_to(mtl: &mut String, statement: &str, texture: &Texture, file: &str) {
    mtl.push_str(statement);
    if texture.wrap == Wrap::Clamp {
        mtl.push_str(" -clamp on");
    }
    if texture.offset != [0.0; 2] {
        let _ = write!(mtl, " -o {} {} 0", texture.offset[0], texture.offset[1]);
    }
    if texture.scale != [1.0; 2] {
        let _ = write!(mtl, " -s {} {} 1", texture.scale[0], texture.scale[1]);
    }
    let _ = writeln!(mtl, " {file}");
}
