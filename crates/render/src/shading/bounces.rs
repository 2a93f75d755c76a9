//! What surfaces show of their surroundings: rays that are mirrored and refracted, and the points
//! that they meet.
//!
//! The points of a list send out rays, and so do the points that these meet: a tree (Whitted, "An
//! Improved Illumination Model for Shaded Display", CACM 1980). All trees of a list grow together,
//! a generation at a time. Its points are sorted by surface and shaded as lists ([`super::hits`]).
//! Each branch of a tree has a weight, the product of the fractions of light on the way to the
//! pixel, so the sum over all branches is the light of the pixel. A pixel's own rays alone decide
//! it, in their order: no bit depends on the others of the list.
//!
//! Rays have a width, so that textures are filtered: Akenine-Möller et al., "Improved Shader and
//! Texture Level of Detail Using Ray Cones", JCGT 2021.

use glam::DVec3;

use super::context::{Around, Group, ShadingContext};
use super::hits::{MOST, Point, no_light};
use super::interpolated::ShadingNumber;
use super::lit_points::{light_place, shares, within};
use super::map_rows::Map;
use super::map_texels::TexelSource;
use super::optics::{Media, Meeting, reflectance};
use super::shader::Shader;
use super::surroundings::{corners_of, normals_of};
use crate::frame::draw::{Draw, Pipeline};
use crate::frame::extras::SurfaceRays;
use crate::frame::{Eye, FramePlan};
use crate::lights::Rows;
use crate::rays::{Corners, Hit, OwnTriangles, Ray, RayStack};
use crate::screen::sample_positions::MANY;
use crate::screen::weights::Weights;
use crate::shadow::rays::RayCount;
use crate::shadow::sequence::after_bounces;
use crate::simd::{BATCH, Bits, dispatch};
use marraztu_core::base::math::unit;

/// The memory of a thread for rays, reused from list to list.
#[derive(Debug)]
pub(crate) struct Bounces<T> {
    /// Shades the points that rays meet.
    pub(super) shader: Shader<T>,
    /// The rays of this generation and of the next.
    branches: Vec<Branch>,
    next: Vec<Branch>,
    met: Vec<Option<Met>>,
    /// The points of the generation, sorted by surface: the thing, the pipeline and the branch.
    order: Vec<[u32; 3]>,
    stack: RayStack,
    light: Rows<T>,
    /// The light of each fragment of the list.
    sums: Vec<[f64; 3]>,
    /// The rays since the frame began.
    count: u64,
}

/// A ray of a tree.
#[derive(Clone, Copy, Debug)]
struct Branch {
    ray: Ray,
    /// The fraction of its light that reaches the pixel.
    weight: [f64; 3],
    /// The index of the fragment.
    target: usize,
    /// The place of its samples in the sequences of lights.
    place: u32,
    /// The environment of the mirror that it comes from, if that has one of its own.
    environment: Option<OwnEnvironment>,
    cone: Cone,
    /// The number of mirrors and refractions on its way.
    bounces: u32,
    /// The number of surfaces that it has passed through unbent since then.
    layers: u32,
    media: Media,
}

/// The environment of a mirror.
#[derive(Clone, Copy, Debug)]
struct OwnEnvironment {
    /// The pipeline that holds it, in the plan of the surroundings.
    pipeline: u32,
    /// Whether nothing else is seen.
    is_alone: bool,
}

/// The width of a ray at its start, and its growth per unit of distance.
#[derive(Clone, Copy, Debug)]
struct Cone {
    width: f64,
    spread: f64,
}

/// A point that a branch meets, shaded.
#[derive(Clone, Copy, Debug)]
struct Met {
    point: Point,
    light: [f64; 3],
    opacity: f64,
    /// The normal on the side of the ray, and the map of Ks; only of surfaces that send rays on.
    normal: DVec3,
    mapped: [f64; 3],
}

/// A point that sends rays on.
struct Sender<'a> {
    rays: &'a SurfaceRays,
    own: OwnTriangles,
    draw: &'a Draw,
    position: DVec3,
    corners: Corners,
    normal: DVec3,
    face: DVec3,
    is_front: bool,
    /// The map of Ks.
    mapped: [f64; 3],
    /// Its pipeline in the plan of the surroundings.
    pipeline: u32,
}

/// The most surfaces that a ray passes through unbent.
const MOST_LAYERS: u32 = 64;

/// Branches with less of their light are cut off: a thousandth of a byte step of white.
const FAINT: f64 = 1.0 / 255_000.0;

impl<T: ShadingNumber> Default for Bounces<T> {
    fn default() -> Self {
        Self {
            shader: Shader::default(),
            branches: Vec::new(),
            next: Vec::new(),
            met: Vec::new(),
            order: Vec::new(),
            stack: RayStack::default(),
            light: no_light(),
            sums: Vec::new(),
            count: 0,
        }
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Adds what the surfaces of the list show of their surroundings to the glow.
    pub(super) fn see_surroundings(&mut self, group: &Group<'_, T>, rays: &SurfaceRays) {
        let Some(around) = group.context.around else { return };
        let mut bounces = self.bounces.take().unwrap_or_default();
        bounces.sums.clear();
        bounces.sums.resize(self.fragments.len, [0.0; 3]);
        bounces.branches.clear();
        self.cast(group, (around, rays), &mut bounces);
        bounces.follow(around);
        for (i, sum) in bounces.sums.iter().enumerate() {
            for ((glow, seen), part) in self.maps.glow.iter_mut().zip(&mut self.maps.seen).zip(sum)
            {
                seen[i] = T::from_f64(*part);
                glow[i] = glow[i] + seen[i];
            }
        }
        self.bounces = Some(bounces);
    }

    /// Casts the first rays of the list: one through each sample of a pixel.
    fn cast(
        &mut self,
        group: &Group<'_, T>,
        (around, rays): (&Around<'_, T>, &SurfaceRays),
        to: &mut Bounces<T>,
    ) {
        let ShadingContext { plan, frame, .. } = *group.context;
        let Some(thing) = around.of_draws[group.draw_index as usize] else { return };
        let mapped = self.mapped_specular(group, rays);
        let positions = frame.sample_positions();
        let count = positions.shares().cast_unsigned();
        let share = 1.0 / f64::from(positions.shares());
        let pixel = plan.pixel_size() * share.sqrt();
        let vertices = frame.corners_of(group.draw_index);
        let draw = group.draw;
        for slot in 0..self.attributes.count {
            let of_slot = self.fragments_of(slot);
            if of_slot == [0; BATCH.div_ceil(64)] {
                continue;
            }
            let number = self.attributes.numbers[slot];
            let corners = corners_of(draw, number);
            let is_front = self.attributes.back >> slot & 1 == 0;
            let side = if is_front { 1.0 } else { -1.0 };
            let normals = normals_of(draw, number).map(|normal| normal * side);
            let outside = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let outside = outside.normalize_or_zero();
            let pipeline = around.surroundings.draw(thing).0.pipeline_of(number);
            for (sample, ray) in (0..positions.count()).zip(0..) {
                let shift =
                    if positions.are_many() { positions.shift::<MANY>(sample) } else { [0; 2] };
                let weights = Weights::of_samples(plan, draw, vertices, (number, shift));
                for i in of_slot
                    .iter()
                    .enumerate()
                    .flat_map(|(word, bits)| Bits(*bits).map(move |bit| 64 * word + bit))
                {
                    let at = [self.fragments.x[i], self.fragments.y[i]];
                    let [y, z] = shares(weights.at(at));
                    let position = within(&corners, [y, z]);
                    let towards = match plan.eye {
                        Eye::Point => unit(position).unwrap_or(DVec3::NEG_Z),
                        Eye::Parallel => DVec3::NEG_Z,
                    };
                    let cone = match plan.eye {
                        Eye::Point => Cone { width: pixel * position.length(), spread: pixel },
                        Eye::Parallel => Cone { width: pixel, spread: 0.0 },
                    };
                    let smooth = normals[0] * (1.0 - y - z) + normals[1] * y + normals[2] * z;
                    let normal = unit(smooth + self.bend_of(group, i)).unwrap_or(outside);
                    let face = if outside.dot(towards) > 0.0 { -outside } else { outside };
                    let sender = Sender {
                        rays,
                        own: OwnTriangles::one(thing, number),
                        draw,
                        position,
                        corners,
                        normal,
                        face,
                        is_front,
                        mapped: mapped[i],
                        pipeline,
                    };
                    let first = Branch {
                        ray: Ray { from: DVec3::ZERO, towards, own: None },
                        weight: [share; 3],
                        target: i,
                        place: light_place(plan, at).wrapping_mul(count).wrapping_add(ray),
                        environment: None,
                        cone,
                        bounces: 0,
                        layers: 0,
                        media: Media::default(),
                    };
                    send_on(&sender, &first, &mut to.branches);
                }
            }
        }
    }

    /// Returns a bit for each fragment in a slot.
    fn fragments_of(&self, slot: usize) -> [u64; BATCH.div_ceil(64)] {
        let mut bits = [0; BATCH.div_ceil(64)];
        for (i, own) in self.fragments.slots[..self.fragments.len].iter().enumerate() {
            bits[i / 64] |= u64::from(own.cast_unsigned() as usize == slot) << (i % 64);
        }
        bits
    }

    /// Returns the map of Ks at each fragment; 1 without a map.
    fn mapped_specular(&mut self, group: &Group<'_, T>, rays: &SurfaceRays) -> [[f64; 3]; BATCH] {
        let Some(map) = &rays.map else { return [[1.0; 3]; BATCH] };
        let source = TexelSource::of_colors(group.context, map);
        self.read_map(group, (Map::Mirror, source), [1.0; 3]);
        let [r, g, b] = &self.maps.texels;
        std::array::from_fn(|i| [r[i].into(), g[i].into(), b[i].into()])
    }

    /// Returns the difference that a bump map makes to the normal of a fragment.
    fn bend_of(&self, group: &Group<'_, T>, i: usize) -> DVec3 {
        let is_bent = group.shaded.is_some_and(|shaded| shaded.extras.bump.is_some());
        if !is_bent {
            return DVec3::ZERO;
        }
        let at = |rows: &Rows<T>| DVec3::from(rows.each_ref().map(|row| row[i].into()));
        at(&self.batch.normal) - at(&self.maps.unbent)
    }
}

impl<T: ShadingNumber> Bounces<T> {
    /// Begins a frame.
    pub(super) fn begin(&mut self) {
        self.count = 0;
        self.shader.begin();
    }

    /// Returns the rays since the frame began, with the shadow rays of the points that they met.
    pub(super) fn count(&self) -> RayCount {
        RayCount { bounced: self.count, ..self.shader.ray_count() }
    }

    /// Follows all rays to their ends, and adds up their light.
    fn follow(&mut self, around: &Around<'_, T>) {
        while !self.branches.is_empty() {
            self.count += self.branches.len() as u64;
            self.meet(around);
            self.shade(around);
            self.grow(around);
            std::mem::swap(&mut self.branches, &mut self.next);
        }
    }

    /// Finds the points that the rays of this generation meet.
    fn meet(&mut self, around: &Around<'_, T>) {
        let Self { branches, met, order, stack, .. } = self;
        met.clear();
        let surroundings = &around.surroundings;
        let stops = |hit: &Hit| surroundings.stops(hit);
        dispatch!(around.context.level, simd => for branch in &*branches {
            let hit = match branch.environment {
                Some(OwnEnvironment { is_alone: true, .. }) => None,
                _ => surroundings.things.nearest(simd, &branch.ray, &stops, stack),
            };
            met.push(hit.map(|hit| {
                let thing = &surroundings.things.all[hit.thing as usize];
                branch.met(hit, thing.corners(hit.triangle))
            }));
        });
        order.clear();
        for (i, met) in (0_u32..).zip(&*met) {
            if let Some(Met { point: Point { hit, .. }, .. }) = met {
                let (draw, _) = surroundings.draw(hit.thing);
                order.push([hit.thing, draw.pipeline_of(hit.triangle), i]);
            }
        }
        order.sort_unstable();
    }

    /// Shades the points of this generation, surface by surface.
    fn shade(&mut self, around: &Around<'_, T>) {
        let Self { shader, met, order, light, .. } = self;
        let context = &around.context;
        let mut points = Vec::with_capacity(MOST);
        for same in order.chunk_by(|a, b| a[..2] == b[..2]) {
            let [thing, pipeline, _] = same[0];
            let (draw, draw_index) = around.surroundings.draw(thing);
            let shaded = match &context.plan.pipelines[pipeline as usize] {
                Pipeline::Shaded(shaded) => Some(shaded),
                Pipeline::Flat(_) => None,
            };
            let program = context.programs.of(draw_index, pipeline);
            let (base, end) = (0, u32::MAX);
            let group = Group { context, draw, draw_index, base, end, pipeline, shaded, program };
            let rays = shaded.and_then(|shaded| shaded.extras.rays.as_ref());
            for list in same.chunks(MOST) {
                points.clear();
                points.extend(list.iter().filter_map(|at| Some(met[at[2] as usize]?.point)));
                shader.shade_points(&group, &points, light);
                let opacities =
                    shaded.and_then(|shaded| shaded.opacity).map(|_| shader.opacities(&group));
                let normals = shader.batch.normal;
                let mapped = rays.filter(|rays| rays.map.is_some());
                let mapped = mapped.map(|rays| shader.mapped_specular(&group, rays));
                for (i, at) in list.iter().enumerate() {
                    let Some(met) = &mut met[at[2] as usize] else { continue };
                    met.light = light.each_ref().map(|row| row[i].into());
                    met.opacity = opacities.map_or(1.0, |all| f64::from(all[i]));
                    met.mapped = mapped.map_or([1.0; 3], |all| all[i]);
                    met.normal = DVec3::from(normals.each_ref().map(|row| row[i].into()));
                }
            }
        }
    }

    /// Adds the light of this generation, and sends rays on.
    fn grow(&mut self, around: &Around<'_, T>) {
        let Self { branches, next, met, sums, .. } = self;
        next.clear();
        let plan = around.context.plan;
        let most = around.context.mode().bounces;
        for (branch, met) in branches.iter().zip(&*met) {
            let Some(met) = met else {
                let behind = branch.light_behind(plan);
                add(&mut sums[branch.target], branch.weight, behind);
                continue;
            };
            let weight = branch.weight.map(|weight| weight * met.opacity);
            add(&mut sums[branch.target], weight, met.light);
            let Hit { thing, triangle, is_front, .. } = met.point.hit;
            let (draw, _) = around.surroundings.draw(thing);
            let own = OwnTriangles::one(thing, triangle);
            // What is behind a transparent surface is seen through it, unbent.
            if met.opacity < 1.0 && branch.layers < MOST_LAYERS {
                let rest = branch.weight.map(|weight| weight * (1.0 - met.opacity));
                let ray = Ray { from: met.point.position(), own: Some(own), ..branch.ray };
                let cone = branch.cone.after(met.point.hit.distance);
                let layers = branch.layers + 1;
                push(Branch { ray, weight: rest, cone, layers, ..*branch }, next);
            }
            let pipeline = draw.pipeline_of(triangle);
            let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { continue };
            let Some(rays) = shaded.extras.rays.as_ref().filter(|_| branch.bounces < most) else {
                continue;
            };
            let sender = Sender {
                rays,
                own,
                draw,
                position: met.point.position(),
                corners: met.point.corners,
                normal: unit(met.normal).unwrap_or(met.point.face()),
                face: met.point.face(),
                is_front,
                mapped: met.mapped,
                pipeline,
            };
            let cone = branch.cone.after(met.point.hit.distance);
            send_on(&sender, &Branch { weight, cone, layers: 0, ..*branch }, next);
        }
    }
}

impl Branch {
    /// Returns the light of the ray if it meets nothing.
    fn light_behind(&self, plan: &FramePlan) -> [f64; 3] {
        let (towards, width) = (self.ray.towards, self.cone.spread.abs());
        let environment = self.environment.and_then(|OwnEnvironment { pipeline, .. }| {
            let Pipeline::Shaded(shaded) = plan.pipelines.get(pipeline as usize)? else {
                return None;
            };
            shaded.extras.rays.as_ref()?.environment.as_ref()
        });
        match environment {
            Some(it) => it.panorama.seen(towards, width),
            None => plan.light_behind(towards, width),
        }
    }

    /// Returns the point that it meets, not shaded yet.
    fn met(&self, hit: Hit, corners: Corners) -> Met {
        let width = self.cone.after(hit.distance).width;
        let place = after_bounces(self.place, self.bounces);
        let point = Point { hit, towards: self.ray.towards, corners, width, place };
        Met { point, light: [0.0; 3], opacity: 1.0, normal: DVec3::ZERO, mapped: [1.0; 3] }
    }
}

impl Cone {
    /// Returns the cone after a distance.
    fn after(self, distance: f64) -> Self {
        Self { width: (self.width + self.spread * distance).abs(), ..self }
    }
}

/// Sends on the mirrored and the refracted ray of a point that a branch meets.
fn send_on(it: &Sender<'_>, branch: &Branch, to: &mut Vec<Branch>) {
    let SurfaceRays { reflection, specular, transmission, index, is_closed, .. } = it.rays;
    let meeting = Meeting { towards: branch.ray.towards, normal: it.normal, face: it.face };
    let specular = std::array::from_fn(|i| specular[i] * it.mapped[i]);
    let transmits = it.rays.transmits();
    // Only closed bodies have an inside.
    let part = it.draw.model.mesh.polygon_of(it.own.first);
    let part = it.draw.model.mesh.polygon_parts()[part as usize];
    let body = it.draw.bodies.get(part as usize).copied().unwrap_or(part);
    let body = u64::from(it.own.thing) << 32 | u64::from(body);
    let (indices, media) = match *is_closed && transmits {
        true => branch.media.across(body, *index, it.is_front),
        false => ([1.0, *index], branch.media),
    };
    let eta = indices[0] / indices[1];
    let refracted = meeting.refracted(if *is_closed { eta } else { 1.0 });
    let cosine = match &refracted {
        // The angle in the medium of the lower index decides.
        Some(refracted) if *is_closed && eta > 1.0 => refracted.cosine,
        _ => meeting.cosine(),
    };
    let reflected = match refracted {
        // Total reflection.
        None if transmits => [1.0; 3],
        _ => reflectance(*reflection, specular, cosine, indices),
    };
    let bend = curvature(&it.corners, it.draw, (it.own.first, it.is_front));
    let Cone { width, spread } = branch.cone;
    let from = it.position;
    let environment = it.rays.environment.as_ref();
    let environment =
        environment.map(|own| OwnEnvironment { pipeline: it.pipeline, is_alone: own.is_alone });
    let sent = |towards: DVec3, spread: f64, share: [f64; 3], media: Media| Branch {
        ray: Ray { from, towards, own: Some(it.own) },
        weight: std::array::from_fn(|i| branch.weight[i] * share[i]),
        cone: Cone { width, spread },
        bounces: branch.bounces + 1,
        environment: None,
        media,
        ..*branch
    };
    if reflected != [0.0; 3] {
        let spread = spread + 2.0 * bend * width;
        let mirrored = sent(meeting.mirrored(), spread, reflected, branch.media);
        push(Branch { environment, ..mirrored }, to);
    }
    if let Some(refracted) = refracted.filter(|_| transmits) {
        let share = std::array::from_fn(|i| (1.0 - reflected[i]) * transmission[i]);
        let (towards, spread) = match *is_closed {
            true => (refracted.towards, eta * spread + (eta - 1.0) * bend * width),
            false => (branch.ray.towards, spread),
        };
        push(sent(towards, spread, share, media), to);
    }
}

/// Adds a branch, unless its light is faint.
fn push(branch: Branch, to: &mut Vec<Branch>) {
    if branch.weight.iter().any(|weight| *weight > FAINT) {
        to.push(branch);
    }
}

/// Adds light with a weight.
fn add(sum: &mut [f64; 3], weight: [f64; 3], light: [f64; 3]) {
    for ((sum, weight), light) in sum.iter_mut().zip(weight).zip(light) {
        *sum += weight * light;
    }
}

/// Returns the mean curvature of a triangle by the normals at its corners, in units of view space:
/// positive if the side that is met is convex.
fn curvature([a, b, c]: &Corners, draw: &Draw, (triangle, is_front): (u32, bool)) -> f64 {
    let [p, q, r] = normals_of(draw, triangle).map(DVec3::normalize_or_zero);
    let along = |from: DVec3, to: DVec3, n: DVec3, m: DVec3| {
        let side = to - from;
        let square = side.length_squared();
        if square > 0.0 { (m - n).dot(side) / square } else { 0.0 }
    };
    let sum = along(*a, *b, p, q) + along(*b, *c, q, r) + along(*c, *a, r, p);
    if is_front { sum / 3.0 } else { -sum / 3.0 }
}
