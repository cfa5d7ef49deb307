//! Pareto front: the points that no other beats both in time and in error.
//!
//! a dominates b where t_a <= t_b and e_a <= e_b, and one of the two is less.

use super::report::{Outcome, Report};

/// The places of the points (time, error) that no other dominates, fastest first; of equal points all.
/// Points that are not finite are on no front.
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let is_finite = |place: &usize| points[*place].iter().all(|value| value.is_finite());
    let mut order: Vec<usize> = (0..points.len()).filter(is_finite).collect();
    order.sort_by(|&a, &b| {
        let [ta, ea] = points[a];
        let [tb, eb] = points[b];
        ta.total_cmp(&tb).then(ea.total_cmp(&eb)).then(a.cmp(&b))
    });
    let mut front: Vec<usize> = Vec::new();
    for place in order {
        // The last of the front is the most exact so far, and not slower.
        let beaten = front.last().is_some_and(|&last| {
            points[last][1] <= points[place][1] && points[last] != points[place]
        });
        if !beaten {
            front.push(place);
        }
    }
    front
}

/// The rows of a plan of a scene that no other row of it beats both in `wall_s` and in the node-wise
/// p95, over all materials; by their places in the report, fastest first.
pub fn of_plan(report: &Report, scene: &str, plan: &str) -> Vec<usize> {
    let mut places = Vec::new();
    let mut points = Vec::new();
    for (place, row) in report.rows.iter().enumerate() {
        if let Outcome::Solved(solved) = &row.outcome
            && row.scene == scene
            && row.plan == plan
        {
            places.push(place);
            points.push([solved.wall_s, solved.error.p95]);
        }
    }
    front(&points).into_iter().map(|point| places[point]).collect()
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn the_front_holds_what_nothing_beats_fastest_first() {
        let points = [[3.0, 1.0], [1.0, 3.0], [2.0, 2.0], [2.5, 2.5], [4.0, 1.0]];
        assert_eq!(front(&points), [1, 2, 0]);
    }

    #[test]
    fn equal_points_are_on_the_front_together() {
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0], [1.0, 2.0]]), [0, 1]);
    }

    #[test]
    fn what_is_no_number_is_on_no_front() {
        assert_eq!(front(&[[f64::NAN, 0.0], [0.0, f64::INFINITY], [1.0, 1.0]]), [2]);
        assert_eq!(front(&[]), [0_usize; 0]);
    }
}
