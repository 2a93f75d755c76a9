//! Decides which cached shadows of earlier frames are still valid.
//!
//! Cached shadows stay valid while the light does not move, the same triangles show at the same
//! pixels, and no caster changed in between. A light that moves is therefore traced again, and no
//! other light. A light with a new colour, or a new material, needs no rays. If an object moves,
//! each light is traced again in the object's shadow volumes.

use super::Damage;
use super::shadow_reach::{self, Changed};
use crate::frame::FramePlan;
use crate::shadow::known::KnownShadows;

/// The cached shadows, and the plan they belong to.
#[derive(Debug, Default)]
pub(crate) struct KeptShadows {
    known: KnownShadows,
    plan: Option<FramePlan>,
}

impl KeptShadows {
    /// Clears the cache.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }

    /// Keeps the shadows that are valid in another plan. The cache then belongs to that plan, even
    /// if drawing it is cancelled.
    pub(crate) fn update(&mut self, plan: &FramePlan) {
        // Only shadows of rays that start at the pixels themselves can be kept.
        if !plan.shadows.are_cast() || !shadow_reach::is_by_pixel(plan) {
            return self.forget();
        }
        let before = self.plan.replace(plan.clone());
        let holds =
            |before: &FramePlan| before.size == plan.size && shadow_reach::is_known(before, plan);
        // If the size changed, or a quantity that all rays share, the cache starts empty.
        let Some(before) = before.filter(holds) else {
            self.known.forget();
            return self.known.keep(plan.size, &plan.shadows.sources);
        };
        self.known.keep(plan.size, &plan.shadows.sources);
        // A tile is stale if its surfaces changed, or if a changed caster's shadow reaches it.
        let damage = Damage::between(&before, plan);
        let changed = Changed::between(&before, plan);
        for (source, light) in self.known.lights() {
            let shadows = changed.tiles(&source);
            let is_shaded_anew = |tile| shadows.as_ref().is_none_or(|tiles| tiles.contains(tile));
            light.forget(|tile| damage.surfaces.contains(tile) || is_shaded_anew(tile));
        }
    }

    /// Returns the cached shadows, if any are kept.
    pub(crate) fn known(&self) -> Option<&KnownShadows> {
        self.plan.is_some().then_some(&self.known)
    }
}
