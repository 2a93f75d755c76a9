//! The built-in shapes: ground, plane, cube, sphere, cylinder, torus.
//!
//! Each shape is centred at the origin. Its size, the width, is part of the mesh: an object of this
//! shape has scale 1, so steps and amounts along its axes count in units of the world. Vertices lie
//! on the exact surface, and corners have the normals of that surface, rounded to single precision.
//! Flat faces are exact. A round shape lies inside its surface by at most 1 - cos(pi / N) of the
//! radius for N faces around.

use std::sync::OnceLock;

use super::{LoadOptions, Mesh, Model, Scale};
use crate::base::Shared;
use crate::base::once::get_or_compute;
use solids::Builder;

mod ground;
mod solids;

/// A built-in shape. The variants describe the shape that is one unit wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A disc of diameter 1 in the XZ plane, seen from above, that fades out towards its rim: see
    /// `ground`.
    Ground,
    /// A square of side 1 in the XZ plane, seen from above.
    Plane,
    /// A cube of side 1.
    Cube,
    /// A sphere of diameter 1, with poles along Y.
    Sphere,
    /// A cylinder of diameter 1 and height 1, along Y.
    Cylinder,
    /// A ring about Y with outer diameter 1 and tube diameter 1/4.
    Torus,
}

impl Shape {
    /// All shapes, in the order of the menu.
    pub const ALL: [Self; 6] =
        [Self::Ground, Self::Plane, Self::Cube, Self::Sphere, Self::Cylinder, Self::Torus];

    /// Returns whether the shape is a ground for other objects. A ground touches the lowest object,
    /// and is at least as large as the scene.
    pub const fn is_ground(self) -> bool {
        match self {
            Self::Ground | Self::Plane => true,
            Self::Cube | Self::Sphere | Self::Cylinder | Self::Torus => false,
        }
    }

    /// Returns the name, which scene files use, too.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Plane => "plane",
            Self::Cube => "cube",
            Self::Sphere => "sphere",
            Self::Cylinder => "cylinder",
            Self::Torus => "torus",
        }
    }

    /// Returns the shape with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// Returns the shape of a model; `None` for other models.
    pub fn of(model: &Model) -> Option<Self> {
        Self::named(&model.name).filter(|_| model.source.is_none())
    }

    /// Returns the model that is one unit wide, shared by all objects of this shape and size.
    pub fn model(self) -> Shared<Model> {
        static MODELS: [OnceLock<Shared<Model>>; 6] = [const { OnceLock::new() }; 6];
        let make = || Shared::new(self.made(Scale::default()));
        get_or_compute(&MODELS[self as usize], make).clone()
    }

    /// Returns a model of this width, at least 1e-30 and at most 1e30. Its scale among the load
    /// options is the width.
    pub fn sized(self, size: Scale) -> Shared<Model> {
        // Positions are in single precision.
        let size = Scale::new(size.get().clamp(1e-30, 1e30)).unwrap_or_default();
        if size == Scale::default() { self.model() } else { Shared::new(self.made(size)) }
    }

    fn made(self, size: Scale) -> Model {
        let materials = if self == Self::Ground { ground::materials() } else { Vec::new() };
        let options = LoadOptions { scale: size, ..LoadOptions::default() };
        Model { materials, options, ..Model::of_mesh(self.name(), self.mesh(size.get())) }
    }

    fn mesh(self, size: f64) -> Mesh {
        let mut builder = Builder::new(size);
        match self {
            Self::Ground => ground::build(&mut builder),
            Self::Plane => solids::plane(&mut builder),
            Self::Cube => solids::cube(&mut builder),
            Self::Sphere => solids::sphere(&mut builder),
            Self::Cylinder => solids::cylinder(&mut builder),
            Self::Torus => solids::torus(&mut builder),
        }
        builder.mesh(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::solids::{AROUND, TORUS};
    use super::*;
    use crate::scene::{dvec3, newell};

    /// Returns the position and normal of each corner, polygon by polygon.
    fn polygons(mesh: &Mesh) -> Vec<Vec<(DVec3, DVec3)>> {
        let count = u32::try_from(mesh.polygon_count()).unwrap();
        let corners = |i: u32| {
            let corner = |c: &crate::scene::Corner| {
                let p = dvec3(mesh.positions()[c.position as usize]);
                (p, dvec3(mesh.points()[c.filed as usize].normal))
            };
            mesh.polygon(i).iter().map(corner).collect()
        };
        (0..count).map(corners).collect()
    }

    fn positions(polygon: &[(DVec3, DVec3)]) -> impl Iterator<Item = DVec3> + Clone {
        polygon.iter().map(|(p, _)| *p)
    }

    /// Returns the volume, by the divergence theorem over fans, and the surface area.
    fn volume_and_area(mesh: &Mesh) -> (f64, f64) {
        let mut sums = (0.0, 0.0);
        for polygon in polygons(mesh) {
            for pair in polygon.windows(2).skip(1) {
                sums.0 += polygon[0].0.dot(pair[0].0.cross(pair[1].0)) / 6.0;
            }
            sums.1 += newell(positions(&polygon)).length() / 2.0;
        }
        sums
    }

    fn close(found: f64, wanted: f64, error: f64) {
        assert!((found / wanted - 1.0).abs() < error, "{found} instead of {wanted}");
    }

    #[test]
    fn every_shape_is_one_unit_wide_about_the_origin_and_closed_but_for_grounds() {
        for shape in Shape::ALL {
            let model = shape.model();
            let bounds = model.mesh.bounds().unwrap();
            let height = match shape {
                Shape::Ground | Shape::Plane => 0.0,
                Shape::Torus => 0.25,
                Shape::Cube | Shape::Sphere | Shape::Cylinder => 1.0,
            };
            assert_eq!(bounds.extent(), DVec3::new(1.0, height, 1.0), "{shape:?}");
            assert_eq!(bounds.centre(), DVec3::ZERO, "{shape:?}");
            assert_eq!(model.mesh.is_closed(), !shape.is_ground(), "{shape:?}");
            assert_eq!(Shape::named(shape.name()), Some(shape));
        }
    }

    #[test]
    fn a_shape_of_another_size_is_scaled_exactly_about_the_origin_and_knows_its_size() {
        for shape in Shape::ALL {
            let unit = shape.model();
            for size in [1e-9, 0.3, 1.0, 64.0, 5e12] {
                let model = shape.sized(Scale::new(size).unwrap());
                assert_eq!((Shape::of(&model), model.options.scale.get()), (Some(shape), size));
                assert_eq!(Shared::same(&model, &unit), size == 1.0, "{shape:?}");
                let extent = model.mesh.bounds().unwrap().extent();
                let wanted = unit.mesh.bounds().unwrap().extent() * size;
                assert!((extent - wanted).abs().max_element() <= 1e-7 * size, "{shape:?}");
                assert_eq!(model.mesh.is_closed(), !shape.is_ground(), "{shape:?}");
            }
        }
    }

    #[test]
    fn volumes_and_areas_match_the_formulas_of_the_solids() {
        let of = |shape: Shape| volume_and_area(&shape.model().mesh);
        assert_eq!(of(Shape::Plane).1, 1.0);
        assert_eq!(of(Shape::Cube), (1.0, 6.0));
        // A regular polygon of N sides in a circle: N / 2 sin(2 pi / N) r^2, and 2 N sin(pi / N) r.
        let n = f64::from(AROUND);
        let base = n / 2.0 * (2.0 * PI / n).sin() / 4.0;
        let (volume, area) = of(Shape::Cylinder);
        close(volume, base, 1e-6);
        close(area, 2.0 * base + n * (PI / n).sin(), 1e-6);
        // Inscribed solids are smaller, by about (pi / N)^2.
        let (volume, area) = of(Shape::Sphere);
        close(volume, PI / 6.0, 0.009);
        close(area, PI, 0.006);
        assert!(volume < PI / 6.0 && area < PI);
        let [middle, tube] = TORUS;
        let (volume, area) = of(Shape::Torus);
        close(volume, 2.0 * PI * PI * middle * tube * tube, 0.009);
        close(area, 4.0 * PI * PI * middle * tube, 0.006);
    }

    #[test]
    fn normals_match_the_exact_surface_and_faces_look_outwards() {
        for shape in Shape::ALL {
            for polygon in polygons(&shape.model().mesh) {
                let facing = newell(positions(&polygon)).normalize_or_zero();
                for (p, n) in &polygon {
                    assert!((n.length() - 1.0).abs() < 1e-6, "{shape:?}");
                    assert!(facing.dot(*n) > 0.99, "{shape:?}: {facing} and {n} at {p}");
                    let ring = DVec3::new(p.x, 0.0, p.z).normalize_or_zero();
                    let exact = match shape {
                        Shape::Sphere => p.normalize_or_zero(),
                        Shape::Torus => (*p - ring * TORUS[0]).normalize_or_zero(),
                        Shape::Cylinder if n.y.abs() < 0.5 => ring,
                        Shape::Ground | Shape::Plane | Shape::Cube | Shape::Cylinder => facing,
                    };
                    assert!((exact - *n).length() < 1e-6, "{shape:?}: {n} instead of {exact}");
                }
            }
        }
    }

    #[test]
    fn texture_coordinates_run_once_over_every_shape() {
        for shape in Shape::ALL {
            let mesh = &shape.model().mesh;
            for axis in 0..2 {
                let all = mesh.uvs().iter().map(|uv| uv[axis]);
                assert_eq!(all.clone().fold(1.0, f32::min), 0.0, "{shape:?}");
                assert_eq!(all.fold(0.0, f32::max), 1.0, "{shape:?}");
            }
            // Seen from outside, the texture is not mirrored.
            let corners: Vec<[f64; 2]> = mesh
                .polygon(0)
                .iter()
                .map(|corner| mesh.uvs()[corner.uv as usize].map(f64::from))
                .collect();
            let flat = corners.iter().map(|[u, v]| DVec3::new(*u, *v, 0.0));
            assert!(newell(flat).z > 0.0, "{shape:?}");
        }
    }
}
