//! Real faces, predicted by the program as people call it.

use crate::support::external::{Missing, shared_data, trials};
use crate::support::program::{facies, path, plan_folder, result, text};

trials! {
    real_faces_move_as_an_independent_code_says
}

/// A face of the shared data, its sets, and the movement of its jaw.
struct Face {
    mesh: &'static str,
    jaw: &'static str,
    fixed: &'static str,
    movement: &'static str,
}

const SUBJECT: Face = Face {
    mesh: "face/subject_face.vtu",
    jaw: "jaw_attached",
    fixed: "skull_fixed_orig",
    movement: "[-5,0,0]",
};

const TEMPLATE: Face = Face {
    mesh: "face/template_face.vtu",
    jaw: "mandible_fixed",
    fixed: "skull_nose_fixed",
    movement: "[0,5,0]",
};

/// The largest and the mean displacement of the skin in mm.
fn face_moves(face: &Face, element: &str) -> Result<[f64; 2], Missing> {
    let mesh = shared_data(face.mesh)?;
    let movement = face.movement;
    let jaw = face.jaw;
    let plan = format!(r#"{{"segments":[{{"name":"{jaw}","translation_mm":{movement}}}]}}"#);
    let folder = plan_folder(&plan);
    let (plan, out) = (folder.path().join("plan.json"), folder.path().join("out"));
    let files = ["predict", "--mesh", path(&mesh), "--plan", path(&plan), "--out", path(&out)];
    let sets = ["--fixed", face.fixed, "--skin", "outer_skin", "--element", element];
    let tissue = ["--method", "fem_linear", "--young-modulus-kpa", "15", "--poisson-ratio", "0.45"];
    let done = facies(&[&files[..], &sets[..], &tissue[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let skin = result(&out).statistics.unwrap().skin.nodes;
    Ok([skin.max, skin.mean])
}

fn real_faces_move_as_an_independent_code_says() -> Result<(), Missing> {
    let cases = [
        (SUBJECT, "mean_dilatation", 4.749, 1.743),
        (SUBJECT, "plain", 4.773, 1.750),
        (TEMPLATE, "mean_dilatation", 4.904, 1.843),
        (TEMPLATE, "plain", 4.930, 1.828),
    ];
    for (face, element, largest, mean) in cases {
        let [max, average] = face_moves(&face, element)?;
        let mesh = face.mesh;
        // Half a per cent: both codes solve the same equations, and the given numbers have four digits.
        assert!((max / largest - 1.0).abs() < 0.005, "{mesh}, {element}: largest {max}");
        assert!((average / mean - 1.0).abs() < 0.005, "{mesh}, {element}: mean {average}");
    }
    Ok(())
}
