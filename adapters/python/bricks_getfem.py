"""GetFEM: a round foot pressed on a block and moved aside, in the plane, by GetFEM's own contact brick and by the library.

Bilinear quadrilaterals whose meshes do not match; the top of the upper block is moved down and aside. The reference is the nodal brick between
nonmatching meshes (augmented Lagrangian): a condition for each node of the foot, as FETI_NODE_TO_FACE has. Forces of nodes have to agree

    without friction:   to the tolerance of the Newton loop of GetFEM
    with friction:      to gap times rotation of the face, relative to the slip: the tangential rows of the library contain it, so that a motion
                        which both bodies share is no slip; the brick leaves it out. A foot ten times flatter, moved a tenth: a tenth of it"""

import sys

import getfem as gf
import numpy as np
from scipy.sparse import csc_matrix

import feti_contact as fc

gf.util("trace level", 0)

YOUNG, POISSON, FRICTION = 1000.0, 0.3, 0.2  # MPa, -, -
ROUND, DOWN, ASIDE = 0.1, 0.05, 0.01  # mm: how far the rim of the foot is above its middle; way of the top
FOOT, FLOOR, TOP, BOTTOM = 1, 2, 3, 4  # regions of the meshes


def meshes(size):
    """Upper block of 4 x 2 mm with a round foot, lower block of 6 x 3 mm. `size` of the roundness, 1: as above."""
    high = gf.Mesh("cartesian", np.linspace(-2, 2, 41), np.linspace(0, 2, 15))
    low = gf.Mesh("cartesian", np.linspace(-3, 3, 46), np.linspace(-3, 0, 21))
    for mesh, up, region in ((high, 1, TOP), (high, -1, FOOT), (low, 1, FLOOR), (low, -1, BOTTOM)):
        mesh.set_region(region, mesh.outer_faces_with_direction([0.0, up], 0.1))
    x, y = high.pts()
    high.set_pts(np.vstack([x, y + size * ROUND * x**2 / 4 * (1 - y / 2)]))
    return high, low


def model(size, aside):
    """Elasticity without supports and contact; of each block: name of u, mesh, mesh_fem, mesh_im, unknowns that are moved, by how much."""
    (high, low), md = meshes(size), gf.Model("real")
    shear, lame = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    md.add_initialized_data("lame", [lame])
    md.add_initialized_data("shear", [shear])
    md.add_initialized_data("way", [aside, -size * DOWN])
    md.add_initialized_data("none", [0.0, 0.0])
    parts = []
    for name, mesh, region, way in (("u1", high, TOP, "way"), ("u2", low, BOTTOM, "none")):
        mf, mim = gf.MeshFem(mesh, 2), gf.MeshIm(mesh, 4)
        mf.set_classical_fem(1)
        md.add_fem_variable(name, mf)
        md.add_isotropic_linearized_elasticity_brick(mim, name, "lame", "shear")
        parts.append((name, mesh, mf, mim, mf.basic_dof_on_region(region), md.get("variable", way)))
    return md, parts


def by_brick(md, parts, friction):
    """Normal and tangential forces of the nodes of the foot, N, by GetFEM."""
    for (name, _, mf, mim, _, _), region, way in zip(parts, (TOP, BOTTOM), ("way", "none")):
        md.add_Dirichlet_condition_with_multipliers(mim, name, mf, region, way)
    md.add_initialized_data("r", [YOUNG])
    md.add_initialized_data("mu", [friction])
    names = ["normal", "tangential", "r", "mu", "mu"] if friction else ["normal", "r"]  # 5.4.2 reads one name more than its pages have
    md.add_nodal_contact_between_nonmatching_meshes_brick(parts[0][3], parts[1][3], "u1", "u2", *names, FOOT, FLOOR)
    md.solve("max_res", 1e-10, "max_iter", 100)
    normal = -md.variable("normal")
    return normal, -md.variable("tangential") if friction else 0 * normal


# ---- what an owner of a program with GetFEM writes, from here ...
def by_library(md, parts, friction):
    """The same by the library, from the matrix of the model; last its facts on the solve."""
    p, surfaces = fc.Problem(), []
    md.assembly("build_matrix")
    pointers, rows = md.tangent_matrix().csc_ind()
    whole = csc_matrix((md.tangent_matrix().csc_val(), rows, pointers)).tocsr()
    for (name, mesh, mf, _, held, way), region in zip(parts, (FOOT, FLOOR)):
        first, n = md.interval_of_variable(name)
        k = whole[first : first + n, first : first + n]
        u, free = np.zeros(n), np.setdiff1d(np.arange(n), held)
        u[held] = np.tile(way, len(held) // 2)
        number = np.full(n, -1, dtype=np.int32)  # of an unknown in the matrix of the body; -1: moved as prescribed
        number[free] = np.arange(free.size)
        body = p.add_body(k[free][:, free], load=-(k @ u)[free])

        x, of_point = np.ascontiguousarray(mesh.pts().T), np.empty((mesh.nbpts(), 2), int)
        of_point[mesh.pid_from_cvid()[0]] = mf.basic_dof_from_cvid()[0].reshape(-1, 2)  # unknowns of each point of the mesh
        cells, sides = mesh.region(region)
        faces = np.array([mesh.pid_in_faces([[c], [s]]) for c, s in zip(cells, sides)])
        inside = np.array([mesh.pts_from_cvid(c)[0].mean(axis=1) for c in cells])
        surface = body.surface(x, number[of_point], fc.outward(faces, x, inside))
        surfaces.append((surface, np.array(sorted(np.unique(faces), key=lambda node: of_point[node, 0]))))  # in the order of GetFEM
    (slave, foot), (master, _) = surfaces
    pair = p.add_pair(slave, master, distance=4 * DOWN, method="node_to_face", friction=friction)
    p.find_pairs()
    info, force, shear, area = p.solve(), *map(pair.field, ("force", "shear", "area"))
    return force[foot], (shear[:, 0] * area)[foot], info


# ---- ... to here
def difference(size, friction):
    """Largest difference of a force of a node, relative to the largest normal force; `size` of roundness and motion."""
    md, parts = model(size, size * ASIDE if friction else 0.0)
    normal, tangential, info = by_library(md, parts, friction)
    reference = by_brick(md, parts, friction)
    worst = max(np.abs(normal - reference[0]).max(), np.abs(tangential - reference[1]).max()) / normal.max()
    print(f"  friction {friction}, size {size:<4}: N = {normal.sum():.6f}, T = {tangential.sum():.6f} N in {info.active} nodes;", end=" ")
    print(f"GetFEM {reference[0].sum():.6f}, {reference[1].sum():.6f} N; a node differs by {worst:.1e}")
    return worst if info.status == 0 and info.worst <= 1 else np.inf


def main():
    without, large, small = difference(1, 0.0), difference(0.1, FRICTION), difference(0.01, FRICTION)
    good = without < 1e-9 and large < 0.02 and 8 < large / small < 12
    print("bricks_getfem", "ok" if good else "FAILED")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
