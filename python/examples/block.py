"""A block that only its contact with a plane holds, with friction: it rests, and pushed by more than mu N it slides; the library says which body."""
import numpy as np
import feti_contact as fc

EDGE, STIFFNESS, MU, WEIGHT = 1.0, 1e4, 0.3, 100.0  # mm, N/mm, -, N
corners = EDGE * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])


def block():
    """K of a square of six bars: it resists no rigid motion."""
    K = np.zeros((8, 8))
    for i in range(4):
        for j in range(i):
            t, b = (corners[i] - corners[j]) / np.linalg.norm(corners[i] - corners[j]), np.zeros(8)
            b[2 * i : 2 * i + 2], b[2 * j : 2 * j + 2] = t, -t
            K += STIFFNESS * np.outer(b, b)
    return K


p = fc.Problem()
body = p.add_body(block(), coordinates=corners)
normal = p.add_contact([-np.eye(8)[1], -np.eye(8)[3]], gap=0)  # feet 0 and 1: -u_y <= 0
p.add_friction(normal, [np.eye(8)[0], np.eye(8)[2]], coefficient=MU)
for push in (0.9 * MU * WEIGHT, 1.1 * MU * WEIGHT):
    body.load([push, 0, 0, 0, 0, -WEIGHT / 2, 0, -WEIGHT / 2])
    try:
        p.solve()
        print(f"push {push:.0f} N: rests, shear {np.abs(p.multipliers('tangential')).sum():.3f} N, states {p.friction_states()}")
    except fc.FetiError as error:
        print(f"push {push:.0f} N: {error.name}, body {error.place['body']} slides, its foot by {body.escape()[0]:.0f} along x")
