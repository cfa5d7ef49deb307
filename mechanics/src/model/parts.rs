//! Adaptive load steps: a step without equilibrium is halved, the step after a successful one is twice as large.

/// The least part of a movement that is tried.
const LEAST: f64 = 1.0 / 64.0;

/// How much of a movement is at rest, and how much of it is tried next, as shares of the whole.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    made: f64,
    part: f64,
}

impl Parts {
    /// A movement of which nothing is made, and its first part.
    pub fn beginning_with(part: f64) -> Parts {
        Parts { made: 0.0, part }
    }

    /// The share that is at rest.
    pub fn made(&self) -> f64 {
        self.made
    }

    /// The share to be brought to rest next.
    pub fn target(&self) -> f64 {
        (self.made + self.part).min(1.0)
    }

    /// The same between two shares of something larger.
    pub fn target_between(&self, from: f64, to: f64) -> f64 {
        match self.target() {
            1.0 => to,
            part => from + (to - from) * part,
        }
    }

    /// The target is at rest. True where that is the whole movement.
    pub fn rested(&mut self) -> bool {
        self.made = self.target();
        self.part = (2.0 * self.part).min(1.0 - self.made);
        self.made >= 1.0
    }

    /// The target found no rest. False where no smaller part is tried.
    pub fn halve(&mut self) -> bool {
        let half = 0.5 * self.part;
        let goes_on = half >= LEAST;
        if goes_on {
            self.part = half;
        }
        goes_on
    }
}

#[cfg(test)]
mod tests {
    use super::Parts;

    #[test]
    fn a_part_that_fails_is_halved_and_the_next_after_one_that_rests_is_twice_as_large() {
        let mut parts = Parts::beginning_with(1.0);
        assert_eq!(parts.target(), 1.0);
        assert!(parts.halve() && parts.halve());
        assert_eq!([parts.made(), parts.target()], [0.0, 0.25]);
        assert!(!parts.rested());
        assert_eq!([parts.made(), parts.target()], [0.25, 0.75]);
        assert!(!parts.rested());
        // Never more than is left: half of that is tried after it fails, not the same again.
        assert_eq!([parts.made(), parts.target()], [0.75, 1.0]);
        assert!(parts.halve());
        assert_eq!(parts.target(), 0.875);
        assert!(!parts.rested() && parts.rested());
        assert_eq!(parts.made(), 1.0);
    }

    #[test]
    fn the_last_part_of_a_step_ends_where_the_step_does() {
        let mut parts = Parts::beginning_with(0.5);
        let (from, to) = (0.3, 0.9);
        assert!(from + (to - from) != to);
        assert_eq!(parts.target_between(from, to), from + (to - from) * 0.5);
        assert!(!parts.rested());
        assert_eq!(parts.target_between(from, to), to);
    }

    #[test]
    fn no_part_is_less_than_a_64th() {
        let mut parts = Parts::beginning_with(1.0);
        assert_eq!((0..10).take_while(|_| parts.halve()).count(), 6);
        assert_eq!(parts.target(), 1.0 / 64.0);
    }
}
