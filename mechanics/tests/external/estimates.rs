//! What linear and second-order answers leave out of real faces and of a shell like one, held against Newton's answer.

use mechanics::material::LinearElastic;
use mechanics::mesh::Vector;
use mechanics::plan::RigidMovement;
use mechanics::prediction::{
    Accepted, Case, Method, Plan, Rung, Scene, Settings, TimedProgress, predict, predict_adequately,
};
use mechanics::progress::Unobserved;

use super::predictions::{
    nine_millimetres_and_five_degrees, second_order, shell, subject, template,
};
use crate::support::external::{Missing, trials};
use crate::support::responses::plan_of;

trials! {
    second_order_is_nearer_to_newton_on_the_shell_of_100_000_tetrahedra
    what_linearity_leaves_out_of_the_two_faces_is_what_newton_changes
    cells_that_all_but_collapse_are_estimated_at_the_size_of_the_error
    a_state_that_the_second_order_does_not_lead_to_is_not_called_adequate
}

fn at_finite_strain(case: &Case, plan: &Plan) -> Vec<Vector> {
    let settings =
        Settings { method: Method::FemNonlinear, estimate: false, ..Settings::default() };
    let scene = Scene::new(case, plan, &settings).unwrap();
    predict(&scene, &Unobserved).unwrap().displacement
}

/// Mean and 95th percentile of lengths in mm.
fn measures(lengths: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut lengths: Vec<f64> = lengths.collect();
    lengths.sort_by(f64::total_cmp);
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    [mean, lengths[(lengths.len() * 95).div_ceil(100) - 1]]
}

fn second_order_is_nearer_to_newton_on_the_shell_of_100_000_tetrahedra() -> Result<(), Missing> {
    let case = shell("shell/100k.vtu")?;
    let plan = plan_of(&case, &nine_millimetres_and_five_degrees());
    let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
    let linear = predict(&scene, &Unobserved).unwrap().displacement;
    let exact = at_finite_strain(&case, &plan);
    let second = second_order(&scene, 1e-3);
    let nodes = scene.skin.nodes().iter().map(|&node| node as usize);
    let first = measures(nodes.clone().map(|node| (linear[node] - exact[node]).norm()));
    let apart = |(node, u2): (usize, &Vector)| (linear[node] + u2 - exact[node]).norm();
    let both = measures(nodes.zip(&second).map(apart));
    println!("off by {first:.4?} mm to first order, {both:.4?} to second");
    assert!(2.0 * both[0] < first[0] && 1.6 * both[1] < first[1], "{both:?} of {first:?}");
    Ok(())
}

/// Both faces in hexahedra and wedges with mean dilatation, the jaw down and turned about an axis across the face.
fn what_linearity_leaves_out_of_the_two_faces_is_what_newton_changes() -> Result<(), Missing> {
    let mut found = Vec::new();
    for (name, case, jaw, across) in [
        ("subject", subject()?, "jaw_attached", Vector::y()),
        ("template", template()?, "mandible_fixed", Vector::x()),
    ] {
        let jaw = case.volume.node_set(jaw).unwrap();
        let pivot = jaw.iter().map(|&node| case.volume.nodes[node as usize]).sum::<Vector>()
            / jaw.len() as f64;
        for moved_mm in [0.5, 2.0, 5.4, 10.8] {
            let turn = across * (0.5_f64 * moved_mm).to_radians();
            let down = Vector::z() * -moved_mm;
            let plan = plan_of(&case, &[RigidMovement::about_pivot(turn, pivot, down)]);
            let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
            let linear = predict(&scene, &Unobserved).unwrap();
            let exact = at_finite_strain(&case, &plan);
            let nodes = scene.skin.nodes().iter().map(|&node| node as usize);
            let told = linear.nonlinearity.unwrap().left_out;
            let told = measures(nodes.clone().map(|node| told[node].norm()));
            let truth =
                measures(nodes.map(|node| (linear.displacement[node] - exact[node]).norm()));
            let ratio = [told[0] / truth[0], told[1] / truth[1]];
            println!("{name} {moved_mm} mm: truth {truth:.4?} mm, told over it {ratio:.2?}");
            found.push((name, moved_mm, ratio));
        }
    }
    for (name, moved_mm, ratio) in &found {
        let least = if *moved_mm <= 2.0 { 0.85 } else { 0.45 };
        assert!(
            ratio.iter().all(|own| (least..1.1).contains(own)),
            "{name} {moved_mm} {ratio:.2?}"
        );
    }
    Ok(())
}

/// The jaw backwards by 10 mm presses cells of the lips to a hundredth of their volume. Against half the edges the mesh leaves out
/// .63 mm in the mean, 2.3 mm at the 95th percentile (`cargo bench --bench estimates -- pressed`).
fn cells_that_all_but_collapse_are_estimated_at_the_size_of_the_error() -> Result<(), Missing> {
    let tissue = LinearElastic::new(15.0, 0.49, 1.0).unwrap();
    let materials = [("*".to_owned(), tissue)].into();
    let case = Case { materials, skin: None, ..subject()? };
    let back = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), Vector::x() * 10.0);
    let settings = Settings { method: Method::FemNonlinear, ..Settings::default() };
    let scene = Scene::new(&case, &plan_of(&case, &[back]), &settings).unwrap();
    let found = predict(&scene, &Unobserved).unwrap();
    let newton = found.solver.newton.unwrap();
    let missing = found.numerical_error.unwrap().missing;
    let skin = scene.skin.nodes().iter().map(|&node| missing[node as usize].norm());
    let [mean, p95] = measures(skin);
    println!("smallest det F {:.4}; estimated {mean:.3} and {p95:.3} mm", newton.least_det_f);
    assert!(newton.least_det_f < 0.1);
    assert!((0.15..1.5).contains(&mean) && (0.6..5.0).contains(&p95), "{mean} {p95}");
    Ok(())
}

/// The jaw 7 mm back and 8 mm aside presses tissue beside it until it gives way on this mesh, and on one with half the edges does not. The
/// estimate is about .7 mm in the mean.
fn a_state_that_the_second_order_does_not_lead_to_is_not_called_adequate() -> Result<(), Missing> {
    let case = subject()?;
    let shift = Vector::new(7.1, -7.7, 0.0);
    let answer = |share: f64, skin_mm: f64| {
        let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), shift * share);
        let plan = plan_of(&case, &[movement]);
        let scene = Scene::new(&case, &plan, &Settings::default()).unwrap();
        let accepted = Accepted { skin_mm, time_s: 1e6, ..Accepted::default() };
        let watched = TimedProgress { stopwatch: &|| 0.0, progress: &Unobserved };
        let found = predict_adequately(&case, &plan, &scene, &accepted, watched).unwrap();
        let errors = found.considered.iter().find(|other| other.rung == found.rung);
        let told = errors.unwrap().error.as_ref().unwrap().skin_mm;
        let codes: Vec<&str> = found.objections.iter().map(|own| own.warning.code).collect();
        println!("{share}: {:?}, {told:.3} mm, {codes:?}", found.rung);
        (found.rung, found.is_met, told, codes.join(" "))
    };
    let (rung, is_met, told, codes) = answer(1.0, 0.8);
    assert_eq!((rung, is_met, codes.as_str()), (Rung::FiniteStrain, false, "another-equilibrium"));
    assert!(told < 0.8, "{told}");
    let (_, is_met, _, codes) = answer(0.3, 0.8);
    assert!(is_met && codes.is_empty(), "{codes}");
    Ok(())
}
