//! Explains one pixel: the surfaces that it shows, and the light that makes up its colour.
//!
//! The pixel is shaded again by the code that shaded the picture, one light at a time, in the
//! picture's arithmetic. The terms therefore equal the picture bit for bit. The rounding error of
//! their sum is a separate term, and with it the terms add up to the colour exactly.

mod light_ray;

use light_ray::{World, first, light_terms, plus, reflect, vec3};

use super::context::{Group, ShadingContext, group_of};
use super::interpolate::{Look, Mixed, Points, mix, surface_samples};
use super::interpolated::ShadingNumber;
use super::light::run;
use super::lit_points::place_fragments;
use super::pixel_color::{Part, PixelColor, SurfacePoint, Term};
use super::shader::Shader;
use super::shadows::{BatchShadows, place_faces};
use crate::frame::Eye;
use crate::frame::draw::{Back, Shaded};
use crate::frame::program::LightOp;
use crate::lights::Batch;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::coverage::PixelBox;
use crate::shadow::rays::{Origins, RayScratch};
use marraztu_core::accuracy::Rounding;
use marraztu_core::base::color;

/// The pixel of a tile to be explained.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    /// The column and row.
    pub(crate) at: [i32; 2],
    /// The pixels of the tile.
    pub(crate) bounds: PixelBox,
    /// The range of depths in the tile.
    pub(crate) depths: Option<[f32; 2]>,
    /// The pixel's words: the opaque surface, and the layers over it, the nearest last.
    pub(crate) words: &'a [u64],
    /// The bytes of the picture.
    pub(crate) bytes: [u8; 3],
}

/// Explains a pixel.
pub(crate) fn explain<T: ShadingNumber>(
    context: &ShadingContext<'_, T>,
    asked: &Asked<'_>,
) -> PixelColor {
    let behind = asked.words.first().copied().unwrap_or(0);
    let (mut whole, _) = one(context, asked, behind);
    if asked.words.len() < 2 {
        return whole;
    }
    // Only clamped colours are blended, as in the picture, and all in linear light or none.
    let linear = context.mode().is_linear();
    make_blendable(&mut whole, linear);
    // Alpha blending scales the terms of a layer by its opacity, and all terms behind it by the
    // rest.
    for word in &asked.words[1..] {
        let (mut layer, opacity) = one(context, asked, *word);
        make_blendable(&mut layer, linear);
        let over = |front: [f64; 3], back: [f64; 3]| {
            [0, 1, 2].map(|i| front[i] * opacity + back[i] * (1.0 - opacity))
        };
        layer.color = over(layer.color, whole.color);
        layer.rounding = over(layer.rounding, whole.rounding);
        for term in &mut layer.terms {
            term.value = over(term.value, [0.0; 3]);
        }
        layer.terms.extend(whole.terms.drain(..).map(|term| Term {
            value: over([0.0; 3], term.value),
            layer: term.layer + 1,
            ..term
        }));
        whole = layer;
    }
    // Other blending methods have a different mean; the difference is a separate term, unless it
    // may come from rounding to a byte and from the fixed-point numbers of blended colours.
    let most = 0.001
        + match context.mode().rounding {
            Rounding::Nearest => 0.5,
            Rounding::Truncated | Rounding::Dithered => 1.0,
        };
    let stored = |x: f64| if linear { color::encoded(x) } else { x };
    let other = |(x, byte): (f64, u8)| (stored(x) * 255.0 - f64::from(byte)).abs() > most;
    if whole.color.into_iter().zip(asked.bytes).any(other) {
        whole.lead_to(asked.bytes, Part::Blending);
    }
    PixelColor { bytes: asked.bytes, ..whole }
}

/// Clamps a colour to be blended, and records the clipped light as a term. In a `linear` picture,
/// also decodes the colour of a surface that is not lit.
fn make_blendable(of: &mut PixelColor, linear: bool) {
    if linear && !of.linear {
        of.color = of.color.map(color::linear);
        of.terms = of.terms.iter().map(|term| Term::new(term.part, of.color)).collect();
        of.linear = true;
    }
    let cut = of.color.map(|x| x.clamp(0.0, 1.0) - x);
    if cut != [0.0; 3] {
        of.terms.push(Term::new(Part::Cut, cut));
        of.color = plus(of.color, cut);
    }
}

/// Returns the colour of one primitive that a pixel shows, and its opacity.
fn one<T: ShadingNumber>(
    context: &ShadingContext<'_, T>,
    asked: &Asked<'_>,
    word: u64,
) -> (PixelColor, f64) {
    let [x, y] = asked.at;
    let at = [x, y].map(|i| usize::try_from(i).unwrap_or(0));
    let plain = |part, [r, g, b, _]: [u8; 4]| plain(at, part, [r, g, b]);
    let ShadingContext { plan, frame, .. } = *context;
    match seen(word) {
        Visible::Background => (plain(Part::Background, plan.behind().at([x, y])), 1.0),
        Visible::Line(line) => (plain(Part::Line, frame.line_color(plan, line, [x, y])), 1.0),
        Visible::Triangle(number) => {
            // The pixel is shaded alone, with the lights of its tile.
            let mut shader = Shader::<T>::default();
            shader.tile.begin(plan, asked.bounds, || asked.depths);
            let place = usize::try_from((y & 7) * 8 + (x & 7)).unwrap_or(0);
            shader.fragments.begin_shared(0, 1);
            shader.fragments.add(number, [x & !7, y & !7], place, 1);
            // A single fragment is lit at its pixel's centre.
            shader.fragments.shared = false;
            let group = group_of(context, number);
            Point { group, shader: &mut shader, number, at }.explained()
        }
    }
}

/// Returns a pixel with a colour and no further explanation.
fn plain(at: [usize; 2], part: Part, bytes: [u8; 3]) -> PixelColor {
    let color = bytes.map(|byte| f64::from(byte) / 255.0);
    let (rounding, terms) = ([0.0; 3], vec![Term::new(part, color)]);
    PixelColor { at, drawn: None, surface: None, terms, rounding, color, linear: false, bytes }
}

/// A pixel that shows a triangle.
struct Point<'a, T> {
    group: Group<'a, T>,
    shader: &'a mut Shader<T>,
    number: u32,
    at: [usize; 2],
}

impl<T: ShadingNumber> Point<'_, T> {
    fn explained(&mut self) -> (PixelColor, f64) {
        let plan = self.group.context.plan;
        let [r, g, b, _] = self.shader.first_color(&self.group);
        let bytes = [r, g, b];
        // The results left by first_color: the light of the pixel, and its texel.
        let of_all = [first(&self.shader.batch.diffuse), first(&self.shader.batch.specular)];
        let texel = first(&self.shader.texels);
        let glow = first(&self.shader.maps.glow);
        let seen = first(&self.shader.maps.seen);
        let drawn = self.shader.batch.clone();
        let opacity = f64::from(self.shader.opacities(&self.group)[0]);
        let mut surface = self.place();
        let red = surface.back && self.group.draw.back == Back::Red;
        let Some(shaded) = self.group.shaded.filter(|_| !red) else {
            let part = if red { Part::BackFace } else { Part::Unlit };
            return (PixelColor { surface: Some(surface), ..plain(self.at, part, bytes) }, opacity);
        };
        let textured = shaded.varies();
        let tint = shaded.tint.map(|x| T::from_f64(x).into());
        surface.own = if textured { texel } else { tint };
        surface.light_at = shaded.light.is_some().then_some(plan.light_at);
        // The terms depend on where light is computed.
        let (mut terms, mut color) = match self.group.program.light {
            LightOp::None => (vec![Term::new(Part::Unlit, surface.own)], surface.own),
            LightOp::Vertices(_) => self.of_corners(&surface, textured.then_some(of_all), shaded),
            LightOp::Points | LightOp::Faces => self.of_lights(&mut surface, shaded, &drawn),
        };
        let glows = shaded.extras.glows().next().is_some();
        let sees = shaded.extras.rays.is_some();
        if glows {
            let own = if sees { [0, 1, 2].map(|i| glow[i] - seen[i]) } else { glow };
            terms.push(Term::new(Part::Emission, own));
        }
        if sees {
            terms.push(Term::new(Part::Surroundings, seen));
        }
        if glows || sees {
            color = plus(color, glow);
        }
        let sum = terms.iter().fold([0.0; 3], |sum, term| plus(sum, term.value));
        let rounding = [0, 1, 2].map(|i| color[i] - sum[i]);
        let linear = self.group.context.mode().is_linear();
        let (at, surface) = (self.at, Some(surface));
        (PixelColor { at, drawn: None, surface, terms, rounding, color, linear, bytes }, opacity)
    }

    /// Returns the point's position on the surface. Afterwards the batch holds its position and
    /// normal.
    fn place(&mut self) -> SurfacePoint {
        let Self { group, shader, number, .. } = self;
        let ShadingContext { level, plan, .. } = *group.context;
        // Forces a fresh fetch: the shader may hold attributes of another kind.
        shader.attributes.forget();
        shader.take(group, true);
        let Shader { fragments, attributes, barycentrics, batch, .. } = &mut **shader;
        barycentrics.find(level, fragments, attributes, group);
        attributes.carry_normals(group.draw);
        attributes.spread(level);
        batch.len = 1;
        let look = Look::new(plan, group.draw);
        let points = Points { fragments, attributes, barycentrics };
        surface_samples(level, look, points, batch);
        let world = World::new(plan);
        let w: f64 = barycentrics.w[0].into();
        let position = vec3(&batch.position);
        let distance = match plan.eye {
            Eye::Point => w,
            Eye::Parallel => -position.z,
        };
        let triangle = *number - group.base;
        SurfacePoint {
            item: group.draw.item,
            polygon: group.draw.model.mesh.polygon_of(triangle),
            triangle,
            weights: barycentrics.weights(0),
            distance: distance / world.unit,
            position: world.point(position),
            normal: world.direction(vec3(&batch.normal)),
            to_eye: world.direction(vec3(&batch.to_eye)),
            back: attributes.back & 1 == 1,
            own: [1.0; 3],
            light_at: None,
        }
    }

    /// Returns the terms of every evaluated light, and their sum.
    fn of_lights(
        &mut self,
        surface: &mut SurfacePoint,
        shaded: &Shaded,
        drawn: &Batch<T>,
    ) -> (Vec<Term>, [f64; 3]) {
        let Self { group, shader, .. } = self;
        let stages = shaded.stages();
        let context = group.context;
        let ShadingContext { level, plan, lit, terms: of, .. } = *context;
        let kept = shader.tile.light(plan, group.pipeline, shaded).kept.map(<[u32]>::to_vec);
        let by_face = group.program.light == LightOp::Faces;
        // Flat shading: the light and the normal belong to the centre of the polygon.
        if by_face {
            let Shader { attributes, batch, .. } = &mut **shader;
            batch.len = attributes.count;
            lit.place_faces(level, (group.draw_index, group.draw), attributes, batch);
            let world = World::new(plan);
            surface.normal = world.direction(vec3(&batch.normal));
            surface.to_eye = world.direction(vec3(&batch.to_eye));
        }
        let lit_places = shader.tile.light(plan, group.pipeline, shaded).needs_positions;
        if !by_face && lit_places {
            // With normals tilted by bump maps, and exponents from a map.
            shader.batch.clone_from(drawn);
            surface.normal = World::new(plan).direction(vec3(&shader.batch.normal));
        }
        let lights = of.of(group.pipeline);
        let mut terms = Vec::new();
        // Lights that do not reach the tile were left out, and get no terms.
        let evaluated = |i: &usize| {
            by_face || kept.as_ref().is_none_or(|kept| kept.iter().any(|at| *at as usize == *i))
        };
        let tracer = context.tracer_of(group.draw_index);
        let Shader { fragments, attributes, barycentrics, batch, .. } = &mut **shader;
        let points = Points { fragments, attributes, barycentrics };
        let mut place = |origins: &mut Origins| {
            if let Some(tracer) = tracer {
                if by_face {
                    place_faces(tracer, group.draw, attributes, origins);
                } else {
                    place_fragments(group, tracer, points, origins);
                }
            }
        };
        let mut scratch = RayScratch::default();
        let shades = tracer.filter(|_| by_face || lit_places);
        // Each light alone, with and without shadows, gives its terms.
        for i in (0..stages.len()).filter(evaluated) {
            let of = (&stages[i..=i], &lights[i..=i]);
            run(of.0, of.1, level, batch, None);
            let bright = [first(&batch.diffuse), first(&batch.specular)];
            let shadows =
                shades.map(|(tracer, _)| BatchShadows::new(tracer, &mut scratch, &mut place));
            run(of.0, of.1, level, batch, shadows);
            let parts = [first(&batch.diffuse), first(&batch.specular)];
            let mut own = light_terms(plan, &stages[i], batch, parts, surface.own);
            if let Some(ray) = own.first_mut().and_then(|term| term.ray.as_mut()) {
                ray.shadow = if parts == bright { 1.0 } else { 0.0 };
            }
            terms.extend(own);
        }
        // All lights together, in the order of the picture, give the exact sum.
        let all = (0..stages.len()).filter(evaluated);
        let (stages, lights): (Vec<_>, Vec<_>) =
            all.map(|i| (stages[i], lights[i].clone())).unzip();
        let shadows = shades.map(|(tracer, _)| BatchShadows::new(tracer, &mut scratch, &mut place));
        run(&stages, &lights, level, batch, shadows);
        shader.batch.len = 1;
        // A map of Ks multiplies all highlights together.
        let (own, mapped) = (first(&shader.batch.specular), first(&drawn.specular));
        for term in terms.iter_mut().filter(|term| term.part == Part::Specular) {
            for i in (0..3).filter(|i| own[*i] != mapped[*i] && own[*i] != 0.0 && !by_face) {
                term.value[i] *= mapped[i] / own[i];
            }
        }
        // The picture's highlights already contain the map.
        if !by_face {
            for (row, value) in shader.batch.specular.iter_mut().zip(mapped) {
                row[0] = T::from_f64(value);
            }
        }
        let color = reflect(&shader.batch, surface.own);
        (terms, color)
    }

    /// Returns the interpolated light of vertices as one term, because its lights were summed
    /// before.
    fn of_corners(
        &mut self,
        surface: &SurfacePoint,
        textured: Option<[[f64; 3]; 2]>,
        shaded: &Shaded,
    ) -> (Vec<Term>, [f64; 3]) {
        let Self { group, shader, .. } = self;
        let ShadingContext { level, lit, .. } = *group.context;
        let term = |value| Term::new(Part::Corners, value);
        if let Some([diffuse, specular]) = textured {
            let mut sums = Batch::<T> { len: 1, ..Batch::default() };
            for i in 0..3 {
                sums.diffuse[i][0] = T::from_f64(diffuse[i]);
                sums.specular[i][0] = T::from_f64(specular[i]);
            }
            let lit = [0, 1, 2].map(|i| surface.own[i] * diffuse[i]);
            let shine = Term { part: Part::Specular, ..term(specular) };
            return (vec![term(lit), shine], reflect(&sums, surface.own));
        }
        // Without a texture, tables hold final colours, which are interpolated again here.
        let tables = lit.tables(group.draw_index, group.pipeline);
        shader.carry_diffuse(group, shaded, tables);
        let Shader { fragments, attributes, barycentrics, batch, .. } = &mut **shader;
        let points = Points { fragments, attributes, barycentrics };
        mix(level, points, &attributes.values, Mixed::Rows(&mut batch.diffuse));
        let color = first(&batch.diffuse);
        (vec![term(color)], color)
    }
}
