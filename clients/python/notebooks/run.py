"""Runs the notebooks beside this file against the service at FACIES_ADDRESS; with what they say, they are written to a folder."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

out = Path(sys.argv[1])
for path in sorted(Path(__file__).parent.glob("*.ipynb")):
    notebook = nbformat.read(path, as_version=4)
    # In this folder, the one that `examples` is in; a cell that fails ends the run with what it said.
    NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": "."}}).execute()
    nbformat.write(notebook, out / path.name)
    print(f"{path.name}: {sum(cell.cell_type == 'code' for cell in notebook.cells)} cells")
