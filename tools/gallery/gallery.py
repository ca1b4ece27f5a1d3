"""gallery.py PICTURES OUT: renders the pictures of docs/gallery.md from what the examples have written below PICTURES; every file
of them, also by the Fortran twins, can be read."""

import shutil
import sys
from pathlib import Path

import matplotlib.pyplot as plot
import numpy as np
import pyvista
from matplotlib.collections import LineCollection, PolyCollection
from PIL import Image

pyvista.OFF_SCREEN = True
STRESS, PRESSURE = "turbo", "inferno_r"
LINE, QUAD = 3, 9
plot.rcParams.update({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False})


def save(image, path):
    """With a palette, of which the bars of colours get their share."""
    image.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE).save(path, optimize=True)
    print("picture", path)


def save_figure(figure, path):
    figure.savefig(path, dpi=110, facecolor="white", bbox_inches="tight")
    save(Image.open(path), path)
    plot.close(figure)


def polygons(grid, kind, scale=0.0):
    """Corners of the cells of one kind in the plane, displaced by so much of u."""
    points = grid.points[:, :2] + (scale * grid["displacement"][:, :2] if scale else 0.0)
    return points[grid.cells_dict[kind]]


def hertz(pictures, out):
    """Pressure of the faces, above the stress of both bodies, whose displacements are drawn as they are."""
    grid = pyvista.read(pictures / "hertz_cylinder.vtu")
    lines, quads = polygons(grid, LINE), polygons(grid, QUAD, 1.0)
    is_line, is_quad = grid.celltypes == LINE, grid.celltypes == QUAD
    pressure = grid.cell_data["pressure"][is_line]
    figure, (above, field) = plot.subplots(2, 1, figsize=(7.2, 6.6), sharex=True, height_ratios=[1, 2.6], layout="constrained")
    x = np.linspace(-0.5, 0.5, 201)
    middles = lines[:, :, 0].mean(axis=1)
    near = abs(middles) < 0.8
    above.bar(middles[near], pressure[near], np.abs(np.diff(lines[:, :, 0], axis=1)).ravel()[near], color="#e8a33d", label="computed")
    above.plot(x, 2884.6 * np.sqrt(1 - (x / 0.5) ** 2), color="#1f3f78", label="Hertz")
    above.set_ylabel("contact pressure / MPa")
    above.legend(frameon=False, loc="upper left")
    drawn = PolyCollection(quads, array=grid.cell_data["von_mises"][is_quad], cmap=STRESS, edgecolors="#00000030", linewidths=0.3)
    field.add_collection(drawn)
    field.set(xlim=(-1.2, 1.2), ylim=(-1.0, 0.75), aspect="equal", xlabel="x / mm", ylabel="y / mm")
    figure.colorbar(drawn, ax=field, label="von Mises stress / MPa", shrink=0.9)
    save_figure(figure, out / "gallery_hertz.png")


def cattaneo(pictures, out):
    """Stress below the contact and states of the surface while the push grows and turns."""
    steps = {0: "pressed, Q = 0", 2: "push Q = 0.6 µP", 3: "push Q = 0.9 µP", 7: "back: Q = -0.9 µP"}
    colours = {0: "#bbbbbb", 1: "#1f5fa8", 2: "#c03a1d"}
    figure, axes = plot.subplots(2, 2, figsize=(8.6, 5.4), sharex=True, sharey=True, layout="constrained")
    for axis, (step, title) in zip(axes.flat, steps.items()):
        grid = pyvista.read(pictures / f"cattaneo_mindlin_{step}.vtu")
        drawn = PolyCollection(polygons(grid, QUAD), array=grid.cell_data["von_mises"][grid.celltypes == QUAD], cmap=STRESS, clim=(0, 360))
        axis.add_collection(drawn)
        upper = (grid.celltypes == LINE) & (grid.cell_data["body"] == 1)
        state, pressure = grid.cell_data["friction"][upper], grid.cell_data["pressure"][upper]
        lines = polygons(grid, LINE)[: upper.sum()]
        for number, colour in colours.items():
            chosen = lines[state == number]
            axis.add_collection(LineCollection(chosen + [0, 0.03], colors=colour, linewidths=5))
        x = lines[:, :, 0].mean(axis=1)
        axis.fill_between(x, 0.07, 0.07 + pressure / 1600, color="#e8a33d", linewidth=0)
        axis.set(xlim=(-1.4, 1.4), ylim=(-1.2, 0.5), aspect="equal", title=title)
    for axis in axes[1]:
        axis.set_xlabel("x / mm")
    for axis in axes[:, 0]:
        axis.set_ylabel("y / mm")
    figure.colorbar(drawn, ax=axes, label="von Mises stress / MPa", shrink=0.8)
    marks = [plot.Line2D([], [], color=colours[k], linewidth=5, label=name) for k, name in ((1, "sticks"), (2, "slips"), (0, "open"))]
    marks.append(plot.Line2D([], [], color="#e8a33d", linewidth=5, label="pressure, 577 MPa at most"))
    figure.legend(handles=marks, loc="outside lower center", ncols=4, frameon=False)
    save_figure(figure, out / "gallery_cattaneo_mindlin.png")


def sliding(pictures, out):
    """Two blocks as they are in three steps; an arrow ends at each node of the foot, the force on it."""
    figure, axes = plot.subplots(3, 1, figsize=(8.6, 8.4), sharex=True, sharey=True, layout="constrained")
    for axis, (step, title) in zip(axes, {0: "pressed by 0.25 mm", 3: "pushed along by 7.5 mm", 6: "pushed along by 15 mm"}.items()):
        grid = pyvista.read(pictures / f"sliding_blocks_{step}.vtu")
        stress = grid.cell_data["von_mises"][grid.celltypes == QUAD]
        drawn = PolyCollection(polygons(grid, QUAD, 1.0), array=stress, cmap=STRESS, clim=(0, 35), edgecolors="#00000040", linewidths=0.4)
        axis.add_collection(drawn)
        state = grid["contact"]
        at, force = [vectors[state > 0, :2] for vectors in (grid.points + grid["displacement"], grid["contact_force"])]
        axis.quiver(*at.T, *force.T, pivot="tip", angles="xy", scale_units="xy", scale=7, width=0.0025)
        title += f": of {sum(state >= 0)} nodes of the foot {sum(state == 2)} stick, {sum(state == 3)} slip"
        axis.set(xlim=(-0.5, 40.5), ylim=(-0.5, 14.5), aspect="equal", title=title, ylabel="y / mm")
    axes[-1].set_xlabel("x / mm")
    figure.colorbar(drawn, ax=axes, label="von Mises stress / MPa", shrink=0.6)
    save_figure(figure, out / "gallery_sliding.png")


class View:
    """One view of solids, off screen."""

    def __init__(self):
        self.plotter = pyvista.Plotter(window_size=(1100, 1000))
        self.plotter.set_background("white")

    def solid(self, cells, **look):
        """The surface of cells; edges of quadratic ones are drawn straight."""
        surface = cells.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=0)
        self.plotter.add_mesh(surface, show_edges=True, show_scalar_bar=False, ambient=0.4, diffuse=0.6, line_width=1, **look)

    def image(self, position, focus, zoom):
        self.plotter.camera_position = [position, focus, (0, 0, 1)]
        self.plotter.enable_parallel_projection()
        self.plotter.camera.zoom(zoom)
        image = self.plotter.screenshot(return_img=True)
        self.plotter.close()
        drawn = (image < 250).any(axis=2)
        rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
        return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def side_by_side(views, path):
    """Images with a title, and with a bar where there is a quantity: (image, title, name with unit, colours, largest value)."""
    figure, axes = plot.subplots(1, len(views), figsize=(10.4, 5.4), layout="constrained")
    for axis, (image, title, name, colours, top) in zip(axes, views):
        axis.imshow(image, interpolation="antialiased")
        axis.set_title(title, fontsize=11)
        axis.set_axis_off()
        if name:
            figure.colorbar(plot.cm.ScalarMappable(plot.Normalize(0, top), colours), ax=axis, location="bottom", shrink=0.6, aspect=30, pad=0.02, label=name)
    save_figure(figure, path)


GREY = {"color": "#e3e6ea", "edge_color": "#5f666f"}


def three_bodies(pictures, out):
    """The deformed bodies with their stress; the bodies apart, with the pressure of each pair on the body below."""
    grid = pyvista.read(pictures / "three_bodies.vtu")
    is_solid = np.isin(grid.celltypes, (12, 24, 25))
    left, right = View(), View()
    moved = grid.warp_by_vector("displacement", factor=100)
    left.solid(moved.extract_cells(is_solid), scalars="von_mises", cmap=STRESS, clim=(0, 150), edge_color="#333333", lighting=False)
    for body, lift in ((1, 0), (2, 3), (3, 6)):
        own = grid.cell_data["body"] == body
        right.solid(grid.extract_cells(is_solid & own).translate((0, 0, lift)), **GREY)
        if body > 1:
            below = grid.extract_cells(~is_solid & own).translate((0, 0, lift - 2.97))
            right.solid(below, scalars="pressure", cmap=PRESSURE, clim=(0, 130), edge_color="#9aa0a8", lighting=False)
    views = [
        (left.image((24, -30, 20), (0, 0, 0.2), 1.25), "deformed, displacements x 100", "von Mises stress / MPa", STRESS, 150),
        (right.image((24, -30, 26), (0, 0, 3.0), 1.2), "moved apart", "contact pressure / MPa", PRESSURE, 130),
    ]
    side_by_side(views, out / "gallery_three_bodies.png")


def pieces(pictures, out):
    """The pieces of the cut block apart; the block with the pressure of the obstacle, turned over."""
    grid = pyvista.read(pictures / "block_in_pieces.vtu")
    is_solid = grid.celltypes == 12
    left, right = View(), View()
    colours = ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2", "#edc948", "#b07aa1", "#9c755f"]
    for piece in range(8):
        part = grid.extract_cells(is_solid & (grid.cell_data["piece"] == piece))
        left.solid(part.translate(0.25 * (np.array(part.center) - 0.5)), color=colours[piece], edge_color="#333333")
    moved = grid.warp_by_vector("displacement", factor=500).rotate_x(180, point=(0.5, 0.5, 0.5))
    right.solid(moved.extract_cells(is_solid), **GREY)
    right.solid(moved.extract_cells(~is_solid).translate((0, 0, 0.005)), scalars="pressure", cmap=PRESSURE, clim=(0, 16), edge_color="#9aa0a8", lighting=False)
    views = [
        (left.image((2.6, -3.2, 2.4), (0.5, 0.5, 0.5), 1.15), "eight pieces, drawn apart", None, None, None),
        (right.image((2.6, -3.2, 2.4), (0.5, 0.5, 0.5), 1.15), "turned over, displacements x 500", "contact pressure / MPa", PRESSURE, 16),
    ]
    side_by_side(views, out / "gallery_pieces.png")


def main(pictures, out):
    out.mkdir(parents=True, exist_ok=True)
    for file in [*pictures.glob("*.vtu"), *pictures.glob("*.pvd")]:
        read = pyvista.get_reader(file).read()
        assert read.n_blocks if file.suffix == ".pvd" else read.n_cells, file
    for draw in (hertz, three_bodies, cattaneo, sliding, pieces):
        draw(pictures, out)
    shutil.copyfile(pictures / "cattaneo_mindlin_shear.svg", out / "gallery_shear.svg")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
