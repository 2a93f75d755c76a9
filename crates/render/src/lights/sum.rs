//! The light of several lights on a batch, in one pass: positions, normals and sums stay in
//! registers from light to light.

use fearless_simd::Level;

use super::batch::{Batch, Sample, load, store};
use super::phong::LightTerm;
use super::reflected;
use crate::simd::{Kernel, Lanes, Number, Vec3};

/// Sets the light at every position of a batch to the sum of some lights: those with the indices
/// `some`, or all.
pub(crate) fn set_lights<T: Number>(
    level: Level,
    batch: &mut Batch<T>,
    terms: &[LightTerm<T>],
    some: Option<&[u32]>,
) {
    T::run(level, Sum { batch, terms, some, continues: false });
}

/// Adds one light at every position of a batch.
pub(crate) fn add_light<T: Number>(level: Level, batch: &mut Batch<T>, term: &LightTerm<T>) {
    let terms = std::slice::from_ref(term);
    T::run(level, Sum { batch, terms, some: None, continues: true });
}

struct Sum<'a, T> {
    batch: &'a mut Batch<T>,
    terms: &'a [LightTerm<T>],
    /// The indices of the lights to add, if not all are.
    some: Option<&'a [u32]>,
    /// Whether the light of the batch is the first summand.
    continues: bool,
}

impl<T: Number> Kernel<T> for Sum<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, terms, some, continues } = self;
        let count = some.map_or(terms.len(), <[u32]>::len);
        let zero = lanes.lift(0.0);
        for at in (0..batch.len).step_by(M::LANES) {
            let sample = Sample {
                position: load(lanes, &batch.position, at),
                normal: load(lanes, &batch.normal, at),
                to_eye: load(lanes, &batch.to_eye, at),
                exponent: lanes.load(&batch.exponent, at),
            };
            let (mut diffuse, mut specular) = (Vec3([zero; 3]), Vec3([zero; 3]));
            if continues {
                diffuse = load(lanes, &batch.diffuse, at);
                specular = load(lanes, &batch.specular, at);
            }
            for i in 0..count {
                let term = &terms[some.map_or(i, |some| some[i] as usize)];
                if let Some(reflected) = reflected(lanes, sample, term) {
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
