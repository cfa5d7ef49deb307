//! Plans as documents: movements that are no movements, too large, twice, or in another frame.

use facies::schema::PlanDocument;
use mechanics::mesh::{Frame, Vector};
use mechanics::prediction::{Load, Prescribed};

use crate::schema::documents::{one, plan, plan_in, refused};

fn matrix_plan(entries: [f64; 16]) -> String {
    format!(r#"{{"segments":[{{"name":"jaw","matrix4x4":{entries:?}}}]}}"#)
}

#[test]
fn a_matrix_that_scales_shears_or_mirrors_is_not_rigid() {
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    assert!(plan(&matrix_plan(identity)).is_ok());
    for (entry, value) in [(0, 1.001), (1, 0.001), (0, -1.0), (12, 1.0), (15, 2.0), (0, 1e308)] {
        let mut matrix = identity;
        matrix[entry] = value;
        let problem = plan(&matrix_plan(matrix)).expect_err("refused");
        assert_eq!(problem.code.name(), "plan-not-rigid", "{entry} {value}");
        assert_eq!(problem.errors[0].pointer, "/plan/segments/0/matrix4x4");
    }
}

#[test]
fn a_matrix_that_is_not_rigid_is_told_its_deviation() {
    let stretched =
        [1.001, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let problem = plan(&matrix_plan(stretched)).expect_err("refused");
    assert!(problem.detail.contains("2.001e-3"), "{}", problem.detail);
}

#[test]
fn movements_beyond_the_published_limits_are_out_of_range() {
    let at = "/plan/segments/0";
    let out = "plan-out-of-range";
    for (movement, place) in [
        (r#""translation_mm":[500,0,0]"#, "/translation_mm"),
        (r#""translation_mm":[1e308,1e308,0]"#, "/translation_mm"),
        (r#""rotation_deg":[400,0,0],"pivot_mm":[0,0,0]"#, "/rotation_deg"),
        (r#""rotation_deg":[0,1e308,0],"pivot_mm":[0,0,0]"#, "/rotation_deg"),
        (r#""rotation_deg":[0,60,0],"pivot_mm":[500,0,0]"#, ""),
        (r#""rotation_deg":[0,5,0],"pivot_mm":[1e300,0,0]"#, "/pivot_mm"),
        (r#""matrix4x4":[1,0,0,1e308,0,1,0,0,0,0,1,0,0,0,0,1]"#, ""),
        (r#""matrix4x4":[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]"#, ""),
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw",{movement}}}]}}"#);
        let told = plan(&text).map_err(|problem| problem.detail).expect_err("refused");
        assert!(!movement.contains("1e308,") || told.contains("1e308"), "{told}");
        assert_eq!(refused(plan(&text)), one(out, out, &format!("{at}{place}")), "{movement}");
    }
}

// Through many small steps.
#[test]
fn a_sequence_may_not_go_where_one_movement_may_not() {
    let step = r#"{"translation_mm":[90,0,0]}"#;
    let text = format!(r#"{{"segments":[{{"name":"jaw","sequence":[{step},{step},{step}]}}]}}"#);
    let out = "plan-out-of-range";
    assert_eq!(refused(plan(&text)), one(out, out, "/plan/segments/0"));
}

// A segment without a movement is no movement by accident.
#[test]
fn a_segment_gives_exactly_one_form_of_movement() {
    for movement in [
        "",
        r#","translation_mm":[0,0,0],"matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#,
        r#","translation_mm":[0,0,0],"sequence":[{"translation_mm":[1,0,0]}]"#,
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw"{movement}}}]}}"#);
        let wanted = one("validation-failed", "one-of", "/plan/segments/0");
        assert_eq!(refused(plan(&text)), wanted, "{movement}");
    }
}

#[test]
fn a_rotation_needs_its_pivot() {
    let text = r#"{"segments":[{"name":"jaw","rotation_deg":[0,5,0]}]}"#;
    let wanted = one("validation-failed", "missing-field", "/plan/segments/0/pivot_mm");
    assert_eq!(refused(plan(text)), wanted);
    assert!(plan(r#"{"segments":[{"name":"jaw","rotation_deg":[0,0,0]}]}"#).is_ok());
}

#[test]
fn the_same_segment_twice_is_refused() {
    let text = r#"{"segments":[{"name":"jaw","translation_mm":[0,0,0]},{"name":" jaw ","translation_mm":[1,0,0]}]}"#;
    let wanted = one("validation-failed", "duplicate-name", "/plan/segments/1/name");
    assert_eq!(refused(plan(text)), wanted);
}

#[test]
fn the_identity_in_every_form_displaces_by_exactly_nothing() {
    for movement in [
        r#""translation_mm":[0,0,0]"#,
        r#""rotation_deg":[0,0,0],"pivot_mm":[3,4,5]"#,
        r#""matrix4x4":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#,
        r#""sequence":[{"translation_mm":[0,0,0]},{"rotation_deg":[0,0,0]}]"#,
    ] {
        let text = format!(r#"{{"segments":[{{"name":"jaw",{movement}}}]}}"#);
        let plan = plan(&text).expect("accepted");
        let point = Vector::new(12.3, -70.1, 33.3);
        assert_eq!(plan.segments[0].movement.displacement(&point), Vector::zeros(), "{movement}");
    }
}

#[test]
fn a_plan_in_the_other_frame_moves_the_same_bone_the_same_way() {
    let lps = r#"{"frame":"LPS","segments":[{"name":"jaw","translation_mm":[1,-5,2],"rotation_deg":[3,4,5],"pivot_mm":[10,20,30]}],
        "prescribed":[{"nodes":{"node_set":"a"},"displacement_mm":[1,null,2]}],
        "loads":[{"force_millinewton":[1,2,3],"nodes":{"node_set":"a"}},{"gravity_m_per_s2":[0,9.81,1]}]}"#;
    let (there, here) = (plan_in(Frame::Ras, lps).expect("ok"), plan(lps).expect("ok"));
    let flip = |v: Vector| Vector::new(-v.x, -v.y, v.z);
    let point = Vector::new(12.0, -70.0, 33.0);
    let moved = there.segments[0].movement.displacement(&flip(point));
    let wanted = flip(here.segments[0].movement.displacement(&point));
    assert!((moved - wanted).norm() < 1e-12, "rounding of one rotation");
    let Prescribed::Uniform { displacement, .. } = &there.prescribed[0] else {
        panic!("a uniform displacement");
    };
    assert_eq!(*displacement, [Some(-1.0), None, Some(2.0)]);
    let Load::Force { force, .. } = &there.loads[0] else { panic!("a force") };
    assert_eq!(*force, Vector::new(-1.0, -2.0, 3.0));
    let Load::Gravity { acceleration } = &there.loads[1] else { panic!("gravity") };
    // 9.81 m/s² is 0.00981 mm/ms².
    assert!((acceleration - Vector::new(0.0, -0.00981, 0.001)).norm() < 1e-15);
}

#[test]
fn the_former_name_of_a_force_is_read_and_not_both_names() {
    let text = r#"{"loads":[{"force_mn":[1,2,3],"nodes":{"node_set":"a"}}]}"#;
    let Load::Force { force, .. } = &plan(text).expect("ok").loads[0] else { panic!("a force") };
    assert_eq!(*force, Vector::new(1.0, 2.0, 3.0));
    let both = text.replace("\"nodes\"", "\"force_millinewton\":[1,2,3],\"nodes\"");
    assert!(serde_json::from_str::<PlanDocument>(&both).is_err());
}

#[test]
fn a_stated_and_an_unspecified_frame_are_in_conflict() {
    let stated = r#"{"frame":"LPS"}"#;
    let open = r#"{"frame":"unspecified"}"#;
    let wanted = one("frame-conflict", "frame-conflict", "/plan/frame");
    assert_eq!(refused(plan_in(Frame::Unspecified, stated)), wanted);
    assert_eq!(refused(plan_in(Frame::Lps, open)), wanted);
    for frame in [Frame::Unspecified, Frame::Ras] {
        assert!(plan_in(frame, "{}").is_ok(), "no frame means that of the case");
    }
}

#[test]
fn at_most_fifty_mistakes_are_listed_and_all_are_counted() {
    let segment = r#"{"name":"","translation_mm":[0,0,0]}"#;
    let text = format!(r#"{{"segments":[{}]}}"#, [segment; 60].join(","));
    let problem = plan(&text).expect_err("refused");
    assert_eq!(problem.errors.len(), 50);
    // Sixty names too short, fifty-nine of them repeated.
    assert!(problem.detail.starts_with("119 mistakes"), "{}", problem.detail);
}

#[test]
fn a_translation_in_metres_beside_a_rotation_is_told_and_usual_ones_are_not() {
    let doubts = |movement: &str| {
        let text = format!(r#"{{"segments":[{{"name":"jaw",{movement}}}]}}"#);
        let document: PlanDocument = serde_json::from_str(&text).unwrap();
        document.doubts()
    };
    let turned = r#""rotation_deg":[0,4,0],"pivot_mm":[10,20,30]"#;
    for told in [
        format!(r#""translation_mm":[0,0.005,0],{turned}"#),
        format!(r#""sequence":[{{{turned}}},{{"translation_mm":[0,0.005,0]}}]"#),
    ] {
        let found = doubts(&told);
        let [warning] = &found[..] else { panic!("{told}: {found:?}") };
        assert_eq!(warning.code, "plan-units-suspect");
        assert_eq!(warning.numbers[0], ("translation_mm", 0.005));
        assert!((warning.numbers[1].1 - 5.0).abs() < 1e-9, "{warning:?}");
        assert!(warning.detail.contains("segment `jaw`"), "{warning:?}");
    }
    for usual in [
        format!(r#""translation_mm":[0,0,0],{turned}"#),
        format!(r#""translation_mm":[0,0.5,0],{turned}"#),
        format!(r#""translation_mm":[0,0.05,0],{turned}"#),
        format!(r#""translation_mm":[0,1e-9,0],{turned}"#),
        turned.to_owned(),
        r#""translation_mm":[0,5,0]"#.to_owned(),
        // Computed: what is left of a registration.
        r#""matrix4x4":[1,0,0,0.01,0,0,-1,0,0,1,0,0,0,0,0,1]"#.to_owned(),
        format!(r#""sequence":[{{{turned}}},{{"translation_mm":[0,5,0]}}]"#),
    ] {
        assert_eq!(doubts(&usual), [], "{usual}");
    }
}
