//! The template face brought to the subject, of which every node is known.

use mechanics::conformation::{Landmark, Patient, Start, Template, carried, conform};
use mechanics::mesh::{SurfaceSearch, Vector, VolumeMesh};
use mechanics::muscle::lines::nearest;
use mechanics::progress::Unobserved;
use mechanics::repair::{Bounds, repair};

use super::muscle_mapping::{face, farthest, surface};
use super::muscles::fibres;
use crate::support::external::{Missing, trials};

trials! {
    landmarks_and_both_sheets_bring_a_template_to_a_subject
    surfaces_alone_bring_the_skin_of_a_template_to_that_of_a_subject
}

/// The nodes of a set within some mm of the orbicularis oris.
fn near_mouth(
    name: &str,
    mesh: &VolumeMesh,
    set: &[u32],
    within: f64,
) -> Result<Vec<u32>, Missing> {
    let fibres = fibres(name)?;
    let mouth = fibres.iter().filter(|(name, _)| name.starts_with("OOM"));
    let mouth: Vec<Vec<Vector>> = mouth.flat_map(|(_, lines)| lines.clone()).collect();
    let near = |node: &u32| nearest(&mesh.nodes[*node as usize], &mouth).unwrap().0 <= within;
    Ok(set.iter().copied().filter(near).collect())
}

fn mean(distances: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = distances.len() as f64;
    distances.sum::<f64>() / count
}

fn landmarks_and_both_sheets_bring_a_template_to_a_subject() -> Result<(), Missing> {
    let (template, subject) = (face("template")?, face("subject")?);
    let [skin, inner] = ["outer_skin", "inner"].map(|set| subject.node_set(set).unwrap());
    // 20 landmarks of lips, up to 48 on the skin, and 24 on the inner sheet, of which 8 behind the lips.
    let lips = near_mouth("template", &template, skin, 8.0)?;
    let behind = near_mouth("template", &template, inner, 12.0)?;
    let mut chosen = farthest(&template, skin, farthest(&template, &lips, Vec::new(), 20), 48);
    chosen.extend(farthest(&template, inner, farthest(&template, &behind, Vec::new(), 8), 24));
    let landmark = |node: u32| Landmark {
        name: format!("node {node}"),
        template: template.nodes[node as usize],
        patient: subject.nodes[node as usize],
    };
    let landmarks: Vec<Landmark> = chosen.into_iter().map(landmark).collect();
    let [skin_surface, inner_surface] = [skin, inner].map(|nodes| surface(&subject, nodes));
    let patient =
        Patient { skin: Some(&skin_surface), bone: Some(&inner_surface), landmarks: &landmarks };
    let of_template = Template { mesh: &template, skin, bone: inner };
    let found = conform(&of_template, &patient, Start::Auto, &Unobserved).unwrap();
    let mut moved = carried(&template, &found.deformation);
    let bounds = Bounds::of(&moved, 1.0, 3.0).along(&moved, &[skin, inner]);
    let report = repair(&mut moved, &bounds, &Unobserved);

    let off = |nodes: &[u32]| {
        let apart =
            |node: &u32| (moved.nodes[*node as usize] - subject.nodes[*node as usize]).norm();
        mean(nodes.iter().map(apart))
    };
    let search = SurfaceSearch::new(&skin_surface).unwrap();
    let squared = |node: &u32| search.closest(&moved.nodes[*node as usize]).distance.powi(2);
    let rms = mean(skin.iter().map(squared)).sqrt();
    let lips = off(&near_mouth("subject", &subject, skin, 8.0)?);
    let (skin, inner) = (off(skin), off(inner));
    println!(
        "skin {skin:.2}, lips {lips:.2}, inner {inner:.2} mm off their nodes, {rms:.2} mm rms off the skin, {} of {} cells unproven",
        report.unproven.len(),
        report.unproven_before
    );
    assert!(skin < 1.5 && lips < 1.0 && inner < 2.5 && rms < 0.3);
    assert_eq!(report.unproven, []);
    Ok(())
}

fn surfaces_alone_bring_the_skin_of_a_template_to_that_of_a_subject() -> Result<(), Missing> {
    let (template, subject) = (face("template")?, face("subject")?);
    let [skin, inner] = ["outer_skin", "inner"].map(|set| subject.node_set(set).unwrap());
    let [skin_surface, inner_surface] = [skin, inner].map(|nodes| surface(&subject, nodes));
    let patient = Patient { skin: Some(&skin_surface), bone: Some(&inner_surface), landmarks: &[] };
    let of_template = Template { mesh: &template, skin, bone: inner };
    let found = conform(&of_template, &patient, Start::Auto, &Unobserved).unwrap();
    let rms = mean(found.skin_distances.iter().map(|distance| distance.powi(2))).sqrt();
    println!("{rms:.2} mm rms off the skin");
    assert!(rms < 0.3);
    Ok(())
}
