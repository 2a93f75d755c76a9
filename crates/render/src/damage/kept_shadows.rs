//! Which of the shadows that are known from earlier frames hold in another one.
//!
//! They hold as long as the light is where it was, the same triangles show at the same pixels, and
//! nothing that casts shadows changed between the two. So a light that moves is traced again by
//! itself; one whose colour changes is not traced at all, nor is anything if a material changes;
//! and for an object that moves, each light is traced again in the shadow volumes of that object.

use super::Damage;
use super::shadow_reach::{self, Changed};
use crate::frame::FramePlan;
use crate::shadow::known::KnownShadows;

/// The shadows that are known, and the plan that they belong to.
#[derive(Debug, Default)]
pub(crate) struct KeptShadows {
    known: KnownShadows,
    plan: Option<FramePlan>,
}

impl KeptShadows {
    /// Forgets everything.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }

    /// Keeps what holds in another plan. What is known then belongs to that plan, even if it is not
    /// drawn to the end.
    pub(crate) fn update(&mut self, plan: &FramePlan) {
        if !plan.shadows.are_cast() || !shadow_reach::is_by_pixel(plan) {
            return self.forget();
        }
        let before = self.plan.replace(plan.clone());
        let holds =
            |before: &FramePlan| before.size == plan.size && shadow_reach::is_known(before, plan);
        let Some(before) = before.filter(holds) else {
            self.known.forget();
            return self.known.keep(plan.size, &plan.shadows.sources);
        };
        self.known.keep(plan.size, &plan.shadows.sources);
        let damage = Damage::between(&before, plan);
        let changed = Changed::between(&before, plan);
        for (source, light) in self.known.lights() {
            let shadows = changed.tiles(&source);
            let is_shaded_anew = |tile| shadows.as_ref().is_none_or(|tiles| tiles.contains(tile));
            light.forget(|tile| damage.surfaces.contains(tile) || is_shaded_anew(tile));
        }
    }

    /// What is known, if anything is kept.
    pub(crate) fn known(&self) -> Option<&KnownShadows> {
        self.plan.is_some().then_some(&self.known)
    }
}
