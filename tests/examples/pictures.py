"""pictures.py FOLDER: the VTK pictures below FOLDER as meshio reads them: cells, bodies, undeformed places, and what the contact does.
Twins in C and in Fortran have the same numbers."""

import math
import sys
from pathlib import Path

import meshio
import numpy as np

OPEN, CLOSED, WEAK, NONE = 0, 1, 2, -1
# Cells by kind, bodies, undeformed size along each axis; resultant of the contact force on the highest body along the axis of the load.
PICTURES = {
    "hertz_cylinder": ({"quad"}, 2, None, (1, 2265.6)),
    "three_bodies": ({"vertex", "hexahedron", "hexahedron20"}, 3, [10.0, 10.0, None], None),
    "block_in_pieces": ({"hexahedron"}, 1, [1.0, 1.0, 1.0], None),
}


def check(name, grid):
    kinds, bodies, size, load = PICTURES[name]
    data = grid.point_data
    assert {block.type for block in grid.cells} == kinds, grid.cells
    numbers = np.concatenate([np.ravel(part) for part in grid.cell_data["body"]])
    assert sorted(set(numbers)) == list(range(1, bodies + 1)), set(numbers)
    assert all(block.data.min() >= 0 and block.data.max() < len(grid.points) for block in grid.cells)
    for k, length in enumerate(size or []):
        assert length is None or math.isclose(np.ptp(grid.points[:, k]), length, rel_tol=1e-9), np.ptp(grid.points, axis=0)
    for field in ("displacement", "contact_force"):
        assert data[field].shape == grid.points.shape and np.isfinite(data[field]).all() and np.abs(data[field]).max() > 0, field
    if name != "block_in_pieces":
        contact(grid, data)
    if load:
        axis, force = load
        first = {node for block, body in zip(grid.cells, grid.cell_data["body"]) for node in block.data[np.ravel(body) == 1].ravel()}
        resultant = data["contact_force"][sorted(first), axis].sum()
        assert math.isclose(abs(resultant), force, rel_tol=1e-4), resultant
    return data


def contact(grid, data):
    """Pressure and gap by the state of a node; one of them is 0 to the accuracy of the answer."""
    state, pressure, gap = np.ravel(data["contact"]), np.ravel(data["pressure"]), np.ravel(data["gap"])
    assert set(state) <= {OPEN, CLOSED, WEAK, NONE} and {OPEN, CLOSED, NONE} <= set(state), set(state)
    assert (np.isnan(gap) == (state == NONE)).all() and (pressure[state == NONE] == 0).all()
    assert (pressure[state == CLOSED] > 0).all() and pressure[state == OPEN].max() <= 1e-6 * pressure.max()
    moved = np.abs(data["displacement"]).max()
    assert np.abs(gap[state == CLOSED]).max() <= 1e-6 * moved and gap[state == OPEN].min() >= -1e-6 * moved
    # Forces on the bodies are in balance: each row acts on two of them.
    force = data["contact_force"]
    assert np.abs(force.sum(axis=0)).max() <= 1e-8 * np.abs(force).sum()


def main(folder):
    for name in PICTURES:
        paths = [sorted(Path(folder).rglob(f"{name}{ending}.vtu")) for ending in ("", "_fortran")]
        assert [len(found) for found in paths] == [1, 1], f"pictures of {name}: {paths}"
        grids = [meshio.read(found[0]) for found in paths]
        c, fortran = [check(name, grid) for grid in grids]
        assert sorted(c) == sorted(fortran), (sorted(c), sorted(fortran))
        assert np.allclose(grids[0].points, grids[1].points, rtol=0, atol=1e-8 * np.abs(grids[0].points).max())
        for one, other in zip(grids[0].cells, grids[1].cells, strict=True):
            assert one.type == other.type and (one.data == other.data).all(), name
        for field, values in c.items():
            size = np.nanmax(np.abs(values))
            # A sample of an area may go to either of two nodes.
            assert np.allclose(values, fortran[field], rtol=0, atol=(1e-3 if field == "pressure" else 1e-6) * size, equal_nan=True), (name, field)


main(sys.argv[1])
