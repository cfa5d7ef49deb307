//! Groups of rows that are coupled to each other, such as the nodes of cells.

/// Members of each clique, one clique after the other.
#[derive(Clone, Debug)]
pub struct Cliques {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Default for Cliques {
    fn default() -> Self {
        Cliques { starts: vec![0], members: Vec::new() }
    }
}

impl Cliques {
    pub fn push(&mut self, members: impl IntoIterator<Item = u32>) {
        self.members.extend(members);
        self.starts.push(self.members.len() as u32);
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn members(&self, clique: usize) -> &[u32] {
        &self.members[self.starts[clique] as usize..self.starts[clique + 1] as usize]
    }

    /// The cliques in another order, with rows renumbered.
    pub fn renumbered(&self, order: &[u32], place: &[u32]) -> Cliques {
        let mut renumbered = Cliques {
            starts: Vec::with_capacity(self.starts.len()),
            members: Vec::with_capacity(self.members.len()),
        };
        renumbered.starts.push(0);
        for &clique in order {
            renumbered.push(self.members(clique as usize).iter().map(|&row| place[row as usize]));
        }
        renumbered
    }
}

/// For each row the cliques it is a member of, ascending.
#[derive(Clone, Debug)]
pub struct CliquesOfRow {
    starts: Vec<u32>,
    cliques: Vec<u32>,
}

impl CliquesOfRow {
    /// A counting sort of cliques around their members.
    pub fn new(cliques: &Cliques, rows: usize) -> Self {
        let mut starts = vec![0_u32; rows + 1];
        for &member in &cliques.members {
            starts[member as usize + 1] += 1;
        }
        for row in 0..rows {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; cliques.members.len()];
        for clique in 0..cliques.len() {
            for &member in cliques.members(clique) {
                sorted[next[member as usize] as usize] = clique as u32;
                next[member as usize] += 1;
            }
        }
        CliquesOfRow { starts, cliques: sorted }
    }

    pub fn of(&self, row: usize) -> &[u32] {
        &self.cliques[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}
