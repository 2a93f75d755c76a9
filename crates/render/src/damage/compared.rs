//! Compares the draws of two plans bit for bit, and finds the kind of difference.

use std::collections::BTreeMap;

use super::Change;
use crate::frame::FramePlan;
use crate::frame::draw::{Draw, Lines, Pipeline, Shaded};
use crate::lights::{PhongMaterial, ViewLight};
use marraztu_core::base::Shared;
use marraztu_core::base::math::same_bits;

/// Two plans to be compared.
pub(super) struct Compared<'a> {
    pub(super) before: &'a FramePlan,
    pub(super) after: &'a FramePlan,
    /// The results for pairs of pipelines, because parts share pipelines.
    pub(super) pipelines: BTreeMap<(u32, u32), bool>,
}

impl Compared<'_> {
    /// Returns the kind of difference between two draws, if they differ.
    pub(super) fn change(&mut self, before: &Draw, after: &Draw) -> Option<Change> {
        let Draw {
            item: _,
            model,
            clip_from_object,
            view_from_object,
            view_from_normal,
            mirrored,
            back,
            culls_opaque,
            normals,
            normal_source,
            part_pipelines,
            uniform: _,
            polygons,
            filled,
            lines,
        } = after;
        // The three kinds in order of severity: the first one that applies is reported.
        let moved = !same_bits(clip_from_object, &before.clip_from_object)
            || !same_bits(view_from_object, &before.view_from_object)
            || !alike(&view_from_normal.to_cols_array(), &before.view_from_normal.to_cols_array())
            || *mirrored != before.mirrored;
        // A different shape changes coverage, so more than the colours.
        let shape = !Shared::same(model, &before.model)
            || *back != before.back
            || *culls_opaque != before.culls_opaque
            || *polygons != before.polygons
            || *filled != before.filled
            || !alike_lines(lines, &before.lines)
            || (lines.vertex_normals.is_some() && *normal_source != before.normal_source)
            || self.kinds(part_pipelines, &before.part_pipelines);
        let look = *normals != before.normals
            || *normal_source != before.normal_source
            || !self.alike_parts(&before.part_pipelines, part_pipelines);
        match () {
            () if moved => Some(Change::Moved),
            () if shape => Some(Change::Shape),
            () if look => Some(Change::Look),
            () => None,
        }
    }

    /// Returns whether the set of drawn parts changed, or a part gained or lost its alpha test or
    /// transparency.
    fn kinds(&self, after: &[Option<u32>], before: &[Option<u32>]) -> bool {
        let kinds = |plan: &FramePlan, parts: &[Option<u32>]| -> Vec<Option<[bool; 2]>> {
            let kind = |pipeline: u32| {
                let pipeline = &plan.pipelines[pipeline as usize];
                [pipeline.is_cutout(), pipeline.opacity().is_some()]
            };
            parts.iter().map(|pipeline| pipeline.map(kind)).collect()
        };
        kinds(self.after, after) != kinds(self.before, before)
    }

    /// Returns whether two draws of the same parts differ in their holes, so other pixels may show
    /// them.
    pub(super) fn has_other_holes(&self, before: &Draw, after: &Draw) -> bool {
        before.part_pipelines.iter().zip(&after.part_pipelines).any(|pair| match pair {
            (Some(before), Some(after)) => {
                let before = &self.before.pipelines[*before as usize];
                let after = &self.after.pipelines[*after as usize];
                !alike_holes(before, after)
            }
            (None, None) => false,
            (Some(_), None) | (None, Some(_)) => true,
        })
    }

    fn alike_parts(&mut self, before: &[Option<u32>], after: &[Option<u32>]) -> bool {
        before.len() == after.len()
            && before.iter().zip(after).all(|pair| match pair {
                (Some(before), Some(after)) => self.alike_pipelines(*before, *after),
                (None, None) => true,
                _ => false,
            })
    }

    fn alike_pipelines(&mut self, before: u32, after: u32) -> bool {
        if let Some(alike) = self.pipelines.get(&(before, after)) {
            return *alike;
        }
        let pair = (&self.before.pipelines[before as usize], &self.after.pipelines[after as usize]);
        let alike = match pair {
            (Pipeline::Flat(before), Pipeline::Flat(after)) => before == after,
            (Pipeline::Shaded(before), Pipeline::Shaded(after)) => {
                self.alike_surfaces(before, after)
            }
            _ => false,
        };
        self.pipelines.insert((before, after), alike);
        alike
    }

    fn alike_surfaces(&self, before: &Shaded, after: &Shaded) -> bool {
        let Shaded {
            material,
            light,
            needs_positions: _,
            tiled,
            vertex_colors,
            tint,
            texture,
            cutout,
            opacity,
            opacity_map,
            extras,
        } = after;
        let textures = Shared::both_same(texture.as_ref(), before.texture.as_ref())
            && Shared::both_same(opacity_map.as_ref(), before.opacity_map.as_ref());
        // Lights are compared by value, because their indices may differ between plans.
        let stages = match (light, &before.light) {
            (Some(after), Some(before)) => {
                after.len() == before.len()
                    && after.iter().zip(before).all(|(after, before)| {
                        after.effect.name == before.effect.name
                            && after.highlight == before.highlight
                            && self.after.shadows.source(after.light).is_some()
                                == self.before.shadows.source(before.light).is_some()
                            && after.is_mapped == before.is_mapped
                            && alike_lights(
                                &self.after.lights[after.light as usize],
                                &self.before.lights[before.light as usize],
                            )
                    })
            }
            (None, None) => true,
            _ => false,
        };
        textures
            && stages
            && *tiled == before.tiled
            && alike_material(material, &before.material)
            && *vertex_colors == before.vertex_colors
            && alike(tint, &before.tint)
            && alike(cutout.as_slice(), before.cutout.as_slice())
            && alike(opacity.as_slice(), before.opacity.as_slice())
            && extras.are_alike(&before.extras)
    }
}

/// Returns whether surfaces have the same holes and the same transparency.
fn alike_holes(before: &Pipeline, after: &Pipeline) -> bool {
    match (before, after) {
        (Pipeline::Shaded(before), Pipeline::Shaded(after)) => {
            let is_solid = |it: &Shaded| it.cutout.is_none() && it.opacity.is_none();
            let both = is_solid(before) && is_solid(after);
            both || (alike(before.cutout.as_slice(), after.cutout.as_slice())
                && alike(before.opacity.as_slice(), after.opacity.as_slice())
                && Shared::both_same(before.texture.as_ref(), after.texture.as_ref())
                && Shared::both_same(before.opacity_map.as_ref(), after.opacity_map.as_ref()))
        }
        (Pipeline::Flat(_), Pipeline::Flat(_)) => true,
        (Pipeline::Flat(_), Pipeline::Shaded(_)) | (Pipeline::Shaded(_), Pipeline::Flat(_)) => {
            false
        }
    }
}

/// Returns whether all numbers have the same bits.
fn alike(a: &[f64], b: &[f64]) -> bool {
    a.iter().map(|a| a.to_bits()).eq(b.iter().map(|b| b.to_bits()))
}

fn alike_lines(a: &Lines, b: &Lines) -> bool {
    let Lines { edges, face_normals, vertex_normals, color } = a;
    *edges == b.edges
        && *color == b.color
        && alike(face_normals.as_slice(), b.face_normals.as_slice())
        && alike(vertex_normals.as_slice(), b.vertex_normals.as_slice())
}

fn alike_lights(a: &ViewLight, b: &ViewLight) -> bool {
    let ViewLight { color, position, direction, attenuation, cos_half_aperture, exponent } = a;
    alike(color, &b.color)
        && alike(position, &b.position)
        && alike(direction, &b.direction)
        && alike(attenuation, &b.attenuation)
        && alike(&[*cos_half_aperture, *exponent], &[b.cos_half_aperture, b.exponent])
}

fn alike_material(a: &PhongMaterial, b: &PhongMaterial) -> bool {
    let PhongMaterial { ambient, diffuse, specular, exponent, floor, least_cosine } = a;
    alike(ambient, &b.ambient)
        && alike(diffuse, &b.diffuse)
        && alike(specular, &b.specular)
        && alike(&[*exponent, *floor, *least_cosine], &[b.exponent, b.floor, b.least_cosine])
}
