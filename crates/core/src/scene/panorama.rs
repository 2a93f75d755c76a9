//! Panoramas: pictures of everything around a scene, which a sky light shines with.

use std::path::PathBuf;
use std::sync::OnceLock;

use glam::{DMat3, DVec3};

use crate::base::Shared;
use crate::base::color::{encoded, linear};
use crate::base::image::Size;
use crate::base::once::get_or_compute;

/// A picture of everything around a point: columns are longitudes and rows are latitudes, of equal
/// angles. The middle lies along -Z, the right half along +X, and the upper edge along +Y.
#[derive(Debug)]
pub struct Panorama {
    /// The file.
    pub source: PathBuf,
    /// The light of each texel, in rows from the top. Finite, and at least 0.
    texels: Texels,
    /// Whether the light is linear, as in HDR and EXR files, or stored, as in PNG and JPEG.
    is_linear: bool,
    /// Whether it replaces a missing file.
    is_placeholder: bool,
    /// The light in stored and in linear values, with smaller copies, made on first use.
    prepared: [OnceLock<PanoramaLight>; 2],
}

impl PartialEq for Panorama {
    fn eq(&self, other: &Self) -> bool {
        let Self { source, texels, is_linear, is_placeholder, prepared: _ } = self;
        (source, is_linear, is_placeholder, texels)
            == (&other.source, &other.is_linear, &other.is_placeholder, &other.texels)
    }
}

/// The panorama of a sky.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyPanorama {
    /// The picture.
    pub panorama: Shared<Panorama>,
    /// The angle by which it is turned about the Y axis, in degrees, anticlockwise seen from above.
    pub turn: f64,
    /// Whether it is the background. Mirrors show it in any case.
    pub is_shown: bool,
}

/// Texels brighter than this are clamped to it.
const BRIGHTEST: f32 = 1e6;

impl Panorama {
    /// The largest number of texels: they take 1.6 GB, or 200 MB in a browser.
    pub const MOST_TEXELS: usize =
        if cfg!(target_pointer_width = "32") { 1 << 24 } else { 1 << 27 };

    /// Creates a panorama of these texels, row by row from the top; `None` if their number does not
    /// fit, or is 0. NaN and negative numbers become 0.
    pub fn new(
        source: impl Into<PathBuf>,
        size: Size,
        mut light: Vec<[f32; 3]>,
        is_linear: bool,
    ) -> Option<Self> {
        if light.is_empty() || light.len() != size.area() {
            return None;
        }
        for channel in light.iter_mut().flatten() {
            *channel = if channel.is_nan() { 0.0 } else { channel.clamp(0.0, BRIGHTEST) };
        }
        let texels = Texels { size, light };
        let (source, prepared) = (source.into(), Default::default());
        Some(Self { source, texels, is_linear, is_placeholder: false, prepared })
    }

    /// Builds a white panorama that replaces a missing or unreadable file. It keeps the file's
    /// path.
    pub fn placeholder(source: PathBuf) -> Self {
        let texels = Texels { size: Size::new(1, 1), light: vec![[1.0; 3]] };
        let prepared = Default::default();
        Self { source, texels, is_linear: false, is_placeholder: true, prepared }
    }

    /// Returns whether the panorama replaces a missing file.
    pub const fn is_placeholder(&self) -> bool {
        self.is_placeholder
    }

    /// Returns the width and height in texels.
    pub const fn size(&self) -> Size {
        self.texels.size
    }

    /// Returns the direction to the middle of a texel of a panorama of this size, by its index.
    pub fn direction(size: Size, place: usize) -> DVec3 {
        Texels { size, light: Vec::new() }.direction(place)
    }

    /// Returns the light in linear or in stored values. Stored values above 1 follow the curve of
    /// sRGB.
    pub fn light(&self, in_linear: bool) -> &PanoramaLight {
        get_or_compute(&self.prepared[usize::from(in_linear)], || {
            let convert: fn(f64) -> f64 = match (self.is_linear, in_linear) {
                (true, false) => encoded,
                (false, true) => linear,
                _ => |it| it,
            };
            PanoramaLight::new(&self.texels, convert)
        })
    }
}

impl SkyPanorama {
    /// Returns the rotation from the world to the picture.
    pub fn picture_from_world(&self) -> DMat3 {
        let (sin, cos) = libm::sincos(-self.turn.to_radians());
        DMat3::from_cols(DVec3::new(cos, 0.0, -sin), DVec3::Y, DVec3::new(sin, 0.0, cos))
    }
}

/// Rows of light.
#[derive(Clone, Debug, PartialEq)]
struct Texels {
    size: Size,
    light: Vec<[f32; 3]>,
}

/// The light of a panorama in one kind of values.
#[derive(Debug)]
pub struct PanoramaLight {
    /// The picture, then copies of half the size each. Each texel is the mean of the texels that it
    /// replaces, by the solid angles that they cover.
    levels: Vec<Texels>,
    moments: [Moments; 3],
    /// The light of lamps, brighter than [`LAMP`] times the mean: the share of all of it that the
    /// texels up to and including each of the level [`Self::guide`] have. Empty without lamps.
    shares: Vec<f64>,
}

/// The integrals of one channel over all directions d.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    /// Of the light L.
    pub all: f64,
    /// Of L d.
    pub along: DVec3,
    /// Of L d d^T.
    pub square: DMat3,
}

impl Moments {
    const ZERO: Self = Self { all: 0.0, along: DVec3::ZERO, square: DMat3::ZERO };
}

/// Texels brighter than the mean by this factor are lamps.
const LAMP: f64 = 4.0;

/// Rays look for lamps if these have at least this share of all light.
const LEAST_SHARE: f64 = 0.05;

/// Integrals and samples use the first level with at most this many columns: 1.4 degrees each.
const GUIDE: usize = 256;

/// Integrals use at least this number of columns and rows.
const FINE: usize = 64;

impl PanoramaLight {
    fn new(texels: &Texels, convert: fn(f64) -> f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
        let converted = |texel: &[f32; 3]| texel.map(|it| convert(f64::from(it)) as f32);
        let light = texels.light.iter().map(converted).collect();
        let mut levels = vec![Texels { size: texels.size, light }];
        while let Some(last) = levels.last()
            && last.size.area() > 1
        {
            levels.push(last.halved());
        }
        let mut it = Self { levels, moments: [Moments::ZERO; 3], shares: Vec::new() };
        let guide = it.guide();
        let mut moments = [Moments::ZERO; 3];
        // Large texels are divided: their light comes from more than one direction.
        let parts = [guide.size.width, guide.size.height].map(|side| FINE.div_ceil(side));
        for (place, texel) in guide.light.iter().enumerate() {
            for (d, angle) in guide.directions(place, parts) {
                for (moments, light) in moments.iter_mut().zip(texel) {
                    let part = f64::from(*light) * angle;
                    moments.all += part;
                    moments.along += d * part;
                    moments.square += DMat3::from_cols(d * d.x, d * d.y, d * d.z) * part;
                }
            }
        }
        let all = luminance(moments.each_ref().map(|channel| channel.all));
        let mean = all / (4.0 * std::f64::consts::PI);
        let mut sum = 0.0;
        let lamps = guide.light.iter().enumerate().map(|(place, texel)| {
            let above = luminance(texel.map(f64::from)) - LAMP * mean;
            sum += above.max(0.0) * guide.solid_angle(place);
            sum
        });
        let mut shares: Vec<f64> = lamps.collect();
        if sum < LEAST_SHARE * all || sum == 0.0 {
            shares.clear();
        }
        shares.iter_mut().for_each(|share| *share /= sum);
        (it.moments, it.shares) = (moments, shares);
        it
    }

    /// Returns the first level with at most this many columns.
    fn level_of(&self, columns: usize) -> &Texels {
        let last = &self.levels[self.levels.len() - 1];
        self.levels.iter().find(|level| level.size.width <= columns).unwrap_or(last)
    }

    fn guide(&self) -> &Texels {
        self.level_of(GUIDE)
    }

    /// Returns the integrals of each channel.
    pub const fn moments(&self) -> &[Moments; 3] {
        &self.moments
    }

    /// Returns the light from a direction (of length 1, in the picture's axes), the mean over an
    /// angle of `width` radians: bilinear between texels, and between two levels.
    pub fn seen(&self, direction: DVec3, width: f64) -> [f64; 3] {
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 texels")]
        let texels = width * self.levels[0].size.width as f64 / std::f64::consts::TAU;
        let last = self.levels.len() - 1;
        let level = if texels > 1.0 { libm::log2(texels) } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 0")]
        let below = (level as usize).min(last);
        let near = self.levels[below].bilinear(direction);
        #[expect(clippy::cast_precision_loss, reason = "below 32")]
        let part = (level - below as f64).min(1.0);
        match self.levels.get(below + 1) {
            Some(far) if part > 0.0 => {
                let far = far.bilinear(direction);
                std::array::from_fn(|i| near[i] + (far[i] - near[i]) * part)
            }
            _ => near,
        }
    }

    /// Returns whether a considerable part of the light comes from lamps.
    pub const fn has_lamps(&self) -> bool {
        !self.shares.is_empty()
    }

    /// Returns the light around a direction, over a quarter of the solid angle that each of a
    /// number of samples has of half of all directions, so that no bright spot falls on a single
    /// one (Křivánek and Colbert, "Real-time Shading with Filtered Importance Sampling", EGSR
    /// 2008).
    pub fn spread(&self, direction: DVec3, samples: u32) -> [f64; 3] {
        let columns = match samples {
            0..16 => 8,
            16..64 => 16,
            64..256 => 32,
            _ => 64,
        };
        let level = self.level_of(columns);
        level.light[level.place(direction)].map(f64::from)
    }

    /// Returns the light around a direction, over a texel of 1.4 degrees, and the density per solid
    /// angle with which [`Self::towards_lamp`] returns such directions.
    pub fn around(&self, direction: DVec3) -> ([f64; 3], f64) {
        let guide = self.guide();
        let place = guide.place(direction);
        let light = guide.light[place].map(f64::from);
        if !self.has_lamps() {
            return (light, 0.0);
        }
        let before = if place > 0 { self.shares[place - 1] } else { 0.0 };
        let density = (self.shares[place] - before) / guide.solid_angle(place);
        (light, density)
    }

    /// Returns a direction to a lamp for two numbers from 0 to 1: the more frequent, the brighter
    /// it is. Without lamps, an arbitrary one.
    pub fn towards_lamp(&self, [u, v]: [f64; 2]) -> DVec3 {
        let guide = self.guide();
        let Some(last) = self.shares.len().checked_sub(1) else { return DVec3::Y };
        let place = self.shares.partition_point(|share| *share <= u).min(last);
        let before = if place > 0 { self.shares[place - 1] } else { 0.0 };
        let own = self.shares[place] - before;
        let across = if own > 0.0 { ((u - before) / own).clamp(0.0, 1.0) } else { 0.5 };
        guide.direction_within(place, [across, v])
    }
}

impl Texels {
    /// Returns the height of the upper edge of a row.
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 rows")]
    fn edge(&self, row: usize) -> f64 {
        Self::height_at(row as f64 / self.size.height as f64)
    }

    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 columns")]
    fn solid_angle(&self, place: usize) -> f64 {
        let row = place / self.size.width;
        (self.edge(row) - self.edge(row + 1)) * std::f64::consts::TAU / self.size.width as f64
    }

    /// Returns the direction to the middle of a texel.
    fn direction(&self, place: usize) -> DVec3 {
        self.direction_within(place, [0.5; 2])
    }

    /// Returns a direction within a texel: by its column, and by its solid angle downwards.
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 texels")]
    fn direction_within(&self, place: usize, [across, down]: [f64; 2]) -> DVec3 {
        let (column, row) = (place % self.size.width, place / self.size.width);
        let turn = (column as f64 + across) / self.size.width as f64 - 0.5;
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
        let (upper, lower) = (self.edge(row), self.edge(row + 1));
        let y = upper + (lower - upper) * down;
        let flat = (1.0 - y * y).max(0.0).sqrt();
        DVec3::new(flat * sin, y, -flat * cos)
    }

    /// Returns the directions of the parts of a texel, with the solid angle of each.
    #[expect(clippy::cast_precision_loss, reason = "few parts")]
    fn directions(
        &self,
        place: usize,
        [across, down]: [usize; 2],
    ) -> impl Iterator<Item = (DVec3, f64)> {
        let angle = self.solid_angle(place) / (across * down) as f64;
        (0..across * down).map(move |part| {
            let [x, y] = [part % across, part / across].map(|at| at as f64 + 0.5);
            (self.direction_within(place, [x / across as f64, y / down as f64]), angle)
        })
    }

    /// Returns the column and row of a direction, with fractions.
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 texels")]
    fn position(&self, direction: DVec3) -> [f64; 2] {
        let across = libm::atan2(direction.x, -direction.z) / std::f64::consts::TAU + 0.5;
        let down = libm::acos(direction.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
        [across * self.size.width as f64, down * self.size.height as f64]
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 0")]
    fn place(&self, direction: DVec3) -> usize {
        let [across, down] = self.position(direction);
        let Size { width, height } = self.size;
        (down as usize).min(height - 1) * width + (across as usize).min(width - 1)
    }

    /// Interpolates between the four nearest texels. Columns repeat; rows end at the poles.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        reason = "kept within the picture"
    )]
    fn bilinear(&self, direction: DVec3) -> [f64; 3] {
        let Size { width, height } = self.size;
        let [across, down] = self.position(direction).map(|at| at - 0.5);
        let (left, upper) = (across.floor(), down.floor());
        let at = |column: isize, row: isize| {
            let column = column.rem_euclid(width as isize) as usize;
            let row = row.clamp(0, height as isize - 1) as usize;
            self.light[row * width + column].map(f64::from)
        };
        let (column, row) = (left as isize, upper as isize);
        let (x, y) = (across - left, down - upper);
        let [a, b] = [at(column, row), at(column + 1, row)];
        let [c, d] = [at(column, row + 1), at(column + 1, row + 1)];
        std::array::from_fn(|i| {
            let [upper, lower] = [a[i] + (b[i] - a[i]) * x, c[i] + (d[i] - c[i]) * x];
            upper + (lower - upper) * y
        })
    }

    /// Returns the height of the line at a fraction of the way down: the cosine of its angle from
    /// +Y.
    fn height_at(part: f64) -> f64 {
        libm::cos(std::f64::consts::PI * part)
    }

    /// Returns a copy of half the width and height, rounded up. Each texel is the mean of the area
    /// that it covers, weighted by solid angle, so odd sizes keep their light, too.
    #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
    fn halved(&self) -> Self {
        let Size { width, height } = self.size;
        let size = Size::new(width.div_ceil(2), height.div_ceil(2));
        let columns: Vec<_> = (0..size.width).map(|i| covered(i, size.width, width)).collect();
        let mut light = Vec::with_capacity(size.area());
        for row in 0..size.height {
            let rows = covered(row, size.height, height)
                .map(|(own, from, to)| (own, Self::height_at(from) - Self::height_at(to)));
            for columns in &columns {
                let (mut sum, mut all) = ([0.0; 3], 0.0);
                for (row, high) in rows {
                    for (column, from, to) in columns {
                        let (texel, weight) =
                            (self.light[row * width + column], high * (to - from));
                        all += weight;
                        for (sum, light) in sum.iter_mut().zip(texel) {
                            *sum += f64::from(light) * weight;
                        }
                    }
                }
                light.push(sum.map(|it| (it / all) as f32));
            }
        }
        Self { size, light }
    }
}

/// Returns the cells of a row of `of` that cell `i` of a row of `count` covers, at most three: each
/// with the ends of the common part, as fractions of the row.
#[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 cells")]
fn covered(i: usize, count: usize, of: usize) -> [(usize, f64, f64); 3] {
    let [from, to] = [i, i + 1].map(|end| end as f64 / count as f64);
    let first = i * of / count;
    std::array::from_fn(|k| {
        let own = (first + k).min(of - 1);
        let [low, high] = [first + k, first + k + 1].map(|end| end as f64 / of as f64);
        // Beyond the last cell, nothing is left.
        let (low, high) = (low.max(from), high.min(to));
        (own, low, high.max(low))
    })
}

/// Returns the brightness of a texel, with the weights of ITU-R BT.709.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Paints a panorama by a function of the direction.
    fn painted(size: Size, light: impl Fn(DVec3) -> f32) -> Panorama {
        let blank = Texels { size, light: Vec::new() };
        let texels = (0..size.area()).map(|place| [light(blank.direction(place)); 3]).collect();
        Panorama::new("a.hdr", size, texels, true).unwrap()
    }

    #[test]
    fn a_direction_meets_its_texel() {
        let size = Size::new(64, 32);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
            let lit = painted(size, |d| f32::from(u8::from(d.dot(axis) > 0.9)));
            let light = lit.light(true);
            assert_eq!(light.seen(axis, 0.0), [1.0; 3], "{axis}");
            assert_eq!(light.seen(-axis, 0.0), [0.0; 3], "{axis}");
        }
        // The middle of the picture lies along -Z, and its right half along +X.
        let blank = Texels { size, light: Vec::new() };
        assert_eq!(blank.position(DVec3::NEG_Z), [32.0, 16.0]);
        assert_eq!(blank.position(DVec3::X), [48.0, 16.0]);
    }

    #[test]
    fn a_turned_picture_is_turned_about_the_vertical() {
        let own = painted(Size::new(8, 4), |_| 1.0).into();
        let sky = SkyPanorama { panorama: own, turn: 90.0, is_shown: true };
        // Anticlockwise from above, the middle of the picture moves from -Z to -X.
        let seen = sky.picture_from_world() * DVec3::NEG_X;
        assert!(seen.abs_diff_eq(DVec3::NEG_Z, 1e-15), "{seen}");
    }

    #[test]
    fn moments_are_those_of_the_sphere() {
        let even = painted(Size::new(300, 150), |_| 0.5);
        let Moments { all, along, square } = even.light(true).moments()[0];
        assert!((all - 2.0 * PI).abs() < 1e-9, "{all}");
        assert!(along.length() < 1e-9);
        assert!(square.abs_diff_eq(DMat3::IDENTITY * (2.0 * PI / 3.0), 1e-3), "{square}");
        // Half a sphere of light, along its axis: pi.
        let half = painted(Size::new(256, 128), |d| f32::from(u8::from(d.y > 0.0)));
        let along = half.light(true).moments()[1].along;
        assert!(along.abs_diff_eq(DVec3::Y * PI, 1e-3), "{along}");
    }

    #[test]
    fn smaller_copies_keep_the_light_of_odd_sizes() {
        for (width, height) in [(1025, 513), (1000, 499), (257, 3), (1, 1), (5, 1), (1, 7)] {
            for place in [0, width - 1, width * height - 1, width * (height / 2)] {
                let mut texels = vec![[0.0; 3]; width * height];
                texels[place] = [1000.0; 3];
                let size = Size::new(width, height);
                let lamp = Panorama::new("a.hdr", size, texels, true).unwrap();
                let own = 1000.0 * lamp.texels.solid_angle(place);
                let got = lamp.light(true).moments()[0].all;
                assert!((got / own - 1.0).abs() < 1e-5, "{width} x {height}, {place}: {got} {own}");
            }
        }
    }

    #[test]
    fn an_even_picture_shines_evenly_whatever_its_size() {
        for (width, height) in [(1, 1), (1, 9), (2, 1), (5, 3), (8, 4), (200, 1), (256, 128)] {
            let even = painted(Size::new(width, height), |_| 0.5);
            let Moments { all, along, square } = &even.light(true).moments()[0];
            let sphere = 2.0 * PI;
            assert!((all - sphere).abs() < 1e-9, "{width} x {height}: {all}");
            assert!(along.length() < 1e-9, "{width} x {height}: {along}");
            let error = *square - DMat3::IDENTITY * (sphere / 3.0);
            let most =
                error.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(most < 2e-3, "{width} x {height}: {square}");
        }
    }

    #[test]
    fn wide_views_see_the_mean() {
        let half = painted(Size::new(255, 127), |d| f32::from(u8::from(d.x > 0.0)));
        let [mean, ..] = half.light(true).seen(DVec3::Y, 2.0 * PI);
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }

    #[test]
    fn no_bright_spot_falls_on_a_single_sample() {
        // A spot of a degree, a thousand times as bright as the rest, has a fiftieth of the light.
        let spot = painted(Size::new(1024, 512), |d| if d.x > 0.99996 { 1000.0 } else { 1.0 });
        let light = spot.light(true);
        assert!(!light.has_lamps());
        let [finest, ..] = light.levels[0].light[light.levels[0].place(DVec3::X)];
        let brightest = [4, 16, 64, 256].map(|samples| light.spread(DVec3::X, samples)[0]);
        assert!(finest == 1000.0 && brightest[3] < 20.0, "{brightest:?}");
        assert!(brightest[1] < 2.0 && brightest.is_sorted(), "{brightest:?}");
    }

    #[test]
    fn samples_go_to_lamps() {
        let lamp = painted(Size::new(512, 256), |d| if d.x > 0.99 { 100.0 } else { 0.1 });
        let light = lamp.light(true);
        let (mut inside, mut sum, count) = (0, 0.0, 4096);
        for i in 0..count {
            let u = (f64::from(i) + 0.5) / f64::from(count);
            let direction = light.towards_lamp([u, (f64::from(i) * 0.618).fract()]);
            assert!((direction.length() - 1.0).abs() < 1e-12);
            inside += i32::from(direction.x > 0.98);
            let (_, density) = light.around(direction);
            sum += 1.0 / density / f64::from(count);
        }
        assert_eq!(inside, count);
        // The solid angle of the lamp: 2 pi (1 - 0.99), and of texels that it covers in part.
        assert!((0.06..0.075).contains(&sum), "{sum}");
        let (dim, density) = light.around(DVec3::NEG_X);
        assert!((dim[0] - 0.1).abs() < 1e-6 && density == 0.0);
        let cloudy = painted(Size::new(64, 32), |d| if d.y > 0.0 { 1.9 } else { 0.1 });
        assert!(!cloudy.light(true).has_lamps() && light.has_lamps());
        let black = painted(Size::new(4, 2), |_| 0.0);
        assert!(!black.light(true).has_lamps());
    }

    #[test]
    fn stored_and_linear_values_agree_and_nonsense_is_black() {
        let texels = vec![[0.25, f32::NAN, -1.0], [4.0, f32::INFINITY, 0.0]];
        let it = Panorama::new("a.exr", Size::new(2, 1), texels, true).unwrap();
        let stored = it.light(false).seen(DVec3::NEG_X, 0.0);
        assert!((stored[0] - encoded(0.25)).abs() < 1e-6, "{stored:?}");
        assert_eq!(stored[1..], [0.0; 2]);
        let bright = it.light(true).seen(DVec3::X, 0.0);
        assert_eq!(bright, [4.0, f64::from(BRIGHTEST), 0.0]);
        assert!(Panorama::new("", Size::new(0, 0), Vec::new(), true).is_none());
        assert!(Panorama::placeholder("b".into()).is_placeholder() && !it.is_placeholder());
    }
}
