"""A spring at a wall, a gap, a block that nothing else holds, and a force: the first program of README.md."""
import feti_contact as fc

k, s, c, force = 1000, 4000, 0.5, 100  # N/mm, N/mm, mm, N
p = fc.Problem(tolerance=1e-10)
spring = p.add_body([[k]], null_space=None)  # None: K is not singular
block = p.add_body([[s, -s], [-s, s]], load=[0, -force], null_space=[1, 1])
p.add_contact({spring: [[1]], block: [[-1, 0]]}, gap=c)  # u1 - u2 <= c
p.solve()
print("force {:.3f} N, u {:.3f} {:.3f} {:.3f} mm".format(*p.multipliers(), *p.displacement()))
