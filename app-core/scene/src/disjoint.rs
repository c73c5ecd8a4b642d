//! Disjoint sets of indices: what hangs together when pairs are joined one after the other.

/// A union-find forest. Source: Galler and Fischer 1964, with path halving (Tarjan and van Leeuwen 1984).
pub struct DisjointSets {
    /// Another index of the same set, closer to its first one; that one is its own parent.
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

    /// Makes one set of those that two indices are in.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b)] = a.min(b);
    }
}
