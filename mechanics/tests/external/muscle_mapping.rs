//! Muscles of the template face mapped to the subject, of which every node is known: the axis of a cell against that which the
//! map of its own nodes gives.

use std::collections::BTreeMap;

use mechanics::conformation::{
    Landmark, Patient, Start, Template, Warp, angle_between, conform, spline_of,
};
use mechanics::mesh::{CellShape, TriangleSurface, Vector, VolumeMesh};
use mechanics::muscle::lines::{CellFibre, MuscleLines, fibre_cells, nearest};
use mechanics::progress::Unobserved;
use nalgebra::Matrix3;

use super::muscles::fibres;
use crate::samples::{read_default, volume};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    muscles_of_the_template_lie_on_the_subject_along_the_fibres_of_its_cells
    cells_near_the_fibres_of_the_subject_are_those_that_were_counted
    lengths_of_the_left_fibres_of_the_subject_are_those_that_were_measured
}

/// From lines within which a cell belongs to a muscle, in mm.
const NEAR: f64 = 6.0;

pub(super) fn face(name: &str) -> Result<VolumeMesh, Missing> {
    let bytes = std::fs::read(shared_data(&format!("face/{name}_face.vtu"))?).unwrap();
    Ok(volume(read_default(&bytes)))
}

pub(super) fn surface(mesh: &VolumeMesh, nodes: &[u32]) -> TriangleSurface {
    let on = |node: &u32| nodes.binary_search(node).is_ok();
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|face| face.nodes().iter().all(on)).collect();
    mesh.surface_of(&faces)
}

fn middle(mesh: &VolumeMesh, cell: usize) -> Vector {
    let corners: Vec<Vector> = mesh.corners(cell).collect();
    corners.iter().sum::<Vector>() / corners.len() as f64
}

/// The muscles of both sides, and the name of each without its side.
fn lines_of(fibres: &BTreeMap<String, Vec<Vec<Vector>>>) -> (Vec<MuscleLines>, Vec<&str>) {
    let muscle = |(name, lines): (&String, &Vec<Vec<Vector>>)| MuscleLines {
        name: name.clone(),
        lines: lines.clone(),
    };
    let names = fibres.keys().map(|name| name.split('_').next().unwrap());
    (fibres.iter().map(muscle).collect(), names.collect())
}

/// Each muscle with the lines of both sides.
fn without_sides(fibres: &BTreeMap<String, Vec<Vec<Vector>>>) -> Vec<MuscleLines> {
    let mut muscles: BTreeMap<&str, Vec<Vec<Vector>>> = BTreeMap::new();
    for (name, lines) in fibres {
        let muscle = name.split('_').next().unwrap();
        muscles.entry(muscle).or_default().extend(lines.clone());
    }
    let muscle =
        |(name, lines): (&str, Vec<Vec<Vector>>)| MuscleLines { name: name.to_owned(), lines };
    muscles.into_iter().map(muscle).collect()
}

fn near_lines(mesh: &VolumeMesh, muscles: &[MuscleLines]) -> Vec<CellFibre> {
    fibre_cells(mesh, muscles, &vec![NEAR; muscles.len()])
}

fn cells_near_the_fibres_of_the_subject_are_those_that_were_counted() -> Result<(), Missing> {
    let (mesh, fibres) = (face("subject")?, fibres("subject")?);
    let (muscles, names) = lines_of(&fibres);
    let near = near_lines(&mesh, &muscles);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    near.iter().for_each(|own| *counts.entry(names[own.muscle]).or_default() += 1);
    assert_eq!(near.len(), 1440);
    #[rustfmt::skip]
    let known = [
        ("BUC", 10), ("DAO", 54), ("DLI", 58), ("LAO", 68), ("LLS", 66), ("LLSAN", 120),
        ("MENT", 70), ("OOM", 636), ("OOP", 162), ("RIS", 150), ("ZYG", 46),
    ];
    assert_eq!(counts, BTreeMap::from(known));
    // Cells from 1, the distance in mm and the axis, whose sign is free.
    for (element, muscle, distance, axis) in [
        (555, "ZYG", 1.1789, [0.04770, -0.27399, 0.96055]),
        (1111, "DAO", 0.6168, [-0.02219, -0.31792, 0.94786]),
        (3898, "RIS", 0.2634, [0.89200, 0.38563, 0.23584]),
        (610, "OOM", 0.3099, [-0.68115, 0.68889, -0.24791]),
    ] {
        let own = near.iter().find(|own| own.cell == element - 1).unwrap();
        let name = names[own.muscle];
        assert!(name == muscle && (own.distance - distance).abs() < 1e-4, "{element}: {own:?}");
        assert!(angle_between(&own.axis, &axis.into()) < 0.01, "{element}: {own:?}");
    }
    // Where muscles lie together, both sides of one as one muscle.
    let both = near_lines(&mesh, &without_sides(&fibres));
    let several = [2, 3].map(|least| both.iter().filter(|own| own.muscles >= least).count());
    assert_eq!((both.len(), several), (1440, [364, 60]));
    Ok(())
}

fn lengths_of_the_left_fibres_of_the_subject_are_those_that_were_measured() -> Result<(), Missing> {
    let fibres = fibres("subject")?;
    let length = |line: &Vec<Vector>| line.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    for (muscle, known) in [
        ("ZYG", vec![55.694]),
        ("RIS", vec![52.975]),
        ("LAO", vec![34.903]),
        ("LLS", vec![35.147]),
        ("BUC", vec![43.224, 30.793]),
    ] {
        let found: Vec<f64> = fibres[&format!("{muscle}_left")].iter().map(length).collect();
        assert_eq!(found.len(), known.len(), "{muscle}: {found:?}");
        for (found, known) in found.iter().zip(&known) {
            assert!((found - known).abs() < 6e-4, "{muscle}: {found} mm, known {known}");
        }
    }
    Ok(())
}

/// F of a hexahedron in its middle, from its places on the template and on the subject.
fn known_gradient(template: &VolumeMesh, moved: &VolumeMesh, cell: usize) -> Matrix3<f64> {
    let signs = |corner: usize| {
        let [x, y, z] = [[1, 2, 5, 6], [2, 3, 6, 7], [4, 5, 6, 7]].map(|up| up.contains(&corner));
        Vector::new(sign(x), sign(y), sign(z))
    };
    let slope = |mesh: &VolumeMesh| -> Matrix3<f64> {
        mesh.corners(cell).enumerate().map(|(corner, x)| x * signs(corner).transpose()).sum()
    };
    slope(moved) * slope(template).try_inverse().unwrap()
}

fn sign(is_up: bool) -> f64 {
    if is_up { 1.0 } else { -1.0 }
}

/// Landmarks one by one, each the farthest from those before.
pub(super) fn farthest(
    mesh: &VolumeMesh,
    nodes: &[u32],
    mut chosen: Vec<u32>,
    count: usize,
) -> Vec<u32> {
    let place = |node: u32| mesh.nodes[node as usize];
    let middle = nodes.iter().map(|&node| place(node)).sum::<Vector>() / nodes.len() as f64;
    while chosen.len() < count {
        let apart = |node: u32| match chosen.is_empty() {
            true => -(place(node) - middle).norm(),
            false => {
                let distances = chosen.iter().map(|&other| (place(node) - place(other)).norm());
                distances.fold(f64::INFINITY, f64::min)
            }
        };
        chosen.extend(nodes.iter().copied().max_by(|a, b| apart(*a).total_cmp(&apart(*b))));
    }
    chosen
}

/// 8 landmarks near the mouth, and 24 on all skin.
fn landmarks(
    template: &VolumeMesh,
    subject: &VolumeMesh,
    fibres: &BTreeMap<String, Vec<Vec<Vector>>>,
) -> Vec<Landmark> {
    let skin = subject.node_set("outer_skin").unwrap();
    let mouth = fibres.iter().filter(|(name, _)| name.starts_with("OOM"));
    let mouth: Vec<Vec<Vector>> = mouth.flat_map(|(_, lines)| lines.clone()).collect();
    let near = |node: &u32| nearest(&template.nodes[*node as usize], &mouth).unwrap().0 <= 8.0;
    let lips: Vec<u32> = skin.iter().copied().filter(near).collect();
    let chosen = farthest(template, skin, farthest(template, &lips, Vec::new(), 8), 32);
    let pair = |node: u32| Landmark {
        name: format!("node {node}"),
        template: template.nodes[node as usize],
        patient: subject.nodes[node as usize],
    };
    chosen.into_iter().map(pair).collect()
}

/// By muscle: cells, mean angle in degrees, mean distance of the middles of cells in mm.
type Table = BTreeMap<String, (usize, f64, f64)>;

struct Known {
    template: VolumeMesh,
    /// The cells of the template with the places of their nodes on the subject, whose own cells name them in another order.
    moved: VolumeMesh,
    fibres: BTreeMap<String, Vec<Vec<Vector>>>,
}

impl Known {
    fn table(&self, map: &dyn Warp) -> Table {
        let mut table = Table::new();
        let (muscles, names) = lines_of(&self.fibres);
        for CellFibre { cell, muscle, axis, .. } in near_lines(&self.template, &muscles) {
            let cell = cell as usize;
            if self.template.cells.shape(cell) != CellShape::Hex8 {
                continue;
            }
            let known = known_gradient(&self.template, &self.moved, cell) * axis;
            let place = middle(&self.template, cell);
            let angle = angle_between(&map.along(&place, &axis).unwrap(), &known);
            let apart = (map.apply(&place) - middle(&self.moved, cell)).norm();
            for key in ["all", names[muscle]] {
                let row = table.entry(key.to_owned()).or_default();
                let before = row.0 as f64;
                *row = (
                    row.0 + 1,
                    (row.1 * before + angle) / (before + 1.0),
                    (row.2 * before + apart) / (before + 1.0),
                );
            }
        }
        table
    }
}

fn muscles_of_the_template_lie_on_the_subject_along_the_fibres_of_its_cells() -> Result<(), Missing>
{
    let (template, subject) = (face("template")?, face("subject")?);
    let moved = VolumeMesh { nodes: subject.nodes.clone(), ..template.clone() };
    let known = Known { template, moved, fibres: fibres("template")? };
    let (template, subject) = (&known.template, &subject);
    let skin = subject.node_set("outer_skin").unwrap();
    let sets = ["jaw_attached", "skull_fixed_orig"].map(|set| subject.node_set(set).unwrap());
    let mut bone = sets.concat();
    bone.sort_unstable();
    bone.dedup();
    let [skin_surface, bone_surface] = [skin, &bone].map(|nodes| surface(subject, nodes));
    let landmarks = landmarks(template, subject, &known.fibres);
    let patient =
        Patient { skin: Some(&skin_surface), bone: Some(&bone_surface), landmarks: &landmarks };
    let of_template = Template { mesh: template, skin, bone: &bone };
    let found = conform(&of_template, &patient, Start::Auto, &Unobserved).unwrap();
    let spline = spline_of(&landmarks).unwrap();
    let (conformed, splined) = (known.table(&found.deformation), known.table(&spline));
    for (name, (cells, degrees, apart)) in &conformed {
        let (_, by_landmarks, farther) = splined[name];
        println!(
            "{name:<6} {cells:>5} cells: conformation {degrees:5.1} degrees {apart:5.2} mm, 32 landmarks {by_landmarks:5.1} degrees {farther:5.2} mm"
        );
    }
    let ((_, degrees, apart), (_, by_landmarks, farther)) = (conformed["all"], splined["all"]);
    assert!(degrees < 13.0 && apart < 2.5, "{degrees} degrees, {apart} mm");
    assert!(degrees < by_landmarks && apart < farther, "{by_landmarks} degrees, {farther} mm");
    Ok(())
}
