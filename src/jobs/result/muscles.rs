//! Muscles of a scene in files: a picture of their cells, and cell arrays of `volume.vtu`.

use std::collections::BTreeMap;

use super::pictures::upright;
use mechanics::chart::{MuscleGroup, MusclesPicture, PngError};
use mechanics::format::{ArrayValues, NamedValues};
use mechanics::mesh::VolumeMesh;
use mechanics::prediction::{Case, Scene};

const MM3_IN_ML: f64 = 1000.0;

/// For each cell the number of the muscle with the largest share of it, -1 without any, and the share of all muscles.
pub struct CellMuscles<'a> {
    pub names: Vec<&'a str>,
    muscle: Vec<i64>,
    share: Vec<f64>,
}

impl<'a> CellMuscles<'a> {
    /// `None` of a scene without muscles.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        if scene.muscles.is_empty() {
            return None;
        }
        let cells = scene.mesh.cells.len();
        let (mut muscle, mut share) = (vec![-1; cells], vec![0.0_f64; cells]);
        let mut largest = vec![0.0; cells];
        for (number, own) in scene.muscles.iter().enumerate() {
            for cell in &own.cells {
                let (at, part) = (cell.cell as usize, cell.stress.trace());
                share[at] = (share[at] + part).min(1.0);
                if part > largest[at] {
                    (largest[at], muscle[at]) = (part, number as i64);
                }
            }
        }
        let names = scene.muscles.iter().map(|own| own.name.as_str()).collect();
        Some(CellMuscles { names, muscle, share })
    }

    pub fn arrays(&self) -> [NamedValues<'_>; 2] {
        let named = |name, values| NamedValues { name, values };
        [
            named("muscle", ArrayValues::Integers(&self.muscle)),
            named("muscle_share", ArrayValues::Reals(&self.share)),
        ]
    }
}

/// `muscles.svg`: the cells in which muscles have the largest share, on the bones of the case; `None` of a scene without muscles.
pub fn muscles_picture(case: &Case, scene: &Scene) -> Result<Option<String>, PngError> {
    let Some(cells) = CellMuscles::of(scene) else { return Ok(None) };
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (number, own) in scene.muscles.iter().enumerate() {
        groups.entry(name_of_both_sides(&own.name)).or_default().push(number);
    }
    let groups = groups.into_iter().map(|(name, numbers)| {
        let is_own = |cell: &usize| numbers.iter().any(|own| cells.muscle[*cell] == *own as i64);
        let own: Vec<usize> = (0..cells.muscle.len()).filter(is_own).collect();
        let volume: f64 =
            numbers.iter().map(|&number| scene.muscles[number].volume(&scene.mesh)).sum();
        let part = part_of(&scene.mesh, &own);
        let surface = part.surface_of(&part.boundary_faces());
        let numbers = format!("{:.1} ml, largest share of {} cells", volume / MM3_IN_ML, own.len());
        MuscleGroup { name, numbers, points: surface.points, triangles: surface.triangles }
    });
    let bones = case.bones.iter().filter_map(|bone| case.surfaces.get(&bone.surface));
    let bones: Vec<_> = bones.map(|bone| (&bone.points[..], &bone.triangles[..])).collect();
    let share = cells.share.iter().filter(|share| **share > 0.0).count();
    let subtitle = format!(
        "{} muscles in {share} of {} cells, each cell in the colour of the largest share; skin and other tissue omitted",
        scene.muscles.len(),
        cells.share.len()
    );
    let picture = MusclesPicture {
        title: "Muscles in the cells of the mesh",
        subtitle: &subtitle,
        muscles: &groups.collect::<Vec<MuscleGroup>>(),
        bones: &bones,
        face_direction: upright(case.frame, &scene.skin.surface),
        frame: case.frame.name(),
    };
    picture.to_svg().map(Some)
}

/// Words, without the side.
fn name_of_both_sides(name: &str) -> String {
    let name = name.strip_suffix("_left").or_else(|| name.strip_suffix("_right")).unwrap_or(name);
    name.replace('_', " ")
}

fn part_of(mesh: &VolumeMesh, cells: &[usize]) -> VolumeMesh {
    let mut part = VolumeMesh { nodes: mesh.nodes.clone(), ..VolumeMesh::default() };
    for &cell in cells {
        part.cells.push(mesh.cells.shape(cell), mesh.cells.nodes(cell));
    }
    part
}
