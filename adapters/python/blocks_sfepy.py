"""SfePy: a block pressed on another one, then pushed along it with friction, in space, by node-to-face; against three sums known by hand.

Hexahedra; the meshes do not match; nothing holds the upper block but the contact. Known, with the weight N on it and a push Q from the side:

    Q = 0, .6 mu N, .99 mu N:   the block rests; the forces on its foot are (-Q, 0, N)
    Q = 1.01 mu N:              no forces within the law of friction balance the load"""

import sys

import numpy as np
from sfepy.base.base import output

output.set_output(quiet=True)  # before the modules that report what is not installed
from sfepy.discrete import Equation, Equations, FieldVariable, Integral, Material, Problem
from sfepy.discrete.conditions import Conditions, EssentialBC
from sfepy.discrete.fem import FEDomain, Field, Mesh
from sfepy.mechanics.matcoefs import stiffness_from_youngpoisson
from sfepy.mesh.mesh_generators import gen_block_mesh
from sfepy.terms import Term

import feti_contact as fc

YOUNG, POISSON, FRICTION = 1000.0, 0.3, 0.3  # MPa, -, -
WEIGHT, WIDE = 8.0, 2.0  # N, mm: edges of the upper block, 1 mm high


def two_blocks():
    """The lower block is 4 x 4 x 2 mm and has its top at z = 0."""
    low = gen_block_mesh([4, 4, 2], [10, 10, 6], [0, 0, -1], verbose=False)
    high = gen_block_mesh([WIDE, WIDE, 1], [9, 9, 5], [0, 0, 0.5], verbose=False)
    corners = np.vstack([low.get_conn("3_8"), high.get_conn("3_8") + low.n_nod])
    part = np.repeat([0, 1], [low.n_el, high.n_el])
    return FEDomain("blocks", Mesh.from_data("blocks", np.vstack([low.coors, high.coors]), None, [corners], [part], ["3_8"]))


def problem(domain, push):
    """K u = f with u = 0 at the bottom; push[0]: load from the side, N per mm^2, which the caller may change."""
    region, whole = domain.create_region, domain.create_region("Omega", "all")
    region("Upper", "cells of group 1")
    top, side = region("Top", "vertices in z > 0.999", "facet"), region("Side", "vertices in x < -0.999 *v r.Upper", "facet")
    field = Field.from_args("displacement", np.float64, "vector", whole, approx_order=1)
    u, integral = FieldVariable("u", "unknown", field), Integral("i", order=2)
    v = FieldVariable("v", "test", field, primary_var_name="u")
    solid = Material("solid", D=stiffness_from_youngpoisson(3, YOUNG, POISSON))
    press = Material("press", val=[[0.0], [0.0], [-WEIGHT / WIDE**2]])

    def side_load(ts, x, mode=None, **_):
        return {"val": np.tile([[push[0]], [0.0], [0.0]], (len(x), 1, 1))} if mode == "qp" else None

    pushed = Material("push", kind="time-dependent", function=side_load)
    terms = Term.new("dw_lin_elastic(solid.D, v, u)", integral, whole, solid=solid, v=v, u=u)
    terms -= Term.new("dw_surface_ltr(press.val, v)", integral, top, press=press, v=v)
    terms -= Term.new("dw_surface_ltr(push.val, v)", integral, side, push=pushed, v=v)
    pb = Problem("blocks", equations=Equations([Equation("balance", terms)]))
    bottom = region("Bottom", "vertices in z < -1.999", "facet")
    pb.set_bcs(ebcs=Conditions([EssentialBC("bottom", bottom, {"u.all": 0.0})]))
    pb.time_update()
    pb.get_initial_state()
    pb.update_materials()
    return pb


# ---- what an owner of a program with SfePy writes, from here ...
def add_surface(body, domain, region, number):
    """Gives the library the facets of a region; `number` (nodes, 3): unknown in K, below 0 where held."""
    mesh, facets = domain.cmesh, region.facets
    mesh.setup_connectivity(2, 0), mesh.setup_connectivity(2, 3)
    faces = mesh.get_incident(0, facets, 2).reshape(len(facets), 4).astype(np.int32)
    inside = mesh.get_centroids(3)[mesh.get_incident(3, facets, 2)]  # a facet of a surface has one element
    return body.surface(mesh.coors, number, fc.outward(faces, mesh.coors, inside))


class Contact:
    """SfePy has K and the residual, the library finds the increment of u."""

    def __init__(self, pb, slave, master):
        self.pb, self.evaluator, self.p = pb, pb.get_evaluator(), fc.Problem()
        numbers = pb.get_variables()["u"].eq_map  # .eq: unknown in K, below 0 where held
        self.u = np.zeros(numbers.n_eq)
        body = self.p.add_body(self.evaluator.eval_tangent_matrix(self.u))  # one K for both blocks: the library finds its parts
        self.surfaces = [add_surface(body, pb.domain, region, numbers.eq.reshape(-1, 3)) for region in (slave, master)]
        self.pair = self.p.add_pair(*self.surfaces, distance=0.1, method="node_to_face", friction=FRICTION)

    def step(self):
        """Goes to equilibrium with the present loads, one step after the last; fc.FetiError if there is none."""
        self.pb.update_materials()
        self.p.commit_pairs()
        for _ in range(20):
            self.p.find_pairs()
            self.p.load(-self.evaluator.eval_residual(self.u))
            info = self.p.solve()
            increment = self.p.displacement()
            self.u += increment
            now = self.pb.domain.mesh.coors + self.evaluator.make_full_vec(self.u).reshape(-1, 3)
            for surface in self.surfaces:
                surface.move(now)
            if np.abs(increment).max() < 1e-8 * WIDE:
                return info, self.pair.info
        raise ArithmeticError("no equilibrium in 20 iterations")


# ---- ... to here
def main():
    push, good, limit = [0.0], True, FRICTION * WEIGHT
    pb = problem(two_blocks(), push)
    region = pb.domain.create_region
    region("Lower", "cells of group 0")
    foot, floor = region("Foot", "vertices in z < 1e-9 *v r.Upper", "facet"), region("Floor", "vertices in z > -1e-9 *v r.Lower", "facet")
    contact = Contact(pb, foot, floor)
    for part in (0, 0.6, 0.99, 1.01):
        push[0] = part * limit / WIDE
        try:
            info, facts = contact.step()
        except fc.FetiError as error:
            good &= part > 1 and error.name == "FETI_LOAD_NOT_HELD"
            print(f"  push {part:.2f} mu N: no forces balance it, {error.name}")
            continue
        wrong = np.abs(np.array(facts.force) - [-part * limit, 0, WEIGHT]).max() / WEIGHT
        good &= part < 1 and info.status == 0 and wrong < 1e-9
        print(f"  push {part:.2f} mu N: {facts.sticking} nodes stick, {facts.slipping} slip, forces on the foot are the load to {wrong:.0e}")
    print("blocks_sfepy", "ok" if good else "FAILED")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
