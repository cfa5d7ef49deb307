//! Muscles of a real face along its published fibres: which way each moves the mouth, and how far for each kPa.

use std::collections::BTreeMap;

use mechanics::boundary::NodeSelection;
use mechanics::mesh::Vector;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Activation, Case, CaseSegment, Method, Muscle, MuscleCourse, Plan, Scene, Settings, predict,
};
use mechanics::progress::Unobserved;
use mechanics::response::{Amounts, ColumnRequest, ResponseOrder, build_of, inner_loads};

use crate::samples::{read_default, volume};
use crate::scenes::{case_of, material, set};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    muscles_of_the_subject_move_its_mouth_as_their_names_say
    muscles_of_the_template_move_its_mouth_as_their_names_say
    a_smile_and_a_closed_mouth_of_the_subject_before_and_after_its_jaw_is_brought_forward
    a_smile_and_a_closed_mouth_of_the_template_before_and_after_its_jaw_is_brought_forward
}

/// Polylines by muscle and side, each fibre one line.
pub fn fibres(face: &str) -> Result<BTreeMap<String, Vec<Vec<Vector>>>, Missing> {
    let path = shared_data(&format!("face/{face}_face_muscle_fibres.csv"))?;
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines: BTreeMap<(String, String), Vec<Vector>> = BTreeMap::new();
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |field: usize| fields[field].parse::<f64>().unwrap();
        let key = (format!("{}_{}", fields[0], fields[1]), fields[2].to_owned());
        lines.entry(key).or_default().push(Vector::new(number(4), number(5), number(6)));
    }
    let mut muscles: BTreeMap<String, Vec<Vec<Vector>>> = BTreeMap::new();
    for ((muscle, _), line) in lines {
        muscles.entry(muscle).or_default().push(line);
    }
    Ok(muscles)
}

/// A face, and which way it looks.
struct Face {
    case: Case,
    fibres: BTreeMap<String, Vec<Vec<Vector>>>,
    /// From the middle to the left side.
    left: Vector,
}

fn face(name: &str, jaw: &str, skull: &str, left: Vector) -> Result<Face, Missing> {
    let bytes = std::fs::read(shared_data(&format!("face/{name}_face.vtu"))?).unwrap();
    let fibres = fibres(name)?;
    let muscle = |(name, lines): (&String, &Vec<Vec<Vector>>)| Muscle {
        name: name.clone(),
        course: MuscleCourse::Lines { lines: lines.clone(), within: 6.0 },
        tissue: None,
        stiffening: None,
    };
    let case = Case {
        skin: Some(set("outer_skin")),
        segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set(jaw) }],
        fixed: vec![set(skull)],
        muscles: fibres.iter().map(muscle).collect(),
        ..case_of(volume(read_default(&bytes)), material(15.0, 0.49))
    };
    Ok(Face { case, fibres, left })
}

impl Face {
    /// The skin node nearest to a place.
    fn skin_at(&self, place: Vector) -> u32 {
        let NodeSelection::NodeSet(skin) = self.case.skin.clone().unwrap() else { panic!("a set") };
        let nodes = self.case.volume.node_set(&skin).unwrap();
        let far = |node: &u32| (self.case.volume.nodes[*node as usize] - place).norm();
        *nodes.iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
    }

    /// The corner of the mouth on the left, and the middle of both lips: ends of the fibres of the orbicularis oris.
    fn mouth(&self) -> [u32; 3] {
        let [upper, lower] = &self.fibres["OOM_left"][..] else { panic!("two fibres") };
        let ends = [upper[upper.len() - 1], upper[0], lower[lower.len() - 1]];
        ends.map(|place| self.skin_at(place))
    }

    /// The displacement of the skin in mm where both sides of a muscle pull with 1 kPa.
    fn pulled(&self, muscle: &str) -> Vec<Vector> {
        let both = ["left", "right"]
            .map(|side| Activation { muscle: format!("{muscle}_{side}"), stress: 1.0 });
        let plan = Plan { activations: both.to_vec(), ..Plan::default() };
        let scene = Scene::new(&self.case, &plan, &Settings::default()).unwrap();
        predict(&scene, &Unobserved).unwrap().displacement
    }

    /// The places of the mouth in mm at finite strain with a movement of the jaw and both sides of a muscle pulling.
    fn mouth_with(&self, forward: f64, pull: Option<(&str, f64)>) -> [Vector; 3] {
        let both = pull.into_iter().flat_map(|(muscle, stress)| {
            ["left", "right"].map(|side| Activation { muscle: format!("{muscle}_{side}"), stress })
        });
        let translation = self.left.cross(&Vector::z()) * forward;
        let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), translation);
        let plan = Plan {
            segments: vec![PlannedSegment { name: "jaw".to_owned(), movement }],
            activations: both.collect(),
            ..Plan::default()
        };
        let settings =
            Settings { method: Method::FemNonlinear, estimate: false, ..Settings::default() };
        let scene = Scene::new(&self.case, &plan, &settings).unwrap();
        let u = predict(&scene, &Unobserved).unwrap().displacement;
        self.mouth().map(|node| self.case.volume.nodes[node as usize] + u[node as usize])
    }

    /// A smile of 50 kPa and lips closed with 20 kPa, before the jaw is brought 8 mm forward and after it: the corner of the
    /// mouth by its smile, and the gap between the middles of the lips, at finite strain.
    fn smiles_before_and_after(&self) {
        let up = Vector::z();
        let gap = |[_, upper, lower]: [Vector; 3]| (upper - lower).dot(&up);
        let mut moved = Vec::new();
        for forward in [0.0, 8.0] {
            let still = self.mouth_with(forward, None);
            let smile = self.mouth_with(forward, Some(("ZYG", 50.0)))[0] - still[0];
            let closed = self.mouth_with(forward, Some(("OOM", 20.0)));
            let (outward, upward) = (smile.dot(&self.left), smile.dot(&up));
            let angle = upward.atan2(outward).to_degrees();
            println!(
                "jaw {forward} mm forward: smile {:.2} mm, {outward:.2} out, {upward:.2} up, {angle:.0} degrees above the \
                 horizontal; lips {:.2} mm apart, {:.2} with the orbicularis",
                smile.norm(),
                gap(still),
                gap(closed)
            );
            assert!(outward > 0.0 && upward > 0.0, "{forward}: {smile}");
            assert!(gap(closed) < gap(still), "{forward}: {} {}", gap(closed), gap(still));
            moved.push(smile);
        }
        // The plan turns and stiffens what the muscle pulls: small strain says that nothing changes.
        let change = (moved[1] - moved[0]).norm();
        assert!(change > 1e-3 && change < 0.5 * moved[0].norm(), "{change} mm");
    }

    fn moves_as_named(&self) {
        let [corner, upper, lower] = self.mouth().map(|node| node as usize);
        let up = Vector::z();
        let mut moved: BTreeMap<&str, [f64; 3]> = BTreeMap::new();
        for muscle in ["ZYG", "DAO", "RIS", "LAO", "DLI", "OOM", "OOP"] {
            let u = self.pulled(muscle);
            let (outward, upward) = (u[corner].dot(&self.left), u[corner].dot(&up));
            let closing = (u[lower] - u[upper]).dot(&up);
            println!(
                "{muscle:4} um for each kPa: corner out {:.2}, up {:.2}, lips closer {:.2}, most {:.2}",
                1e3 * outward,
                1e3 * upward,
                1e3 * closing,
                1e3 * u.iter().map(|u| u.norm()).fold(0.0, f64::max)
            );
            moved.insert(muscle, [outward, upward, closing]);
        }
        let [outward, upward, _] = moved["ZYG"];
        assert!(outward > 0.0 && upward > 0.0, "zygomaticus: out {outward}, up {upward}");
        let [_, upward, _] = moved["DAO"];
        assert!(upward < 0.0, "depressor anguli oris: up {upward}");
        let [outward, _, _] = moved["RIS"];
        assert!(outward > 0.0, "risorius: out {outward}");
        let [_, upward, _] = moved["LAO"];
        assert!(upward > 0.0, "levator anguli oris: up {upward}");
        let [outward, _, closing] = moved["OOM"];
        assert!(closing > 0.0 && outward < 0.0, "orbicularis: closer {closing}, out {outward}");
        let [_, _, closing] = moved["DLI"];
        assert!(closing < 0.0, "depressor labii inferioris: closer {closing}");
        self.response_smiles();
    }

    /// A smile as a sum of columns is the smile of the full solution.
    fn response_smiles(&self) {
        let rest = Scene::new(&self.case, &Plan::default(), &Settings::default()).unwrap();
        let names = ["ZYG_left", "ZYG_right"].map(str::to_owned);
        let inner = inner_loads(&rest, &[], &names).unwrap();
        let asked = ColumnRequest { segments: &[], order: ResponseOrder::First, inner: &inner };
        let columns = build_of(&rest, &asked, &Unobserved).unwrap().to_response();
        let still = [mechanics::plan::RigidMovement::default()];
        let smile = columns.apply_all(&Amounts { movements: &still, inner: &[1.0, 1.0] });
        let direct = self.pulled("ZYG");
        for (&node, sum) in columns.nodes.iter().zip(&smile) {
            assert!((direct[node as usize] - sum).norm() < 1e-6);
        }
    }
}

fn muscles_of_the_subject_move_its_mouth_as_their_names_say() -> Result<(), Missing> {
    face("subject", "jaw_attached", "skull_fixed_orig", -Vector::y())?.moves_as_named();
    Ok(())
}

fn muscles_of_the_template_move_its_mouth_as_their_names_say() -> Result<(), Missing> {
    face("template", "mandible_fixed", "skull_nose_fixed", -Vector::x())?.moves_as_named();
    Ok(())
}

fn a_smile_and_a_closed_mouth_of_the_subject_before_and_after_its_jaw_is_brought_forward()
-> Result<(), Missing> {
    face("subject", "jaw_attached", "skull_fixed_orig", -Vector::y())?.smiles_before_and_after();
    Ok(())
}

fn a_smile_and_a_closed_mouth_of_the_template_before_and_after_its_jaw_is_brought_forward()
-> Result<(), Missing> {
    face("template", "mandible_fixed", "skull_nose_fixed", -Vector::x())?.smiles_before_and_after();
    Ok(())
}
