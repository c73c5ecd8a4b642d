//! CPU reference of the sets of lights in `common/baseline.wgsl`.

/// The lights that do not reach a place: bit i stands for light i. Empty for a fully lit place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct LightSet(pub u32);

impl LightSet {
    /// The set of the lights in a list.
    #[must_use]
    pub fn of(lights: &[u32]) -> Self {
        Self(lights.iter().fold(0, |set, light| set | 1 << light))
    }

    /// Whether it contains a light.
    #[must_use]
    pub fn has(self, light: usize) -> bool {
        self.0 >> light & 1 == 1
    }

    /// Its lights.
    pub fn lights(self) -> impl Iterator<Item = usize> {
        (0..u32::BITS as usize).filter(move |light| self.has(*light))
    }

    /// Dissimilarity of another set: first the number of different lights, then whether it has an
    /// additional one.
    #[must_use]
    pub fn unlikeness(self, other: Self) -> (usize, bool) {
        let missing = self.lights().filter(|light| !other.has(*light)).count();
        let surplus = other.lights().filter(|light| !self.has(*light)).count();
        (missing + surplus, surplus > 0)
    }

    /// The given sets in groups of equal dissimilarity, the most similar first.
    #[must_use]
    pub fn closest_first(self, among: &[Self]) -> Vec<Vec<Self>> {
        let mut groups: Vec<Vec<Self>> = Vec::new();
        let mut sets: Vec<Self> = among.to_vec();
        sets.sort_by_key(|set| (self.unlikeness(*set), *set));
        for set in sets {
            match groups.last_mut() {
                Some(group) if self.unlikeness(group[0]) == self.unlikeness(set) => group.push(set),
                _ => groups.push(vec![set]),
            }
        }
        groups
    }
}
