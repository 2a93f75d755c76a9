//! Runs plans: does, and asks no setting.

use fearless_simd::Level;

use super::bins::Bins;
use super::coverage::PixelBox;
use super::effects::{BATCH, Light as Number};
use super::geometry::Geometry;
use super::light::Lit;
use super::plan::FramePlan;
use super::surface::{Pixel, Shader};
use super::tile::{self, Seen, Visibility};
use crate::base::image::{Picture, Size};
use crate::scene::{Arithmetic, ItemId};

/// Pixels to a side of a block: those of one are coloured together.
const BLOCK: i32 = 8;

/// Draws pictures, and keeps the memory that this takes from one to the next.
#[derive(Debug)]
pub struct Renderer {
    level: Level,
    picture: Picture,
    geometry: Geometry,
    bins: Bins,
    /// What is seen at each pixel of the picture, for picking.
    words: Vec<u64>,
    /// Whose the draws of the last plan are.
    items: Vec<ItemId>,
    /// The polygon of each triangle on the screen.
    polygons: Vec<u32>,
}

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object, the camera whose mark it is, or the bulb's light.
    pub item: ItemId,
    /// The polygon of its mesh.
    pub polygon: u32,
    /// The depth in the picture: 1 at the near plane, 0 at the far one.
    pub depth: f32,
}

impl Default for Renderer {
    fn default() -> Self {
        Self::new(Level::new())
    }
}

impl Renderer {
    /// A renderer that uses instructions of this level. The pictures are the same on every level.
    #[must_use]
    pub fn new(level: Level) -> Self {
        Self {
            level,
            picture: Picture::default(),
            geometry: Geometry::default(),
            bins: Bins::default(),
            words: Vec::new(),
            items: Vec::new(),
            polygons: Vec::new(),
        }
    }

    /// Draws what is planned.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.picture.resize(plan.size);
        self.picture.pixels_mut().fill(plan.background.opaque());
        self.words.clear();
        self.words.resize(plan.size.area(), 0);
        self.geometry.build(plan);
        self.bins.build(&self.geometry, plan.size, plan.line_width);
        match plan.arithmetic {
            Arithmetic::F32 => self.draw::<f32>(plan),
            Arithmetic::F64 => self.draw::<f64>(plan),
        }
        self.remember(plan);
        &self.picture
    }

    /// The picture that was drawn last.
    #[must_use]
    pub const fn picture(&self) -> &Picture {
        &self.picture
    }

    /// How many triangles of the last picture faced the observer inside the view.
    #[must_use]
    pub const fn triangles_drawn(&self) -> usize {
        self.geometry.triangles.len()
    }

    /// What the last picture shows in column `x` of row `y`; `None` for the background.
    #[must_use]
    pub fn hit(&self, x: usize, y: usize) -> Option<Hit> {
        let Size { width, height } = self.picture.size();
        if x >= width || y >= height {
            return None;
        }
        let word = self.words[y * width + x];
        let depth = tile::depth(word);
        let (draw, polygon) = match tile::seen(word) {
            Seen::Background => return None,
            Seen::Triangle(number) => {
                let triangle = &self.geometry.triangles[number as usize];
                (triangle.draw, self.polygons[number as usize])
            }
            Seen::Line(number) => {
                let line = &self.geometry.lines[number as usize];
                (line.draw, line.polygon)
            }
        };
        Some(Hit { item: self.items[draw as usize], polygon, depth })
    }

    fn draw<T: Number>(&mut self, plan: &FramePlan) {
        let lit = Lit::<T>::new(plan, &self.geometry, self.level);
        let mut shader = Shader::new(plan, &self.geometry, &lit, self.level);
        let mut visibility = Box::new(Visibility::new());
        for (bounds, bin) in self.bins.tiles(plan.size) {
            if bin.triangles.is_empty() && bin.lines.is_empty() {
                continue;
            }
            visibility.draw(plan, &self.geometry, bounds, bin);
            let mut target = Target {
                width: plan.size.width,
                pixels: self.picture.pixels_mut(),
                words: &mut self.words,
            };
            for top in (bounds.top..bounds.bottom).step_by(BLOCK as usize) {
                for left in (bounds.left..bounds.right).step_by(BLOCK as usize) {
                    let block = PixelBox { left, top, right: left + BLOCK, bottom: top + BLOCK };
                    let block = block.intersection(bounds);
                    color_block(&mut shader, &visibility, block, &mut target);
                }
            }
        }
    }

    /// Keeps what picking asks for.
    fn remember(&mut self, plan: &FramePlan) {
        self.items.clear();
        self.items.extend(plan.draws.iter().map(|draw| draw.item));
        self.polygons.clear();
        self.polygons.extend(self.geometry.triangles.iter().map(|triangle| {
            let mesh = &plan.draws[triangle.draw as usize].model.mesh;
            mesh.triangles()[triangle.triangle as usize].polygon
        }));
    }
}

/// Where pixels go.
struct Target<'a> {
    width: usize,
    pixels: &'a mut [[u8; 4]],
    words: &'a mut [u64],
}

impl Target<'_> {
    fn at(&self, x: i32, y: i32) -> usize {
        let inside = |i: i32| usize::try_from(i).expect("inside the picture");
        inside(y) * self.width + inside(x)
    }
}

/// Colours the pixels of a block, those of one pipeline together.
fn color_block<T: Number>(
    shader: &mut Shader<'_, T>,
    visibility: &Visibility,
    block: PixelBox,
    target: &mut Target<'_>,
) {
    let mut waiting: Vec<(u32, Pixel)> = Vec::with_capacity(BATCH);
    for y in block.top..block.bottom {
        for x in block.left..block.right {
            let at = target.at(x, y);
            target.words[at] = visibility.word(x, y);
            match visibility.seen(x, y) {
                Seen::Background => {}
                Seen::Line(number) => {
                    target.pixels[at] = shader.geometry.lines[number as usize].color;
                }
                Seen::Triangle(number) => {
                    let triangle = &shader.geometry.triangles[number as usize];
                    let draw = &shader.plan.draws[triangle.draw as usize];
                    if triangle.side == super::geometry::Side::Back
                        && draw.back == super::plan::Back::Red
                    {
                        target.pixels[at] = crate::base::color::Color::BACK_FACE.opaque();
                        continue;
                    }
                    waiting.push((triangle.pipeline, Pixel { triangle: number, at: [x, y] }));
                }
            }
        }
    }
    while let Some(&(pipeline, _)) = waiting.first() {
        let (now, later): (Vec<_>, Vec<_>) = waiting.into_iter().partition(|w| w.0 == pipeline);
        waiting = later;
        let pixels: Vec<Pixel> = now.into_iter().map(|(_, pixel)| pixel).collect();
        shader.shade(&pixels, |[x, y], color| {
            let at = target.at(x, y);
            target.pixels[at] = color;
        });
    }
}
