//! Disjoint sets of numbered things, joined two by two.

/// Which things hang together. The smallest of a set stands for it.
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// So many things, each alone.
    pub fn new(count: usize) -> Self {
        DisjointSets { parent: (0..count as u32).collect() }
    }

    pub fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.parent[one.max(other) as usize] = one.min(other);
    }

    /// The thing that stands for the set of another. Halves the path on its way.
    pub fn root(&mut self, mut thing: u32) -> u32 {
        while self.parent[thing as usize] != thing {
            let above = self.parent[self.parent[thing as usize] as usize];
            self.parent[thing as usize] = above;
            thing = above;
        }
        thing
    }
}
