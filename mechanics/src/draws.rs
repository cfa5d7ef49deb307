//! Pseudorandom draws that are the same on every machine: SplitMix64 (Steele, Lea, Flood 2014).

/// A sequence of draws.
pub struct Draws(u64);

impl Draws {
    /// A sequence of its own for each place of a seed.
    pub fn of(seed: u64, place: u64) -> Self {
        let mut draws = Draws(seed);
        let start = draws.next() ^ place.wrapping_mul(0xd134_2543_de82_ef95);
        Draws(start)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// From 0 up to 1, without it.
    pub fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Every factor alike.
    pub fn by_factors(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    /// From `low` to `high`, both of them.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.next() % (high - low + 1) as u64) as usize
    }

    /// One of so many.
    pub fn below(&mut self, count: usize) -> usize {
        self.whole(0, count.max(1) - 1)
    }

    /// Once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.whole(1, times) == 1
    }

    pub fn of_list<'a, T>(&mut self, list: &'a [T]) -> Option<&'a T> {
        (!list.is_empty()).then(|| &list[self.below(list.len())])
    }

    /// Of mean 0 and standard deviation 1 (Box, Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let length = (-2.0 * (1.0 - self.share()).ln()).sqrt();
        length * (std::f64::consts::TAU * self.share()).cos()
    }

    /// The same, but within two standard deviations.
    pub fn usual(&mut self) -> f64 {
        self.normal().clamp(-2.0, 2.0)
    }
}
