"""pictures.py FOLDER: the VTK pictures below FOLDER as meshio reads them: cells, bodies, stresses, and what the contact does.
Twins in C and in Fortran have the same numbers; every step of a .pvd file is there. Where displacements are large, pressures act on displaced
faces and stresses are Cauchy's."""

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
    **{f"newton_loop_{k}": ({"quad": 96, "line": 22}, 1, None, None, None) for k in range(2)},
    **{f"block_between_dies_{k}": ({"quad": 192, "line": 48}, 1, None, None, None) for k in range(5)},
    **{f"sliding_blocks_{k}": ({"quad": 328, "line": 16}, 2, None, None, None) for k in range(7)},
}
FILMS = ("cattaneo_mindlin", "newton_loop", "block_between_dies", "sliding_blocks")
LARGE = FILMS[1:]
YOUNG, POISSON, MU = 1000.0, 0.3, 0.3  # of the large ones
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
    large = name.startswith(LARGE)
    at = grid.points + grid.point_data["displacement"] if large else grid.points
    total = covered = 0.0
    for k, block in enumerate(grid.cells):
        pressure = np.ravel(grid.cell_data["pressure"][k])
        von_mises = np.ravel(grid.cell_data["von_mises"][k]) if "von_mises" in grid.cell_data else np.where(np.isnan(pressure), 0.0, math.nan)
        face = block.type in FACES or (name == "block_in_pieces" and block.type == "quad")
        assert np.isnan(von_mises).all() == face and np.isnan(pressure).all() != face, (name, block.type)
        if face:
            assert pressure.min() >= -1e-6 * pressure.max()
            covered += areas(at, block.data, block.type).sum()
            total += (pressure * areas(at, block.data, block.type)).sum()
        elif large and "von_mises" in grid.cell_data:
            assert np.allclose(von_mises, cauchy(grid.points[block.data], at[block.data]), rtol=0, atol=1e-5 * von_mises.max()), name
    assert area is None or math.isclose(covered, area, rel_tol=1e-6), covered
    assert force is None or math.isclose(total, force, rel_tol=1e-4), total
    assert stress is None or math.isclose(np.nanmax(cells_of(grid, "von_mises")), stress[0], rel_tol=stress[1]), name
    if name == "block_in_pieces":
        piece = cells_of(grid, "piece")
        assert sorted(set(piece)) == list(range(-1, 8)) and np.bincount(piece[piece >= 0]).min() >= 100, np.bincount(piece + 1)
    if name.startswith("cattaneo"):
        assert set(cells_of(grid, "friction")) <= {-1, 0, 1, 2, 3}
    else:
        contact(name, grid, total)


def cauchy(rest, now):
    """Von Mises stress in the middle of quadrilaterals, plane strain: Cauchy's of the material of St. Venant and Kirchhoff."""
    sides = [np.stack([x[:, 1] + x[:, 2] - x[:, 0] - x[:, 3], x[:, 2] + x[:, 3] - x[:, 0] - x[:, 1]], axis=-1)[:, :2] for x in (rest, now)]
    F = np.tile(np.eye(3), (len(rest), 1, 1))
    F[:, :2, :2] = sides[1] @ np.linalg.inv(sides[0])
    E, G = (F.transpose(0, 2, 1) @ F - np.eye(3)) / 2, YOUNG / (2 * (1 + POISSON))
    S = 2 * G * (E + POISSON / (1 - 2 * POISSON) * np.trace(E, axis1=1, axis2=2)[:, None, None] * np.eye(3))
    stress = F @ S @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
    s = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (s**2).sum(axis=(1, 2)))


def contact(name, grid, total):
    """Gaps and forces by the state of a node."""
    data = grid.point_data
    state, gap, force = np.ravel(data["contact"]), np.ravel(data["gap"]), data["contact_force"]
    if name.startswith("sliding"):  # closed nodes stick (2) or slip (3); the force of those that slip is mu times the push, along
        assert set(state) <= {OPEN, 2, 3, NONE}, set(state)
        along = np.linalg.norm(force[state >= 0], axis=1).sum() / total
        assert 1 <= along <= math.hypot(1, MU) * (1 + 1e-6) and (name[-1] != "6" or along >= math.hypot(1, MU) * (1 - 1e-6)), along
        state = np.where(state > 0, CLOSED, state)
    assert set(state) <= {OPEN, CLOSED, WEAK, NONE} and {OPEN, CLOSED, NONE} <= set(state), set(state)
    assert (np.isnan(gap) == (state == NONE)).all()
    moved = np.abs(data["displacement"]).max()
    assert np.abs(gap[state == CLOSED]).max() <= 1e-6 * moved and gap[state == OPEN].min() >= -1e-6 * moved
    assert (np.linalg.norm(force[state == CLOSED], axis=1) > 0).all()
    if name == "block_in_pieces":  # a rigid obstacle: faces beside the clamp have a force on one side only
        assert 0.9 * force.sum() <= total <= force.sum() * (1 + 1e-6) and force.min() >= 0, (force.sum(), total)
    elif name.startswith(LARGE[:2]):  # rigid dies without friction
        assert math.isclose(np.linalg.norm(force, axis=1).sum(), total, rel_tol=1e-6)
    else:  # each row acts on two bodies
        assert np.abs(force.sum(axis=0)).max() <= 1e-8 * np.abs(force).sum()


def main(folder):
    for name in PICTURES:
        stem, _, step = name.rpartition("_") if name.startswith(FILMS) else (name, "", "")
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
    assert len(films) == 2 * len(FILMS), films
    for film in films:
        steps = [entry.get("file") for entry in xml.parse(film).iter("DataSet")]
        assert len(steps) == sum(name.startswith(film.stem.removesuffix("_fortran")) for name in PICTURES) and all((film.parent / step).is_file() for step in steps), film


main(sys.argv[1])
