//! Adds several lights to a batch in one pass: positions, normals and sums stay in registers from
//! light to light.

use super::ambient::Ambient;
use super::batch::{Batch, Reflected, Sample, load, store};
use super::bulb::Bulb;
use super::phong::{Form, HalfVector, Highlight, LightTerm, Nothing, Reflection};
use super::shader::{LightShader, Which};
use super::sky::Sky;
use super::spot::Spot;
use super::sun::Sun;
use crate::simd::{Kernel, Lanes, Number, Vec3};

/// Computes the light at every position of a batch from several shaders, added in the order of an
/// iterator.
pub(crate) struct Together<'a, T, I> {
    pub(crate) batch: &'a mut Batch<T>,
    pub(crate) lights: I,
}

impl<'a, T: Number, I> Kernel<T> for Together<'_, T, I>
where
    I: Iterator<Item = (Which, Form, &'a LightTerm<T>)> + Clone,
{
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, lights } = self;
        let zero = lanes.lift(0.0);
        for at in (0..batch.len).step_by(M::LANES) {
            let sample = Sample {
                position: load(lanes, &batch.position, at),
                normal: load(lanes, &batch.normal, at),
                to_eye: load(lanes, &batch.to_eye, at),
                // If any exponent is mapped, lights are added one by one instead.
                exponent: lanes.lift(1.0),
            };
            // The sums replace the batch's light, so it is not cleared before.
            let (mut diffuse, mut specular) = (Vec3([zero; 3]), Vec3([zero; 3]));
            // The light kind is matched per batch of lanes, where the branch is well predicted.
            for (which, form, term) in lights.clone() {
                let reflected = match form {
                    Form::Plain => reflected::<M, Nothing>(which, lanes, sample, term),
                    Form::Reflection => reflected::<M, Reflection>(which, lanes, sample, term),
                    Form::HalfVector => reflected::<M, HalfVector>(which, lanes, sample, term),
                };
                if let Some(reflected) = reflected {
                    diffuse = diffuse.plus(reflected.diffuse);
                    if let Some(more) = reflected.specular {
                        specular = specular.plus(more);
                    }
                }
            }
            store(lanes, diffuse, &mut batch.diffuse, at);
            store(lanes, specular, &mut batch.specular, at);
        }
    }
}

#[inline(always)]
fn reflected<M: Lanes, H: Highlight>(
    which: Which,
    lanes: M,
    sample: Sample<M::R>,
    term: &LightTerm<M::Number>,
) -> Option<Reflected<M::R>> {
    match which {
        Which::Ambient => Ambient::shade::<M, H>(lanes, sample, term),
        Which::Sky => Sky::shade::<M, H>(lanes, sample, term),
        Which::Sun => Sun::shade::<M, H>(lanes, sample, term),
        Which::Bulb => Bulb::shade::<M, H>(lanes, sample, term),
        Which::Spot => Spot::shade::<M, H>(lanes, sample, term),
    }
}
