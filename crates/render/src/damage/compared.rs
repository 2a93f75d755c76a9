//! Compares the draws of two plans bit for bit, and finds the kind of difference.

use std::collections::BTreeMap;

use super::change::Change;
use crate::frame::FramePlan;
use crate::frame::draw::{Draw, Lines, Pipeline, Shaded, Stage};
use crate::frame::extras::address;
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
        // Every field is named, so that a new one cannot be forgotten here.
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
            bodies,
            polygons,
            filled,
            lines,
            strokes,
        } = after;
        // The three kinds in order of severity: the first one that applies is reported.
        let moved = !same_bits(clip_from_object, &before.clip_from_object)
            || !same_bits(view_from_object, &before.view_from_object)
            || bits(view_from_normal.to_cols_array())
                != bits(before.view_from_normal.to_cols_array())
            || *mirrored != before.mirrored;
        // A different shape changes coverage, so more than the colours.
        let shape = !Shared::same(model, &before.model)
            || *back != before.back
            || *culls_opaque != before.culls_opaque
            || *polygons != before.polygons
            || *filled != before.filled
            || *strokes != before.strokes
            || *bodies != before.bodies
            || lines_key(lines) != lines_key(&before.lines)
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
        let holes = |plan: &FramePlan, part: &Option<u32>| {
            part.map(|pipeline| holes_key(&plan.pipelines[pipeline as usize]))
        };
        let mut parts = before.part_pipelines.iter().zip(&after.part_pipelines);
        parts.any(|(old, new)| holes(self.before, old) != holes(self.after, new))
    }

    fn alike_parts(&mut self, before: &[Option<u32>], after: &[Option<u32>]) -> bool {
        before.len() == after.len()
            && before.iter().zip(after).all(|pair| match pair {
                (Some(before), Some(after)) => self.alike_pipelines(*before, *after),
                (before, after) => before == after,
            })
    }

    fn alike_pipelines(&mut self, before: u32, after: u32) -> bool {
        // Many parts share few pipelines, so each pair is compared once.
        *self.pipelines.entry((before, after)).or_insert_with(|| {
            let key = |plan: &FramePlan, pipeline: u32| match &plan.pipelines[pipeline as usize] {
                Pipeline::Flat(color) => (Some(*color), None),
                Pipeline::Shaded(shaded) => (None, Some(surface_key(plan, shaded))),
            };
            key(self.before, before) == key(self.after, after)
        })
    }
}

/// Returns a key that is equal for surfaces that get the same colours. Lights are compared by
/// value, because their indices may differ between plans.
fn surface_key(plan: &FramePlan, shaded: &Shaded) -> impl PartialEq + use<> {
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
    } = shaded;
    let stage = |stage: &Stage| {
        let Stage { effect, light, highlight, is_mapped } = *stage;
        let casts_shadows = plan.shadows.source(light).is_some();
        let light = light_key(&plan.lights[light as usize]);
        (effect.name, highlight, is_mapped, casts_shadows, light)
    };
    let light: Option<Vec<_>> = light.as_ref().map(|stages| stages.iter().map(stage).collect());
    let PhongMaterial { ambient, diffuse, specular, exponent, floor, least_cosine } = *material;
    (
        (light, *tiled, *vertex_colors),
        [ambient, diffuse, specular, *tint, [exponent, floor, least_cosine]].map(bits),
        [cutout, opacity].map(|number| number.map(f64::to_bits)),
        // Textures are compared by address: comparing pixels would cost more than drawing.
        [address(texture), address(opacity_map)],
        extras.identity(),
    )
}

/// Returns a key that is equal for surfaces with the same holes and the same transparency.
fn holes_key(pipeline: &Pipeline) -> impl PartialEq + use<> {
    let Pipeline::Shaded(shaded) = pipeline else { return None };
    let Shaded { cutout, opacity, texture, opacity_map, .. } = shaded;
    let is_solid = cutout.is_none() && opacity.is_none();
    let numbers = [cutout, opacity].map(|number| number.map(f64::to_bits));
    Some((!is_solid).then(|| (numbers, address(texture), address(opacity_map))))
}

fn light_key(light: &ViewLight) -> impl PartialEq + use<> {
    let ViewLight { color, ground, position, direction, attenuation, cos_half_aperture, exponent } =
        *light;
    let vectors = [color, ground, position, direction, attenuation].map(bits);
    (vectors, bits([cos_half_aperture, exponent]))
}

fn lines_key(lines: &Lines) -> impl PartialEq + use<> {
    let Lines { edges, face_normals, vertex_normals, color } = *lines;
    (edges, color, face_normals.map(f64::to_bits), vertex_normals.map(f64::to_bits))
}

fn bits<const N: usize>(numbers: [f64; N]) -> [u64; N] {
    numbers.map(f64::to_bits)
}
