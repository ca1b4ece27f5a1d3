"""pictures.py FOLDER: the VTK pictures below FOLDER as meshio reads them: cells, bodies, stresses, and what the contact does.
Twins in C and in Fortran have the same numbers; every step of a .pvd file is there."""

import math
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import meshio
import numpy as np

OPEN, CLOSED, WEAK, NONE = 0, 1, 2, -1
# Cells by kind (elements, faces in contact), bodies, area of the faces, their force, the largest von Mises stress and how near.
# Hertz in plane strain, nu = .3: .5576 p0 in a half plane; the finite block adds a lateral stress of some P / (pi h) (h = 10 mm).
HERTZ = 0.5576
PICTURES = {
    "hertz_cylinder": ({"quad": 8430, "line": 88}, 2, None, 2265.571625, (HERTZ * 2884.6, 0.06)),
    "three_bodies": ({"hexahedron": 300, "tetra10": 691, "hexahedron20": 75, "triangle6": 118, "quad8": 25}, 3, 52.0, 1280.0, None),
    "block_in_pieces": ({"hexahedron": 1000, "quad": 90}, 1, 0.9, None, None),
    **{f"cattaneo_mindlin_{k}": ({"line": 800, "quad": 3000}, 2, 6.0, 2 * 906.23, (HERTZ * 576.923, 1e-3) if k == 0 else None) for k in range(12)},
}
FACES = {"line", "triangle6", "quad8"}


def cells_of(grid, name):
    """Numbers of all cells in their order."""
    return np.concatenate([np.ravel(part) for part in grid.cell_data[name]])


def areas(points, cells, kind):
    x = points[cells]
    if kind == "line":
        return np.linalg.norm(x[:, 1] - x[:, 0], axis=1)
    sides = (x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) if kind == "triangle6" else (x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    return np.linalg.norm(np.cross(*sides), axis=1) / 2


def check(name, grid):
    kinds, bodies, area, force, stress = PICTURES[name]
    assert {block.type: len(block.data) for block in grid.cells} == kinds, grid.cells
    assert sorted(set(cells_of(grid, "body"))) == list(range(1, bodies + 1))
    assert all(block.data.min() >= 0 and block.data.max() < len(grid.points) for block in grid.cells)
    total = covered = 0.0
    for block, pressure, von_mises in zip(grid.cells, grid.cell_data["pressure"], grid.cell_data["von_mises"]):
        pressure, von_mises = np.ravel(pressure), np.ravel(von_mises)
        face = block.type in FACES or (name == "block_in_pieces" and block.type == "quad")
        assert np.isnan(von_mises).all() == face and np.isnan(pressure).all() != face, (name, block.type)
        if face:
            assert pressure.min() >= -1e-6 * pressure.max()
            covered += areas(grid.points, block.data, block.type).sum()
            total += (pressure * areas(grid.points, block.data, block.type)).sum()
    assert area is None or math.isclose(covered, area, rel_tol=1e-6), covered
    assert force is None or math.isclose(total, force, rel_tol=1e-4), total
    largest = np.nanmax(cells_of(grid, "von_mises"))
    assert stress is None or math.isclose(largest, stress[0], rel_tol=stress[1]), largest
    if name == "block_in_pieces":
        piece = cells_of(grid, "piece")
        assert sorted(set(piece)) == list(range(-1, 8)) and np.bincount(piece[piece >= 0]).min() >= 100, np.bincount(piece + 1)
    if name.startswith("cattaneo"):
        assert set(cells_of(grid, "friction")) <= {-1, 0, 1, 2, 3}
    else:
        contact(name, grid, total)


def contact(name, grid, total):
    """Gaps and forces by the state of a node."""
    data = grid.point_data
    state, gap, force = np.ravel(data["contact"]), np.ravel(data["gap"]), data["contact_force"]
    assert set(state) <= {OPEN, CLOSED, WEAK, NONE} and {OPEN, CLOSED, NONE} <= set(state), set(state)
    assert (np.isnan(gap) == (state == NONE)).all()
    moved = np.abs(data["displacement"]).max()
    assert np.abs(gap[state == CLOSED]).max() <= 1e-6 * moved and gap[state == OPEN].min() >= -1e-6 * moved
    assert (np.linalg.norm(force[state == CLOSED], axis=1) > 0).all()
    if name == "block_in_pieces":  # a rigid obstacle: faces beside the clamp have a force on one side only
        assert 0.9 * force.sum() <= total <= force.sum() * (1 + 1e-6) and force.min() >= 0, (force.sum(), total)
    else:  # each row acts on two bodies
        assert np.abs(force.sum(axis=0)).max() <= 1e-8 * np.abs(force).sum()


def main(folder):
    for name in PICTURES:
        stem, _, step = name.rpartition("_") if name.startswith("cattaneo") else (name, "", "")
        paths = [sorted(Path(folder).rglob(f"{stem}{ending}{'_' + step if step else ''}.vtu")) for ending in ("", "_fortran")]
        assert [len(found) for found in paths] == [1, 1], f"pictures of {name}: {paths}"
        one, other = [meshio.read(found[0]) for found in paths]
        check(name, one)
        assert np.allclose(one.points, other.points, rtol=0, atol=1e-8 * np.abs(one.points).max())
        for mine, its in zip(one.cells, other.cells, strict=True):
            assert mine.type == its.type and (mine.data == its.data).all(), name
        for fields, others in ((one.point_data, other.point_data), ({k: cells_of(one, k) for k in one.cell_data}, {k: cells_of(other, k) for k in other.cell_data})):
            assert sorted(fields) == sorted(others), (sorted(fields), sorted(others))
            for field, values in fields.items():
                size = np.nanmax(np.abs(values))
                assert np.allclose(values, others[field], rtol=0, atol=1e-6 * size, equal_nan=True), (name, field)
    films = sorted(Path(folder).rglob("*.pvd"))
    assert len(films) == 2, films
    for film in films:
        steps = [entry.get("file") for entry in xml.parse(film).iter("DataSet")]
        assert len(steps) == 12 and all((film.parent / step).is_file() for step in steps), film


main(sys.argv[1])
