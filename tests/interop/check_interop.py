"""Proof that other programs read what facies writes, and files of theirs for facies to read.

check FOLDER: reads every file in FOLDER with vtk, meshio, trimesh or SimpleITK and compares it with
              the JSON description beside it.
write FOLDER: writes one mesh and one surface in every encoding that vtk and meshio know, transforms
              by SimpleITK, and list.json and movements.json with what facies should find in each.
"""

import sys
from pathlib import Path

import reading
import writing

if __name__ == "__main__":
    command, folder = sys.argv[1], Path(sys.argv[2])
    {"check": reading.check_all, "write": writing.write_all}[command](folder)
