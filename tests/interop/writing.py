"""Writes one mesh and one surface in every encoding that vtk and meshio know, and transforms of ITK.

All numbers are multiples of a quarter, so that text and 32 bits hold them exactly.
"""

import itertools
import json

import meshio
import numpy as np
import SimpleITK as sitk
import vtk
from vtk.util.numpy_support import numpy_to_vtk

POINTS = np.array([
    [0, 0, 0], [90.25, 0, 0], [90.25, 80.5, 0], [0, 80.5, 0],
    [0, 0, 70], [90.25, 0, 70], [90.25, 80.5, 70], [0, 80.5, 70.75],
    [45, 0, 120.5], [45, 80.5, 120], [45, -60, 71],
])  # fmt: skip
HEX, WEDGE, TET = [0, 1, 2, 3, 4, 5, 6, 7], [4, 8, 5, 7, 9, 6], [4, 10, 5, 8]
LABELS = np.array([1, 1, 1, 1, 5, 0, 0, 0, 7, 7, 3])
JAW = np.array([1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1])
VECTORS = POINTS[:, ::-1] / 4
BAND = np.array([4, 0, 120])
FAT = np.array([0, 1, 1])
FIBRES = np.array([[1, 0, 0], [0, 0.5, 0], [0.25, 0, 0.75]])
SCALARS = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"]

SIDE = 5
GRID = np.array([[x * 20.25, y * 20.25, (x * y) % 3 * 5.5] for y in range(SIDE) for x in range(SIDE)])
TRIANGLES = np.array([
    triangle
    for y in range(SIDE - 1) for x in range(SIDE - 1)
    for a in [y * SIDE + x]
    for triangle in ([a, a + 1, a + SIDE + 1], [a, a + SIDE + 1, a + SIDE])
])  # fmt: skip
NODE_IDS = np.arange(len(GRID)) * 3 + 100

files = []


def note(folder, file, mesh, tolerance=0.0):
    if not (folder / file).exists():
        raise SystemExit(f"{file} was not written")
    files.append({"file": file, "mesh": mesh, "tolerance": tolerance})


def plain(values):
    return np.asarray(values).tolist()


def volume(frame=None, labels=None):
    return {
        "frame": frame,
        "points": plain(POINTS.astype(float)),
        "cells": [["hex8", HEX], ["wedge6", WEDGE], ["tet4", TET]],
        "node_sets": {"jaw left": plain(np.flatnonzero(JAW))},
        "cell_sets": {"fat": plain(np.flatnonzero(FAT))},
        "node_labels": labels or {"tag": plain(LABELS)},
        "cell_labels": {"band": plain(BAND)},
        "node_vectors": {"u_mm": plain(VECTORS)},
        "cell_vectors": {"fibre": plain(FIBRES)},
    }


def surface(frame=None, node_ids=None):
    return {
        "frame": frame,
        "points": plain(GRID),
        "triangles": plain(TRIANGLES),
        "node_ids": node_ids,
    }


def welded(frame=None):
    """Points in the order in which the triangles name them, as STL gives them."""
    order = list(dict.fromkeys(TRIANGLES.flatten().tolist()))
    number = {point: index for index, point in enumerate(order)}
    return {
        "frame": frame,
        "points": plain(GRID[order]),
        "triangles": [[number[corner] for corner in triangle] for triangle in TRIANGLES.tolist()],
    }


def add(attributes, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    attributes.AddArray(array)


def add_space(data, text):
    array = vtk.vtkStringArray()
    array.SetName("SPACE")
    array.InsertNextValue(text)
    data.GetFieldData().AddArray(array)


def vtk_points(points, dtype):
    result = vtk.vtkPoints()
    result.SetData(numpy_to_vtk(points.astype(dtype), deep=True))
    return result


def vtk_grid(dtype=float):
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(vtk_points(POINTS, dtype))
    for kind, nodes in ((12, HEX), (13, WEDGE), (10, TET)):
        grid.InsertNextCell(kind, len(nodes), nodes)
    add(grid.GetPointData(), "set_jaw left", JAW.astype(np.uint8))
    for scalar in SCALARS:
        add(grid.GetPointData(), scalar, LABELS.astype(scalar))
    add(grid.GetPointData(), "u_mm", VECTORS.astype(np.float32))
    add(grid.GetPointData(), "temperature", VECTORS[:, 0].copy())
    add(grid.GetPointData(), "pairs", np.zeros((len(POINTS), 2), np.int32))
    add(grid.GetCellData(), "band", BAND.astype(np.int16))
    add(grid.GetCellData(), "elset_fat", FAT.astype(np.uint8))
    add(grid.GetCellData(), "fibre", FIBRES)
    add(grid.GetCellData(), "det_f", np.array([1.0, 0.5, 0.25]))
    return grid


def vtk_surface(dtype=float):
    data = vtk.vtkPolyData()
    data.SetPoints(vtk_points(GRID, dtype))
    cells = vtk.vtkCellArray()
    for triangle in TRIANGLES:
        cells.InsertNextCell(3, triangle.tolist())
    data.SetPolys(cells)
    add(data.GetPointData(), "node_id", NODE_IDS.astype(np.int64))
    add(data.GetPointData(), "displacement_mm", GRID / 4)
    add(data.GetCellData(), "quality", np.zeros(len(TRIANGLES)))
    return data


def write_vtk(writer, data, path):
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    if writer.Write() != 1:
        raise SystemExit(f"vtk did not write {path.name}")


def write_vtk_xml(folder):
    modes = {"ascii": 0, "binary": 1, "appended_raw": 2, "appended_base64": 2}
    labels = {scalar: plain(LABELS) for scalar in SCALARS}
    encodings = itertools.product(modes, ("none", "zlib"), (32, 64), ("little", "big"), ("f4", "f8"))
    for mode, compressor, header, order, dtype in encodings:
        stem = f"vtk_{mode}_{compressor}_{header}_{order}_{dtype}"
        for kind in ("vtu", "vtp"):
            writer = vtk.vtkXMLUnstructuredGridWriter() if kind == "vtu" else vtk.vtkXMLPolyDataWriter()
            writer.SetDataMode(modes[mode])
            writer.SetEncodeAppendedData(mode == "appended_base64")
            writer.SetCompressorTypeToZLib() if compressor == "zlib" else writer.SetCompressorTypeToNone()
            writer.SetHeaderTypeToUInt32() if header == 32 else writer.SetHeaderTypeToUInt64()
            writer.SetByteOrderToLittleEndian() if order == "little" else writer.SetByteOrderToBigEndian()
            # Small blocks, so that arrays have several and a last one that is not full.
            writer.SetBlockSize(48)
            data = vtk_grid(dtype) if kind == "vtu" else vtk_surface(dtype)
            add_space(data, "LPS" if header == 32 else "SPACE=RAS")
            write_vtk(writer, data, folder / f"{stem}.{kind}")
            frame = "LPS" if header == 32 else "RAS"
            expected = volume(frame, labels) if kind == "vtu" else surface(frame, plain(NODE_IDS))
            note(folder, f"{stem}.{kind}", expected)


def write_vtk_legacy(folder):
    labels = {scalar: plain(LABELS) for scalar in SCALARS}
    for version, binary, dtype in itertools.product((42, 51), (False, True), ("f4", "f8")):
        stem = f"legacy_{version}_{'binary' if binary else 'ascii'}_{dtype}"
        for kind in ("grid", "surface"):
            is_grid = kind == "grid"
            writer = vtk.vtkUnstructuredGridWriter() if is_grid else vtk.vtkPolyDataWriter()
            writer.SetFileVersion(version)
            writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
            data = vtk_grid(dtype) if is_grid else vtk_surface(dtype)
            if version == 42:
                writer.SetHeader("3D Slicer output. SPACE=RAS")
            else:
                add_space(data, "RAS")
            if is_grid:
                data.GetPointData().SetActiveScalars("int32")
                data.GetPointData().SetActiveVectors("u_mm")
                data.GetCellData().SetActiveScalars("band")
            write_vtk(writer, data, folder / f"{stem}_{kind}.vtk")
            expected = volume("RAS", labels) if is_grid else surface("RAS", plain(NODE_IDS))
            note(folder, f"{stem}_{kind}.vtk", expected)


def write_vtk_surfaces(folder):
    data = vtk_surface()
    for binary in (False, True):
        writer = vtk.vtkSTLWriter()
        writer.SetHeader("3D Slicer output. SPACE=LPS" if binary else "SPACE=LPS")
        writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        name = f"vtk_{'binary' if binary else 'ascii'}.stl"
        write_vtk(writer, data, folder / name)
        note(folder, name, welded("LPS"))
    for binary, order in ((False, 0), (True, 0), (True, 1)):
        writer = vtk.vtkPLYWriter()
        writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
        writer.SetDataByteOrder(order)
        writer.AddComment("SPACE=RAS")
        name = f"vtk_{'binary' if binary else 'ascii'}_{order}.ply"
        write_vtk(writer, data, folder / name)
        note(folder, name, surface("RAS"))
    write_vtk(vtk.vtkOBJWriter(), data, folder / "vtk.obj")
    note(folder, "vtk.obj", surface())


def meshio_volume():
    return meshio.Mesh(
        POINTS.astype(float),
        [("hexahedron", [HEX]), ("wedge", [WEDGE]), ("tetra", [TET])],
        point_data={"set_jaw left": JAW, "tag": LABELS, "u_mm": VECTORS},
        cell_data={
            "band": [BAND[i : i + 1] for i in range(3)],
            "elset_fat": [FAT[i : i + 1] for i in range(3)],
            "fibre": [FIBRES[i : i + 1] for i in range(3)],
        },
    )


def write_meshio_volumes(folder):
    for number, options in enumerate(({"binary": False}, {"compression": None}, {"compression": "zlib"})):
        name = f"meshio_{number}.vtu"
        meshio.write(folder / name, meshio_volume(), **options)
        note(folder, name, volume())
    for version, binary in itertools.product(("vtk42", "vtk51"), (False, True)):
        name = f"meshio_{version}_{binary}.vtk"
        mesh = meshio_volume()
        # meshio's legacy names must not hold a space.
        mesh.point_data["set_jaw%20left"] = mesh.point_data.pop("set_jaw left")
        meshio.write(folder / name, mesh, file_format=version, binary=binary)
        note(folder, name, volume())


def write_meshio_gmsh(folder):
    groups = [BAND[i : i + 1] + 1 for i in range(3)]
    mesh = meshio.Mesh(
        POINTS.astype(float),
        [("hexahedron", [HEX]), ("wedge", [WEDGE]), ("tetra", [TET]), ("triangle", [[0, 1, 2]])],
        cell_data={
            "gmsh:physical": [*groups, np.array([9])],
            "gmsh:geometrical": [*groups, np.array([9])],
        },
        field_data={"fat": np.array([5, 3]), "lower lip": np.array([9, 2])},
    )
    expected = volume()
    expected["node_sets"] = {"lower lip": [0, 1, 2]}
    expected["cell_sets"] = {"fat": [0], "physical_3_1": [1], "physical_3_121": [2]}
    expected["cell_labels"] = {"gmsh:physical": [5, 1, 121]}
    expected["node_labels"] = expected["node_vectors"] = expected["cell_vectors"] = {}
    for binary in (False, True):
        name = f"meshio_gmsh22_{binary}.msh"
        meshio.write(folder / name, mesh, file_format="gmsh22", binary=binary)
        note(folder, name, expected)
    # Version 4.1 lists nodes by the entity they lie on; these keep their order.
    owners = [[2, 9]] * 3 + [[3, 1]] * 3 + [[3, 5]] * 3 + [[3, 121]] * 2
    mesh.point_data["gmsh:dim_tags"] = np.array(owners)
    for binary in (False, True):
        name = f"meshio_gmsh41_{binary}.msh"
        meshio.write(folder / name, mesh, file_format="gmsh", binary=binary)
        note(folder, name, expected)


def write_meshio_surfaces(folder):
    mesh = meshio.Mesh(GRID, [("triangle", TRIANGLES)])
    for binary in (False, True):
        meshio.write(folder / f"meshio_{binary}.stl", mesh, binary=binary)
        note(folder, f"meshio_{binary}.stl", welded())
        meshio.write(folder / f"meshio_{binary}.ply", mesh, binary=binary)
        note(folder, f"meshio_{binary}.ply", surface())
    for name in ("meshio.obj", "meshio_surface.vtu"):
        meshio.write(folder / name, mesh)
        note(folder, name, surface())


def write_transforms(folder):
    """A turn and a shift of ITK, whose way resampling goes: the movement of bone leads back."""
    turn = sitk.Euler3DTransform([0.0] * 3, 0.1, -0.2, 0.3, [4.0, -3.0, 2.0])
    listed = []
    for name, centre in (("origin", [0.0] * 3), ("centre", [5.0, 60.0, -7.0])):
        transform = sitk.AffineTransform(turn.GetMatrix(), turn.GetTranslation(), centre)
        for suffix in ("tfm", "txt"):
            file = f"itk_{name}.{suffix}"
            sitk.WriteTransform(transform, str(folder / file))
            moved = [[10.0, -12.0, 20.0], [-31.0, 4.5, -7.0], [0.0, 0.0, 0.0]]
            places = [transform.TransformPoint(at) for at in moved]
            listed.append({"file": file, "places": places, "moved": moved})
    (folder / "movements.json").write_text(json.dumps(listed))


def write_all(folder):
    folder.mkdir(parents=True, exist_ok=True)
    write_vtk_xml(folder)
    write_vtk_legacy(folder)
    write_vtk_surfaces(folder)
    write_meshio_volumes(folder)
    write_meshio_gmsh(folder)
    write_meshio_surfaces(folder)
    write_transforms(folder)
    (folder / "list.json").write_text(json.dumps(files))
    print(f"{len(files)} files written for facies")
