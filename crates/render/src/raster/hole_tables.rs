//! Classifies alpha-tested triangles as opaque, empty or mixed.
//!
//! The result depends on the mesh and its textures, not on the observer. It is computed once and
//! kept from frame to frame. Only mixed triangles need the alpha test in each frame.

use rayon::prelude::*;

use super::numbers::number;
use crate::frame::FramePlan;
use crate::frame::draw::{Draw, Pipeline, Shaded};
use crate::texture::opacity::{Holes, Opacity, between};
use crate::texture::uv::uvs;
use marraztu_core::accuracy::Filter;
use marraztu_core::base::Shared;
use marraztu_core::scene::{Model, Texture};

/// The table of each draw of a frame, if the draw has holes. Draws may share one.
#[derive(Debug, Default)]
pub(crate) struct HoleTables(Vec<Option<Shared<HoleTable>>>);

/// The classification of a mesh's triangles with its surfaces.
#[derive(Debug)]
struct HoleTable {
    model: Shared<Model>,
    /// The surface of each part, if it has holes.
    surfaces: Vec<Option<Surface>>,
    filter: Filter,
    holes: Vec<Holes>,
}

/// The inputs that determine the holes of a surface.
#[derive(Clone, Debug)]
struct Surface {
    opacity: f64,
    pictures: [Option<Shared<Texture>>; 2],
}

impl Surface {
    fn of(shaded: &Shaded) -> Option<Self> {
        let pictures = [shaded.texture.clone(), shaded.opacity_map.clone()];
        Some(Self { opacity: shaded.cutout?, pictures })
    }

    fn is_of(&self, shaded: &Shaded) -> bool {
        shaded.cutout.is_some_and(|opacity| opacity.to_bits() == self.opacity.to_bits())
            && Shared::both_same(self.pictures[0].as_ref(), shaded.texture.as_ref())
            && Shared::both_same(self.pictures[1].as_ref(), shaded.opacity_map.as_ref())
    }
}

/// Iterates over the parts of a draw: the surface, if it has holes.
fn with_holes<'a>(
    draw: &'a Draw,
    plan: &'a FramePlan,
) -> impl ExactSizeIterator<Item = Option<&'a Shaded>> {
    draw.part_pipelines.iter().map(|pipeline| match &plan.pipelines[(*pipeline)? as usize] {
        Pipeline::Shaded(shaded) => shaded.cutout.is_some().then_some(shaded),
        Pipeline::Flat(_) => None,
    })
}

impl HoleTable {
    fn new(draw: &Draw, plan: &FramePlan) -> Self {
        let mesh = &draw.model.mesh;
        let parts: Vec<Option<Opacity<'_>>> =
            with_holes(draw, plan).map(|shaded| Opacity::of(shaded?, plan.filter)).collect();
        // Outside of the parallel section.
        parts.iter().flatten().for_each(Opacity::prepare);
        let of = |triangle: usize| {
            let triangle = number(triangle);
            let part = mesh.polygon_parts()[mesh.polygon_of(triangle) as usize];
            let uvs = uvs(draw, triangle);
            let opacity = parts[part as usize].as_ref().zip(uvs);
            // A part without holes is opaque, and so is a triangle without texture coordinates.
            opacity.map_or(Holes::Nowhere, |(opacity, uvs)| opacity.holes(between(uvs)))
        };
        Self {
            model: draw.model.clone(),
            surfaces: with_holes(draw, plan).map(|it| it.and_then(Surface::of)).collect(),
            filter: plan.filter,
            holes: (0..mesh.triangle_count()).into_par_iter().with_min_len(4096).map(of).collect(),
        }
    }

    fn is_of(&self, draw: &Draw, plan: &FramePlan) -> bool {
        let same = |(own, shaded): (&Option<Surface>, Option<&Shaded>)| match own {
            Some(own) => shaded.is_some_and(|shaded| own.is_of(shaded)),
            None => shaded.is_none(),
        };
        Shared::same(&self.model, &draw.model)
            && self.filter == plan.filter
            && self.surfaces.len() == draw.part_pipelines.len()
            && self.surfaces.iter().zip(with_holes(draw, plan)).all(same)
    }
}

impl HoleTables {
    /// Creates the tables that a frame needs, and drops all others.
    pub(crate) fn update(&mut self, plan: &FramePlan) {
        // Only tables that are found again below are kept.
        let last = std::mem::take(&mut self.0);
        for (i, draw) in plan.draws.iter().enumerate() {
            let table = if !draw.filled || with_holes(draw, plan).all(|it| it.is_none()) {
                None
            } else {
                // Usually the table of the last frame still fits.
                let mut known = last.get(i).into_iter().chain(&self.0).chain(&last).flatten();
                let found = known.find(|table| table.is_of(draw, plan)).cloned();
                Some(found.unwrap_or_else(|| Shared::new(HoleTable::new(draw, plan))))
            };
            self.0.push(table);
        }
    }

    /// Returns the classification of each triangle of a draw; empty if the draw has no holes.
    pub(crate) fn of_draw(&self, draw: usize) -> &[Holes] {
        self.0.get(draw).and_then(Option::as_ref).map_or(&[], |table| &table.holes)
    }
}
