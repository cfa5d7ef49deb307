//! Lips of real faces that meet when their jaw is raised.

use std::time::Instant;

use mechanics::mesh::Vector;
use mechanics::mesh::crossing::{cross, self_crossings};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Case, CaseSegment, ContactKind, Plan, Scene, Settings, predict};
use mechanics::progress::Unobserved;

use crate::samples::{read_default, volume};
use crate::scenes::{case_of, material, set};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    lips_of_real_faces_do_not_pass_through_each_other_when_the_jaw_is_raised
}

/// The subject and the template, with jaw and skull.
fn faces() -> Result<[Case; 2], Missing> {
    let face = |file: &str, jaw: &str, skull: &str| -> Result<Case, Missing> {
        let bytes = std::fs::read(shared_data(file)?).unwrap();
        let segments = vec![CaseSegment { name: "jaw".to_owned(), nodes: set(jaw) }];
        Ok(Case {
            segments,
            fixed: vec![set(skull)],
            ..case_of(volume(read_default(&bytes)), material(15.0, 0.45))
        })
    };
    let subject = face("face/subject_face.vtu", "jaw_attached", "skull_fixed_orig")?;
    let subject = Case { skin: Some(set("outer_skin")), ..subject };
    Ok([subject, face("face/template_face.vtu", "mandible_fixed", "skull_nose_fixed")?])
}

fn raised(by: f64) -> Plan {
    let up = Vector::new(0.0, 0.0, by);
    let movement = RigidMovement::about_pivot(Vector::zeros(), Vector::zeros(), up);
    let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
    Plan { segments, ..Plan::default() }
}

pub fn lips_of_real_faces_do_not_pass_through_each_other_when_the_jaw_is_raised()
-> Result<(), Missing> {
    for (name, case) in ["subject", "template"].into_iter().zip(faces()?) {
        for by in [4.0, 8.0, 15.0] {
            let mut took = Vec::new();
            for contact in [ContactKind::None, ContactKind::Unilateral] {
                let settings = Settings { contact, estimate: false, ..Settings::default() };
                let scene = Scene::new(&case, &raised(by), &settings).unwrap();
                let begun = Instant::now();
                let found = match predict(&scene, &Unobserved) {
                    Ok(found) => found,
                    Err(error) => {
                        println!("   {name} {by}: {error}");
                        continue;
                    }
                };
                took.push(begun.elapsed());
                let moved = scene.skin.moved(&found.displacement);
                let new = self_crossings(&moved, |pair| !cross(&scene.skin.surface, pair)).count;
                println!("{name} {by} {contact:?}: {new} new pairs");
                if let Some(touch) = &found.contact {
                    println!(
                        "   passes {} changes {} rounds {} last {:.1e} iterations {} pressed {} kept {} penetration {:.2e} area {:.1} pressure {:.2} negative {:.2e}",
                        touch.contact.passes,
                        touch.contact.changes,
                        touch.contact.rounds,
                        touch.contact.last_moved_mm,
                        touch.contact.iterations,
                        touch.contact.pressed.len(),
                        touch.contact.kept,
                        touch.largest_penetration(),
                        touch.area(),
                        touch.largest_pressure(),
                        touch.contact.pressed.iter().map(|p| p.force).fold(f64::INFINITY, f64::min),
                    );
                    for pair in &touch.pairs {
                        println!("   {pair:?}");
                    }
                }
                for warning in found
                    .warnings
                    .iter()
                    .filter(|w| w.code.contains("contact") || w.code.contains("overlap"))
                {
                    println!("   {}: {}", warning.code, warning.detail);
                }
            }
            println!("   took {took:?}");
        }
    }
    Ok(())
}
