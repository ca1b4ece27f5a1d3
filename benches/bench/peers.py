"""Clarabel or OSQP on min 1/2 u'Ku - f'u subject to B u <= c.

peers.py clarabel|osqp <problem>   prints lines `name value`; the problem is written by matrix.rs.
"""

import sys
import time

import numpy as np
from scipy import sparse


def read(path):
    """Upper triangle of K, f, B and c."""
    with open(path, "rb") as file:

        def take(kind, count):
            return np.fromfile(file, dtype=kind, count=count)

        def matrix(columns=None):
            rows, entries = take(np.int64, 2)
            ptr, index, value = take(np.int32, rows + 1), take(np.int32, entries), take(np.float64, entries)
            return sparse.csr_matrix((value, index, ptr), shape=(rows, columns or rows))

        upper = matrix()
        load = take(np.float64, upper.shape[0])
        rows = matrix(upper.shape[0])
        return upper.tocsc(), load, rows.tocsc(), take(np.float64, rows.shape[0])


def by_clarabel(upper, load, rows, gap):
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    cones = [clarabel.NonnegativeConeT(len(gap))]
    solution = clarabel.DefaultSolver(upper, -load, rows, gap, cones, settings).solve()
    return np.array(solution.x), np.array(solution.z), str(solution.status) == "Solved", solution.iterations


def by_osqp(upper, load, rows, gap):
    import osqp

    solver = osqp.OSQP()
    limits = {"eps_abs": 1e-6, "eps_rel": 1e-6, "max_iter": 100000, "time_limit": 150.0}
    solver.setup(upper, -load, rows, np.full(len(gap), -np.inf), gap, verbose=False, **limits)
    result = solver.solve()
    return result.x, result.y, result.info.status == "solved", result.info.iter


def main():
    upper, load, rows, gap = read(sys.argv[2])
    # The tests of both have absolute parts: forces and lengths in units that make the largest load 1.
    unit = np.abs(load).max()
    problem = upper, load / unit, rows, gap / unit
    wall, cpu = time.monotonic(), time.process_time()
    u, force, solved, iterations = {"clarabel": by_clarabel, "osqp": by_osqp}[sys.argv[1]](*problem)
    print("wall", time.monotonic() - wall)
    print("cpu", time.process_time() - cpu)
    upper, load, rows, gap = problem
    product = upper @ u + upper.T @ u - upper.diagonal() * u
    print("energy", unit**2 * (0.5 * (u @ product) - load @ u))
    print("equilibrium", np.abs(product - load + rows.T @ force).max() / np.abs(load).max())
    print("penetration", np.maximum(rows @ u - gap, 0.0).max() / np.abs(u).max())
    print("solved", int(solved))
    print("iterations", iterations)


if __name__ == "__main__":
    main()
