//! Checks of anisotropy: fibres of the tissue, the skin as a membrane.

use super::case::{Case, FibreDirection, Muscle, Settings};
use super::check::Check;
use super::element_choice::ElementChoice;
use super::error_code::SceneErrorCode;
use super::method::{Laws, Method, MethodKind, MethodProperties};
use super::skin::Skin;
use crate::material::LinearElastic;
use crate::material::hyperelastic::Law;
use crate::mesh::ignored::listed;
use crate::mesh::{ArrayUse, Vector, VolumeMesh, Warning};
use crate::model::fem::membrane::Membrane;
use crate::muscle::axis::{CROSSING, MeanAxis, mean_axis};

/// A direction shorter than this, and a line of the skin of which less than this lies in a face, has no angle.
const SHORTEST: f64 = 1e-6;

/// Regions by number, and what each is made of.
pub(super) struct Tissues<'a> {
    pub regions: &'a [String],
    pub region_of_cell: &'a [u16],
    pub materials: &'a mut [LinearElastic],
}

impl Check<'_> {
    /// For each cell the direction of its fibres, of length 1, or zero where it has none; empty where no
    /// region has fibres. Methods that know no fibres get materials without.
    pub(super) fn fibres(&mut self, tissues: Tissues, method: &Method) -> Vec<Vector> {
        let Tissues { regions, region_of_cell, materials } = tissues;
        let properties = method.properties();
        self.warnings.extend(self.laws_at_rest(regions, materials, properties));
        let has_directions = |material: &LinearElastic| match properties.laws {
            Laws::Any => material.has_pulling_fibres(),
            Laws::AtRest | Laws::SaintVenantKirchhoff => {
                material.has_fibre() && properties.knows_fibres
            }
        };
        let is_ignored = |material: &&mut LinearElastic| {
            material.has_fibre() && !properties.knows_fibres && !has_directions(material)
        };
        let ignored: Vec<&mut LinearElastic> = materials.iter_mut().filter(is_ignored).collect();
        if !ignored.is_empty() {
            self.warnings.push(fibres_ignored(ignored.len(), "regions"));
            ignored.into_iter().for_each(|material| *material = material.without_fibre());
        }
        let has_fibres: Vec<bool> = materials.iter().map(has_directions).collect();
        if !has_fibres.contains(&true) {
            let of_muscle = |muscle: &Muscle| muscle.tissue.is_some_and(|own| own.has_fibre());
            if properties.expects_fibres && !self.case.muscles.iter().any(of_muscle) {
                let detail = "no region has fibres: this is the isotropic mass-tensor model";
                self.warnings.push(Warning::new("fibres-missing", detail));
            }
            return Vec::new();
        }
        let mut of_cell = vec![Vector::zeros(); region_of_cell.len()];
        let mut cells_of = vec![Vec::new(); regions.len()];
        for (cell, &region) in region_of_cell.iter().enumerate() {
            cells_of[usize::from(region)].push(cell);
        }
        for (number, (name, cells)) in regions.iter().zip(&cells_of).enumerate() {
            // Regions without a material are refused elsewhere.
            if has_fibres.get(number) == Some(&true) {
                self.fibres_of_region(name, cells, &mut of_cell);
            }
        }
        of_cell
    }

    /// The warning of laws that are stated for a method of small strain, by region or by what an image shows.
    fn laws_at_rest(
        &self,
        regions: &[String],
        materials: &[LinearElastic],
        method: &MethodProperties,
    ) -> Option<Warning> {
        let is_stated = |material: &LinearElastic| match method.laws {
            Laws::Any => false,
            Laws::AtRest => material.stated_law().is_some() || material.has_pulling_fibres(),
            Laws::SaintVenantKirchhoff => {
                let other = |law: &Law| !matches!(law, Law::SaintVenantKirchhoff(_));
                material.stated_law().is_some_and(other) || material.has_pulling_fibres()
            }
        };
        let windows = self.case.hounsfield.iter().flat_map(|image| &image.tissues);
        let windows = windows.map(|window| (&window.name, &window.material));
        let all = regions.iter().zip(materials).chain(windows);
        let names: Vec<&str> = all
            .filter(|(_, material)| is_stated(material))
            .map(|(name, _)| name.as_str())
            .collect();
        let detail = format!(
            "`{}` does not know the law of {}: its tissue has the moduli that the law has at rest, without fibres that only \
             pull (what is of second order, where the method has it, is of the law); `fem_nonlinear` follows the law",
            method.name,
            listed(&names)
        );
        let warning = Warning::new("law-at-rest", detail).with("regions", names.len() as f64);
        (!names.is_empty()).then_some(warning)
    }

    fn fibres_of_region(&mut self, region: &str, cells: &[usize], of_cell: &mut [Vector]) {
        let case: &Case = self.case;
        let name = if case.materials.contains_key(region) { region } else { "*" };
        let pointer = format!("/case/materials/{name}/fibre");
        let stated = case.fibres.get(region).or_else(|| case.fibres.get("*"));
        let (place, wrong) = match stated {
            None => {
                let detail = format!("region {region:?} has fibres and no direction for them");
                return self.problems.add(pointer, SceneErrorCode::MissingField, detail);
            }
            Some(FibreDirection::Uniform(direction)) => {
                ("direction", directions(cells, of_cell, |_| *direction))
            }
            Some(FibreDirection::Array(array)) => match Course::of(&case.volume, array) {
                Some(course) => {
                    self.warnings.extend(course.disagreeing(region, cells));
                    ("array", directions(cells, of_cell, |cell| course.axis(cell).along))
                }
                None => {
                    let detail = case.volume.missing_array(ArrayUse::CellVectors, array);
                    let detail = format!("{detail}; a point array of 3 components would do too");
                    let at = format!("{pointer}/array");
                    return self.problems.add(at, SceneErrorCode::UnknownArray, detail);
                }
            },
        };
        if let Some((first, count)) = wrong {
            let detail = format!(
                "cell {first} of region {region:?} has a fibre direction without length ({count} such cells)"
            );
            self.problems.add(
                format!("{pointer}/{place}"),
                SceneErrorCode::FibreDirectionZero,
                detail,
            );
        }
    }

    /// The skin as a membrane, where the settings ask for one.
    pub(super) fn membrane(&mut self, skin: &Skin, settings: &Settings) -> Option<Membrane> {
        let stated = settings.membrane.as_ref()?;
        let method = settings.method.kind();
        let is_quadratic = settings.element == ElementChoice::Quadratic;
        const AT: &str = "/spec/membrane";
        let refused = if !method.properties().knows_membrane {
            Some((AT, "this method has no skin of its own: leave the membrane out"))
        } else if method == MethodKind::FemNonlinear && is_quadratic {
            Some((
                AT,
                "quadratic elements have no membrane at finite strain: choose another element",
            ))
        } else if method != MethodKind::FemNonlinear && !stated.sheet.bears_compression() {
            let detail = "a membrane that bears no compression is not linear: request `fem_nonlinear`, or a membrane that bears it";
            Some(("/spec/membrane/compression", detail))
        } else {
            None
        };
        if let Some((pointer, detail)) = refused {
            let code = SceneErrorCode::MethodNotAvailable;
            self.problems.add(pointer, code, detail.to_owned());
            return None;
        }
        let nodes = skin.nodes();
        let corners = |points: &[u32; 3]| points.map(|point| nodes[point as usize]);
        let triangles: Vec<[u32; 3]> = skin.surface.triangles.iter().map(corners).collect();
        let sheet = stated.sheet;
        let lines = match &stated.lines {
            Some(lines) => self.lines(lines, &triangles),
            None => Vec::new(),
        };
        Some(Membrane { sheet, triangles, lines })
    }

    /// The lines of the skin in the plane of each triangle.
    fn lines(&mut self, stated: &FibreDirection, triangles: &[[u32; 3]]) -> Vec<Vector> {
        let mesh = &self.case.volume;
        let (pointer, vectors) = match stated {
            FibreDirection::Uniform(_) => ("/spec/membrane/fibre/direction", None),
            FibreDirection::Array(array) => match mesh.node_vectors.get(array) {
                Some(vectors) => ("/spec/membrane/fibre/array", Some(vectors)),
                None => {
                    let detail = mesh.missing_array(ArrayUse::PointVectors, array);
                    self.problems.add(
                        "/spec/membrane/fibre/array",
                        SceneErrorCode::UnknownArray,
                        detail,
                    );
                    return Vec::new();
                }
            },
        };
        let along = |corners: &[u32; 3]| match (stated, vectors) {
            (_, Some(vectors)) => {
                common_axis(corners, vectors).map_or(Vector::zeros(), |of| of.direction)
            }
            (FibreDirection::Uniform(direction), _) => *direction,
            (FibreDirection::Array(_), None) => Vector::zeros(),
        };
        let in_plane = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|node| mesh.nodes[node as usize]);
            let normal = unit(&(b - a).cross(&(c - a)))?;
            let along = unit(&along(corners))?;
            unit(&(along - normal * normal.dot(&along)))
        };
        let lines: Vec<Option<Vector>> = triangles.iter().map(in_plane).collect();
        let wrong = lines.iter().filter(|line| line.is_none()).count();
        if let Some(first) = lines.iter().position(Option::is_none) {
            let detail = format!(
                "the lines have no direction in the face of the nodes {:?} ({wrong} such faces)",
                triangles[first]
            );
            self.problems.add(pointer, SceneErrorCode::FibreDirectionZero, detail);
        }
        lines.into_iter().flatten().collect()
    }
}

/// The code of the warning that a method has no fibres.
pub(super) const FIBRES_IGNORED: &str = "fibres-ignored";

/// The warning of regions or muscles with fibres, which are not known.
pub(super) fn fibres_ignored(count: usize, what: &'static str) -> Warning {
    let detail = format!(
        "{count} {what} have fibres, which this method does not know: they are as stiff along as across"
    );
    Warning::new(FIBRES_IGNORED, detail).with(what, count as f64)
}

/// Gives cells their directions; the first that has none, and how many there are.
fn directions(
    cells: &[usize],
    of_cell: &mut [Vector],
    stated: impl Fn(usize) -> Vector,
) -> Option<(usize, usize)> {
    let mut wrong = None;
    for &cell in cells {
        match unit(&stated(cell)) {
            Some(direction) => of_cell[cell] = direction,
            None => wrong = wrong.or(Some((cell, 0))).map(|(first, count)| (first, count + 1)),
        }
    }
    wrong
}

/// Length 1, or nothing where there is no direction.
pub(super) fn unit(vector: &Vector) -> Option<Vector> {
    let length = vector.norm();
    (length.is_finite() && length > SHORTEST).then(|| vector / length)
}

/// The course of fibres in an array of the mesh.
pub(super) enum Course<'a> {
    Cells(&'a [Vector]),
    /// At the nodes of a mesh (Zachow et al. 2006, section 4.2).
    Nodes(&'a VolumeMesh, &'a [Vector]),
}

/// The axis of a cell, of any length, and how nearly those of its nodes have another one: 0 where all agree, 1 where none is
/// preferred.
pub(super) struct Axis {
    pub along: Vector,
    beside: f64,
}

impl<'a> Course<'a> {
    /// None where neither cells nor nodes have an array of that name.
    pub(super) fn of(mesh: &'a VolumeMesh, array: &str) -> Option<Self> {
        let of_cells = mesh.cell_vectors.get(array).map(|vectors| Course::Cells(vectors));
        let of_nodes = mesh.node_vectors.get(array);
        of_cells.or_else(|| of_nodes.map(|vectors| Course::Nodes(mesh, vectors)))
    }

    /// Of nodes the leading eigenvector of sum a a^T over those of a cell that have a direction a of length 1.
    pub(super) fn axis(&self, cell: usize) -> Axis {
        let (mesh, vectors) = match self {
            Course::Cells(vectors) => return Axis { along: vectors[cell], beside: 0.0 },
            Course::Nodes(mesh, vectors) => (mesh, vectors),
        };
        let nodes = mesh.cells.nodes(cell);
        let Some(mean) = common_axis(nodes, vectors) else {
            return Axis { along: Vector::zeros(), beside: 0.0 };
        };
        let mut units = nodes.iter().filter_map(|&node| unit(&vectors[node as usize]));
        let is_opposite = units.next().is_some_and(|first| mean.direction.dot(&first) < 0.0);
        let along = if is_opposite { -mean.direction } else { mean.direction };
        Axis { along, beside: mean.crossing }
    }

    /// The warning of cells whose nodes have no common direction.
    fn disagreeing(&self, region: &str, cells: &[usize]) -> Option<Warning> {
        let count = cells.iter().filter(|&&cell| self.axis(cell).beside > CROSSING).count();
        let detail = format!(
            "in {count} of {} cells of region {region:?} the fibres of the nodes run in two ways, and their mean is taken",
            cells.len()
        );
        let warning = Warning::new("fibres-disagree", detail).with("cells", count as f64);
        (count > 0).then(|| warning.with("of", cells.len() as f64))
    }
}

/// The mean of the axes of nodes that have one, which have neither sign nor length.
fn common_axis(nodes: &[u32], vectors: &[Vector]) -> Option<MeanAxis> {
    let units = nodes.iter().filter_map(|&node| unit(&vectors[node as usize]));
    mean_axis(units.map(|axis| (1.0, axis)))
}
