//! Meshes made in code, for tests, benches and the demo: blocks and the octant of a thick sphere.
//!
//! Both are a sheet of quadrilaterals repeated in layers. A tetrahedral cell is cut so that every
//! face is cut from its lowest node number: neighbours agree without looking at each other, and on
//! a block the cut is Kuhn's, six tetrahedra around the diagonal (0,0,0)-(1,1,1) of each cell.
//!
//! Source of the cut: Dompierre, Labbé, Vallet, Camarero, How to subdivide pyramids, prisms, and
//! hexahedra into tetrahedra, 8th International Meshing Roundtable, 1999.

use std::collections::BTreeMap;

use super::{CellShape, Cells, TriangleSurface, Vector, VolumeMesh};

/// A block from the origin to `size` (mm) with `cells` cells along each axis; a wedge mesh cuts
/// each cell into two wedges that stand along z. Node sets: `x_min`, `x_max`, `y_min`, …
pub fn block(size: Vector, cells: [usize; 3], shape: CellShape) -> VolumeMesh {
    let [nx, ny, nz] = cells;
    let number = |i: usize, j: usize| (i + (nx + 1) * j) as u32;
    let mut quads = Vec::with_capacity(nx * ny);
    for j in 0..ny {
        for i in 0..nx {
            quads.push([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
        }
    }
    let mut nodes = Vec::with_capacity((nx + 1) * (ny + 1) * (nz + 1));
    let mut sets = NodeSets::default();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let node = nodes.len() as u32;
                nodes.push(Vector::new(
                    size.x * i as f64 / nx as f64,
                    size.y * j as f64 / ny as f64,
                    size.z * k as f64 / nz as f64,
                ));
                sets.push("x_min", node, i == 0);
                sets.push("x_max", node, i == nx);
                sets.push("y_min", node, j == 0);
                sets.push("y_max", node, j == ny);
                sets.push("z_min", node, k == 0);
                sets.push("z_max", node, k == nz);
            }
        }
    }
    VolumeMesh {
        cells: layers_of(&quads, (nx + 1) * (ny + 1), nz, shape, &nodes),
        nodes,
        node_sets: sets.0,
        ..VolumeMesh::default()
    }
}

/// How a thick sphere is divided: its radii in mm and its cells across and along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThickSphere {
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// Cells between the two radii.
    pub cells_radial: usize,
    /// Cells along an edge of each of the three patches, so half as many as along a quarter circle.
    pub cells_along: usize,
}

/// The octant x, y, z >= 0 of a thick sphere, its directions those of an equiangular cube.
/// Node sets: `inner`, `outer` and the symmetry planes `x_min`, `y_min`, `z_min`.
pub fn thick_sphere_octant(sphere: ThickSphere, shape: CellShape) -> VolumeMesh {
    let (directions, quads) = octant_sheet(sphere.cells_along);
    let layers = sphere.cells_radial;
    let mut nodes = Vec::with_capacity(directions.len() * (layers + 1));
    let mut sets = NodeSets::default();
    for layer in 0..=layers {
        let depth = layer as f64 / layers as f64;
        let radius = sphere.inner_radius + (sphere.outer_radius - sphere.inner_radius) * depth;
        for direction in &directions {
            let node = nodes.len() as u32;
            nodes.push(direction * radius);
            sets.push("inner", node, layer == 0);
            sets.push("outer", node, layer == layers);
            sets.push("x_min", node, direction.x == 0.0);
            sets.push("y_min", node, direction.y == 0.0);
            sets.push("z_min", node, direction.z == 0.0);
        }
    }
    VolumeMesh {
        cells: layers_of(&quads, directions.len(), layers, shape, &nodes),
        nodes,
        node_sets: sets.0,
        ..VolumeMesh::default()
    }
}

/// Unit directions of the octant and its quads, counter-clockwise seen from outside: the three
/// faces of the cube corner (n, n, n), so that a direction is known by its place on the cube.
fn octant_sheet(n: usize) -> (Vec<Vector>, Vec<[u32; 4]>) {
    let mut number_of: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut directions = Vec::new();
    let mut quads = Vec::with_capacity(3 * n * n);
    let tangent = |step: usize| {
        let angle = std::f64::consts::FRAC_PI_4 * step as f64 / n as f64;
        if step == n { 1.0 } else { angle.tan() }
    };
    for axis in 0..3 {
        for b in 0..n {
            for a in 0..n {
                // The diagonal 0-2 points to the cube's corner, where three quads meet at 120
                // degrees each: from there it is the short one.
                let corners = [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]];
                quads.push(corners.map(|[a, b]| {
                    let mut place = [0; 3];
                    place[axis] = n;
                    place[(axis + 1) % 3] = a;
                    place[(axis + 2) % 3] = b;
                    *number_of.entry(place).or_insert_with(|| {
                        directions.push(Vector::from(place.map(tangent)).normalize());
                        directions.len() as u32 - 1
                    })
                }));
            }
        }
    }
    (directions, quads)
}

/// Cells between a sheet of quads and its copies: the node of sheet point p in layer l is
/// `l * sheet_points + p`. Quads are counter-clockwise seen from the next layer; where the shape
/// asks for it they are cut along their diagonal 0-2.
pub(super) fn layers_of(
    quads: &[[u32; 4]],
    sheet_points: usize,
    layers: usize,
    shape: CellShape,
    nodes: &[Vector],
) -> Cells {
    let mut cells = Cells::default();
    for layer in 0..layers {
        let low = (layer * sheet_points) as u32;
        let high = low + sheet_points as u32;
        for &[p, q, r, s] in quads {
            match shape {
                CellShape::Hex8 => cells.push(
                    shape,
                    &[low + p, low + q, low + r, low + s, high + p, high + q, high + r, high + s],
                ),
                CellShape::Wedge6 => {
                    for [a, b, c] in [[p, q, r], [p, r, s]] {
                        cells.push(
                            shape,
                            &[low + a, low + b, low + c, high + a, high + b, high + c],
                        );
                    }
                }
                CellShape::Tet4 => {
                    push_prism(&mut cells, nodes, [p, q, r], [low, high]);
                    push_prism(&mut cells, nodes, [p, r, s], [low, high]);
                }
            }
        }
    }
    cells
}

/// The three tetrahedra of a prism, each of its upright faces cut from its lowest sheet point.
fn push_prism(cells: &mut Cells, nodes: &[Vector], mut triangle: [u32; 3], [low, high]: [u32; 2]) {
    triangle.sort_unstable();
    let [a, b, c] = triangle;
    for mut tetrahedron in [
        [low + a, low + b, low + c, high + c],
        [low + a, low + b, high + b, high + c],
        [low + a, high + a, high + b, high + c],
    ] {
        let [p0, p1, p2, p3] = tetrahedron.map(|node| nodes[node as usize]);
        if (p1 - p0).cross(&(p2 - p0)).dot(&(p3 - p0)) < 0.0 {
            tetrahedron.swap(1, 2);
        }
        cells.push(CellShape::Tet4, &tetrahedron);
    }
}

/// The faces all of whose nodes are in a set, as bone has them that is seen from the tissue.
pub(super) fn bone_below(mesh: &VolumeMesh, name: &str) -> TriangleSurface {
    let mut attached = vec![false; mesh.nodes.len()];
    for &node in mesh.node_set(name).unwrap_or_default() {
        attached[node as usize] = true;
    }
    let mut faces = mesh.boundary_faces();
    faces.retain(|face| face.nodes().iter().all(|&node| attached[node as usize]));
    let mut surface = mesh.surface_of(&faces);
    for triangle in &mut surface.triangles {
        triangle.swap(1, 2);
    }
    surface
}

/// Node sets that are filled in the order of the nodes, and so are ascending.
#[derive(Default)]
pub(super) struct NodeSets(pub(super) BTreeMap<String, Vec<u32>>);

impl NodeSets {
    pub(super) fn push(&mut self, name: &str, node: u32, belongs: bool) {
        if belongs {
            match self.0.get_mut(name) {
                Some(set) => set.push(node),
                None => {
                    self.0.insert(name.to_owned(), vec![node]);
                }
            }
        }
    }
}

/// The hard block of docs/finite-strain.md in tetrahedra: 100 x 100 x 20 mm, at whose bottom `patch` is 30 x 30 mm to be
/// moved and `rest` what lies more than 25 mm from it; the ring between is free.
pub fn hard_block(cells: [usize; 3]) -> VolumeMesh {
    let mut mesh = block(Vector::new(100.0, 100.0, 20.0), cells, CellShape::Tet4);
    let outside = |node: &u32| {
        let x = &mesh.nodes[*node as usize];
        let [x, y] = [x.x, x.y].map(|v| (35.0 - v).max(v - 65.0).max(0.0));
        x.hypot(y)
    };
    let bottom = mesh.node_sets["z_min"].clone();
    let patch = bottom.iter().copied().filter(|node| outside(node) == 0.0).collect();
    let rest = bottom.iter().copied().filter(|node| outside(node) > 25.0).collect();
    mesh.node_sets.insert("patch".to_owned(), patch);
    mesh.node_sets.insert("rest".to_owned(), rest);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [CellShape; 3] = [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6];

    /// The volume by Gauss's theorem over the faces of each cell, each cut along 0-2.
    fn cell_volumes(mesh: &VolumeMesh) -> Vec<f64> {
        mesh.cells
            .iter()
            .map(|(shape, nodes)| {
                let mut volume = 0.0;
                for face in shape.faces() {
                    let at = |local: usize| mesh.nodes[nodes[face[local]] as usize];
                    for corner in 2..face.len() {
                        volume += at(0).cross(&at(corner - 1)).dot(&at(corner)) / 6.0;
                    }
                }
                volume
            })
            .collect()
    }

    fn octant(cells_along: usize, shape: CellShape) -> VolumeMesh {
        let sphere =
            ThickSphere { inner_radius: 60.0, outer_radius: 72.0, cells_radial: 2, cells_along };
        thick_sphere_octant(sphere, shape)
    }

    #[test]
    fn a_block_is_filled_by_cells_of_positive_volume() {
        for (shape, a_cell) in SHAPES.into_iter().zip([6, 1, 2]) {
            let mesh = block(Vector::new(6.0, 4.0, 2.0), [3, 2, 1], shape);
            let volumes = cell_volumes(&mesh);
            assert_eq!(volumes.len(), 6 * a_cell);
            assert!(volumes.iter().all(|&volume| volume > 0.0), "{shape:?}");
            // Rounding only.
            assert!((volumes.iter().sum::<f64>() - 48.0).abs() < 1e-12);
            assert_eq!(mesh.nodes.len(), 4 * 3 * 2);
            assert_eq!(mesh.node_sets["x_max"].len(), 3 * 2);
            assert_eq!(mesh.node_sets["z_min"].len(), 4 * 3);
        }
    }

    #[test]
    fn a_tetrahedral_block_is_cut_as_kuhn_cut_it() {
        let mesh = block(Vector::new(1.0, 1.0, 1.0), [1, 1, 1], CellShape::Tet4);
        for (_, nodes) in mesh.cells.iter() {
            assert!(nodes.contains(&0) && nodes.contains(&7));
        }
    }

    #[test]
    fn neighbouring_cells_share_whole_faces() {
        for shape in SHAPES {
            let mesh = octant(3, shape);
            let outside = mesh.surface_of(&mesh.boundary_faces());
            // A closed surface has Euler characteristic 2: points - edges + triangles, three
            // edges for two triangles. A face that a neighbour does not share would add some.
            let (points, triangles) = (outside.points.len(), outside.triangles.len());
            assert_eq!(2 * points, triangles + 4, "{shape:?}");
            let radii = outside.points.iter().map(Vector::norm);
            let between = radii.filter(|radius| (radius - 66.0).abs() < 1.0).count();
            assert_eq!(between, 3 * 2 * 3, "the rim of the middle layer");
        }
    }

    #[test]
    fn the_octant_approaches_the_volume_of_the_sphere() {
        let exact = std::f64::consts::PI / 6.0 * (72f64.powi(3) - 60f64.powi(3));
        for shape in SHAPES {
            let errors = [4, 8].map(|cells| {
                let volumes = cell_volumes(&octant(cells, shape));
                assert!(volumes.iter().all(|&volume| volume > 0.0), "{shape:?}");
                exact - volumes.iter().sum::<f64>()
            });
            // Chords lie inside the sphere and their defect falls with the square of the cell.
            assert!(errors[1] > 0.0 && (errors[0] / errors[1] - 4.0).abs() < 0.2);
        }
    }

    #[test]
    fn the_sets_of_an_octant_lie_on_its_walls() {
        let mesh = octant(4, CellShape::Hex8);
        let on = |name: &str| mesh.node_sets[name].iter().map(|&n| mesh.nodes[n as usize]);
        assert!(on("inner").all(|p| (p.norm() - 60.0).abs() < 1e-12));
        assert!(on("outer").all(|p| (p.norm() - 72.0).abs() < 1e-12));
        assert!(on("y_min").all(|p| p.y == 0.0));
        assert_eq!(on("y_min").count(), 9 * 3);
        assert_eq!(on("inner").count(), 3 * 16 + 3 * 4 + 1);
    }
}
