//! The width search of Zhang et al. 2016, section 2.4, steps a to c: a climb in steps of one length.
//!
//! "Change the value of sigma by a step length such as 0.01. If the RMSE increases, change the value of sigma in the other
//! direction. If sigma changes only minutely like 0.005, select the current value." A step of 0.01 is never as small as 0.005:
//! the rule never selects, and beside a minimum it goes back and forth for good. Where features are many, all widths near 1
//! give the nearest case and the error does not change at all. Kept to be compared; `regression` searches widths for use.

/// The paper's numbers.
pub const START: f64 = 1.0;
pub const STEP: f64 = 0.01;

/// How a climb ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClimbEnd {
    /// Both neighbours are worse: the rule goes back and forth between them.
    Alternates,
    /// The error neither rises nor falls: the rule does not say what to do.
    Flat,
    /// The next width would not be positive.
    AtZero,
    /// It was still going.
    OutOfSteps,
}

/// Where a climb came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climb {
    pub width: f64,
    pub rmse: f64,
    /// Steps by which the error fell.
    pub steps: usize,
    pub end: ClimbEnd,
}

/// Climbs from [`START`] by [`STEP`], at most so many times.
pub fn hill_climb(rmse: impl Fn(f64) -> f64, most: usize) -> Climb {
    // Places are counted, so that a thousand steps add no rounding.
    let width = |place: i64| START + STEP * place as f64;
    let (mut place, mut direction, mut has_turned) = (0_i64, 1_i64, false);
    let mut now = rmse(width(0));
    let ended = |place: i64, rmse: f64, steps: usize, end: ClimbEnd| Climb {
        width: width(place),
        rmse,
        steps,
        end,
    };
    let mut steps = 0;
    while steps < most {
        let next = place + direction;
        if width(next) < 0.5 * STEP {
            return ended(place, now, steps, ClimbEnd::AtZero);
        }
        let error = rmse(width(next));
        if error < now {
            (place, now, steps) = (next, error, steps + 1);
        } else if error == now {
            return ended(place, now, steps, ClimbEnd::Flat);
        } else if has_turned || steps > 0 {
            return ended(place, now, steps, ClimbEnd::Alternates);
        } else {
            (direction, has_turned) = (-direction, true);
        }
    }
    ended(place, now, steps, ClimbEnd::OutOfSteps)
}
