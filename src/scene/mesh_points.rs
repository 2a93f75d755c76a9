//! Normals of vertices, and whether a mesh can be made at all.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::index;
use super::{Corner, MeshError, MeshSource, NONE, Point, SourceCorner, dvec3};
use crate::base::math;

/// Checks that every index is in range and every number finite.
pub(super) fn check(source: &MeshSource) -> Result<(), MeshError> {
    let room = |what, length: usize| {
        // A vertex may need one point a corner, and NONE is taken.
        if length < NONE as usize / 4 { Ok(()) } else { Err(MeshError::TooMany(what)) }
    };
    room("vertices", source.positions.len())?;
    room("corners", source.corners.len())?;
    let length = |what, right: bool| if right { Ok(()) } else { Err(MeshError::Length(what)) };
    let corners: u64 = source.arities.iter().map(|&n| u64::from(n)).sum();
    length("corners", corners == source.corners.len() as u64)?;
    length("parts of polygons", source.polygon_parts.len() == source.arities.len())?;
    length("colours", [0, source.positions.len()].contains(&source.colors.len()))?;
    let finite = |what, right: bool| if right { Ok(()) } else { Err(MeshError::NotFinite(what)) };
    let all = |rows: &[[f32; 3]]| rows.iter().flatten().all(|x| x.is_finite());
    finite("positions", all(&source.positions))?;
    finite("colours", all(&source.colors))?;
    finite("normals", all(&source.normals))?;
    finite("places on the texture", source.uvs.iter().flatten().all(|x| x.is_finite()))?;
    if let Some(short) = source.arities.iter().position(|&n| n < 3) {
        return Err(MeshError::Short(index(short)));
    }
    let within = |what, i: u32, length: usize, optional: bool| {
        let right = (i as usize) < length || (optional && i == NONE);
        if right { Ok(()) } else { Err(MeshError::Index(what, i)) }
    };
    for corner in &source.corners {
        within("vertex", corner.position, source.positions.len(), false)?;
        within("place on the texture", corner.uv, source.uvs.len(), true)?;
        within("normal", corner.normal, source.normals.len(), true)?;
    }
    for part in &source.polygon_parts {
        within("part", *part, source.parts.len(), false)?;
    }
    Ok(())
}

/// The points of a mesh, and its corners, which name them.
pub(super) fn points_and_corners(
    source: &MeshSource,
    starts: &[u32],
    polygon_normals: &[Option<DVec3>],
) -> (Vec<Point>, Vec<Corner>) {
    // The computed normal of a vertex is the mean of the unit normals of the polygons around it; a
    // polygon that names the vertex twice is around it once.
    let mut sums = vec![DVec3::ZERO; source.positions.len()];
    let mut last_polygon = vec![NONE; source.positions.len()];
    for (i, normal) in polygon_normals.iter().enumerate() {
        for corner in &source.corners[starts[i] as usize..starts[i + 1] as usize] {
            let position = corner.position as usize;
            if std::mem::replace(&mut last_polygon[position], index(i)) != index(i) {
                sums[position] += normal.unwrap_or(DVec3::ZERO);
            }
        }
    }
    // Unit normals that cancel out leave only their rounding errors.
    let smooth: Vec<Option<DVec3>> = sums
        .into_iter()
        .map(|sum| if sum.length() > 1e-9 { math::unit(sum) } else { None })
        .collect();

    let mut points: Vec<Point> = smooth
        .iter()
        .enumerate()
        .map(|(i, n)| Point { position: index(i), normal: narrow(n.unwrap_or(DVec3::Z)) })
        .collect();
    let mut filed_points: HashMap<(u32, u32), u32> = HashMap::new();
    let mut corners = Vec::with_capacity(source.corners.len());
    for (i, polygon_normal) in polygon_normals.iter().enumerate() {
        let own = &source.corners[starts[i] as usize..starts[i + 1] as usize];
        let file_normal = |corner: &SourceCorner| {
            let normal = source.normals.get(corner.normal as usize)?;
            math::unit(dvec3(*normal))
        };
        let filed = own.iter().all(|corner| file_normal(corner).is_some());
        for corner in own {
            let position = corner.position;
            let mut add = |normal: DVec3| {
                points.push(Point { position, normal: narrow(normal) });
                index(points.len() - 1)
            };
            let smooth = match (smooth[position as usize], polygon_normal) {
                (None, Some(normal)) => add(*normal),
                _ => position,
            };
            let filed = match file_normal(corner) {
                Some(normal) if filed => {
                    *filed_points.entry((position, corner.normal)).or_insert_with(|| add(normal))
                }
                _ => smooth,
            };
            corners.push(Corner { position, uv: corner.uv, smooth, filed });
        }
    }
    (points, corners)
}

fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}
