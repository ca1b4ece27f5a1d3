"""Contact of elastic bodies, with and without friction, by FETI duality: minimise 1/2 u'K u - f'u with B u <= c and H u = h.

    import feti_contact as fc
    with fc.Problem(tolerance=1e-10) as p:
        spring = p.add_body([[1000]], null_space=None)                     # K, N/mm; None: K is not singular
        block = p.add_body([[4000, -4000], [-4000, 4000]], load=[0, -100])   # N
        p.add_contact([[1, -1, 0]], gap=0.5)                               # u1 - u2 <= c, mm
        p.solve()
        print(p.multipliers(), spring.displacement(), block.displacement())

Bodies, unknowns, rows, surfaces and pairs count from 0. Any consistent set of units will do. docs/python.md is the manual,
include/feti_contact.h describes every C function; `feti_contact._raw` and `_library.call` reach them all."""

from ._arrays import outward
from ._library import LIBRARY, FetiError, FetiWarning
from ._methods import BodyInfo, Certificate, Findings, PairInfo, Progress
from ._records import Info
from .parts import Body, Pair, Surface
from .problem import Problem, serve

__version__ = LIBRARY.feti_version().decode()
__all__ = ["Body", "BodyInfo", "Certificate", "FetiError", "FetiWarning", "Findings", "Info", "Pair", "PairInfo", "Problem", "Progress", "Surface"]
__all__ += ["outward", "serve"]
