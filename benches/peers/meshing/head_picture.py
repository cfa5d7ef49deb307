"""A predicted head in four views, skin over bone with its cuts, classes of nodes, before and after: head_picture.py RESULT OUTPUT.png

RESULT is the folder of `facies predict --scan … --plan … --out RESULT`. Needs pyvista.
"""

import sys

import numpy as np
import pyvista


def panel(plotter, column, title, surfaces):
    plotter.subplot(0, column)
    plotter.add_text(title, position=(0.02, 0.93), viewport=True, font_size=8, color="black")
    for surface, look in surfaces:
        plotter.add_mesh(surface, smooth_shading=surface.n_cells != surface.n_points, **look)
    middle = surfaces[0][0].center
    plotter.camera_position = [np.add(middle, (-330, -330, 60)), middle, (0, 0, 1)]
    plotter.camera.zoom(1.12)


def before(surface):
    """Files hold the positions after."""
    back = surface.copy()
    back.points = surface.points - surface["displacement_mm"]
    return back


# Of nodes on bone: those that a segment takes along, that slide on it, that are held, and that are free beside cuts.
CLASSES = {"maxilla": "#c98a3b", "mandible": "#4f7fae", "sliding_maxilla": "#e8d04c", "sliding_mandible": "#63c5da", "fixed": "#8f8f8f"}


def classes(volume):
    """The nodes of each class as points."""
    looks = []
    for name, colour in CLASSES.items():
        nodes = volume.points[volume.point_data[f"set_{name}"] > 0]
        looks.append((pyvista.PolyData(nodes), {"color": colour, "point_size": 4 if name == "fixed" else 6, "render_points_as_spheres": True}))
    return looks


def main():
    folder, output = sys.argv[1:]
    skin, bones = (pyvista.read(f"{folder}/{name}.vtp") for name in ("skin", "bones"))
    volume = pyvista.read(f"{folder}/mesh/volume.vtu")
    bone = {"scalars": "segment", "cmap": ["#c98a3b", "#4f7fae"], "show_scalar_bar": False}
    far = {"scalars": "displacement_magnitude_mm", "cmap": "viridis", "clim": (0, 5)}
    far["scalar_bar_args"] = {"title": "mm", "n_labels": 3, "color": "black", "width": 0.4, "position_x": 0.5, "position_y": 0.02, "label_font_size": 10, "title_font_size": 10}
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 4), window_size=(1480, 430), border=False)
    plotter.set_background("white")
    flesh = {"color": "#e3b79a"}
    panel(plotter, 0, "segments between their cuts", [(before(skin), {**flesh, "opacity": 0.25}), (before(bones), bone)])
    panel(plotter, 1, "nodes: joined, sliding (light), held (grey)", [(before(skin), {**flesh, "opacity": 0.1}), *classes(volume)])
    panel(plotter, 2, "before", [(before(skin), flesh)])
    panel(plotter, 3, "after, by displacement", [(skin, far)])
    plotter.screenshot(output)


if __name__ == "__main__":
    main()
