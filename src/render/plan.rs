//! What a frame needs, and why: decides, and touches no pixel.
//!
//! A [`FramePlan`] holds a snapshot of everything that drawing reads, already in the observer's
//! terms. What the scene does not call for is not in it, and [`FramePlan::skipped`] says why.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use super::effects::{self, Entry, Lamp, Matter};
use super::marks;
use crate::base::image::Size;
use crate::base::{Shared, color::Color, math};
use crate::scene::{
    Arithmetic, Fill, Filter, ItemId, LightAt, LightId, LightKind, Model, NormalLength,
    NormalSource, Normals, Object, Observer, PartLook, Projection, Scene, Settings, SpecularForm,
    SpotOwner, Surface, Texture, View,
};

/// Everything that a frame needs.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Pixels.
    pub(super) size: Size,
    /// What is seen where nothing is.
    pub(super) background: Color,
    /// Where V goes.
    pub(super) eye: Eye,
    /// The numbers that light is computed in.
    pub(super) arithmetic: Arithmetic,
    /// Where light is evaluated.
    pub(super) light_at: LightAt,
    /// What textures give between their texels.
    pub(super) filter: Filter,
    /// `clip_from_view`.
    pub(super) clip_from_view: DMat4,
    /// Width of lines in pixels: 1 or 2.
    pub(super) line_width: i32,
    /// The lights that shine, in the order of the scene.
    pub(super) lamps: Vec<Lamp>,
    /// What is drawn, in the order that decides between equal depths.
    pub(super) draws: Vec<Draw>,
    /// The different ways in which surfaces are drawn.
    pub(super) pipelines: Vec<Pipeline>,
    skipped: Vec<Skipped>,
}

/// Where directions to the observer go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Eye {
    /// To the origin of view space: perspective.
    Point,
    /// Along +Z: parallel projection.
    Parallel,
}

/// One mesh of a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Draw {
    /// Whose it is.
    pub(super) item: ItemId,
    /// Its shape.
    pub(super) model: Shared<Model>,
    pub(super) clip_from_object: DMat4,
    pub(super) view_from_object: DMat4,
    /// What normals are multiplied by: sign(det) cof.
    pub(super) view_from_normal: DMat3,
    /// Whether the placement mirrors: then fronts run clockwise.
    pub(super) mirrored: bool,
    pub(super) back: Back,
    pub(super) normals: Normals,
    pub(super) normal_source: NormalSource,
    /// The pipeline of each part; `None` for parts that are not drawn.
    pub(super) part_pipelines: Vec<Option<u32>>,
    /// The pipeline of all parts, where they share one.
    pub(super) uniform: Option<u32>,
    /// The polygons that are drawn, where not all are.
    pub(super) polygons: Option<BTreeSet<u32>>,
    pub(super) filled: bool,
    pub(super) lines: Lines,
}

impl Draw {
    /// The pipeline of a triangle that is drawn.
    #[inline(always)]
    pub(super) fn pipeline_of(&self, triangle: u32) -> u32 {
        self.uniform.unwrap_or_else(|| {
            let mesh = &self.model.mesh;
            let polygon = mesh.triangles()[triangle as usize].polygon;
            let part = mesh.polygon_parts()[polygon as usize];
            self.part_pipelines[part as usize].unwrap_or(0)
        })
    }
}

/// What becomes of faces that are turned away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Back {
    /// They are not drawn.
    Left,
    /// They are red, and not lit.
    Red,
    /// They are lit with their normals turned.
    Lit,
}

/// The lines that a draw has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lines {
    /// Whether the outlines of polygons are drawn.
    pub(super) edges: bool,
    /// How long the normals of faces are drawn, in object space.
    pub(super) face_normals: Option<f64>,
    /// How long the normals of vertices are drawn, in object space.
    pub(super) vertex_normals: Option<f64>,
    /// Their colour.
    pub(super) color: Color,
}

/// The stages of one way of drawing a surface, in order.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Pipeline {
    /// One colour, whatever the light.
    Flat(Color),
    /// Texture, tint and vertex colours, and light where it is lit.
    Shaded(Shaded),
}

impl Pipeline {
    /// Whether a texture decides where it is drawn.
    pub(super) const fn is_cutout(&self) -> bool {
        matches!(self, Self::Shaded(Shaded { cutout: Some(_), .. }))
    }
}

/// See [`Pipeline::Shaded`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shaded {
    /// What reflects.
    pub(super) matter: Matter,
    /// The lights that are evaluated; `None` where the surface is not lit.
    pub(super) light: Option<Vec<Stage>>,
    /// Whether vertex colours are multiplied in.
    pub(super) vertex_colors: bool,
    /// The tint as factors.
    pub(super) tint: [f64; 3],
    /// The texture.
    pub(super) texture: Option<Shared<Texture>>,
    /// The material's opacity where the texture's alpha may bring it below one half.
    pub(super) cutout: Option<f64>,
}

/// One light on one surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    pub(super) effect: &'static Entry,
    /// Its place in [`FramePlan::lamps`].
    pub(super) lamp: u32,
    pub(super) highlight: Form,
}

impl Stage {
    /// The effect compiled for the stage's highlight.
    pub(super) const fn variant(&self) -> &'static effects::Variant {
        match self.highlight {
            Form::Plain => &self.effect.plain,
            Form::Reflection => &self.effect.reflection,
            Form::HalfVector => &self.effect.half_vector,
        }
    }
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        let key = |stage: &Self| (stage.effect.name, stage.lamp, stage.highlight);
        key(self) == key(other)
    }
}

/// The highlight of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// None: Ks is 0.
    Plain,
    /// (R.V)^Ns
    Reflection,
    /// (N.H)^Ns
    HalfVector,
}

/// An effect that a frame does without, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// What is left out: a light, an object, a texture.
    pub effect: String,
    /// Why nothing of the picture changes by it.
    pub reason: String,
}

impl FramePlan {
    /// Plans the picture of a scene: `size` in pixels, at least 1 x 1.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        let observer = ObserverSpace::new(scene, view, size);
        let mut plan = Self {
            size,
            background: scene.background,
            eye: match view.projection {
                Projection::Perspective => Eye::Point,
                Projection::Orthographic => Eye::Parallel,
            },
            arithmetic: settings.arithmetic,
            light_at: settings.light,
            filter: settings.filter,
            clip_from_view: observer.clip_from_view,
            line_width: if view.wide_lines { 2 } else { 1 },
            lamps: Vec::new(),
            draws: Vec::new(),
            pipelines: Vec::new(),
            skipped: Vec::new(),
        };
        let shining = plan.add_lamps(scene, view, &observer);
        let planner = Planner { scene, view, settings, observer, shining };
        planner.add_objects(&mut plan);
        if view.marks {
            planner.add_marks(&mut plan);
        }
        plan.skipped.dedup();
        plan
    }

    /// What the frame does without.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Pixels.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    fn skip(&mut self, effect: impl Into<String>, reason: impl Into<String>) {
        let skipped = Skipped { effect: effect.into(), reason: reason.into() };
        if !self.skipped.contains(&skipped) {
            self.skipped.push(skipped);
        }
    }

    /// The lights that shine, in the observer's space.
    fn add_lamps(&mut self, scene: &Scene, view: &View, observer: &ObserverSpace) -> Vec<Shining> {
        let mut shining = Vec::new();
        for (id, light) in scene.lights.iter() {
            if !light.on {
                self.skip(&light.name, "switched off");
                continue;
            }
            let Some(source) = source(scene, view, &light.kind) else {
                self.skip(&light.name, "what it is fixed to is not there");
                continue;
            };
            let lamp = u32::try_from(self.lamps.len()).expect("fewer than 2^32 lights");
            let attenuation = light.attenuation;
            let turned = math::unit(observer.view_from_world.transform_vector3(source.direction));
            self.lamps.push(Lamp {
                color: light.color.factors(),
                position: observer.view_from_world.transform_point3(source.position).to_array(),
                direction: turned.unwrap_or(DVec3::NEG_Z).to_array(),
                attenuation: [attenuation.constant, attenuation.linear, attenuation.quadratic],
                cos_half_aperture: source.cos_half_aperture,
                exponent: source.exponent,
            });
            shining.push(Shining { id, name: light.name.clone(), effect: source.effect, lamp });
        }
        shining
    }

    /// The place of a pipeline among those of the frame.
    fn pipeline(&mut self, pipeline: Pipeline) -> u32 {
        let at = self.pipelines.iter().position(|other| *other == pipeline).unwrap_or_else(|| {
            self.pipelines.push(pipeline);
            self.pipelines.len() - 1
        });
        u32::try_from(at).expect("fewer than 2^32 pipelines")
    }
}

/// A light that shines in this frame.
#[derive(Clone, Debug)]
struct Shining {
    id: LightId,
    name: String,
    effect: &'static Entry,
    lamp: u32,
}

/// Where light comes from, in world space.
struct Source {
    effect: &'static Entry,
    position: DVec3,
    direction: DVec3,
    cos_half_aperture: f64,
    exponent: f64,
}

/// Where a light is now; `None` for a spot whose owner is not there.
fn source(scene: &Scene, view: &View, kind: &LightKind) -> Option<Source> {
    let source = |effect, position, direction| Source {
        effect,
        position,
        direction,
        cos_half_aperture: -1.0,
        exponent: 0.0,
    };
    Some(match kind {
        LightKind::Ambient => source(&effects::AMBIENT, DVec3::ZERO, DVec3::NEG_Z),
        LightKind::Sun { direction } => source(&effects::SUN, DVec3::ZERO, *direction.now()),
        LightKind::Bulb { position, orbit } => {
            source(&effects::BULB, orbit.at(*position.now(), view.time), DVec3::NEG_Z)
        }
        LightKind::Spot { owner, half_aperture, exponent } => {
            let (position, direction) = owner_aim(scene, view, owner)?;
            Source {
                cos_half_aperture: libm::cos(half_aperture.to_radians()),
                exponent: *exponent,
                ..source(&effects::SPOT, position, direction)
            }
        }
    })
}

/// From where and which way a spot shines.
fn owner_aim(scene: &Scene, view: &View, owner: &SpotOwner) -> Option<(DVec3, DVec3)> {
    let along = |frame: DMat4| (frame.w_axis.truncate(), -frame.z_axis.truncate());
    let object = |id| scene.objects.get(id).map(|o| along(Scene::frame_of_object(o, view.time)));
    let camera = |id| scene.cameras.get(id).map(|c| along(c.pose.now().world_from_camera()));
    match owner {
        SpotOwner::SelectedObject => object(view.object?),
        SpotOwner::SelectedCamera => camera(view.camera),
        SpotOwner::Object(id) => object(*id),
        SpotOwner::Camera(id) => camera(*id),
        SpotOwner::Fixed(aim) => Some((aim.now().position, aim.now().direction)),
    }
}

/// The observer's spaces.
pub(super) struct ObserverSpace {
    pub(super) world_from_view: DMat4,
    pub(super) view_from_world: DMat4,
    pub(super) clip_from_view: DMat4,
    pub(super) size: Size,
}

impl ObserverSpace {
    fn new(scene: &Scene, view: &View, size: Size) -> Self {
        let world_from_view = scene.observer_frame(view);
        // The axes are orthonormal, so the inverse turn is the transposed one.
        let turn = DMat3::from_mat4(world_from_view).transpose();
        let eye = world_from_view.w_axis.truncate();
        let lens = scene.selected_camera(view).lens;
        Self {
            world_from_view,
            view_from_world: math::placed(turn, DVec3::ZERO) * DMat4::from_translation(-eye),
            clip_from_view: lens.clip_from_view(view.projection, size),
            size,
        }
    }

    /// Whether a box lies wholly outside one of the planes of the view.
    fn misses(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let clip = corners.map(|corner| clip_from_object * corner.extend(1.0));
        // A little is left for rounding, so that nothing is missed that geometry would keep.
        let beyond = |distance: fn(glam::DVec4) -> f64| {
            clip.iter().all(|p| distance(*p) < -1e-9 * (p.w.abs() + p.abs().max_element()))
        };
        beyond(|p| p.w + p.x)
            || beyond(|p| p.w - p.x)
            || beyond(|p| p.w + p.y)
            || beyond(|p| p.w - p.y)
            || beyond(|p| p.z)
            || beyond(|p| p.w - p.z)
    }
}

/// What planning reads.
struct Planner<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: &'a Settings,
    observer: ObserverSpace,
    shining: Vec<Shining>,
}

impl Planner<'_> {
    /// Objects, the oldest first.
    fn add_objects(&self, plan: &mut FramePlan) {
        let mut objects: Vec<_> = self.scene.objects.iter().collect();
        objects.sort_by_key(|(id, _)| *id);
        for (id, object) in objects {
            let selected = self.view.object == Some(id);
            let alone = self.view.only_selected || self.view.polygons.is_some();
            if !object.visible {
                plan.skip(&object.name, "hidden");
            } else if alone && !selected {
                plan.skip(&object.name, "only the selected object is shown");
            } else {
                self.add_object(plan, ItemId::Object(id), object, selected);
            }
        }
    }

    fn add_object(&self, plan: &mut FramePlan, item: ItemId, object: &Object, selected: bool) {
        let placement = object.world_from_object(self.view.time);
        let part_pipelines = (0..object.model.mesh.parts().len())
            .map(|part| {
                let part = u32::try_from(part).expect("parts are numbered by 32 bits");
                (!object.hidden_parts.contains(&part))
                    .then(|| self.object_pipeline(plan, object, part))
                    .flatten()
            })
            .collect();
        let polygons = self.view.polygons.as_ref().filter(|_| selected).map(|mode| {
            if self.view.polygons_stay {
                mode.shown.clone()
            } else {
                BTreeSet::from([mode.current])
            }
        });
        let back = match (object.two_sided, self.view.back_faces) {
            (true, _) => Back::Lit,
            (false, true) => Back::Red,
            (false, false) => Back::Left,
        };
        let draw = Draw {
            back,
            normal_source: if object.file_normals {
                NormalSource::File
            } else {
                NormalSource::Computed
            },
            part_pipelines,
            polygons,
            lines: self.lines(&object.model, object.edge_color),
            ..self.draw(item, &object.model, placement)
        };
        self.add(plan, &object.name, draw);
    }

    /// A draw of a mesh at a place, with everything about its surface still to be said.
    fn draw(&self, item: ItemId, model: &Shared<Model>, world_from_object: DMat4) -> Draw {
        let view_from_object = self.observer.view_from_world * world_from_object;
        let linear = DMat3::from_mat4(view_from_object);
        Draw {
            item,
            model: model.clone(),
            clip_from_object: self.observer.clip_from_view * view_from_object,
            view_from_object,
            view_from_normal: math::normal_matrix(linear),
            mirrored: linear.determinant() < 0.0,
            back: Back::Left,
            normals: self.view.normals,
            normal_source: NormalSource::File,
            part_pipelines: Vec::new(),
            uniform: None,
            polygons: None,
            filled: self.view.fill == Fill::Filled,
            lines: Lines {
                edges: false,
                face_normals: None,
                vertex_normals: None,
                color: Color::WHITE,
            },
        }
    }

    /// Puts a draw into the plan, unless nothing of it can be seen.
    fn add(&self, plan: &mut FramePlan, name: &str, mut draw: Draw) {
        let first = draw.part_pipelines.first().copied().flatten();
        let alike = draw.part_pipelines.iter().all(|pipeline| *pipeline == first);
        draw.uniform = first.filter(|_| alike);
        let linear = DMat3::from_mat4(draw.view_from_object);
        let Some(bounds) = draw.model.mesh.bounds() else {
            return plan.skip(name, "has no vertices");
        };
        let drawn_normals =
            draw.lines.face_normals.is_some() || draw.lines.vertex_normals.is_some();
        if draw.model.mesh.polygon_count() == 0 {
            plan.skip(name, "has no faces");
        } else if !math::has_full_rank(linear) {
            plan.skip(name, "its placement is flat: it has no inside and no outside");
        } else if !drawn_normals && self.observer.misses(draw.clip_from_object, bounds.corners()) {
            plan.skip(name, "outside the view");
        } else {
            plan.draws.push(draw);
        }
    }

    fn lines(&self, model: &Model, color: Color) -> Lines {
        let view = self.view;
        let extent = model.mesh.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
        let length = match view.normal_length {
            NormalLength::Units => 5.0,
            NormalLength::BySize => extent / 20.0,
        };
        Lines {
            edges: view.fill == Fill::Edges || view.edges_over_fill,
            face_normals: view.face_normals.then_some(length),
            vertex_normals: view.vertex_normals.then_some(length),
            color,
        }
    }

    /// How one part of an object is drawn; `None` where its opacity leaves nothing.
    fn object_pipeline(&self, plan: &mut FramePlan, object: &Object, part: u32) -> Option<u32> {
        let look = object.part_look(part);
        let texture = look.texture.filter(|_| !object.model.mesh.uvs().is_empty());
        if object.surface != Surface::Material && texture.is_none() {
            plan.skip(format!("texture of {}", object.name), "there is none");
        }
        let opaque = |texture: &Shared<Texture>| {
            let mut texels = texture.picture.pixels().iter();
            texels.all(|texel| f64::from(texel[3]) / 255.0 * look.opacity >= 0.5)
        };
        let cutout = texture.filter(|texture| !opaque(texture)).map(|_| look.opacity);
        if look.opacity < 0.5 {
            let name = object.model.mesh.parts().get(part as usize).map_or("", |part| &part.name);
            plan.skip(format!("{} of {}", name, object.name), "its opacity is below one half");
            return None;
        }
        let colored = object.surface != Surface::Material;
        let shaded = Shaded {
            vertex_colors: colored && !object.model.mesh.colors().is_empty(),
            tint: if colored { object.tint.factors() } else { [1.0; 3] },
            texture: texture.cloned(),
            cutout,
            ..self.lit(plan, &object.name, &look, object.surface != Surface::Texture)
        };
        Some(plan.pipeline(Pipeline::Shaded(shaded)))
    }

    /// The light of a material.
    fn lit(&self, plan: &mut FramePlan, name: &str, look: &PartLook<'_>, lit: bool) -> Shaded {
        let material = look.material;
        let mut matter = Matter {
            ambient: material.ambient,
            diffuse: material.diffuse,
            specular: material.specular,
            exponent: material.exponent,
            ..Matter::default()
        }
        .with_floor(-24.0);
        let light = lit.then(|| self.stages(plan, name, &matter));
        if !lit {
            plan.skip(format!("light of {name}"), "only its texture is shown");
        }
        if self.settings.arithmetic == Arithmetic::F32 {
            let stages = light.as_deref().unwrap_or_default();
            let count = stages.iter().filter(|stage| stage.highlight != Form::Plain).count();
            let count = u32::try_from(count.max(1)).unwrap_or(u32::MAX);
            // 2^-10 shared out among the highlights, so that all that is left out stays below a
            // quarter of a byte step.
            matter = matter.with_floor(-10.0 - libm::log2(f64::from(count)));
        }
        let (vertex_colors, tint) = (false, [1.0; 3]);
        Shaded { matter, light, vertex_colors, tint, texture: None, cutout: None }
    }

    /// The lights that a material needs, in the order of the scene.
    fn stages(&self, plan: &mut FramePlan, name: &str, matter: &Matter) -> Vec<Stage> {
        let mut stages = Vec::new();
        for Shining { name: light, effect, lamp, .. } in &self.shining {
            let source = plan.lamps[*lamp as usize];
            if let Some(reason) = (effect.needless)(&source, matter) {
                plan.skip(format!("{light} on {name}"), reason);
                continue;
            }
            let mirrored =
                matter.specular.iter().zip(source.color).any(|(ks, color)| ks * color != 0.0);
            let highlight = match self.settings.specular {
                _ if !mirrored => Form::Plain,
                SpecularForm::Reflection => Form::Reflection,
                SpecularForm::HalfVector => Form::HalfVector,
            };
            stages.push(Stage { effect, lamp: *lamp, highlight });
        }
        stages
    }

    /// Cameras that do not look, and bulbs that shine.
    fn add_marks(&self, plan: &mut FramePlan) {
        let object_looks = self.view.observer == Observer::Object
            && self.view.object.is_some_and(|id| self.scene.objects.get(id).is_some());
        for (id, camera) in self.scene.cameras.iter() {
            let looks = !object_looks && self.view.camera == id;
            if looks || !camera.visible {
                continue;
            }
            let mark = Object {
                name: camera.name.clone(),
                ..Object::new(camera.model.clone(), camera.material.clone())
            };
            let placement = marks::world_from_mark(camera);
            let pipelines = (0..mark.model.mesh.parts().len()).map(|part| {
                let part = u32::try_from(part).expect("parts are numbered by 32 bits");
                self.object_pipeline(plan, &mark, part)
            });
            let part_pipelines = pipelines.collect();
            let draw = Draw {
                back: if self.view.back_faces { Back::Red } else { Back::Left },
                part_pipelines,
                lines: self.lines(&mark.model, mark.edge_color),
                ..self.draw(ItemId::Camera(id), &mark.model, placement)
            };
            self.add(plan, &camera.name, draw);
        }
        for (id, position) in self.shining.iter().filter_map(|light| self.bulb_place(light.id)) {
            let Some(placement) = marks::world_from_diamond(&self.observer, position) else {
                continue;
            };
            let pipeline = plan.pipeline(Pipeline::Flat(marks::YELLOW));
            let draw = Draw {
                part_pipelines: vec![Some(pipeline)],
                filled: true,
                ..self.draw(ItemId::Light(id), marks::diamond(), placement)
            };
            self.add(plan, "mark of the bulb", draw);
        }
    }

    fn bulb_place(&self, id: LightId) -> Option<(LightId, DVec3)> {
        match &self.scene.lights.get(id)?.kind {
            LightKind::Bulb { position, orbit } => {
                Some((id, orbit.at(*position.now(), self.view.time)))
            }
            _ => None,
        }
    }
}
