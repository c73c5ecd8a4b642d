//! Disjoint sets of indices: connected components of successively joined pairs.

/// A union-find forest. Source: Galler and Fischer 1964, with path halving (Tarjan and van Leeuwen 1984).
pub struct DisjointSets {
    /// For each index, another index of its set that is closer to the set's first one, which is its
    /// own parent.
    parents: Vec<usize>,
}

impl DisjointSets {
    /// `n` sets of one index each.
    pub fn new(n: usize) -> Self {
        Self {
            parents: (0..n).collect(),
        }
    }

    /// The smallest index of the set that `index` is in.
    pub fn first(&mut self, index: usize) -> usize {
        let mut at = index;
        while self.parents[at] != at {
            self.parents[at] = self.parents[self.parents[at]];
            at = self.parents[at];
        }
        at
    }

    /// Joins the sets of two indices.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b)] = a.min(b);
    }
}
