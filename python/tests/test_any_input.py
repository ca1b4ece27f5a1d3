"""Any calls with any arguments end with an answer or an exception of Python, never with the end of the interpreter.

Runs in a process of its own that the test watches. SECONDS=600 makes it long; the default is a few seconds."""

import os
import subprocess
import sys
import time
import warnings

import numpy as np
import scipy.sparse as sp
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import feti_contact as fc

SECONDS = float(os.environ.get("SECONDS", "8"))
ORDINARY = (fc.FetiError, TypeError, ValueError, IndexError, OverflowError, MemoryError, AttributeError)

floats = st.floats(allow_nan=True, allow_infinity=True) | st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e300, 5e-324])
small = st.integers(-2, 9)
dtypes = st.sampled_from([np.float64, np.float32, np.int32, np.int64, np.uint8, np.uint64, object, bool, np.complex128, ">f8", "<U2"])
shapes = st.lists(st.integers(0, 6), max_size=3).map(tuple)
dense = st.tuples(shapes, dtypes).flatmap(lambda a: arrays(*(a[1], a[0])) if a[1] is not object else st.just(np.full(a[0], None)))


@st.composite
def spoiled(draw):
    """A sparse matrix whose arrays are changed behind the back of scipy."""
    n, m = draw(st.integers(1, 6)), draw(st.integers(1, 6))
    K = sp.random(n, draw(st.sampled_from([n, m])), 0.5, draw(st.sampled_from(["csr", "csc", "coo"])), random_state=draw(st.integers(0, 99)))
    if draw(st.booleans()) and n == K.shape[1]:
        K = (K + K.T + sp.identity(n) * draw(floats)).asformat(K.format)
    for name in ("indptr", "indices", "row", "col", "data"):
        if hasattr(K, name) and draw(st.integers(0, 4)) == 0 and getattr(K, name).size:
            a = getattr(K, name).copy()
            a[draw(st.integers(0, a.size - 1))] = draw(floats) if name == "data" else draw(st.integers(-3, 20) | st.just(2**31 - 1))
            cut = draw(st.integers(0, 4))
            for holder, key in ((K, name), (K, "coords")):
                if name in ("row", "col") and key == name:
                    continue
                if key == "coords" and name in ("row", "col"):
                    K.coords = (a, K.col) if name == "row" else (K.row, a)
                elif key == name:
                    setattr(holder, key, a[: a.size - cut] if cut < 2 else a)
    return K


square = st.integers(1, 5).flatmap(lambda n: arrays(np.float64, (n, n), elements=st.sampled_from([0.0, 1.0, -1.0, 2.0])).map(lambda a: a + a.T))
anything = st.one_of(dense, spoiled(), square, floats, small, st.none(), st.lists(floats, max_size=6), st.text(max_size=3), st.dictionaries(small, square, max_size=3))
words = st.sampled_from(["full", "lower", "upper", "contact", "equality", "tangential", "all", "exact", "soft", "candidates", "", "x"]) | anything
PARTS = ("stiffness values load null_space coordinates numbering skyline elements operator displacement reaction motions amplitudes held_forces pieces "
         "escape surface move set field").split()  # fmt: skip
WHOLE = ("add_body add_contact add_equality add_friction set_rhs set_compliance set_friction clear load dof_table displacement reaction multipliers gaps "
         "active slips friction_states check start_from save restore drop diagnosis diagnosis_rows phases commit_friction add_surface add_plane add_sphere "
         "add_cylinder add_pair find_pairs commit_pairs setup solve cancel get close").split()  # fmt: skip


def calls(data):
    p = fc.Problem(threads=1, time_limit=2.0)
    parts = []
    for n in data.draw(st.lists(st.integers(1, 6), min_size=1, max_size=3)):
        parts.append(p.add_body(np.diag(np.full(n, 2.0)), load=-np.ones(n)))
    for _ in range(data.draw(st.integers(1, 12))):
        whole = data.draw(st.booleans())
        name, on = (data.draw(st.sampled_from(WHOLE)), p) if whole else (data.draw(st.sampled_from(PARTS)), data.draw(st.sampled_from(parts)))
        if name == "close" and data.draw(st.integers(0, 3)):
            continue
        given = data.draw(st.lists(st.one_of(words, st.sampled_from(parts)), max_size=4))
        try:
            made = getattr(on, name)(*given)
            if isinstance(made, (fc.Body, fc.Surface, fc.Pair)):
                parts.append(made)
            repr((p, parts, made))
        except ORDINARY:
            pass


def run(seconds):
    warnings.simplefilter("ignore")
    quiet = settings(max_examples=50, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    end, rounds = time.monotonic() + seconds, 0
    while time.monotonic() < end:  # the same rounds on every run
        seed(rounds)(quiet(given(st.data())(lambda data: calls(data))))()
        rounds += 1
    print(rounds, "rounds of 50 problems")


def test_any_calls_leave_the_interpreter_alive():
    done = subprocess.run([sys.executable, "-X", "faulthandler", __file__, str(SECONDS)], capture_output=True, text=True)
    assert done.returncode == 0 and "rounds" in done.stdout, done.stderr[-4000:]


if __name__ == "__main__":
    run(float(sys.argv[1]))
