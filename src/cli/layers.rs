//! The layers of pictures: their options, files and encodings.

use std::path::{Path, PathBuf};

use clap::Args;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::{
    self as io, ExrCamera, IdPixels, LayerKind, LayerNumbers, LayerPicture, PictureFormat,
    PngNumbers,
};
use marraztu_render::{
    AxesConvention, Layer, LayerSet, LayerValues, Layers, NormalSpace, PictureCamera,
};

use super::arguments::choice;

/// The field of a file name that is replaced by the name of the layer.
pub(super) const FIELD: &str = "{layer}";

/// The layers to write, and the form of their numbers.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Layers")]
pub(crate) struct LayerOptions {
    #[arg(long, value_name = "LAYERS", value_parser = list, help = layers_help())]
    layers: Option<LayerList>,
    /// The space of normals in a layer: camera* (x to the right, y up, z towards the observer),
    /// world
    #[arg(long, value_name = "SPACE", hide_possible_values = true, value_parser = choice(&[
        ("camera", NormalSpace::Camera),
        ("world", NormalSpace::World),
    ]))]
    normal_space: Option<NormalSpace>,
    /// The steps of depth per unit in a PNG: 1000*; the largest depth is 65535 steps
    #[arg(long, value_name = "STEPS", allow_negative_numbers = true, value_parser = steps)]
    depth_scale: Option<f64>,
    /// The ids in a PNG: grey* (16 bits), rgb (id = R + 256 G + 65536 B, as in COCO)
    #[arg(long, value_name = "FORM", hide_possible_values = true, value_parser = choice(&[
        ("grey", IdPixels::Grey),
        ("rgb", IdPixels::Rgb),
    ]))]
    ids: Option<IdPixels>,
}

/// A layer of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputLayer {
    /// The picture.
    Color,
    /// Numbers for each pixel.
    Numbers(Layer),
}

/// The layers of the output, in the order of the argument.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LayerList(Vec<OutputLayer>);

impl OutputLayer {
    /// Returns the name: `color`, `depth`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Numbers(layer) => layer.name(),
        }
    }

    fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Color).chain(Layer::ALL.map(Self::Numbers))
    }

    /// Returns the kind of numbers, and the names of the channels in an OpenEXR file.
    const fn form(self) -> (LayerKind, &'static [&'static str]) {
        match self {
            Self::Color => (LayerKind::Color, &["R", "G", "B", "A"]),
            Self::Numbers(Layer::Depth) => (LayerKind::Depth, &["Z"]),
            Self::Numbers(Layer::Distance) => (LayerKind::Depth, &["distance"]),
            Self::Numbers(Layer::Normal) => {
                (LayerKind::Normal, &["normal.X", "normal.Y", "normal.Z"])
            }
            Self::Numbers(Layer::Position) => {
                (LayerKind::Vector, &["position.X", "position.Y", "position.Z"])
            }
            Self::Numbers(Layer::Uv) => (LayerKind::Vector, &["uv.U", "uv.V"]),
            Self::Numbers(Layer::Object) => (LayerKind::Ids, &["id"]),
            Self::Numbers(Layer::Part) => (LayerKind::Ids, &["part"]),
            Self::Numbers(Layer::Material) => (LayerKind::Ids, &["material"]),
            Self::Numbers(Layer::Polygon) => (LayerKind::Ids, &["polygon"]),
            Self::Numbers(Layer::Mask) => (LayerKind::Mask, &["mask"]),
        }
    }
}

impl LayerOptions {
    /// Returns whether layers were asked for.
    pub(crate) const fn are_given(&self) -> bool {
        self.layers.is_some()
    }

    /// Returns the layers to write: the picture alone by default.
    pub(crate) fn list(&self) -> &[OutputLayer] {
        self.layers.as_ref().map_or(&[OutputLayer::Color], |list| &list.0)
    }

    /// Returns whether the picture is written.
    pub(crate) fn has_color(&self) -> bool {
        self.list().contains(&OutputLayer::Color)
    }

    /// Returns the layers of numbers.
    pub(crate) fn set(&self) -> LayerSet {
        let numbers = self.list().iter().filter_map(|layer| match layer {
            OutputLayer::Color => None,
            OutputLayer::Numbers(layer) => Some(*layer),
        });
        numbers.collect()
    }

    pub(crate) fn normal_space(&self) -> NormalSpace {
        self.normal_space.unwrap_or_default()
    }

    /// Returns whether a layer of ids is written.
    pub(crate) fn has_ids(&self) -> bool {
        let is_ids = |layer: &OutputLayer| layer.form().0 == LayerKind::Ids;
        self.list().iter().any(is_ids)
    }

    /// Returns the name of the space of normals.
    pub(crate) fn space_name(&self) -> &'static str {
        match self.normal_space() {
            NormalSpace::Camera => "camera",
            NormalSpace::World => "world",
        }
    }

    /// Returns how numbers become the pixels of a PNG.
    pub(crate) fn png(&self) -> PngNumbers {
        let default = PngNumbers::default();
        PngNumbers {
            depth_scale: self.depth_scale.unwrap_or(default.depth_scale),
            ids: self.ids.unwrap_or_default(),
        }
    }

    /// Returns the files of a picture. `path` returns the file of a layer by its name. Fails with
    /// the reason if a file cannot hold its layers.
    pub(crate) fn files(&self, path: impl Fn(&str) -> PathBuf) -> Result<Vec<LayerFile>, String> {
        let mut files: Vec<LayerFile> = Vec::new();
        for layer in self.list() {
            let path = path(layer.name());
            match files.iter_mut().find(|file| file.path == path) {
                Some(file) => file.layers.push(*layer),
                None => {
                    let encoding = Encoding::of(&path)
                        .map_err(|reason| format!("{}: {reason}", path.display()))?;
                    files.push(LayerFile { path, encoding, layers: vec![*layer] });
                }
            }
        }
        files.iter().try_for_each(LayerFile::check)?;
        Ok(files)
    }
}

/// The encoding of a file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Encoding {
    /// A picture; a PNG also holds a layer of numbers.
    Picture(&'static PictureFormat),
    /// OpenEXR, for any number of layers.
    Exr,
    /// An array of NumPy, for one layer.
    Npy,
}

/// The extensions of the encodings that are not pictures.
pub(super) const NUMBER_ENDINGS: [&str; 2] = ["exr", "npy"];

impl Encoding {
    /// Returns the encoding of the path's extension. Fails with all extensions if the name has
    /// another one.
    pub(crate) fn of(path: &Path) -> Result<Self, String> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_deref().and_then(|ending| ending.to_str()) {
            Some("exr") => Ok(Self::Exr),
            Some("npy") => Ok(Self::Npy),
            _ => PictureFormat::of(path).map(Self::Picture).map_err(|_other_ending| {
                let endings = PictureFormat::usual_endings().replace(" or ", ", ");
                format!("its name has to end in {endings}, .exr or .npy")
            }),
        }
    }

    /// Returns the common name.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Picture(format) => format.name,
            Self::Exr => "OpenEXR",
            Self::Npy => "NumPy",
        }
    }

    fn is_png(self) -> bool {
        matches!(self, Self::Picture(format) if format.name == "PNG")
    }
}

/// A file with one or more layers.
#[derive(Clone, Debug)]
pub(crate) struct LayerFile {
    pub(crate) path: PathBuf,
    pub(crate) encoding: Encoding,
    pub(crate) layers: Vec<OutputLayer>,
}

/// The content of all layers of a picture.
#[derive(Debug)]
pub(crate) struct LayerContent<'a> {
    pub(crate) color: Option<&'a Picture>,
    pub(crate) numbers: Option<&'a Layers>,
    pub(crate) camera: PictureCamera,
    /// Whether the picture keeps its alpha channel.
    pub(crate) transparent: bool,
}

impl<'a> LayerContent<'a> {
    pub(crate) fn new(
        shot: &Shot,
        color: Option<&'a Picture>,
        numbers: Option<&'a Layers>,
        transparent: bool,
    ) -> Self {
        Self { color, numbers, camera: PictureCamera::of(shot), transparent }
    }

    /// Returns a layer; `None` if it was not computed.
    fn layer(&self, layer: OutputLayer) -> Option<LayerPicture<'a>> {
        let (kind, channels) = layer.form();
        let numbers = match layer {
            OutputLayer::Color => LayerNumbers::U8(self.color?.pixels().as_flattened()),
            OutputLayer::Numbers(layer) => match self.numbers?.values.get(&layer)? {
                LayerValues::F32(values) => LayerNumbers::F32(values),
                LayerValues::I32(values) => LayerNumbers::I32(values),
                LayerValues::U8(values) => LayerNumbers::U8(values),
            },
        };
        Some(LayerPicture { name: layer.name(), kind, channels, numbers })
    }
}

impl LayerFile {
    fn check(&self) -> Result<(), String> {
        let shown = self.path.display();
        if let ([first, second, ..], Encoding::Picture(_) | Encoding::Npy) =
            (&self.layers[..], self.encoding)
        {
            let (first, second) = (first.name(), second.name());
            return Err(format!(
                "the layers {first} and {second} would be written to {shown}: write {FIELD} in its \
                 name, or choose .exr"
            ));
        }
        if let (Encoding::Picture(format), [OutputLayer::Numbers(layer)]) =
            (self.encoding, &self.layers[..])
        {
            let is_vector = matches!(layer, Layer::Position | Layer::Uv);
            if is_vector || !self.encoding.is_png() {
                let (name, layer) = (format.name, layer.name());
                let or = if is_vector { "" } else { ".png, " };
                return Err(format!(
                    "{name} cannot hold the layer {layer}: {shown} has to end in {or}.exr or .npy"
                ));
            }
        }
        Ok(())
    }

    /// Encodes the file, with a stamp if one is given. Fails with the reason if the format cannot
    /// hold a layer.
    pub(crate) fn encode(
        &self,
        content: &LayerContent<'_>,
        png: &PngNumbers,
        stamp: Option<&str>,
    ) -> Result<Vec<u8>, String> {
        let layers = self.layers.iter().filter_map(|layer| content.layer(*layer));
        let layers: Vec<LayerPicture<'_>> = layers.collect();
        let [first, ..] = &layers[..] else { return Err("it has no layer".to_owned()) };
        let size = content.camera.intrinsics.size;
        let encoded = match (self.encoding, content.color) {
            (Encoding::Picture(format), Some(color)) if first.kind == LayerKind::Color => {
                return match stamp {
                    Some(stamp) => io::encode_stamped(format, color, stamp),
                    None => format.encode(color),
                };
            }
            (Encoding::Picture(_), _) => return io::layer_png(size, first, png, stamp),
            (Encoding::Exr, _) => {
                io::layers_exr(size, &layers, Some(&exr_camera(&content.camera)))?
            }
            (Encoding::Npy, Some(color))
                if first.kind == LayerKind::Color && !content.transparent =>
            {
                opaque_npy(size, color)
            }
            (Encoding::Npy, _) => io::layer_npy(size, first),
        };
        Ok(match stamp {
            Some(stamp) => io::stamped_at_end(encoded, stamp),
            None => encoded,
        })
    }
}

/// Encodes a picture without its alpha channel.
fn opaque_npy(size: Size, picture: &Picture) -> Vec<u8> {
    let bytes: Vec<u8> = picture.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let (kind, numbers) = (LayerKind::Color, LayerNumbers::U8(&bytes));
    let channels = &["R", "G", "B"];
    io::layer_npy(size, &LayerPicture { name: "color", kind, channels, numbers })
}

/// Returns the matrices of an OpenEXR file: z points forward.
fn exr_camera(camera: &PictureCamera) -> ExrCamera {
    let forward = glam::DMat4::from_scale(glam::DVec3::new(1.0, 1.0, -1.0));
    ExrCamera {
        camera_from_world: forward * camera.camera_from_world(AxesConvention::OpenGl),
        ndc_from_world: camera.ndc_from_world(),
    }
}

fn list(text: &str) -> Result<LayerList, String> {
    if text == "all" {
        return Ok(LayerList(OutputLayer::all().collect()));
    }
    let mut list = Vec::new();
    for name in text.split(',').map(str::trim) {
        let layer = OutputLayer::all().find(|layer| layer.name() == name).ok_or_else(|| {
            let names: Vec<&str> = OutputLayer::all().map(OutputLayer::name).collect();
            format!("there is no layer {name:?}; write names from {}, or all", names.join(", "))
        })?;
        if list.contains(&layer) {
            return Err(format!("the layer {name} is named twice"));
        }
        list.push(layer);
    }
    Ok(LayerList(list))
}

fn layers_help() -> String {
    let names: Vec<&str> = OutputLayer::all().map(OutputLayer::name).collect();
    format!(
        "The layers to write, with commas between: {}; or all. A name with {FIELD} gives a file \
         for each, and an OpenEXR file (.exr) holds all; .png has 16 bits, .npy is an array of \
         NumPy. cameras.json in the same folder has the cameras",
        names.join(", ")
    )
}

fn steps(text: &str) -> Result<f64, String> {
    let steps = text.parse().ok().filter(|steps: &f64| steps.is_finite() && *steps > 0.0);
    steps.ok_or_else(|| "write a number of steps above 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(layers: &str, name: &str) -> Result<Vec<LayerFile>, String> {
        let options = LayerOptions { layers: Some(list(layers)?), ..LayerOptions::default() };
        options.files(|layer| name.replace(FIELD, layer).into())
    }

    #[test]
    fn each_layer_has_a_file_and_an_exr_holds_them_all() {
        let pngs = files("color, depth,mask", "a-{layer}.png").unwrap();
        let paths: Vec<&Path> = pngs.iter().map(|file| &*file.path).collect();
        assert_eq!(paths, ["a-color.png", "a-depth.png", "a-mask.png"].map(Path::new));
        let exr = files("all", "a.exr").unwrap();
        assert_eq!((exr.len(), exr[0].layers.len()), (1, 1 + Layer::ALL.len()));
        assert_eq!(files("uv", "a.npy").unwrap()[0].layers, [OutputLayer::Numbers(Layer::Uv)]);
    }

    #[test]
    fn files_that_cannot_hold_their_layers_are_rejected_with_the_reason() {
        for (layers, name, reason) in [
            ("color,depth", "a.png", "write {layer} in its name, or choose .exr"),
            ("depth,normal", "a.npy", "write {layer} in its name"),
            ("depth", "a.jpg", "has to end in .png, .exr or .npy"),
            ("position", "a.png", "PNG cannot hold the layer position"),
            ("depth", "a.gif", "its name has to end in .png, .jpg, .webp, .ppm, .exr or .npy"),
            ("deep", "a.exr", "there is no layer \"deep\"; write names from color, depth"),
            ("depth,depth", "a.exr", "named twice"),
            ("", "a.exr", "there is no layer \"\""),
        ] {
            let error = files(layers, name).unwrap_err();
            assert!(error.contains(reason), "{layers} {name}: {error}");
        }
        assert!(steps("0").is_err() && steps("inf").is_err() && steps("1e3") == Ok(1000.0));
    }
}
