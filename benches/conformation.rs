//! Template and subject of the shared face data, node by node, and repairs of noisy blocks, as tables of
//! docs/conformation.md: `cargo bench --bench conformation`.

use std::time::Instant;

use mechanics::conformation::{Landmark, Patient, Start, Template, carried, conform};
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::mesh::quality::quality;
use mechanics::mesh::{SurfaceSearch, TriangleSurface, Vector, VolumeMesh};
use mechanics::progress::Unobserved;
use mechanics::registration::ThinPlateSpline;
use mechanics::repair::corner_rule::repair_by_corners;
use mechanics::repair::noisy::noisy_block;
use mechanics::repair::{Bounds, repair};

fn main() {
    for noise in [0.35, 0.45] {
        blocks(noise);
    }
    match Faces::read() {
        Some(faces) => faces.tables(),
        None => println!("../shared/data/face is not there"),
    }
}

/// A hundred noisy blocks, repaired with proof and by corners alone.
fn blocks(noise: f64) {
    let (mut unproven, mut named, mut whole, mut slowest) = (0, 0, 0, 0.0_f64);
    let (mut ended, mut wrong_runs, mut wrong_cells) = (0, 0, 0);
    for seed in 0..100 {
        let mesh = noisy_block(noise, seed);
        let bounds = Bounds::of(&mesh, 1.0, 3.0);
        let mut mended = mesh.clone();
        let start = Instant::now();
        let report = repair(&mut mended, &bounds, &Unobserved);
        slowest = slowest.max(start.elapsed().as_secs_f64());
        unproven += report.unproven_before;
        named += report.unproven.len();
        whole += usize::from(report.unproven.is_empty());
        let mut by_corners = mesh;
        if repair_by_corners(&mut by_corners, &bounds).is_some() {
            ended += 1;
            let inverted = quality(&by_corners).inverted;
            wrong_runs += usize::from(inverted > 0);
            wrong_cells += inverted;
        }
    }
    println!(
        "noise {noise}: {} of 200 cells unproven; proof: {whole} of 100 blocks whole, {named} cells named, {slowest:.2} s \
         at most; corners: {ended} of 100 end, {wrong_cells} cells in {wrong_runs} of them inverted",
        unproven / 100
    );
}

struct Faces {
    template: VolumeMesh,
    subject: VolumeMesh,
    skin: Vec<u32>,
    inner: Vec<u32>,
    /// On bone of the subject, by the identity of nodes of the template too.
    bone: Vec<u32>,
    skin_surface: TriangleSurface,
    bone_surface: TriangleSurface,
    /// Nodes of the skin within 8 mm of the orbicularis oris: of the subject to measure, of the template to choose from.
    lips: [Vec<u32>; 2],
}

fn file(name: &str) -> Option<Vec<u8>> {
    std::fs::read(format!("{}/../../shared/data/face/{name}", env!("CARGO_MANIFEST_DIR"))).ok()
}

fn volume(name: &str) -> Option<VolumeMesh> {
    match read(&file(name)?, &ReadLimits::default()).ok()?.mesh {
        Mesh::Volume(mesh) => Some(mesh),
        Mesh::Surface(_) | Mesh::Image(_) => None,
    }
}

impl Faces {
    fn read() -> Option<Faces> {
        let [template, subject] = [volume("template_face.vtu")?, volume("subject_face.vtu")?];
        let set = |name: &str| subject.node_set(name).map(<[u32]>::to_vec);
        let (skin, inner) = (set("outer_skin")?, set("inner")?);
        let mut bone = set("jaw_attached")?;
        bone.extend(set("skull_fixed_orig")?);
        bone.sort_unstable();
        bone.dedup();
        let lips = [("subject", &subject), ("template", &template)]
            .map(|(name, mesh)| near_mouth(name, mesh, &skin).unwrap_or_default());
        let [skin_surface, bone_surface] = [&skin, &bone].map(|nodes| surface(&subject, nodes));
        Some(Faces { template, subject, skin, inner, bone, skin_surface, bone_surface, lips })
    }

    fn tables(&self) {
        let lips = farthest(&self.template, &self.lips[1], Vec::new(), 8);
        let landmarks = farthest(&self.template, &self.skin, lips, 32);
        let spread = farthest(&self.template, &self.skin, Vec::new(), 32);
        let mut with_bone = landmarks.clone();
        with_bone.extend(farthest(&self.template, &self.bone, Vec::new(), 16));
        for (name, nodes) in [("32 spread", &spread), ("8 lips + 24", &landmarks)] {
            self.by_spline(name, &self.landmarks(nodes));
        }
        let none = Vec::new();
        self.row("surfaces alone", &none, true, true);
        self.row("landmarks alone", &landmarks, false, false);
        self.row("skin, 32 spread", &spread, true, false);
        self.row("skin, 8 lips + 24", &landmarks, true, false);
        self.row("and bone", &landmarks, true, true);
        self.row("and 16 on bone", &with_bone, true, true);
    }

    fn landmarks(&self, nodes: &[u32]) -> Vec<Landmark> {
        let pair = |&node: &u32| Landmark {
            name: format!("node {node}"),
            template: self.template.nodes[node as usize],
            patient: self.subject.nodes[node as usize],
        };
        nodes.iter().map(pair).collect()
    }

    fn by_spline(&self, name: &str, landmarks: &[Landmark]) {
        let from: Vec<Vector> = landmarks.iter().map(|one| one.template).collect();
        let to: Vec<Vector> = landmarks.iter().map(|one| one.patient).collect();
        let spline = ThinPlateSpline::new(&from, &to, 0.0).expect("landmarks are in space");
        let mut mesh = self.template.clone();
        mesh.nodes.iter_mut().for_each(|x| *x = spline.apply(x));
        println!("thin-plate spline, {name}: {}", self.told(&mesh));
    }

    fn row(&self, name: &str, nodes: &[u32], skin: bool, bone: bool) {
        let landmarks = self.landmarks(nodes);
        let template = Template { mesh: &self.template, skin: &self.skin, bone: &self.bone };
        let patient = Patient {
            skin: skin.then_some(&self.skin_surface),
            bone: bone.then_some(&self.bone_surface),
            landmarks: &landmarks,
        };
        let start = Instant::now();
        let found = match conform(&template, &patient, Start::Auto, &Unobserved) {
            Ok(found) => found,
            Err(error) => return println!("{name}: {error}"),
        };
        let seconds = start.elapsed().as_secs_f64();
        let mut mesh = carried(&self.template, &found.deformation);
        println!("{name}: {} in {seconds:.1} s", self.told(&mesh));
        let mut affinely = self.template.clone();
        affinely.nodes.iter_mut().for_each(|x| *x = found.deformation.affine.apply(x));
        println!("    its affine map alone: {}", self.told(&affinely));
        let bounds = Bounds::of(&mesh, 1.0, 3.0).along(&mesh, &[&self.skin, &self.bone]);
        let start = Instant::now();
        let report = repair(&mut mesh, &bounds, &Unobserved);
        println!(
            "    repaired: {} nodes by {:.2} mm at most, {} of {} cells unproven, in {:.2} s; {}",
            report.nodes_moved,
            report.largest_move,
            report.unproven.len(),
            report.unproven_before,
            start.elapsed().as_secs_f64(),
            self.told(&mesh)
        );
    }

    fn told(&self, mesh: &VolumeMesh) -> String {
        let search = SurfaceSearch::new(&self.skin_surface).expect("the skin has triangles");
        let square = |&node: &u32| search.closest(&mesh.nodes[node as usize]).distance.powi(2);
        let squares: f64 = self.skin.iter().map(square).sum();
        let left = |nodes: &[u32]| {
            let one = |&node: &u32| {
                (mesh.nodes[node as usize] - self.subject.nodes[node as usize]).norm()
            };
            let mut all: Vec<f64> = nodes.iter().map(one).collect();
            all.sort_by(f64::total_cmp);
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            format!("{mean:.2}/{:.1}/{:.1}", all[all.len() * 95 / 100], all[all.len() - 1])
        };
        format!(
            "skin {} lips {} inner {} on bone {} surface {:.2} mm",
            left(&self.skin),
            left(&self.lips[0]),
            left(&self.inner),
            left(&self.bone),
            (squares / self.skin.len() as f64).sqrt()
        )
    }
}

fn surface(mesh: &VolumeMesh, nodes: &[u32]) -> TriangleSurface {
    let on = |node: &u32| nodes.binary_search(node).is_ok();
    let faces = mesh.boundary_faces().into_iter();
    let faces: Vec<_> = faces.filter(|face| face.nodes().iter().all(on)).collect();
    mesh.surface_of(&faces)
}

/// Nodes of the skin within 8 mm of the fibres of the orbicularis oris.
fn near_mouth(name: &str, mesh: &VolumeMesh, skin: &[u32]) -> Option<Vec<u32>> {
    let text = String::from_utf8(file(&format!("{name}_face_muscle_fibres.csv"))?).ok()?;
    let rows = text.lines().filter(|row| row.starts_with("OOM"));
    let points: Vec<(String, Vector)> = rows
        .filter_map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            let at = |place: usize| cells.get(place)?.parse().ok();
            Some((cells[..3].join(","), Vector::new(at(4)?, at(5)?, at(6)?)))
        })
        .collect();
    let near = |x: &Vector| {
        points.windows(2).filter(|pair| pair[0].0 == pair[1].0).any(|pair| {
            let (from, along) = (pair[0].1, pair[1].1 - pair[0].1);
            let share = ((x - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (x - from - along * share).norm() <= 8.0
        })
    };
    Some(skin.iter().copied().filter(|&node| near(&mesh.nodes[node as usize])).collect())
}

/// Nodes one by one, each the farthest from those before; the first is the nearest to the centroid.
fn farthest(mesh: &VolumeMesh, nodes: &[u32], mut chosen: Vec<u32>, count: usize) -> Vec<u32> {
    let place = |node: u32| mesh.nodes[node as usize];
    if chosen.is_empty() {
        let middle = nodes.iter().map(|&node| place(node)).sum::<Vector>() / nodes.len() as f64;
        let from_middle = |node: &&u32| (place(**node) - middle).norm();
        chosen.extend(nodes.iter().min_by(|a, b| from_middle(a).total_cmp(&from_middle(b))));
    }
    while chosen.len() < count {
        let apart = |node: &&u32| {
            let distances = chosen.iter().map(|&other| (place(**node) - place(other)).norm());
            distances.fold(f64::INFINITY, f64::min)
        };
        let Some(&next) = nodes.iter().max_by(|a, b| apart(a).total_cmp(&apart(b))) else { break };
        chosen.push(next);
    }
    chosen
}
