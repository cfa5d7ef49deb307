//! Stack of the nodes of a tree that are still to be visited.

/// Nodes still to be visited. A tree halved to leaves of four over at most 2^32 triangles is less than 32 deep, and a visit
/// leaves one node for each level.
pub(super) struct Stack {
    nodes: [u32; 40],
    count: usize,
}

impl Stack {
    /// With the root, if the tree has one.
    pub(super) fn new(nodes: usize) -> Stack {
        Stack { nodes: [0; 40], count: usize::from(nodes > 0) }
    }

    pub(super) fn push(&mut self, node: usize) {
        self.nodes[self.count] = node as u32;
        self.count += 1;
    }

    pub(super) fn pop(&mut self) -> Option<usize> {
        self.count = self.count.checked_sub(1)?;
        Some(self.nodes[self.count] as usize)
    }
}
