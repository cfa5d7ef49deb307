//! Inverse planning: plans found again from the skin they make, with bounds, noise and too little to go by.

use std::f64::consts::TAU;

use mechanics::mesh::Vector;
use mechanics::optimisation::{
    Bound, Goal, OptimisationError, Optimum, Parameter, Question, SegmentBounds, SkinPoint, Target,
    optimise,
};
use mechanics::response::Response;

use crate::optimisation::scenes::{
    Random, bounds, check, difference, every_node, moved_skin, movement, planted, response, skin,
};

const SURGERY: [[f64; 6]; 2] =
    [[4.0, -6.0, 1.5, 7.0, -5.0, 11.0], [-1.0, -3.0, 2.0, -4.0, 2.0, 3.0]];

/// Of movements alone, to first order.
fn asked<'a>(
    response: &'a Response,
    bounds: &'a [SegmentBounds],
    targets: &'a [Target],
) -> Question<'a> {
    Question { response, bounds, targets, inner: &[], constants: &[], second_order: None }
}

fn found(response: &Response, bounds: &[SegmentBounds], targets: &[Target]) -> Optimum {
    let optimum = optimise(&asked(response, bounds, targets)).unwrap();
    check(&optimum, bounds);
    optimum
}

/// The segment of a parameter of these plans, and which of its six numbers it is.
fn six(parameter: Parameter) -> (usize, usize) {
    let Parameter::Movement { segment, number } = parameter else { panic!("{parameter:?}") };
    (segment, number)
}

#[test]
fn a_planted_plan_is_found_again_from_its_skin() {
    let response = response(&skin());
    let plan = planted(SURGERY);
    let targets = [every_node(&moved_skin(&response, &plan), 1.0)];
    let found = found(&response, &bounds(25.0, 30.0), &targets);
    let (mm, degrees) = difference(&found.parameters, &plan);
    // The last step is below 1e-8.
    assert!(mm < 1e-7 && degrees < 1e-7, "{mm} mm, {degrees} degrees");
    assert!(found.targets[0].largest < 1e-7 && found.weighted_square_sum < 1e-12);
    assert!(found.at_bound.is_empty() && found.certainty.undetermined.is_empty());
    assert_eq!((found.components, found.certainty.determined.len()), (300, 12));
    assert!(found.iterations <= 10, "{}", found.iterations);
}

/// A plan of two segments that turn by at most `degrees` about each axis, and by 90 degrees in all.
fn random_plan(random: &mut Random, degrees: f64) -> [[f64; 6]; 2] {
    let mut number = |k: usize| match k {
        0..3 => random.between(-55.0, 55.0),
        _ => random.between(-degrees, degrees),
    };
    loop {
        let plan = planted([(); 2].map(|()| std::array::from_fn(&mut number)));
        if (0..2).all(|segment| movement(segment, &plan[segment]).angle() <= TAU / 4.0) {
            return plan;
        }
    }
}

#[test]
fn any_plan_within_the_limits_of_the_service_is_found_from_rest() {
    let response = response(&skin());
    let mut random = Random(1);
    for (points, degrees) in [(100, 85.0), (8, 60.0)] {
        for draw in 0..75 {
            let plan = random_plan(&mut random, degrees);
            let mut target = every_node(&moved_skin(&response, &plan), 1.0);
            while target.goals.len() > points {
                let place = random.between(0.0, target.goals.len() as f64) as usize;
                target.goals.swap_remove(place);
            }
            let found = found(&response, &bounds(57.0, 90.0), &[target]);
            let (mm, degrees) = difference(&found.parameters, &plan);
            // Near 90 degrees about y the other two angles hardly differ, and few points determine little.
            let place = format!("{points} points, draw {draw}: {mm} mm, {degrees} degrees");
            assert!(mm < 1e-4 && degrees < 1e-4, "{place}");
        }
    }
}

/// The mean squared error of each parameter over draws of noise, divided by the variance stated.
fn variance_ratio(plan: [[f64; 6]; 2], draws: usize, seed: u64) -> Vec<f64> {
    const NOISE: f64 = 0.3;
    let response = response(&skin());
    let skin = moved_skin(&response, &plan);
    let bounds = bounds(25.0, 30.0);
    let mut random = Random(seed);
    let mut ratios = vec![0.0; 12];
    for _ in 0..draws {
        let noise = skin.iter().map(|u| u + Vector::from_fn(|_, _| NOISE * random.normal()));
        let targets = [every_node(&noise.collect::<Vec<_>>(), NOISE)];
        let found = found(&response, &bounds, &targets);
        assert_eq!(found.certainty.determined.len(), 12);
        for (k, parameter) in found.certainty.determined.iter().enumerate() {
            let (segment, number) = six(*parameter);
            let error = found.parameters[segment][number] - plan[segment][number];
            ratios[k] += error.powi(2) / found.certainty.covariance[(k, k)] / draws as f64;
        }
    }
    ratios
}

#[test]
fn the_error_that_noise_causes_is_as_large_as_the_variance_says() {
    // 800 draws scatter by a twentieth: each of the 24 ratios is four times that from its bounds, with any seed.
    for plan in [planted([[0.0; 6]; 2]), planted(SURGERY)] {
        let ratios = variance_ratio(plan, 800, 1);
        assert!(ratios.iter().all(|ratio| (0.8..1.25).contains(ratio)), "{ratios:.3?}");
    }
}

#[test]
fn the_weighted_squares_add_up_to_the_components_less_the_parameters() {
    let response = response(&skin());
    let (mut random, skin) = (Random(3), moved_skin(&response, &planted(SURGERY)));
    let (draws, mut mean) = (200, 0.0);
    for _ in 0..draws {
        let noise = skin.iter().map(|u| u + Vector::from_fn(|_, _| 0.5 * random.normal()));
        let targets = [every_node(&noise.collect::<Vec<_>>(), 0.5)];
        mean += found(&response, &bounds(25.0, 30.0), &targets).weighted_square_sum / draws as f64;
    }
    // Chi squared with 288 degrees of freedom: its mean over 200 draws scatters by 1.7.
    assert!((mean - 288.0).abs() < 7.0, "{mean}");
}

/// The sum that the optimum minimises, from its definition.
fn sum(response: &Response, targets: &[Target], q: &[[f64; 6]; 2]) -> f64 {
    let skin = moved_skin(response, q);
    let mut sum = 0.0;
    for target in targets {
        for (goal, u) in target.goals.iter().zip(&skin) {
            for k in 0..3 {
                sum += goal.displacement[k].map_or(0.0, |d| ((u[k] - d) / target.sigma).powi(2));
            }
        }
    }
    sum
}

#[test]
fn within_bounds_that_stop_it_nothing_nearby_is_better() {
    let response = response(&skin());
    let mut random = Random(11);
    for draw in 0..20 {
        let mut number = |k: usize| random.between(-1.0, 1.0) * if k < 3 { 20.0 } else { 30.0 };
        let plan = planted([(); 2].map(|()| std::array::from_fn(&mut number)));
        // Out of reach by the bounds, and by 20 mm of noise.
        let skin = moved_skin(&response, &plan).into_iter();
        let wanted: Vec<Vector> =
            skin.map(|u| u + Vector::from_fn(|_, _| 20.0 * random.normal())).collect();
        let targets = [every_node(&wanted, 2.0)];
        let bounds = bounds(8.0, 9.0);
        let found = found(&response, &bounds, &targets);
        assert!(!found.at_bound.is_empty());
        for (parameter, bound) in &found.at_bound {
            let (segment, number) = six(*parameter);
            let (low, high) = bounds[segment].intervals[number];
            let end = if *bound == Bound::Lower { low } else { high };
            assert!((found.parameters[segment][number] - end).abs() < 1e-15);
            assert!(!found.certainty.determined.contains(parameter));
        }
        let best = [found.parameters[0], found.parameters[1]];
        let lowest = sum(&response, &targets, &best);
        assert!((lowest - found.weighted_square_sum).abs() < 1e-9 * lowest);
        for _ in 0..200 {
            let near: [[f64; 6]; 2] = std::array::from_fn(|segment| {
                std::array::from_fn(|k| {
                    let (low, high) = bounds[segment].intervals[k];
                    let size = if k < 3 { 0.1 } else { 0.1_f64.to_radians() };
                    (best[segment][k] + size * random.between(-1.0, 1.0)).clamp(low, high)
                })
            });
            assert!(sum(&response, &targets, &near) >= lowest, "draw {draw}");
        }
    }
}

/// Bounds whose angles are halves of others, one for each choice of halves of the first segment.
fn halves(whole: &[SegmentBounds]) -> Vec<Vec<SegmentBounds>> {
    let half = |choice: usize| {
        let mut own = whole.to_vec();
        for axis in 0..3 {
            let (low, high) = own[0].intervals[3 + axis];
            let middle = 0.5 * (low + high);
            let is_upper = choice >> axis & 1 == 1;
            own[0].intervals[3 + axis] = if is_upper { (middle, high) } else { (low, middle) };
        }
        own
    };
    (0..8).map(half).collect()
}

#[test]
fn no_part_of_wide_bounds_has_a_better_plan() {
    let response = response(&skin());
    let mut random = Random(21);
    let (mut with_others, mut from_rest_alone) = (0, 0);
    for draw in 0..60 {
        let mut number = |k: usize| random.between(-1.0, 1.0) * if k < 3 { 4.0 } else { 60.0 };
        let plan = planted([std::array::from_fn(&mut number), [0.0; 6]]);
        let wanted: Vec<Vector> = moved_skin(&response, &plan)
            .iter()
            .map(|u| u + Vector::from_fn(|_, _| 0.3 * random.normal()))
            .collect();
        let mut target = every_node(&wanted, 0.3);
        while target.goals.len() > 6 {
            let place = random.between(0.0, target.goals.len() as f64) as usize;
            target.goals.swap_remove(place);
        }
        let mut wide = bounds(2.0, 80.0);
        wide[1].intervals = [(0.0, 0.0); 6];
        let found = found(&response, &wide, std::slice::from_ref(&target));
        assert_eq!(found.starts, 13);
        let sums = halves(&wide).into_iter().map(|part| {
            let question = asked(&response, &part, std::slice::from_ref(&target));
            optimise(&question).unwrap().weighted_square_sum
        });
        let least = sums.fold(f64::INFINITY, f64::min);
        let own = found.weighted_square_sum;
        assert!(own <= least * (1.0 + 1e-5) + 1e-9, "draw {draw}: {own}, in a part {least}");
        with_others += usize::from(!found.other_minima.is_empty());
        assert!(found.other_minima.iter().all(|other| *other >= own * (1.0 - 1e-5)));
        // Bounds of surgery have one start.
        let mut narrow = bounds(2.0, 20.0);
        narrow[1].intervals = [(0.0, 0.0); 6];
        let question = asked(&response, &narrow, std::slice::from_ref(&target));
        from_rest_alone += usize::from(optimise(&question).unwrap().starts == 1);
    }
    assert!(with_others > 0 && from_rest_alone == 60, "{with_others} {from_rest_alone}");
}

#[test]
fn a_parameter_with_equal_bounds_stays_there_and_the_others_make_up_for_it() {
    let response = response(&skin());
    let plan = planted([[4.0, -6.0, 1.5, 7.0, 0.0, 11.0], [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]]);
    let targets = [every_node(&moved_skin(&response, &plan), 1.0)];
    let mut bounds = bounds(25.0, 30.0);
    bounds[0].intervals[4] = (0.0, 0.0);
    for (number, interval) in bounds[1].intervals.iter_mut().enumerate() {
        *interval = (plan[1][number], plan[1][number]);
    }
    let found = found(&response, &bounds, &targets);
    let (mm, degrees) = difference(&found.parameters, &plan);
    assert!(mm < 1e-7 && degrees < 1e-7, "{mm} mm, {degrees} degrees");
    assert_eq!(found.certainty.determined.len(), 5);
    assert!(found.at_bound.is_empty());
}

#[test]
fn what_the_targets_do_not_determine_is_named_and_stays_at_rest() {
    let response = response(&skin());
    let skin = moved_skin(&response, &planted(SURGERY));
    let mut target = every_node(&skin, 1.0);
    // One point has three components; the chin segment has six parameters, of which three are left over.
    target.goals = vec![target.goals[25]];
    let mut bounds = bounds(25.0, 30.0);
    bounds[1].intervals = [(0.0, 0.0); 6];
    let found = found(&response, &bounds, &[target]);
    assert!(found.targets[0].largest < 1e-7);
    let certainty = &found.certainty;
    assert_eq!(certainty.undetermined.len(), 3);
    assert!(certainty.determined.is_empty() && certainty.covariance.is_empty());
    // Moving along a combination moves the target by its square only.
    let q = [found.parameters[0], found.parameters[1]];
    let place = |q: &[[f64; 6]; 2]| moved_skin(&response, q)[25];
    for combination in &certainty.undetermined {
        let step = |size: f64| {
            let mut q = q;
            for weight in combination {
                let (_, number) = six(weight.parameter);
                let unit = if number < 3 { 1.0 } else { 1_f64.to_radians() };
                q[0][number] += size * unit * weight.part;
            }
            (place(&q) - place(&found.parameters.clone().try_into().unwrap())).norm()
        };
        // 0.01 degrees of 60 mm squared is 1e-6 mm; single precision of the response adds some 1e-8.
        assert!(step(0.01) < 5e-6, "{} {combination:?}", step(0.01));
        assert!((0.999..=1.0).contains(&combination.iter().fold(0.0, |most, w| w.part.max(most))));
    }
}

#[test]
fn a_segment_that_the_targets_do_not_feel_stays_at_rest_and_spoils_nothing() {
    let mut response = response(&skin());
    let half = response.columns.len() / 2;
    response.columns[half..].fill(0.0);
    let plan = planted([SURGERY[0], [0.0; 6]]);
    let targets = [every_node(&moved_skin(&response, &plan), 1.0)];
    let found = found(&response, &bounds(25.0, 30.0), &targets);
    let (mm, degrees) = difference(&found.parameters, &plan);
    assert!(mm < 1e-7 && degrees < 1e-7, "{mm} mm, {degrees} degrees");
    let determined = found.certainty.determined.iter();
    assert!(determined.map(|parameter| six(*parameter).0).eq([0; 6]));
    // Each of the other six is a combination of itself.
    assert_eq!(found.certainty.undetermined.len(), 6);
    for combination in &found.certainty.undetermined {
        assert_eq!((combination.len(), six(combination[0].parameter).0), (1, 1));
    }
}

#[test]
fn a_point_within_a_triangle_moves_with_its_corners_and_free_components_are_left_alone() {
    let response = response(&skin());
    let mut bounds = bounds(25.0, 30.0);
    for segment in &mut bounds {
        segment.intervals[3..].fill((0.0, 0.0));
    }
    bounds[1].intervals = [(0.0, 0.0); 6];
    let point = SkinPoint::within([3, 4, 13], [0.2, 0.3, 0.5]);
    let goals = vec![Goal { point, displacement: [Some(1.0), None, Some(-2.0)] }];
    let found = found(&response, &bounds, &[Target { goals, sigma: 0.5 }]);
    let movements = &found.movements;
    let skin = response.apply(movements);
    let moved = skin[3] * 0.2 + skin[4] * 0.3 + skin[13] * 0.5;
    assert!((moved - Vector::new(1.0, 0.0, -2.0)).norm() < 1e-9);
    // Along y nothing is asked, and nothing moves.
    assert_eq!(found.parameters[0][1], 0.0);
    let [combination] = &found.certainty.undetermined[..] else { panic!() };
    assert_eq!((combination.len(), six(combination[0].parameter).1), (1, 1));
    // u = share * t, so the standard error of t is sigma over the share.
    let share = moved.x / found.parameters[0][0];
    let errors = found.certainty.standard_errors();
    assert_eq!(errors.len(), 2);
    for error in errors {
        assert!((error - 0.5 / share).abs() < 1e-9, "{error}");
    }
}

#[test]
fn a_question_without_an_answer_is_refused() {
    let response = response(&skin());
    let wanted = every_node(&skin(), 1.0);
    let ask = |response: &Response, bounds: &[SegmentBounds], targets: &[Target]| {
        optimise(&asked(response, bounds, targets)).unwrap_err()
    };
    let free = bounds(25.0, 30.0);
    let held = bounds(0.0, 0.0);
    assert_eq!(
        ask(&response, &held, std::slice::from_ref(&wanted)),
        OptimisationError::NothingFree
    );
    let mut nothing = wanted.clone();
    nothing.goals.iter_mut().for_each(|goal| goal.displacement = [None; 3]);
    assert_eq!(ask(&response, &free, &[nothing]), OptimisationError::NoTarget);
    assert_eq!(ask(&response, &free, &[]), OptimisationError::NoTarget);
    let mut broken = response.clone();
    broken.columns[7] = f32::NAN;
    assert_eq!(ask(&broken, &free, &[wanted]), OptimisationError::NotFinite);
}

#[test]
fn targets_far_from_any_skin_have_a_nearest_plan_or_say_that_it_was_not_found() {
    let response = response(&skin());
    let mut random = Random(5);
    let mut without = 0;
    for points in [1, 2, 5, 100] {
        for _ in 0..20 {
            let wanted: Vec<Vector> =
                (0..points).map(|_| Vector::from_fn(|_, _| 60.0 * random.normal())).collect();
            let (bounds, targets) = (bounds(25.0, 90.0), [every_node(&wanted, 1.0)]);
            match optimise(&asked(&response, &bounds, &targets)) {
                Ok(found) => {
                    check(&found, &bounds);
                    assert!(found.weighted_square_sum.is_finite());
                }
                Err(OptimisationError::NotConverged { iterations, step, .. }) => {
                    assert!(iterations == 1000 && step.is_finite());
                    without += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
    // The residual is larger than the skin is curved, and steps become short before the minimum.
    assert!(without <= 1, "{without} of 80");
}
