//! Hash table from the keys of lattice nodes to their numbers.

/// Stands for a free place: no node has this key.
const FREE: u64 = u64::MAX;

/// Open addressing with linear probing; at most half full.
pub(super) struct NodeTable {
    keys: Vec<u64>,
    numbers: Vec<u32>,
    shift: u32,
    held: usize,
}

impl NodeTable {
    /// For about so many nodes.
    pub fn with_room(nodes: usize) -> NodeTable {
        let places = (2 * nodes).next_power_of_two().max(64);
        let shift = 64 - places.trailing_zeros();
        NodeTable { keys: vec![FREE; places], numbers: vec![0; places], shift, held: 0 }
    }

    /// The number of a key, which is `next` if it has none yet.
    pub fn number(&mut self, key: u64, next: u32) -> u32 {
        if 2 * self.held >= self.keys.len() {
            self.grow();
        }
        let place = self.place(key);
        if self.keys[place] == FREE {
            self.keys[place] = key;
            self.numbers[place] = next;
            self.held += 1;
        }
        self.numbers[place]
    }

    pub fn get(&self, key: u64) -> Option<u32> {
        let place = self.place(key);
        (self.keys[place] == key).then(|| self.numbers[place])
    }

    /// Where the key is, or would be put.
    fn place(&self, key: u64) -> usize {
        // Fibonacci hashing: Knuth, The Art of Computer Programming 3, section 6.4.
        let mut place = (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> self.shift) as usize;
        while self.keys[place] != FREE && self.keys[place] != key {
            place = (place + 1) & (self.keys.len() - 1);
        }
        place
    }

    fn grow(&mut self) {
        let mut larger = NodeTable::with_room(self.keys.len());
        for (&key, &number) in self.keys.iter().zip(&self.numbers) {
            if key != FREE {
                larger.number(key, number);
            }
        }
        *self = larger;
    }
}
