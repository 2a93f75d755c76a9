//! The layers of a picture: for each pixel, the depth, the position, the normal and the ids of its
//! surface. [`Renderer::layers`](super::Renderer::layers) computes them.
//!
//! * A pixel shows the surface that its centre shows, for any number of samples. Layers do not
//!   depend on [`Settings`](marraztu_core::accuracy::Settings); they equal the picture with the
//!   default settings.
//! * Only objects are shown: no edges, drawn normals, or marks of cameras and lights.
//! * A transparent surface counts like an opaque one, so a pixel shows its nearest surface. Holes
//!   of the alpha test show the surface behind.
//! * Values are computed in f64 and rounded once. They are the same for any number of threads.

use std::collections::{BTreeMap, HashMap, TryReserveError};

use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Fill, MaterialChoice, ObjectId, PresetId, Scene, View};

/// A layer of a picture: one or more numbers for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// f32: the distance along the camera's axis, in units of the world; infinite for the
    /// background.
    Depth,
    /// f32: the distance from the camera along the ray, in units of the world; infinite for the
    /// background. In orthographic projection, rays start in the camera's plane.
    Distance,
    /// 3 x f32: the normal that lights the surface, without bump maps, of length 1; 0 for the
    /// background. On a back face it is reversed. See [`NormalSpace`].
    Normal,
    /// 3 x f32: the position in the world; 0 for the background.
    Position,
    /// 2 x f32: the texture coordinates of the file, with (0, 0) at the lower left; 0 for the
    /// background and for surfaces without texture coordinates.
    Uv,
    /// i32: the object, from 1; 0 for the background. [`LayerNames::objects`] lists them.
    Object,
    /// i32: the part of a file (`o`, `g` and `usemtl`), from 1; 0 for the background.
    /// [`LayerNames::parts`] lists them.
    Part,
    /// i32: the material, from 1; 0 for the background. [`LayerNames::materials`] lists them.
    Material,
    /// i32: the polygon of the object, from 1, in the order of its file; 0 for the background.
    /// Faces that are skipped when the file is read do not count.
    Polygon,
    /// u8: 1 if the pixel shows an object, 0 for the background.
    Mask,
}

/// The type of a layer's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerType {
    /// Floating point, 32 bits.
    F32,
    /// Integers, 32 bits.
    I32,
    /// Bytes.
    U8,
}

impl Layer {
    /// All layers.
    pub const ALL: [Self; 10] = [
        Self::Depth,
        Self::Distance,
        Self::Normal,
        Self::Position,
        Self::Uv,
        Self::Object,
        Self::Part,
        Self::Material,
        Self::Polygon,
        Self::Mask,
    ];

    /// Returns the name, the number of numbers per pixel, and their type.
    const fn row(self) -> (&'static str, usize, LayerType) {
        match self {
            Self::Depth => ("depth", 1, LayerType::F32),
            Self::Distance => ("distance", 1, LayerType::F32),
            Self::Normal => ("normal", 3, LayerType::F32),
            Self::Position => ("position", 3, LayerType::F32),
            Self::Uv => ("uv", 2, LayerType::F32),
            Self::Object => ("object", 1, LayerType::I32),
            Self::Part => ("part", 1, LayerType::I32),
            Self::Material => ("material", 1, LayerType::I32),
            Self::Polygon => ("polygon", 1, LayerType::I32),
            Self::Mask => ("mask", 1, LayerType::U8),
        }
    }

    /// Returns the name: `depth`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// Returns the number of numbers per pixel.
    #[must_use]
    pub const fn channels(self) -> usize {
        self.row().1
    }

    /// Returns the type of the numbers.
    #[must_use]
    pub const fn number_type(self) -> LayerType {
        self.row().2
    }

    /// Returns the number that background pixels have in each channel.
    pub(crate) const fn background(self) -> f32 {
        match self {
            Self::Depth | Self::Distance => f32::INFINITY,
            _ => 0.0,
        }
    }
}

/// The space of [`Layer::Normal`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalSpace {
    /// The camera's frame: x to the right, y up, z towards the observer.
    #[default]
    Camera,
    /// The world's frame.
    World,
}

/// The layers to compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct LayerSet(u16);

impl LayerSet {
    /// All layers.
    pub const ALL: Self = Self((1 << Layer::ALL.len()) - 1);

    /// Returns the set with another layer.
    #[must_use]
    pub const fn with(self, layer: Layer) -> Self {
        Self(self.0 | 1 << layer as u16)
    }

    /// Returns whether the set has a layer.
    #[must_use]
    pub const fn has(self, layer: Layer) -> bool {
        self.0 >> layer as u16 & 1 != 0
    }

    /// Returns whether the set has no layer.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Checks that there is memory for a picture with these layers, which Rust cannot report while
    /// it draws. Another thread may take the memory meanwhile.
    ///
    /// # Errors
    /// If the memory cannot be reserved.
    pub fn check_memory(self, size: Size) -> Result<(), TryReserveError> {
        let bytes = |layer: Layer| match layer.number_type() {
            LayerType::F32 | LayerType::I32 => 4 * layer.channels(),
            LayerType::U8 => layer.channels(),
        };
        // A picture, and the one that it replaces.
        let per_pixel = 8 + self.iter().map(bytes).sum::<usize>();
        let mut memory = Vec::<u8>::new();
        let reserved = memory.try_reserve_exact(size.area().saturating_mul(per_pixel));
        // Otherwise the compiler may leave out memory that nothing uses.
        std::hint::black_box(&memory);
        reserved
    }

    /// Returns the layers in the order of [`Layer::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(move |layer| self.has(*layer))
    }
}

impl FromIterator<Layer> for LayerSet {
    fn from_iter<I: IntoIterator<Item = Layer>>(layers: I) -> Self {
        layers.into_iter().fold(Self::default(), Self::with)
    }
}

/// The numbers of a layer: row by row from the top, and the channels of a pixel together. The
/// shape is (height, width, [channels](Layer::channels)).
#[derive(Clone, Debug, PartialEq)]
pub enum LayerValues {
    /// See [`LayerType::F32`].
    F32(Vec<f32>),
    /// See [`LayerType::I32`].
    I32(Vec<i32>),
    /// See [`LayerType::U8`].
    U8(Vec<u8>),
}

/// Layers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The size of the picture in pixels.
    pub size: Size,
    /// The space of the normals.
    pub normals: NormalSpace,
    /// The computed layers.
    pub values: BTreeMap<Layer, LayerValues>,
    /// The meaning of the ids.
    pub names: LayerNames,
}

impl Layers {
    /// Creates layers that show the background alone.
    pub(crate) fn new(size: Size, set: LayerSet, normals: NormalSpace) -> Self {
        let values = |layer: Layer| {
            let count = size.area() * layer.channels();
            match layer.number_type() {
                LayerType::F32 => LayerValues::F32(vec![layer.background(); count]),
                LayerType::I32 => LayerValues::I32(vec![0; count]),
                LayerType::U8 => LayerValues::U8(vec![0; count]),
            }
        };
        let values = set.iter().map(|layer| (layer, values(layer))).collect();
        Self { size, normals, values, names: LayerNames::default() }
    }

    /// Returns the numbers of a layer of type f32; empty if it was not computed.
    #[must_use]
    pub fn floats(&self, layer: Layer) -> &[f32] {
        match self.values.get(&layer) {
            Some(LayerValues::F32(values)) => values,
            _ => &[],
        }
    }

    /// Returns the numbers of a layer of type i32; empty if it was not computed.
    #[must_use]
    pub fn ids(&self, layer: Layer) -> &[i32] {
        match self.values.get(&layer) {
            Some(LayerValues::I32(values)) => values,
            _ => &[],
        }
    }

    /// Returns the mask; empty if it was not computed.
    #[must_use]
    pub fn mask(&self) -> &[u8] {
        match self.values.get(&Layer::Mask) {
            Some(LayerValues::U8(values)) => values,
            _ => &[],
        }
    }
}

/// The meaning of ids: the entry at index i has the id i + 1.
///
/// Ids depend on the scene alone. Hidden objects have ids, so they are the same in all views.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LayerNames {
    /// The objects, in the order of the scene.
    pub objects: Vec<NamedObject>,
    /// The parts of all objects, in the order of objects and files.
    pub parts: Vec<NamedPart>,
    /// The names of the materials, in the order of their first use by a part. Materials of two
    /// files differ even if their names are equal.
    pub materials: Vec<String>,
    /// The material of each part.
    materials_of_parts: Vec<i32>,
}

/// An object with an id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedObject {
    /// The object of the scene.
    pub object: ObjectId,
    /// Its name.
    pub name: String,
    /// The id of its first part.
    first_part: i32,
}

/// A part with an id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedPart {
    /// The id of its object.
    pub object: i32,
    /// Its name in the file.
    pub name: String,
}

/// What makes two materials the same. A model is named by its address.
#[derive(PartialEq, Eq, Hash)]
enum MaterialKey {
    Preset(PresetId),
    Own(ObjectId),
    File(usize, u32),
}

impl LayerNames {
    /// Lists the ids of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut names = Self::default();
        let mut ids: HashMap<MaterialKey, i32> = HashMap::new();
        for (object, own) in scene.objects.iter() {
            let first_part = id_at(names.parts.len());
            let id = id_at(names.objects.len());
            names.objects.push(NamedObject { object, name: own.name.clone(), first_part });
            for part in own.model.mesh.parts() {
                names.parts.push(NamedPart { object: id, name: part.name.clone() });
                let (key, name) = match (&own.material, part.material) {
                    (MaterialChoice::File, Some(material)) => {
                        let of_file = own.model.materials.get(material as usize);
                        let name = of_file.map_or("", |material| &material.name);
                        (MaterialKey::File(Shared::address(&own.model), material), name)
                    }
                    // A part without a material is drawn in silver.
                    (MaterialChoice::File, None) => preset(PresetId::SILVER),
                    (MaterialChoice::Preset(id), _) => preset(*id),
                    (MaterialChoice::Own(_), _) => (MaterialKey::Own(object), &*own.name),
                };
                let id = *ids.entry(key).or_insert_with(|| {
                    names.materials.push(name.to_owned());
                    id_at(names.materials.len() - 1)
                });
                names.materials_of_parts.push(id);
            }
        }
        names
    }

    /// Returns the ids of a part of an object and of its material.
    pub(crate) fn part_of(&self, object: i32, part: u32) -> [i32; 2] {
        let at = |id: i32| usize::try_from(id - 1).unwrap_or(usize::MAX);
        let Some(named) = self.objects.get(at(object)) else { return [0; 2] };
        let id = named.first_part.saturating_add_unsigned(part);
        [id, self.materials_of_parts.get(at(id)).copied().unwrap_or(0)]
    }
}

fn preset(id: PresetId) -> (MaterialKey, &'static str) {
    (MaterialKey::Preset(id), id.get().name)
}

/// Returns the id of the entry at an index.
pub(crate) fn id_at(index: usize) -> i32 {
    i32::try_from(index).map_or(i32::MAX, |index| index.saturating_add(1))
}

/// Returns the view with filled polygons alone: no lines and no marks.
pub(crate) fn surfaces_alone(view: &View) -> View {
    View {
        fill: Fill::Filled,
        edges_over_fill: false,
        face_normals: false,
        vertex_normals: false,
        marks: false,
        ..view.clone()
    }
}
