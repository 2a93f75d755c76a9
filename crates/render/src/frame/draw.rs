//! The draws of a frame, and the pipelines that colour them.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::{DMat3, DMat4};

use super::extras::{Extras, bits};
use crate::lights::{Form, LightRow, PhongMaterial};
use marraztu_core::base::{Shared, color::Color};
use marraztu_core::scene::{ItemId, Model, NormalSource, Normals, Texture};

/// One mesh of a frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Draw {
    /// The item to draw.
    pub(crate) item: ItemId,
    /// The shape.
    pub(crate) model: Shared<Model>,
    pub(crate) clip_from_object: DMat4,
    pub(crate) view_from_object: DMat4,
    /// The normal transform: sign(det) cof.
    pub(crate) view_from_normal: DMat3,
    /// Whether the placement mirrors: front faces then run clockwise.
    pub(crate) mirrored: bool,
    pub(crate) back: Back,
    /// Whether back faces of opaque parts are culled although those of transparent parts are lit.
    pub(crate) culls_opaque: bool,
    pub(crate) normals: Normals,
    pub(crate) normal_source: NormalSource,
    /// The pipeline of each part; `None` for parts that are not drawn.
    pub(crate) part_pipelines: Vec<Option<u32>>,
    /// The pipeline of all parts, if they share one.
    pub(crate) uniform: Option<u32>,
    /// The body of glass that each part belongs to: the number of its first part. Empty if each
    /// part is a body of its own.
    pub(crate) bodies: Vec<u32>,
    /// The polygons to draw, if not all are drawn.
    pub(crate) polygons: Option<BTreeSet<u32>>,
    pub(crate) filled: bool,
    pub(crate) lines: Lines,
    /// The lines and points of the mesh, if any are drawn.
    pub(crate) strokes: Option<DrawnStrokes>,
}

impl Draw {
    /// Returns whether a polygon is shown: its part is shown, and it is among the drawn polygons.
    pub(crate) fn shows(&self, polygon: u32) -> bool {
        let part = self.model.mesh.polygon_parts()[polygon as usize];
        self.part_pipelines[part as usize].is_some()
            && self.polygons.as_ref().is_none_or(|some| some.contains(&polygon))
    }

    /// Returns the pipeline of a drawn triangle.
    #[inline(always)]
    pub(crate) fn pipeline_of(&self, triangle: u32) -> u32 {
        self.uniform.unwrap_or_else(|| {
            let mesh = &self.model.mesh;
            let polygon = mesh.polygon_of(triangle);
            let part = mesh.polygon_parts()[polygon as usize];
            // A drawn triangle belongs to a shown part, which has a pipeline.
            self.part_pipelines[part as usize].unwrap_or(0)
        })
    }
}

/// Returns the pipeline of all parts, if they share one: no triangle has to look up its part then.
pub(crate) fn uniform(part_pipelines: &[Option<u32>]) -> Option<u32> {
    let first = part_pipelines.first().copied().flatten();
    first.filter(|_| part_pipelines.iter().all(|pipeline| *pipeline == first))
}

/// The drawing of back faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Back {
    /// Back-face culling.
    Culled,
    /// Red, without light.
    Red,
    /// Lit, with reversed normals.
    Lit,
}

/// The lines of a draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lines {
    /// Whether the outlines of polygons are drawn.
    pub(crate) edges: bool,
    /// The drawn length of face normals, in object space.
    pub(crate) face_normals: Option<f64>,
    /// The drawn length of vertex normals, in object space.
    pub(crate) vertex_normals: Option<f64>,
    /// The colour of the lines.
    pub(crate) color: Color,
}

impl Lines {
    /// No lines.
    pub(crate) const NONE: Self =
        Self { edges: false, face_normals: None, vertex_normals: None, color: Color::WHITE };
}

/// How the lines and points of a mesh are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DrawnStrokes {
    /// The colour of the strokes of each part; `None` for parts that are not drawn.
    pub(crate) colors: Vec<Option<Color>>,
    /// Whether the colours of vertices are shown instead.
    pub(crate) vertex_colors: bool,
}

/// The stages that colour a surface, in order.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a frame has few pipelines, most of them shaded")]
pub(crate) enum Pipeline {
    /// One colour, independent of light.
    Flat(Color),
    /// Texture, tint and vertex colours, and light if the surface is lit.
    Shaded(Shaded),
}

impl Pipeline {
    /// See [`FramePlan::keys`](super::FramePlan::keys).
    pub(crate) fn key(&self) -> String {
        let Self::Shaded(shaded) = self else { return "flat".to_owned() };
        let mut key = Vec::new();
        let light = shaded.light.as_deref();
        key.extend(light.is_none().then(|| "unlit".to_owned()));
        key.extend(shaded.needs_positions.then(|| "places".to_owned()));
        key.extend(light.unwrap_or_default().iter().map(|stage| match stage.highlight {
            Form::Plain => stage.effect.name.to_owned(),
            Form::Reflection => format!("{} R.V", stage.effect.name),
            Form::HalfVector => format!("{} N.H", stage.effect.name),
        }));
        key.extend(shaded.texture.as_ref().map(|_| "texture".to_owned()));
        key.extend(shaded.cutout.map(|_| "holes".to_owned()));
        key.extend(shaded.opacity.map(|_| "transparent".to_owned()));
        key.extend(shaded.opacity_map.as_ref().map(|_| "opacity map".to_owned()));
        key.extend(shaded.vertex_colors.then(|| "vertex colours".to_owned()));
        key.extend(shaded.extras.key().map(str::to_owned));
        key.join(" + ")
    }

    /// Returns a hash: equal pipelines share it, different ones hardly ever do.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        match self {
            Self::Flat(color) => color.0.hash(&mut hasher),
            Self::Shaded(shaded) => shaded.hash_into(&mut hasher),
        }
        hasher.finish()
    }

    /// Returns whether the pipeline needs the alpha test.
    pub(crate) const fn is_cutout(&self) -> bool {
        matches!(self, Self::Shaded(Shaded { cutout: Some(_), .. }))
    }

    /// Returns the opacity, if the pipeline is transparent.
    pub(crate) const fn opacity(&self) -> Option<f64> {
        match self {
            Self::Shaded(Shaded { opacity, .. }) => *opacity,
            Self::Flat(_) => None,
        }
    }
}

/// See [`Pipeline::Shaded`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shaded {
    /// The Phong material.
    pub(crate) material: PhongMaterial,
    /// The lights that are evaluated; `None` if the surface is not lit.
    pub(crate) light: Option<Vec<Stage>>,
    /// Whether any light reads positions and normals.
    pub(crate) needs_positions: bool,
    /// Whether lights may be culled tile by tile: nothing of the surface is clipped, so each
    /// pixel's depth tells its position.
    pub(crate) tiled: bool,
    /// Whether vertex colours are multiplied in.
    pub(crate) vertex_colors: bool,
    /// The tint as factors.
    pub(crate) tint: [f64; 3],
    /// The texture.
    pub(crate) texture: Option<Shared<Texture>>,
    /// For the alpha test: the material's opacity, if the texture's alpha may bring it below one
    /// half.
    pub(crate) cutout: Option<f64>,
    /// For a transparent surface: its opacity, which multiplies the texture's alpha.
    pub(crate) opacity: Option<f64>,
    /// The opacity map, which multiplies the opacity in the alpha test.
    pub(crate) opacity_map: Option<Shared<Texture>>,
    /// Emission and additional maps.
    pub(crate) extras: Extras,
}

impl Shaded {
    /// Creates an opaque, unlit surface of a material, without any texture or map.
    pub(crate) fn unlit(material: PhongMaterial) -> Self {
        Self {
            material,
            light: None,
            needs_positions: false,
            tiled: false,
            vertex_colors: false,
            tint: [1.0; 3],
            texture: None,
            cutout: None,
            opacity: None,
            opacity_map: None,
            extras: Extras::default(),
        }
    }

    /// Returns the lights that are evaluated.
    pub(crate) fn stages(&self) -> &[Stage] {
        self.light.as_deref().unwrap_or_default()
    }

    /// Returns whether the surface itself has a colour or an opacity for each pixel.
    pub(crate) fn varies(&self) -> bool {
        self.texture.is_some()
            || self.vertex_colors
            || self.extras.reads_texels()
            // In the alpha test, an opacity map cuts holes but changes no colour.
            || (self.opacity.is_some() && self.opacity_map.is_some())
    }

    /// Hashes the properties that equal surfaces share; of a texture, only its source.
    fn hash_into(&self, hasher: &mut DefaultHasher) {
        // Destructured without `..`, so a new field cannot be forgotten.
        let Self {
            material,
            light,
            needs_positions,
            tiled,
            vertex_colors,
            tint,
            texture,
            cutout,
            opacity,
            opacity_map,
            extras,
        } = self;
        let PhongMaterial { ambient, diffuse, specular, exponent, floor, least_cosine } = material;
        for color in [ambient, diffuse, specular, tint] {
            color.map(bits).hash(hasher);
        }
        [*exponent, *floor, *least_cosine].map(bits).hash(hasher);
        (*needs_positions, *tiled, *vertex_colors).hash(hasher);
        (cutout.map(bits), opacity.map(bits)).hash(hasher);
        // Pipelines with the same hash are still compared, so these two fields suffice.
        for stage in light.iter().flatten() {
            (stage.effect.name, stage.light).hash(hasher);
        }
        // Hashing the texels would take too long.
        texture.as_ref().map(|texture| &texture.source).hash(hasher);
        opacity_map.as_ref().map(|map| &map.source).hash(hasher);
        extras.hash_into(hasher);
    }
}

/// One light on one surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    pub(crate) effect: &'static LightRow,
    /// The index of the light in the plan.
    pub(crate) light: u32,
    pub(crate) highlight: Form,
    /// Whether a map multiplies the exponent of the highlight.
    pub(crate) is_mapped: bool,
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        // Names identify rows; function pointers may differ between equal rows.
        let key = |stage: &Self| (stage.effect.name, stage.light, stage.highlight, stage.is_mapped);
        key(self) == key(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::extras::Glow;

    fn shaded(change: impl FnOnce(&mut Shaded)) -> u64 {
        let mut shaded = Shaded::unlit(PhongMaterial::default());
        shaded.light = Some(Vec::new());
        change(&mut shaded);
        Pipeline::Shaded(shaded).fingerprint()
    }

    #[test]
    fn equal_pipelines_share_a_fingerprint_and_others_are_told_apart() {
        let plain = shaded(|_| {});
        let zero = shaded(|shaded| shaded.tint[0] = 0.0);
        assert_eq!(shaded(|shaded| shaded.tint[0] = -0.0), zero, "0 and -0 are equal");
        let others = [
            shaded(|shaded| shaded.material.diffuse[1] = 0.5),
            shaded(|shaded| shaded.material.exponent = 9.0),
            shaded(|shaded| shaded.material.floor = -3.0),
            shaded(|shaded| shaded.tint[2] = 0.5),
            shaded(|shaded| shaded.cutout = Some(1.0)),
            shaded(|shaded| shaded.opacity = Some(1.0)),
            shaded(|shaded| shaded.vertex_colors = true),
            shaded(|shaded| {
                shaded.extras.emission = Some(Glow { color: [0.0, 0.0, 0.5], map: None });
            }),
            Pipeline::Flat(Color::WHITE).fingerprint(),
            Pipeline::Flat(Color::BACK_FACE).fingerprint(),
        ];
        let all: BTreeSet<u64> = others.into_iter().chain([plain]).collect();
        assert_eq!(all.len(), 11);
    }
}
