//! Scenes in pixel units: their pictures reveal the triangle at each pixel.
//!
//! In orthographic projection, with a power of two as side, corners in subpixels reach the screen
//! without rounding. The unlit colour of each triangle encodes its number, so coverage, depth and
//! order can be read from a picture, pixel by pixel.

use glam::{DMat4, DVec3};

use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Camera, CameraId, Lens, List, MaterialChoice, Mesh, MeshSource, Model, Object, ObjectId,
    PresetId, Projection, Scene, Sides, SourceCorner, Surface, View,
};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

/// The distance of the camera's far plane, in units.
pub const FAR: f64 = 1024.0;

/// A triangle in subpixels, with a distance from 0 to [`FAR`] at each corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    /// The corners.
    pub corners: [Snapped; 3],
    /// The distances of the corners from the camera.
    pub distances: [f64; 3],
}

impl Flat {
    /// Builds a triangle at half of [`FAR`].
    pub const fn new(corners: [Snapped; 3]) -> Self {
        Self { corners, distances: [FAR / 2.0; 3] }
    }
}

/// Encodes the number of a triangle as its colour.
pub fn color_of(number: usize) -> [u8; 4] {
    let [r, g, b, ..] = (number + 1).to_le_bytes();
    [r, g, b, 255]
}

/// Decodes the number of a triangle from its colour; `None` for the background.
pub fn number_of([r, g, b, _]: [u8; 4]) -> Option<usize> {
    (usize::from(r) | usize::from(g) << 8 | usize::from(b) << 16).checked_sub(1)
}

/// Builds a scene with one object per list of triangles, for a picture with a power of two as side.
/// The oldest object is first, and triangles are numbered across all lists.
///
/// # Panics
/// If a coordinate has more than 24 bits, which a mesh cannot hold.
#[expect(clippy::cast_precision_loss, reason = "a side is at most 2^14")]
pub fn scene(objects: &[Vec<Flat>], side: usize) -> (Scene, View) {
    assert!(side.is_power_of_two(), "only then is every corner exact");
    // One unit is one pixel, and the centre of the picture is the origin.
    let silver = || MaterialChoice::Preset(PresetId::SILVER);
    let half_size = side as f64 / 2.0;
    let lens = Lens { half_size, parallel_near: 0.0, parallel_far: FAR, ..Lens::default() };
    let camera = Camera::new("camera", model(&[], side, 0), silver(), DVec3::ZERO);
    let camera = Camera { visible: false, lens, ..camera };
    let mut number = 0;
    let objects = objects.iter().zip(1..).map(|(triangles, id)| {
        let mut object = Object::new(model(triangles, side, number), silver());
        number += triangles.len();
        // Unlit, so the vertex colours reach the picture unchanged.
        object.surface = Surface::Texture;
        object.sides = Sides::Two;
        (ObjectId(id), object)
    });
    let mut scene = Scene::with_camera(camera);
    scene.objects = List::from_iter(objects);
    scene.next_id = u32::MAX;
    scene.background = Color::BLACK;
    let mut view = View::new(scene.objects.first(), CameraId(0), None);
    (view.projection, view.marks) = (Projection::Orthographic, false);
    (scene, view)
}

/// Draws a scene made by [`scene`].
pub fn draw((scene, view): &(Scene, View), side: usize, renderer: &mut Renderer) -> Picture {
    let plan = plan_frame(&Shot::new(scene, view, &Settings::default(), Size::new(side, side)));
    renderer.render(&plan).clone()
}

/// Draws triangles as one object.
pub fn draw_triangles(triangles: &[Flat], side: usize, renderer: &mut Renderer) -> Picture {
    draw(&scene(&[triangles.to_vec()], side), side, renderer)
}

/// Converts a corner in subpixels to its position in world space.
#[expect(clippy::cast_precision_loss, reason = "a side is at most 2^14")]
pub fn place(corner: Snapped, distance: f64, side: usize) -> DVec3 {
    let (half, parts) = (side as f64 / 2.0, f64::from(SUBPIXELS));
    DVec3::new(f64::from(corner.x) / parts - half, half - f64::from(corner.y) / parts, -distance)
}

fn model(triangles: &[Flat], side: usize, first: usize) -> Shared<Model> {
    let mut source = MeshSource::of_polygons([], vec![3; triangles.len()]);
    for (number, triangle) in triangles.iter().enumerate() {
        for (corner, distance) in triangle.corners.into_iter().zip(triangle.distances) {
            let place = place(corner, distance, side);
            // Meshes store f32: a rounded corner would make the test meaningless.
            let narrow = place.as_vec3();
            assert_eq!(narrow.as_dvec3(), place, "a corner has too many bits");
            let position = u32::try_from(source.positions.len()).expect("few triangles");
            source.corners.push(SourceCorner::bare(position));
            source.positions.push(narrow.to_array());
            let [r, g, b, _] = color_of(first + number).map(|byte| f32::from(byte) / 255.0);
            source.colors.push([r, g, b]);
        }
    }
    Shared::new(Model::of_mesh(
        "triangles",
        Mesh::new(source).expect("numbers of pictures are finite"),
    ))
}

/// Returns the matrix that moves a scene by a number of pixels to the right and down.
pub fn moved(right: f64, down: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(right, -down, 0.0))
}
