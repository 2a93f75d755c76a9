//! Shadow maps: pictures of depths from the positions of lights.
//!
//! Maps are rendered with the renderer's own visibility buffer: one picture for a sun, fitted to
//! the casters; one for a spot; six of 90 degrees each for a bulb and for a spot wider than
//! [`WIDEST`]. A picture without casters has no texels. Depths are 1 near and 0 far, as everywhere,
//! which gives spots and bulbs the same relative precision at every distance.
//!
//! **Bias against shadow acne.** A texel's depth is moved away from the light by the change of
//! depth within the compared area: s = |dz/dx| + |dz/dy| times half a texel, or times one and a
//! half if nine texels are compared (PCF). s is the largest slope among the planes of the texel and
//! of the neighbours that continue its surface, out of eight, because a point in the texel may lie
//! on any of them. It is limited to [`STEEPEST`](super::map_draws) times the slope of a surface at
//! 45 degrees. Up to that slope, no plane shades itself.
//!
//! Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978; Reeves, Salesin and Cook,
//! "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987. The projection without a far
//! plane: Upchurch and Desbrun, "Tightening the Precision of Perspective Rendering", 2012.

use fearless_simd::Level;
use glam::{DMat3, DMat4, DVec3};

use super::map_draws::{MapDraws, MapView};
use super::map_face::LightMap;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::shadows::{Caster, ShadowSource};
use marraztu_core::accuracy::{Filter, ShadowMapForm};
use marraztu_core::base::math::placed;

/// The shadow maps of a frame, cached until their light or the casters change.
#[derive(Debug, Default)]
pub(crate) struct ShadowMaps {
    form: Option<ShadowMapForm>,
    filter: Filter,
    casters: Vec<Caster>,
    lights: Vec<(ShadowSource, LightMap)>,
}

/// The cosine of the largest half-aperture that a spot covers with one picture: 70 degrees.
const WIDEST: f64 = 0.342;

/// The smallest distance of a map's near plane, relative to the farthest caster. Closer geometry
/// casts no shadow.
const NEAR: f64 = 1e-3;

impl ShadowMaps {
    /// Draws the missing maps of a plan, unless cancelled, and drops all others.
    pub(crate) fn update(&mut self, level: Level, plan: &FramePlan, watch: &Cancellation<'_>) {
        // Ray tracing and frames without shadows keep no maps.
        let Some(form) = plan.variants.shadow_method.map().filter(|_| plan.shadows.are_cast())
        else {
            return *self = Self::default();
        };
        let casters = &plan.shadows.casters;
        // Any other caster, form or filter invalidates all maps.
        let are_same = self.form == Some(form)
            && self.filter == plan.filter
            && self.casters.len() == casters.len()
            && self.casters.iter().zip(casters).all(|(a, b)| a.is_same(b));
        if !are_same {
            let casters = casters.clone();
            *self = Self { form: Some(form), filter: plan.filter, casters, lights: Vec::new() };
        }
        let sources: Vec<&ShadowSource> = plan.shadows.sources.iter().flatten().collect();
        // Lights that moved lose their maps; the others keep them.
        self.lights.retain(|(source, _)| sources.iter().any(|other| source.is_same(other)));
        let missing = sources.iter().filter(|source| self.of(source).is_none());
        let missing: Vec<ShadowSource> = missing.map(|source| **source).collect();
        if missing.is_empty() {
            return;
        }
        let mut draws = MapDraws::new(plan, form);
        for source in missing {
            // A cancelled update keeps the finished maps; the next update draws the rest.
            if !watch.goes_on() {
                return;
            }
            let views = views_of(&source, &Around::of(casters));
            // Empty pictures are dropped, because points outside all pictures are lit.
            let faces = views.iter().filter_map(|view| draws.face(level, view)).collect();
            self.lights.push((source, LightMap { faces, is_filtered: form.is_filtered }));
        }
    }

    /// Returns the map of a light.
    pub(super) fn of(&self, source: &ShadowSource) -> Option<&LightMap> {
        self.lights.iter().find(|(other, _)| other.is_same(source)).map(|(_, map)| map)
    }
}

/// The corners of each caster's bounding box, in world space.
struct Around(Vec<[DVec3; 8]>);

impl Around {
    fn of(casters: &[Caster]) -> Self {
        let corners = |caster: &Caster| {
            let bounds = caster.model.mesh.bounds()?;
            Some(bounds.corners().map(|corner| caster.world_from_object.transform_point3(corner)))
        };
        // One infinite corner would make the range of all casters infinite.
        let is_finite = |corners: &[DVec3; 8]| corners.iter().all(|p| p.is_finite());
        Self(casters.iter().filter_map(corners).filter(is_finite).collect())
    }

    /// Returns the smallest and largest value of a function over the corners.
    fn range(&self, of: impl Fn(&DVec3) -> f64) -> [f64; 2] {
        let all = || self.0.iter().flatten().map(&of);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// Returns the views of a light's pictures.
fn views_of(source: &ShadowSource, around: &Around) -> Vec<MapView> {
    match source {
        // No picture shows all directions that a point may see.
        ShadowSource::Everywhere => Vec::new(),
        ShadowSource::Direction(towards) => sun(*towards, around).into_iter().collect(),
        ShadowSource::Cone { at, direction, cos_half_aperture } if *cos_half_aperture > WIDEST => {
            // A closed cone would have an infinite focal length.
            let cos = cos_half_aperture.min(1.0 - 1e-9);
            let sine = (1.0 - cos * cos).sqrt();
            // Slightly wider than the cone, so PCF finds texels beyond its border.
            vec![face(*at, *direction, cos / sine * 0.98, around)]
        }
        ShadowSource::Point(at) | ShadowSource::Cone { at, .. } => {
            // Six pictures of 90 degrees form a cube map around the light.
            let axes = DVec3::AXES.into_iter().chain(DVec3::AXES.map(|axis| -axis));
            axes.map(|axis| face(*at, axis, 1.0, around)).collect()
        }
    }
}

/// Computes the rotation to a view along a direction.
fn along(direction: DVec3) -> DMat3 {
    let right = direction.any_orthonormal_vector();
    let up = right.cross(direction);
    DMat3::from_cols(right, up, -direction).transpose()
}

/// Computes the view of a sun: orthographic, around all casters.
fn sun(towards: DVec3, around: &Around) -> Option<MapView> {
    let turn = along(-towards);
    let ranges = [0, 1, 2].map(|axis| around.range(|p| (turn * *p)[axis]));
    if !ranges.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    // A margin of a few texels on each side.
    let half = ranges.map(|[low, high]| (high - low) * 0.51 + f64::MIN_POSITIVE);
    // Casters in one plane get a thin volume, so no scale becomes extreme.
    let longest = half[0].max(half[1]).max(half[2]) * 1e-6;
    let half = half.map(|half| half.max(longest));
    let middle = DVec3::from_array(ranges.map(|[low, high]| low.midpoint(high)));
    // z runs from 0 at the far plane to 1 at the near plane.
    let scale = DVec3::new(1.0 / half[0], 1.0 / half[1], 0.5 / half[2]);
    let clip_from_view = DMat4::from_translation(DVec3::new(0.0, 0.0, 0.5))
        * DMat4::from_scale(scale)
        * DMat4::from_translation(-middle);
    let slope = half[0].max(half[1]) / half[2];
    let view_from_world = placed(turn, DVec3::ZERO);
    Some(MapView { view_from_world, clip_from_view, slope, is_perspective: false })
}

/// Computes a view from a point along a direction. `focal` is 1 / the tangent of half of its angle.
fn face(at: DVec3, direction: DVec3, focal: f64, around: &Around) -> MapView {
    let view_from_world = placed(along(direction), DVec3::ZERO) * DMat4::from_translation(-at);
    let [_, farthest] = around.range(|p| p.distance(at));
    // A nearer plane costs no precision: the depth is near / w in f32, 1 at the plane and 0 at
    // infinity, without a far plane.
    let near = (farthest * NEAR).max(f64::MIN_POSITIVE);
    let clip_from_view = DMat4::from_cols_array_2d(&[
        [focal, 0.0, 0.0, 0.0],
        [0.0, focal, 0.0, 0.0],
        [0.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, near, 0.0],
    ]);
    MapView { view_from_world, clip_from_view, slope: 2.0 / focal, is_perspective: true }
}
