//! Warnings of the baseline about real shadows that are not visible.

use crate::baseline::Baseline;
use crate::baseline::census::SeenSets;
use crate::frame::warning::{UnseenShadow, Warning};
use crate::gpu::{Gpu, GpuError};
use crate::readback::{FloatMap, Map};
use app_scene::scene::MAX_LIGHTS;

/// Number of possible sets of lights, including the empty one.
const N_SETS: usize = 1 << MAX_LIGHTS;

impl Baseline {
    /// Waits for the device and returns warnings about the real shadows that are not visible, for
    /// the pose shown last. `listed` has the indices of the used receivers and lights in the
    /// caller's lists.
    pub(crate) fn read_warnings(
        &self,
        gpu: &Gpu,
        listed: (&[usize], &[usize]),
    ) -> Result<Vec<Warning>, GpuError> {
        if !self.plan.is_sampled {
            return Ok(Vec::new());
        }
        let seen: SeenSets = bytemuck::pod_read_unaligned(&gpu.read_buffer(&self.targets.census.seen_sets)?);
        if seen.iter().all(|sets| *sets == 0) {
            return Ok(vec![Warning::NothingToSample]);
        }
        let needed = self.read_map(gpu, Map::Terms)?.map(|terms| sets_in(&terms));
        let unseen = unseen(&needed.unwrap_or_default(), &seen, listed);
        let is_any = !unseen.is_empty();
        Ok(is_any
            .then_some(Warning::ShadowsUnseen { unseen })
            .into_iter()
            .collect())
    }
}

/// The sets that the labels of the terms contain, in the form of a census.
fn sets_in(terms: &FloatMap) -> SeenSets {
    let mut needed = SeenSets::default();
    for term in &terms.texels {
        #[allow(clippy::cast_possible_truncation, reason = "labels are small whole numbers")]
        let label = term[3] as usize;
        if let Some(sets) = needed.get_mut(label / N_SETS).filter(|_| label > 0) {
            *sets |= 1 << (label % N_SETS);
        }
    }
    needed
}

fn unseen(
    needed: &SeenSets,
    seen: &SeenSets,
    (receiver_indices, light_indices): (&[usize], &[usize]),
) -> Vec<UnseenShadow> {
    let lights = |set: usize| {
        let used = light_indices.iter().enumerate();
        let in_set = used.filter(|(light, _)| set >> light & 1 == 1);
        in_set.map(|(_, index)| *index).collect()
    };
    let of_receiver = |(receiver, (needed, seen)): (usize, (&u32, &u32))| {
        let sets = needed & !seen;
        let sets = (1..N_SETS).filter(move |set| sets >> set & 1 == 1);
        sets.map(move |set| UnseenShadow {
            receiver,
            lights: lights(set),
        })
    };
    let sets = needed.iter().zip(seen);
    receiver_indices
        .iter()
        .copied()
        .zip(sets)
        .flat_map(of_receiver)
        .collect()
}
