use super::*;

/// Dihedral angles in degrees: between the faces that meet at each edge.
fn dihedral_angles(corners: [Vector; 4]) -> [f64; 6] {
    [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]].map(
        |[a, b, c, d]| {
            let edge = (corners[b] - corners[a]).normalize();
            let [p, q] = [c, d].map(|other| {
                let side = corners[other] - corners[a];
                side - edge * edge.dot(&side)
            });
            p.angle(&q).to_degrees()
        },
    )
}

fn corners_of(mesh: &VolumeMesh, cell: usize) -> [Vector; 4] {
    let nodes = mesh.cells.nodes(cell);
    [0, 1, 2, 3].map(|local| mesh.nodes[nodes[local] as usize])
}

#[test]
fn the_demo_has_about_sixty_thousand_sound_tetrahedra() {
    let mesh = half_head(STANDARD_FINENESS).mesh;
    assert_eq!(mesh.cells.len(), 62_208);
    for cell in 0..mesh.cells.len() {
        let corners = corners_of(&mesh, cell);
        let [a, b, c] = [1, 2, 3].map(|corner| corners[corner] - corners[0]);
        assert!(a.cross(&b).dot(&c) > 0.0, "cell {cell}");
        let angles = dihedral_angles(corners);
        // The worst is 5.1 degrees, below the lips, where 2 mm of skin meet cells of 8 mm.
        assert!(angles.iter().all(|&angle| angle > 4.5 && angle < 170.0), "{angles:?}");
    }
}

#[test]
fn the_tissue_is_as_thick_as_faces_are() {
    let mesh = half_head(STANDARD_FINENESS).mesh;
    let sheet = mesh.nodes.len() / 5;
    let thickness: Vec<f64> = (0..sheet)
        .map(|point| (mesh.nodes[point + 4 * sheet] - mesh.nodes[point]).norm())
        .collect();
    let least = thickness.iter().copied().fold(f64::INFINITY, f64::min);
    let most = thickness.iter().copied().fold(0.0, f64::max);
    assert!(least > 5.5 && most < 17.5 && most > 2.0 * least, "{least} to {most} mm");
}

#[test]
fn the_half_head_mirrors_in_the_middle_of_the_face() {
    let mesh = half_head(2).mesh;
    let bits = |p: &Vector| [p.x + 0.0, p.y, p.z].map(f64::to_bits);
    let node_at: BTreeMap<_, u32> = (0u32..).zip(&mesh.nodes).map(|(n, p)| (bits(p), n)).collect();
    let mirrored = |node: u32| {
        let p = mesh.nodes[node as usize];
        node_at[&bits(&Vector::new(-p.x, p.y, p.z))]
    };
    let sorted = |nodes: &mut [u32]| nodes.sort_unstable();
    let mut cells: Vec<Vec<u32>> = mesh.cells.iter().map(|(_, nodes)| nodes.to_vec()).collect();
    let mut images = cells.clone();
    for image in images.iter_mut().flatten() {
        *image = mirrored(*image);
    }
    for list in [&mut cells, &mut images] {
        list.iter_mut().for_each(|nodes| sorted(nodes));
        list.sort_unstable();
    }
    assert_eq!(cells, images);
    for set in mesh.node_sets.values() {
        let mut image: Vec<u32> = set.iter().map(|&node| mirrored(node)).collect();
        sorted(&mut image);
        assert_eq!(&image, set);
    }
}

#[test]
fn bones_are_apart_and_far_enough_not_to_tear() {
    let mesh = half_head(STANDARD_FINENESS).mesh;
    let position = |node: &u32| mesh.nodes[*node as usize];
    let names = ["maxilla", "mandible", "skull", "rim"];
    for (first, name) in names.iter().enumerate() {
        for other in &names[first + 1..] {
            let [a, b] = [&mesh.node_sets[*name], &mesh.node_sets[*other]];
            let gap = a
                .iter()
                .flat_map(|p| b.iter().map(move |q| (position(p) - position(q)).norm()))
                .fold(f64::INFINITY, f64::min);
            // The jaws part by 10 mm in the demo; the skull ends at the rim.
            let least = match (*name, *other) {
                ("maxilla", "mandible") => 18.0,
                ("skull", "rim") => 0.0,
                _ => 8.0,
            };
            assert!(gap > least, "{name} and {other}: {gap} mm");
        }
    }
}

#[test]
fn bone_surfaces_look_at_the_tissue() {
    let head = half_head(2);
    assert_eq!(head.bones.keys().copied().collect::<Vec<_>>(), ["mandible", "maxilla", "skull"]);
    for (name, bone) in &head.bones {
        let nodes = bone.node_ids.as_ref().unwrap();
        assert!(nodes.iter().all(|node| head.mesh.node_sets[*name].contains(node)));
        let sum: Vector = (0..bone.triangles.len()).map(|t| bone.area_vector(t)).sum();
        assert!(sum.y < -0.5 * sum.norm() && bone.area() > 100.0, "{name}: {sum:?}");
    }
}

#[test]
fn landmarks_follow_each_other_down_the_profile() {
    let head = half_head(STANDARD_FINENESS);
    let order = [
        "glabella",
        "nasion",
        "pronasale",
        "subnasale",
        "labrale_superius",
        "stomion",
        "labrale_inferius",
        "sulcus_mentolabialis",
        "pogonion",
        "menton",
    ];
    let heights = order.map(|name| head.landmarks[name].z);
    assert!(heights.is_sorted_by(|a, b| a > b), "{heights:?}");
    let most_forward = head.mesh.nodes.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    assert_eq!(head.landmarks["pronasale"].y, most_forward);
    let on_skin =
        |p: &Vector| head.mesh.node_sets["skin"].iter().any(|&n| head.mesh.nodes[n as usize] == *p);
    assert!(head.landmarks.values().all(on_skin));
}

#[test]
fn parts_of_the_skin_hold_their_landmarks() {
    let HalfHead { mesh, landmarks, .. } = half_head(STANDARD_FINENESS);
    for (part, landmark) in [("nose", "pronasale"), ("lips", "stomion"), ("chin", "pogonion")] {
        let set = &mesh.node_sets[part];
        assert!(set.iter().any(|&node| mesh.nodes[node as usize] == landmarks[landmark]));
        assert!(set.iter().all(|node| mesh.node_sets["skin"].contains(node)));
    }
}

#[test]
fn every_layer_has_cells_and_muscle_is_a_band() {
    let mesh = half_head(2).mesh;
    let labels = &mesh.cell_labels["layer"];
    assert_eq!(labels.len(), mesh.cells.len());
    for label in 0..LAYERS.len() as i64 {
        assert!(labels.contains(&label));
    }
    for (cell, &label) in labels.iter().enumerate() {
        let middle = corners_of(&mesh, cell).iter().sum::<Vector>() / 4.0;
        assert!(label != 1 || (-75.0..0.0).contains(&middle.z), "muscle at {middle:?}");
    }
}
