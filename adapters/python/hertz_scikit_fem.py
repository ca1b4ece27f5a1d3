"""scikit-fem: a cylinder on a block, plane strain, elements of 8 nodes, by mortar; pressure and half width against Hertz.

Two blocks 24 half widths wide and 12 high; the foot of the upper one has the radius R, and a load presses it on the lower one. Their meshes do not
match. Nothing holds the upper block but the contact. Known, for half planes:

    a^2 = 4 P R / (pi E'),   p(x) = p0 sqrt(1 - (x/a)^2),   p0 = 2 P / (pi a),   E' = E / (2 (1 - nu^2))

p0 and a are read off the straight line through p^2 over x^2, of the nodes within .9 a."""

import sys

import numpy as np
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

import feti_contact as fc

YOUNG, POISSON, RADIUS, HALF_WIDTH, SIDE = 1000.0, 0.3, 100.0, 1.0, 12.0  # MPa, -, mm, mm, mm
STIFF = YOUNG / (2 * (1 - POISSON**2))
LOAD = np.pi * HALF_WIDTH**2 * STIFF / (4 * RADIUS)  # N, of 1 mm of thickness
PEAK = 2 * LOAD / (np.pi * HALF_WIDTH)  # MPa


@skfem.LinearForm
def weight(v, _):
    return -LOAD / (2 * SIDE) * v[1]


def block(h, up):
    """A block with corners `h` apart in the contact, then further and further: basis of elements with 8 nodes, facets in the contact."""
    fine = np.arange(0, 1.5 * HALF_WIDTH + h / 2, h)
    coarse = np.cumsum(1.4 ** np.arange(1, 12))
    line = np.append(fine, fine[-1] + coarse / coarse[-1] * (SIDE - fine[-1]))
    mesh = skfem.MeshQuad.init_tensor(np.append(-line[:0:-1], line), line if up else -line[::-1])
    mesh = skfem.MeshQuad2.from_mesh(mesh)
    contact = mesh.facets_satisfying(lambda x: np.isclose(x[1], 0), boundaries_only=True)
    if up:  # the foot is a parabola, and so are the edges on it
        mesh = mesh.morphed(None, lambda x: x[1] + x[0] ** 2 / (2 * RADIUS) * (1 - x[1] / SIDE))
    return skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2())), contact


def add_body(p, basis, stiffness, load, held, contact):
    """Gives the library K and f without the unknowns `held`, and the facets `contact` as a surface."""
    # ---- what an owner of a program with scikit-fem writes, from here ...
    k, f, _, free = skfem.condense(stiffness, load, D=held)
    body = p.add_body(k, load=f)

    mesh, number = basis.mesh, np.full(basis.N, -1, dtype=np.int32)
    number[free] = np.arange(free.size)  # of an unknown in K; -1: held
    nodes = np.hstack([basis.nodal_dofs, basis.facet_dofs])  # (2, nodes): unknowns of the corners, then of the mid nodes
    x = basis.doflocs[:, nodes[0]].T  # (nodes, 2), mm
    faces = np.vstack([mesh.facets[:, contact], mesh.nvertices + contact]).T
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, contact]]].mean(axis=1).T
    return body.surface(x, number[nodes].T, fc.outward(faces, x, inside)), x


def solve(bodies):
    """Pressure of each node of the first body (slave), its place, and what the library says of the pair and the solve."""
    p = fc.Problem()
    (slave, x), (master, _) = [add_body(p, *body) for body in bodies]
    pair = p.add_pair(slave, master, distance=HALF_WIDTH)
    p.find_pairs()
    info, pressure = p.solve(), pair.field("pressure")
    # ---- ... to here
    return x, pressure, pair.info, info


def main():
    bodies = []
    for h, up in ((0.1, True), (0.125, False)):
        basis, contact = block(h * HALF_WIDTH, up)
        stiffness = linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis)
        top = basis.mesh.facets_satisfying(lambda x: np.isclose(x[1], SIDE), boundaries_only=True)
        bottom = basis.get_dofs(lambda x: np.isclose(x[1], -SIDE)).all()
        load = weight.assemble(basis.boundary(top)) if up else basis.zeros()
        bodies.append((basis, stiffness, load, np.array([], dtype=int) if up else bottom, contact))
    x, pressure, facts, info = solve(bodies)

    near = (np.abs(x[:, 0]) < 0.9 * HALF_WIDTH) & (pressure > 0)
    slope, start = np.polyfit(x[near, 0] ** 2, pressure[near] ** 2, 1)
    peak, half_width = np.sqrt(start), np.sqrt(-start / slope)
    worst = np.abs(pressure[near] - PEAK * np.sqrt(1 - (x[near, 0] / HALF_WIDTH) ** 2)).max() / PEAK
    force = abs(facts.force[1] / LOAD - 1)
    print(f"  {info.dofs} unknowns, {info.rows} contact rows, {info.active} closed; certificate {info.worst:.1e} of its limit")
    print(f"  peak {peak:.4f} MPa, Hertz {PEAK:.4f}: {100 * (peak / PEAK - 1):+.2f} %;", end=" ")
    print(f"half width {half_width:.4f} mm: {100 * (half_width / HALF_WIDTH - 1):+.2f} %")
    print(f"  nodes within .9 a: {100 * worst:.2f} % of the peak at most; resultant against load {force:.0e}")
    good = info.status == 0 and info.worst <= 1 and force < 1e-9 and abs(peak / PEAK - 1) < 0.01 and abs(half_width / HALF_WIDTH - 1) < 0.01
    print("hertz_scikit_fem", "ok" if good else f"FAILED, status {info.status}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
