"""What the tests share: the spring and the block of README.md, and a floating chain of any length."""

import numpy as np
import pytest
import scipy.sparse as sp

import feti_contact as fc


def spring_and_block(**options):
    p = fc.Problem(**{"tolerance": 1e-10, **options})
    spring = p.add_body([[1000]], null_space=None)
    block = p.add_body([[4000, -4000], [-4000, 4000]], load=[0, -100], null_space=[1, 1])
    p.add_contact({spring: [[1]], block: [[-1, 0]]}, gap=0.5)
    return p, spring, block


def chain(n, kind="csr"):
    """K of n points with springs of stiffness 1 between them; nothing holds it."""
    d = np.full(n, 2.0)
    d[[0, -1]] = 1
    return sp.diags([np.full(n - 1, -1.0), d, np.full(n - 1, -1.0)], [-1, 0, 1], format=kind)


def chain_at_wall(K, storage="full", copy=True, **options):
    """A chain pushed by 1 at its end against a wall at its beginning: the force is 1, u_i = -i."""
    n = K.shape[0]
    p = fc.Problem(**options)
    load = np.zeros(n)
    load[-1] = -1
    body = p.add_body(K, storage=storage, copy=copy, load=load, null_space=np.ones(n))
    p.add_contact(sp.csr_matrix(([-1.0], ([0], [0])), shape=(1, n)))
    return p, body


@pytest.fixture
def spring():
    return spring_and_block()
