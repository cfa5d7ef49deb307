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

    /// For each thing the number of its set, and how many sets there are, numbered in the order of their smallest.
    pub fn numbers(&mut self) -> (Vec<u32>, u32) {
        let mut numbers = vec![0; self.parent.len()];
        let mut count = 0;
        for thing in 0..self.parent.len() as u32 {
            let root = self.root(thing);
            numbers[thing as usize] = if root == thing { count } else { numbers[root as usize] };
            count += u32::from(root == thing);
        }
        (numbers, count)
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
