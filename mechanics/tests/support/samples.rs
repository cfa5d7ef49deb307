//! Small meshes and files that the tests of the formats share.

use std::collections::BTreeMap;

use mechanics::format::{Mesh, ReadLimits, ReadMesh, read};
use mechanics::mesh::{CellShape, Cells, TriangleSurface, Vector, VolumeMesh};

#[path = "scans.rs"]
pub mod scans;

/// A hexahedron with a wedge and a tetrahedron on it; every kind of set and array.
pub fn mixed_mesh() -> VolumeMesh {
    let nodes = [
        [0.0, 0.0, 0.0],
        [90.0, 0.0, 0.0],
        [90.0, 80.0, 0.0],
        [0.0, 80.0, 0.0],
        [0.0, 0.0, 70.0],
        [90.0, 0.0, 70.0],
        [90.0, 80.0, 70.1],
        [0.0, 80.0, 70.0],
        [45.0, 0.0, 120.5],
        [45.0, 80.0, 120.0],
        [45.0, -60.0, 71.0],
    ];
    let mut cells = Cells::default();
    cells.push(CellShape::Hex8, &[0, 1, 2, 3, 4, 5, 6, 7]);
    cells.push(CellShape::Wedge6, &[4, 8, 5, 7, 9, 6]);
    cells.push(CellShape::Tet4, &[4, 10, 5, 8]);
    let named = |name: &str, set: &[u32]| (name.to_string(), set.to_vec());
    let displacement = nodes.map(|[x, y, z]| Vector::new(x / 3.0, -y / 7.0, z * 1e-17));
    VolumeMesh {
        nodes: nodes.map(Vector::from).to_vec(),
        cells,
        node_sets: BTreeMap::from([
            named("jaw attached", &[0, 1, 2, 3]),
            named("peau <outer> & \"skin\" é", &[8, 9, 10]),
            named("nobody", &[]),
        ]),
        cell_sets: BTreeMap::from([named("muscle", &[0, 2])]),
        node_labels: BTreeMap::from([(
            "tag".into(),
            vec![1, 1, 1, 1, -5, 0, 0, 0, i64::MIN, i64::MAX, 3],
        )]),
        cell_labels: BTreeMap::from([("band".into(), vec![0, 1, -7])]),
        node_vectors: BTreeMap::from([("u_mm".into(), displacement.to_vec())]),
        cell_vectors: BTreeMap::from([(
            "fibre".into(),
            vec![Vector::new(1.0, 0.0, -0.25), Vector::zeros(), Vector::new(0.0, 1e-9, 3.0)],
        )]),
        ..VolumeMesh::default()
    }
}

/// A tetrahedron's four faces, facing outwards, as cut from some mesh.
pub fn closed_surface() -> TriangleSurface {
    TriangleSurface {
        points: vec![
            Vector::new(0.0, 0.0, 0.0),
            Vector::new(100.0, 0.0, 0.0),
            Vector::new(0.0, 100.0, 0.0),
            Vector::new(0.0, 0.0, 100.0 / 3.0),
        ],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        node_ids: Some(vec![7, 11, 13, 17]),
    }
}

pub fn read_default(bytes: &[u8]) -> ReadMesh {
    match read(bytes, &ReadLimits::default()) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error}"),
    }
}

/// The code of the error that a file causes, or "read".
pub fn code_of(bytes: &[u8]) -> &'static str {
    match read(bytes, &ReadLimits::default()) {
        Ok(_) => "read",
        Err(error) => error.code(),
    }
}

/// The sentence of the error that a file causes.
pub fn error_of(bytes: &[u8]) -> String {
    match read(bytes, &ReadLimits::default()) {
        Ok(_) => "read".into(),
        Err(error) => error.to_string(),
    }
}

pub fn volume(read: ReadMesh) -> VolumeMesh {
    match read.mesh {
        Mesh::Volume(mesh) => mesh,
        _ => panic!("a volume mesh was expected"),
    }
}

pub fn surface(read: ReadMesh) -> TriangleSurface {
    match read.mesh {
        Mesh::Surface(surface) => surface,
        _ => panic!("a surface was expected"),
    }
}

pub fn warning_codes(read: &ReadMesh) -> Vec<&'static str> {
    read.warnings.iter().map(|warning| warning.code).collect()
}

/// An ascii VTU from the text of its arrays; corners and type for each cell.
pub fn ascii_vtu(points: &[[f64; 3]], cells: &[(u8, &[u32])], more: &str) -> String {
    let numbers = |values: Vec<String>| values.join(" ");
    let coordinates = points.iter().flatten().map(f64::to_string).collect();
    let nodes = cells.iter().flat_map(|(_, nodes)| nodes.iter());
    let mut end = 0;
    let ends = cells.iter().map(|(_, nodes)| {
        end += nodes.len();
        end.to_string()
    });
    let ends = ends.collect();
    let types = cells.iter().map(|(kind, _)| kind.to_string()).collect();
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">
<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points>
<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>
<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{}</DataArray>
<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray></Cells>
{more}</Piece></UnstructuredGrid></VTKFile>",
        points.len(),
        cells.len(),
        numbers(coordinates),
        numbers(nodes.map(u32::to_string).collect()),
        numbers(ends),
        numbers(types),
    )
}

/// Four points of a tetrahedron that the node order 0 1 2 3 makes positive.
pub const TETRAHEDRON: [[f64; 3]; 4] =
    [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];

/// Binary STL of some triangles with a header of one's own and a count of one's own.
pub fn binary_stl(header: &[u8], count: u32, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        let coordinates = triangle.as_flattened().iter();
        bytes.extend(coordinates.flat_map(|coordinate| coordinate.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];

/// One small valid file of every format, and more than one where a format has more than one form.
pub fn one_of_each() -> Vec<(&'static str, Vec<u8>)> {
    use mechanics::format::vtk::{vtp, vtu};
    use mechanics::format::{SurfaceOutput, VolumeOutput, ply, stl};
    use mechanics::mesh::Frame;
    let (mesh, surface) = (mixed_mesh(), closed_surface());
    let output = SurfaceOutput::plain(&surface, Frame::Lps);
    let volume = VolumeOutput::plain(&mesh, Frame::Ras);
    let mut each = vec![
        ("vtu", vtu::write(&volume).unwrap()),
        ("vtp", vtp::write(&output).unwrap()),
        ("stl", stl::write(&output).unwrap()),
        ("ply", ply::write(&output).unwrap()),
        ("vtu ascii", ascii_vtu(&TETRAHEDRON, &[(10, &[0, 1, 2, 3])], "").into_bytes()),
        ("vtk", VTK.as_bytes().to_vec()),
        ("vtk binary", binary_vtk()),
        ("gmsh 2.2", GMSH_2.as_bytes().to_vec()),
        ("gmsh 4.1", GMSH_4.as_bytes().to_vec()),
        ("gmsh 2.2 binary", binary_gmsh()),
        ("stl ascii", STL.as_bytes().to_vec()),
        ("ply ascii", PLY.as_bytes().to_vec()),
        ("obj", OBJ.as_bytes().to_vec()),
        ("nrrd", nrrd(NRRD, &VOXELS.map(i16::to_le_bytes).concat())),
        (
            "nrrd gzip",
            nrrd(&NRRD.replace("raw", "gzip"), &gzip(&VOXELS.map(i16::to_le_bytes).concat())),
        ),
    ];
    each.extend(scans::one_of_each());
    each
}

/// An image of 3 x 2 x 4 voxels.
pub const NRRD: &str = "NRRD0004
# Complete NRRD file format specification at:
type: short
dimension: 3
space: left-posterior-superior
sizes: 3 2 4
space directions: (30,0,0) (0,40,0) (0,0,20)
kinds: domain domain domain
endian: little
encoding: raw
space origin: (1, -2, 3.5)
patient:=Jane Roe

";

pub const VOXELS: [i16; 24] = [
    -1000, -30, 0, 40, 100, 3000, 1, 2, 3, 4, 5, 6, -7, -8, -9, -10, -11, -12, 13, 14, 15, 16, 17,
    -18,
];

pub fn nrrd(header: &str, voxels: &[u8]) -> Vec<u8> {
    [header.as_bytes(), voxels].concat()
}

pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub const VTK: &str = "# vtk DataFile Version 3.0
a title SPACE=RAS
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 double
0 0 0  100 0 0  0 100 0  0 0 100
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
POINT_DATA 4
SCALARS set_lower%20lip int 1
LOOKUP_TABLE default
0 1 0 1
VECTORS u_mm float
1 0 0 0 1 0 0 0 1 .5 .5 .5
FIELD FieldData 2
tag 1 4 long
5 5 6 6
temperature 1 4 double
1 2 3 4
CELL_DATA 1
SCALARS band unsigned_char
LOOKUP_TABLE default
2
";

fn binary_vtk() -> Vec<u8> {
    let mut bytes =
        b"# vtk DataFile Version 5.1\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
            .to_vec();
    let coordinates = TETRAHEDRON.as_flattened().iter();
    bytes.extend(coordinates.flat_map(|c| (*c as f32).to_be_bytes()));
    bytes.extend(b"\nCELLS 2 4\nOFFSETS vtktypeint64\n");
    bytes.extend([0_i64, 4].iter().flat_map(|v| v.to_be_bytes()));
    bytes.extend(b"\nCONNECTIVITY vtktypeint64\n");
    bytes.extend([0_i64, 1, 2, 3].iter().flat_map(|v| v.to_be_bytes()));
    bytes.extend(b"\nCELL_TYPES 1\n");
    bytes.extend(10_i32.to_be_bytes());
    bytes.extend(b"\nPOINT_DATA 4\nFIELD FieldData 1\nset_lip 1 4 short\n");
    bytes.extend([0_i16, 1, 0, 1].iter().flat_map(|v| v.to_be_bytes()));
    bytes.extend(b"\n");
    bytes
}

pub const GMSH_2: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 3 \"lower lip\"
3 8 \"fat\"
$EndPhysicalNames
$Nodes
4
1000000000000 0 0 0
7 100 0 0
-4 0 100 0
9 0 0 100
$EndNodes
$Elements
3
1 15 2 0 1 7
2 2 2 3 1 7 -4 9
3 4 2 8 1 1000000000000 7 -4 9
$EndElements
";

pub const GMSH_4: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
3 8 \"fat\"
$EndPhysicalNames
$Entities
0 0 1 1
5 0 0 0 1 1 1 1 4 0
6 0 0 0 1 1 1 2 8 2 1 5
$EndEntities
$Nodes
1 4 1 4
3 6 0 4
1
2
3
4
0 0 0
100 0 0
0 100 0
0 0 100
$EndNodes
$Elements
2 2 1 2
2 5 2 1
1 2 3 4
3 6 4 1
2 1 2 3 4
$EndElements
";

fn binary_gmsh() -> Vec<u8> {
    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n4\n");
    for (number, point) in (1_i32..).zip(TETRAHEDRON) {
        bytes.extend(number.to_le_bytes());
        bytes.extend(point.iter().flat_map(|c| c.to_le_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n1\n");
    let element = [4_i32, 1, 2, 1, 8, 1, 1, 2, 3, 4];
    bytes.extend(element.iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(b"\n$EndElements\n");
    bytes
}

pub const STL: &str = "solid skin SPACE=LPS
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 1e2 0 0
  vertex 0 100.5 -0
 endloop
endfacet
facet normal 0 0 1
 outer loop
  vertex 1e2 0 -0.0
  vertex 100 100 0
  vertex 0 100.5 0
 endloop
endfacet
endsolid skin
";

pub const PLY: &str = "ply\r
format ascii 1.0\r
comment made by hand, SPACE=LPS\r
element vertex 4\r
property list uchar int neighbours\r
property uchar red\r
property double z\r
property double y\r
property double x\r
property int node_id\r
element face 1\r
property uchar flags\r
property list uchar uint vertex_index\r
element edge 1\r
property int vertex1\r
property int vertex2\r
end_header\r
2 8 9 255 0 0 0 40\r
0 255 0 0 100 41\r
0 255 0 100 100 42\r
1 3 255 0 100 0 43\r
1 4 0 1 2 3\r
0 1\r
";

pub const OBJ: &str = "# SPACE=RAS
mtllib ../../../../etc/passwd
o someone
v 0 0 0
v 100 0 0 1.0
v 100 100 0 0.5 0.5 0.5
v 0 100 0
vt 0 0
vn 0 0 1
usemtl skin
f 1/1/1 2//1 3/1
f -4 -2 -1
l 1 2
";

/// A CT in LPS of a ball of soft tissue of radius 50 mm around (60, 60, 60), with a ball of bone of radius 30 mm around
/// (60, 55, 60) in it; voxels of 4 mm, their values mixed where a boundary crosses them.
pub fn ball_ct() -> Vec<u8> {
    ball_ct_with(|_| None)
}

/// The same with other values at some places.
pub fn ball_ct_with(other: impl Fn(mechanics::mesh::Vector) -> Option<i16>) -> Vec<u8> {
    use mechanics::image::{ImageVolume, Placement, Voxels};
    use mechanics::mesh::{Frame, Vector};
    let share = |depth: f64| (depth / 4.0 + 0.5).clamp(0.0, 1.0);
    let value = |number: usize| {
        let index = [number % 30, number / 30 % 30, number / 900];
        let at = Vector::from(index.map(|i| 4.0 * i as f64 + 2.0));
        let skin = share(50.0 - (at - Vector::repeat(60.0)).norm());
        let bone = share(30.0 - (at - Vector::new(60.0, 55.0, 60.0)).norm());
        other(at).unwrap_or((-1000.0 + 1040.0 * skin + 1160.0 * bone) as i16)
    };
    let placement = Placement {
        origin: Vector::repeat(2.0),
        steps: [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * 4.0),
    };
    let voxels = Voxels::I16((0..27_000).map(value).collect());
    let image = ImageVolume::new([30; 3], placement, voxels).unwrap();
    mechanics::format::nrrd::write(&image, Frame::Lps)
}

/// A ball in mm.
#[derive(Clone, Copy)]
pub struct SampleBall {
    pub centre: [f64; 3],
    pub radius: f64,
}

/// The balls of `ball_ct`.
pub const SKIN_BALL: SampleBall = SampleBall { centre: [60.0; 3], radius: 50.0 };
pub const BONE_BALL: SampleBall = SampleBall { centre: [60.0, 55.0, 60.0], radius: 30.0 };

/// The surface of a ball as text STL, of 40 rings of 80 triangles or less, within .2 % of its radius.
pub fn ball_stl(ball: SampleBall) -> Vec<u8> {
    const RINGS: usize = 40;
    let place = |ring: usize, step: usize| {
        let angle = |part: usize| part as f64 * std::f64::consts::PI / RINGS as f64;
        let ((sin, cos), (east, north)) = (angle(ring).sin_cos(), angle(2 * step).sin_cos());
        let [x, y, z] = [sin * north, sin * east, cos];
        let [a, b, c] = ball.centre;
        let at = [a + ball.radius * x, b + ball.radius * y, c + ball.radius * z];
        format!("vertex {:.6} {:.6} {:.6}\n", at[0], at[1], at[2])
    };
    let mut text = "solid ball\n".to_owned();
    for (ring, step) in (0..RINGS).flat_map(|ring| (0..RINGS).map(move |step| (ring, step))) {
        let next = (step + 1) % RINGS;
        let corners = [(ring, step), (ring + 1, step), (ring + 1, next), (ring, next)];
        let [a, b, c, d] = corners.map(|(ring, step)| place(ring, step));
        // At the poles one of the two is a line.
        for [p, q, r] in
            [[&a, &b, &c], [&a, &c, &d]].into_iter().filter(|[p, q, r]| q != r && p != r)
        {
            text += &format!("facet normal 0 0 0\nouter loop\n{p}{q}{r}endloop\nendfacet\n");
        }
    }
    text += "endsolid ball\n";
    text.into_bytes()
}

/// The balls of `ball_ct` as labels: 1 within 40 mm of the middle and 2 around it, 3 bone.
pub fn ball_labels() -> Vec<u8> {
    use mechanics::mesh::Vector;
    ball_ct_with(|at| {
        let depth = (at - Vector::repeat(60.0)).norm();
        Some(match (at - Vector::new(60.0, 55.0, 60.0)).norm() < 30.0 {
            true => 3,
            false if depth < 40.0 => 1,
            false if depth < 50.0 => 2,
            false => 0,
        })
    })
}
