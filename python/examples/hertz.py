"""A cylinder pressed on a block, plane strain, meshes of scikit-fem that do not match, mortar; pressures against Hertz. MPa, mm, N."""
import numpy as np
import skfem
import feti_contact as fc
from skfem.models.elasticity import lame_parameters, linear_elasticity

E, NU, R, A, SIDE = 1000.0, 0.3, 100.0, 1.0, 12.0  # A: half width of the contact
LOAD = np.pi * A**2 * E / (2 * (1 - NU**2)) / (4 * R)
PEAK = 2 * LOAD / (np.pi * A)


def add(p, h, up):
    """A block with corners h apart in the contact, then further apart; the foot of the upper one is round, the lower one is held."""
    fine, coarse = np.arange(0, 1.5 * A + h / 2, h), np.cumsum(1.4 ** np.arange(1, 12))
    line = np.append(fine, fine[-1] + coarse / coarse[-1] * (SIDE - fine[-1]))
    mesh = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(np.append(-line[:0:-1], line), line if up else -line[::-1]))
    contact = mesh.facets_satisfying(lambda x: np.isclose(x[1], 0), boundaries_only=True)
    top = mesh.facets_satisfying(lambda x: np.isclose(x[1], SIDE), boundaries_only=True)
    if up:
        mesh = mesh.morphed(None, lambda x: x[1] + x[0] ** 2 / (2 * R) * (1 - x[1] / SIDE))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()))
    f = skfem.LinearForm(lambda v, _: -LOAD / (2 * SIDE) * v[1]).assemble(basis.boundary(top)) if up else basis.zeros()
    held = np.array([], dtype=int) if up else basis.get_dofs(lambda x: np.isclose(x[1], -SIDE)).all()
    k, f, _, free = skfem.condense(linear_elasticity(*lame_parameters(E, NU)).assemble(basis), f, D=held)
    number = np.full(basis.N, -1)
    number[free] = np.arange(free.size)  # of an unknown in K; -1: held
    nodes = np.hstack([basis.nodal_dofs, basis.facet_dofs])  # corners, then mid nodes
    x = basis.doflocs[:, nodes[0]].T
    faces = np.vstack([mesh.facets[:, contact], mesh.nvertices + contact]).T
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, contact]]].mean(axis=1).T
    return p.add_body(k, load=f).surface(x, number[nodes].T, fc.outward(faces, x, inside)), x


p = fc.Problem()
(slave, x), (master, _) = add(p, 0.1 * A, True), add(p, 0.125 * A, False)
pair, _ = p.add_pair(slave, master, distance=A), p.find_pairs()
info, pressure = p.solve(), pair.field("pressure")
near = np.abs(x[:, 0]) < 0.9 * A
worst = np.abs(pressure - PEAK * np.sqrt(np.maximum(1 - (x[:, 0] / A) ** 2, 0)))[near & (pressure > 0)].max() / PEAK
print(f"{info.dofs} unknowns, force {pair.info.force[1]:.6f} N of {LOAD:.6f} N, peak {pressure.max():.4f} MPa, Hertz {PEAK:.4f}, within .9 a {100 * worst:.2f} %")
