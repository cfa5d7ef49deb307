"""Reads the files that facies wrote and compares them with their descriptions."""

import csv
import json
import re
import struct

import meshio
import numpy as np
import SimpleITK as sitk
import trimesh
import vtk
from vtk.util.numpy_support import vtk_to_numpy

VTK_TYPES = {"tet4": 10, "hex8": 12, "wedge6": 13}
MESHIO_TYPES = {"tet4": "tetra", "hex8": "hexahedron", "wedge6": "wedge"}
TO_GLTF = {
    "LPS": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "RAS": np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]]),
}

checks = 0


def same(what, wanted, found, dtype=float):
    global checks
    wanted, found = np.asarray(wanted, dtype), np.asarray(found, dtype)
    if wanted.shape != found.shape or not np.array_equal(wanted, found):
        raise SystemExit(f"{what}: wanted {wanted}, found {found}")
    checks += 1


def close(what, wanted, found, tolerance):
    global checks
    wanted, found = np.asarray(wanted, float), np.asarray(found, float)
    if wanted.shape != found.shape or not np.allclose(wanted, found, rtol=0, atol=tolerance):
        raise SystemExit(f"{what}: wanted {wanted}, found {found}")
    checks += 1


def members(names, size, prefix):
    """Sets as the arrays of zeros and ones that they are in the file."""
    arrays = {}
    for name, nodes in names.items():
        inside = np.zeros(size, int)
        inside[nodes] = 1
        arrays[prefix + name] = inside
    return arrays


def expected_arrays(wanted):
    points = dict(wanted.get("node_labels", {}))
    points.update(wanted.get("node_vectors", {}))
    points.update(members(wanted.get("node_sets", {}), len(wanted["points"]), "set_"))
    points.update(wanted.get("point_arrays", {}))
    if wanted.get("node_ids"):
        points["node_id"] = wanted["node_ids"]
    if wanted.get("colours"):
        points["colour_rgb"] = wanted["colours"]
    cells = dict(wanted.get("cell_labels", {}))
    cells.update(wanted.get("cell_vectors", {}))
    cells.update(members(wanted.get("cell_sets", {}), len(wanted.get("cells", [])), "elset_"))
    cells.update(wanted.get("cell_arrays", {}))
    return points, cells


def dtype_of(values):
    return np.int64 if np.issubdtype(np.asarray(values).dtype, np.integer) else float


def same_arrays(what, wanted, found):
    same(what + " names", sorted(wanted), sorted(found), str)
    for name, values in wanted.items():
        same(f"{what} {name}", values, found[name], dtype_of(values))


def vtk_read(reader, path):
    problems = []
    reader.AddObserver("ErrorEvent", lambda *_: problems.append("error"))
    reader.AddObserver("WarningEvent", lambda *_: problems.append("warning"))
    reader.SetFileName(str(path))
    reader.Update()
    if problems:
        raise SystemExit(f"{path.name}: vtk complains")
    return reader.GetOutput()


def vtk_arrays(attributes):
    arrays = (attributes.GetArray(number) for number in range(attributes.GetNumberOfArrays()))
    return {array.GetName(): vtk_to_numpy(array) for array in arrays}


def check_vtk(path, wanted, reader):
    name = f"{path.name} in vtk"
    data = vtk_read(reader, path)
    same(name, wanted["points"], vtk_to_numpy(data.GetPoints().GetData()))
    points, cells = expected_arrays(wanted)
    same_arrays(name, points, vtk_arrays(data.GetPointData()))
    same_arrays(name, cells, vtk_arrays(data.GetCellData()))
    fields = data.GetFieldData()
    if path.suffix == ".vtp":
        same(name, [wanted["frame"]], [fields.GetAbstractArray("SPACE").GetValue(0)], str)
    else:
        same(name, [True], [fields.HasArray(f"SPACE={wanted['frame']}")], bool)
    for field, text in wanted.get("field_data", {}).items():
        array = fields.GetAbstractArray(field)
        found = array.GetValue(0) if path.suffix == ".vtp" else bytes(vtk_to_numpy(array)).decode()
        same(name, [text], [found], str)
    listed = wanted["cells"] if "cells" in wanted else [["", t] for t in wanted["triangles"]]
    same(name, [len(listed)], [data.GetNumberOfCells()], int)
    for number, (shape, nodes) in enumerate(listed):
        cell = data.GetCell(number)
        same(name, [VTK_TYPES.get(shape, 5)], [cell.GetCellType()], int)
        ids = [cell.GetPointId(corner) for corner in range(cell.GetNumberOfPoints())]
        same(f"{name}, cell {number}", nodes, ids, int)


def check_meshio_vtu(path, wanted):
    name = f"{path.name} in meshio"
    mesh = meshio.read(path)
    same(name, wanted["points"], mesh.points)
    same(name, [True], [f"SPACE={wanted['frame']}" in mesh.field_data], bool)
    points, cells = expected_arrays(wanted)
    same_arrays(name, points, mesh.point_data)
    shapes = [cell for block in mesh.cells for cell in [block.type] * len(block.data)]
    nodes = [list(row) for block in mesh.cells for row in block.data]
    same(name, [MESHIO_TYPES[shape] for shape, _ in wanted["cells"]], shapes, str)
    for (shape, one), other in zip(wanted["cells"], nodes):
        # meshio takes every wedge of a VTK file to have its triangles the other way round.
        one = [one[node] for node in (0, 2, 1, 3, 5, 4)] if shape == "wedge6" else one
        same(name, one, other, int)
    found = {key: np.concatenate(blocks) for key, blocks in mesh.cell_data.items()}
    same_arrays(name, cells, found)


def space_mark(text):
    """What follows SPACE= in a header or a comment, up to a blank or a semicolon."""
    found = re.search(r"SPACE=([^\s;]+)", text)
    return found.group(1) if found else ""


def slicer_frame(path):
    """The frame that 3D Slicer takes a file for, as its vtkMRMLModelStorageNode finds it: a string array SPACE in the
    field data of XML files, a mark in the header of STL and in the comments of PLY; without any it is LPS."""
    match path.suffix:
        case ".vtu" | ".vtp":
            reader = (vtk.vtkXMLUnstructuredGridReader if path.suffix == ".vtu" else vtk.vtkXMLPolyDataReader)()
            array = vtk_read(reader, path).GetFieldData().GetAbstractArray("SPACE")
            mark = array.GetValue(0) if isinstance(array, vtk.vtkStringArray) else ""
        case ".stl":
            mark = space_mark(path.read_bytes()[:80].split(b"\0")[0].decode())
        case ".ply":
            head = path.read_bytes().split(b"end_header")[0].decode()
            mark = space_mark("\n".join(line for line in head.splitlines() if line.startswith("comment")))
    return "RAS" if mark == "RAS" else "LPS"


def in_lps(points, frame):
    return np.asarray(points) * ([-1, -1, 1] if frame == "RAS" else [1, 1, 1])


def check_slicer(path, wanted):
    """The patient's left is on the same side in 3D Slicer as in the case."""
    in_case = wanted.get("in_case", wanted)
    case = in_lps(in_case["points"], in_case["frame"])
    slicer = in_lps(read_points(path), slicer_frame(path))
    if path.suffix == ".stl":
        case = case[np.asarray(wanted["triangles"])].reshape(-1, 3)
    close(f"{path.name} in Slicer", case, slicer, 1e-4)


def read_points(path):
    if path.suffix == ".stl":
        return trimesh.load(path, process=False).triangles.reshape(-1, 3)
    readers = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".vtp": vtk.vtkXMLPolyDataReader, ".ply": vtk.vtkPLYReader}
    return vtk_to_numpy(vtk_read(readers[path.suffix](), path).GetPoints().GetData())


def corners_of(wanted):
    return np.asarray(wanted["points"])[np.asarray(wanted["triangles"])]


def check_stl(path, wanted):
    corners = corners_of(wanted).astype(np.float32).reshape(-1, 3)
    data = vtk_read(vtk.vtkSTLReader(), path)
    found = [data.GetPoint(data.GetCell(cell).GetPointId(corner))
             for cell in range(data.GetNumberOfCells()) for corner in range(3)]
    same(f"{path.name} in vtk", corners, found)
    loaded = trimesh.load(path, process=False)
    same(f"{path.name} in trimesh", corners, loaded.triangles.reshape(-1, 3))
    read = meshio.read(path)
    same(f"{path.name} in meshio", corners, read.points[read.cells[0].data].reshape(-1, 3))
    header = path.read_bytes()[:80]
    same(path.name, [True], [f"SPACE={wanted['frame']}".encode() in header], bool)


def check_ply(path, wanted):
    data = vtk_read(vtk.vtkPLYReader(), path)
    close(f"{path.name} in vtk", wanted["points"], vtk_to_numpy(data.GetPoints().GetData()), 1e-4)
    same(path.name, wanted["colours"], vtk_to_numpy(data.GetPointData().GetArray("RGB")), int)
    loaded = trimesh.load(path, process=False)
    same(f"{path.name} in trimesh", wanted["points"], loaded.vertices)
    same(f"{path.name} in trimesh", wanted["triangles"], loaded.faces, int)
    same(f"{path.name} in trimesh", wanted["colours"], loaded.visual.vertex_colors[:, :3], int)
    read = meshio.read(path)
    same(f"{path.name} in meshio", wanted["points"], read.points)
    same(f"{path.name} in meshio", wanted["triangles"], read.cells[0].data, int)
    same(f"{path.name} in meshio", wanted["node_ids"], read.point_data["node_id"], int)
    for array, values in wanted["point_arrays"].items():
        values = np.asarray(values)
        for axis, column in enumerate("xyz" if values.ndim == 2 else [""]):
            key = f"{array}_{column}" if column else array
            part = values[:, axis] if column else values
            same(f"{path.name} {key}", part, read.point_data[key])
    head = path.read_bytes().split(b"end_header")[0]
    same(path.name, [True], [f"comment SPACE={wanted['frame']}\n".encode() in head], bool)


def check_glb(path, wanted):
    data = path.read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    same(path.name, [b"glTF", 2, len(data)], [magic, version, length], object)
    json_bytes, kind = struct.unpack("<I4s", data[12:20])
    same(path.name, [0, b"JSON"], [json_bytes % 4, kind], object)
    scene = json.loads(data[20 : 20 + json_bytes])
    for extras in (scene["extras"], scene["nodes"][0]["extras"]):
        same(path.name, [wanted["frame"], "mm"], [extras["frame"], extras["units"]], str)
    metres = np.asarray(wanted["points"]) @ TO_GLTF[wanted["frame"]].T / 1000
    bounds = scene["accessors"][1]
    stored = metres.astype(np.float32)
    same(path.name, stored.min(0), np.asarray(bounds["min"], np.float32))
    same(path.name, stored.max(0), np.asarray(bounds["max"], np.float32))

    mesh = next(iter(trimesh.load(path, process=False).geometry.values()))
    close(f"{path.name} in trimesh", metres, mesh.vertices, 1e-7)
    same(f"{path.name} in trimesh", wanted["triangles"], mesh.faces, int)
    matrix = np.reshape(scene["extras"]["matrix4x4_to_case_row_major"], (4, 4))
    back = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    # 32 bits of 0.1 m are 1e-8 m.
    close(f"{path.name} back in the case", wanted["points"], back, 1e-4)
    normals = np.asarray(mesh.vertex_normals)
    close(f"{path.name} normals", np.ones(len(normals)), np.linalg.norm(normals, axis=1), 1e-6)
    srgb = np.asarray(wanted["colours"]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    close(f"{path.name} colours", linear, colours_of(scene, data[28 + json_bytes :]), 1e-6)

    imported = vtk.vtkGLTFReader()
    imported.SetFileName(str(path))
    imported.Update()
    blocks = imported.GetOutput()
    same(f"{path.name} in vtk", [len(metres)], [blocks.GetNumberOfPoints()], int)


def colours_of(scene, binary):
    accessor = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    view = scene["bufferViews"][accessor["bufferView"]]
    part = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    return np.frombuffer(part, "<f4").reshape(-1, 3)


def check_csv(path, wanted):
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    same(path.name, ["node_id", "x_mm", "y_mm", "z_mm", "ux_mm", "uy_mm", "uz_mm",
                     "displacement_magnitude_mm", "side"], header, str)
    table = np.array(rows, float)
    arrays = wanted["point_arrays"]
    columns = [np.reshape(wanted["node_ids"], (-1, 1)), wanted["points"], arrays["displacement_mm"],
               np.reshape(arrays["displacement_magnitude_mm"], (-1, 1)), np.reshape(arrays["side"], (-1, 1))]
    same(path.name, np.hstack(columns), table)


def check_transform(path, wanted):
    """ITK's rule: a transform takes a point of the resampled image to where its value comes from."""
    transform = sitk.ReadTransform(str(path))
    for place, moved in zip(wanted["places"], wanted["moved"]):
        close(f"{path.name} in ITK", place, transform.TransformPoint(moved), 1e-12)
        close(f"{path.name} turned round in ITK", moved, transform.GetInverse().TransformPoint(place), 1e-12)
        close(f"what {path.name} resamples", moved, brightest(sitk.Resample(image_at(place), transform)), 0.05)


def image_at(place):
    """A spot of 2 mm in an image of 1 mm voxels."""
    origin = [-60.0, -55.0, -60.0]
    spot = sitk.GaussianImageSource()
    spot.SetOutputPixelType(sitk.sitkFloat64)
    spot.SetSize([121, 111, 121])
    spot.SetOrigin(origin)
    spot.SetSigma([2.0] * 3)
    # ITK measures its mean from the origin of space, as it does all places.
    spot.SetMean(place)
    return spot.Execute()


def brightest(image):
    """The middle of what an image holds, in space."""
    values = sitk.GetArrayFromImage(image)
    places = np.indices(values.shape).reshape(3, -1)[::-1]
    middle = (places * values.ravel()).sum(axis=1) / values.sum()
    return image.TransformContinuousIndexToPhysicalPoint(middle.tolist())


def check_matrix(path, wanted):
    same(path.name, np.reshape(wanted["matrix4x4"], (4, 4)), np.loadtxt(path))


def check_all(folder):
    files = 0
    for description in sorted(folder.glob("*.json")):
        wanted = json.loads(description.read_text())
        for path in sorted(folder.glob(description.stem + ".*")):
            if path.suffix in (".vtu", ".vtp", ".stl", ".ply"):
                check_slicer(path, wanted)
            match path.suffix:
                case ".vtu":
                    check_vtk(path, wanted, vtk.vtkXMLUnstructuredGridReader())
                    check_meshio_vtu(path, wanted)
                case ".vtp":
                    check_vtk(path, wanted, vtk.vtkXMLPolyDataReader())
                case ".stl":
                    check_stl(path, wanted)
                case ".ply":
                    check_ply(path, wanted)
                case ".glb":
                    check_glb(path, wanted)
                case ".csv":
                    check_csv(path, wanted)
                case ".tfm":
                    check_transform(path, wanted)
                case ".txt":
                    check_matrix(path, wanted)
                case ".json":
                    continue
                case other:
                    raise SystemExit(f"{path.name}: nothing reads {other}")
            files += 1
    if files < 10:
        raise SystemExit(f"only {files} files to check")
    print(f"{files} files of facies read back, {checks} comparisons")
