"""scikit-fem: python/examples/hertz.py, a cylinder pressed on a block, plane strain, elements of 8 nodes, by mortar; compared with Hertz.

Known, for half planes, a being half the width of the contact and P the load:

    a^2 = 4 P R / (pi E'),   p(x) = p0 sqrt(1 - (x/a)^2),   p0 = 2 P / (pi a),   E' = E / (2 (1 - nu^2))

p0 and a are read off the straight line through p^2 over x^2, of the nodes within .9 a."""

import runpy
import sys
from pathlib import Path

import numpy as np


def main():
    host = runpy.run_path(str(Path(__file__).parents[2] / "python/examples/hertz.py"))
    x, pressure, info, a, p0 = host["x"][:, 0], host["pressure"], host["info"], host["A"], host["PEAK"]
    force = abs(host["pair"].info.force[1] / host["LOAD"] - 1)
    near = (np.abs(x) < 0.9 * a) & (pressure > 0)
    slope, start = np.polyfit(x[near] ** 2, pressure[near] ** 2, 1)
    peak, half_width = np.sqrt(start), np.sqrt(-start / slope)
    print(f"  {info.rows} contact rows, {info.active} closed; certificate {info.worst:.1e} of its limit; resultant against load {force:.0e}")
    print(f"  peak {peak:.4f} MPa: {100 * (peak / p0 - 1):+.2f} %; half width {half_width:.4f} mm: {100 * (half_width / a - 1):+.2f} %")
    good = info.status == 0 and info.worst <= 1 and force < 1e-9 and abs(peak / p0 - 1) < 0.01 and abs(half_width / a - 1) < 0.01
    print("hertz_scikit_fem", "ok" if good else f"FAILED, status {info.status}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
