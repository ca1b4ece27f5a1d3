"""Wrong input raises and says what; nothing harms the interpreter; arrays are passed as they are."""

import gc
import os
import subprocess
import sys
import threading

import numpy as np
import pytest
import scipy.sparse as sp
from conftest import chain, chain_at_wall, spring_and_block

import feti_contact as fc


@pytest.mark.parametrize("wrong, says", [
    (lambda: fc.Problem().add_body(np.array([[1, "a"]], dtype=object)), "K: numbers of type object"),
    (lambda: fc.Problem().add_body(np.eye(2, dtype=np.float32)), "K: numbers of type float32"),
    (lambda: fc.Problem().add_body(np.eye(2) * 1j), "K: numbers of type complex128"),
    (lambda: fc.Problem().add_body(chain(3).astype(np.float32)), "K.data: numbers of type float32"),
    (lambda: fc.Problem().add_body([["1", "2"], ["3", "4"]]), "K: numbers of type <U1"),
    (lambda: fc.Problem().add_body(n=2, load=np.ones(2, dtype=np.float32)), "load: numbers of type float32"),
    (lambda: fc.Problem().add_body(n=2.5), "float"),
    (lambda: fc.Problem().add_body(), "add_body needs K or n"),
    (lambda: fc.Problem().add_body(n=2).numbering([0.0, 1.0]), "number: numbers of type float64, not integers"),
])  # fmt: skip
def test_a_wrong_type_is_a_TypeError_that_names_the_argument(wrong, says):
    with pytest.raises(TypeError, match=says):
        wrong()


@pytest.mark.parametrize("wrong, says", [
    (lambda b: b.stiffness(np.eye(3)), r"K: shape \(3, 3\), not \(2, 2\)"),
    (lambda b: b.stiffness(chain(3)), r"K: shape \(3, 3\), not \(2, 2\)"),
    (lambda b: b.stiffness(np.ones(4)), r"K: shape \(4,\)"),
    (lambda b: b.load([1, 2, 3]), r"load: shape \(3,\), not \(2,\)"),
    (lambda b: b.load(1.0), r"load: shape \(\)"),
    (lambda b: b.null_space(np.ones((3, 1))), "null_space: shape"),
    (lambda b: b.coordinates(np.ones((2, 2))), "coordinates: shape"),
    (lambda b: b.stiffness(np.eye(2), "left"), "storage: 'left', not one of 'full'"),
    (lambda b: b.elements([[0, 1]], [np.eye(3)]), r"matrices\[0\]: shape"),
    (lambda b: b.skyline([0, 1, 30], [1.0, 2.0]), "ptr ends with 30"),
    (lambda b: b.problem.add_contact([[1, 0]], gap=[0, 1]), "right-hand side: shape"),
    (lambda b: b.problem.add_contact({b: [[1, 0]], 1: [[1], [1]]}), "rows"),
    (lambda b: b.problem.add_friction([0, 1], [[1, 0]] * 3), "rows: 3 for 2 nodes"),
    (lambda b: b.surface(np.ones((2, 2)), np.ones((2, 2), int), np.ones((1, 4), int)), "dimensions and nodes of a face"),
    (lambda b: b.problem.check(u=[1.0]), "u: shape"),
    (lambda b: b.problem.multipliers("normal"), "kind: 'normal'"),
])  # fmt: skip
def test_a_wrong_shape_or_word_is_a_ValueError_that_names_the_argument(wrong, says):
    with pytest.raises(ValueError, match=says):
        wrong(fc.Problem().add_body(n=2))


def broken(**arrays):
    K = chain(3)
    for name, (k, value) in arrays.items():
        getattr(K, name)[k] = value
    return K


@pytest.mark.parametrize("wrong, says", [
    (lambda p: p.add_body(broken(data=(1, np.nan))), "row 0, entry 1"),
    (lambda p: p.add_body(broken(indices=(1, 7))), "column 7 is outside"),
    (lambda p: p.add_body(broken(indices=(1, -1))), "column -1 is outside"),
    (lambda p: p.add_body(broken(indptr=(1, 6))), "row"),
    (lambda p: p.add_body(broken(indptr=(1, -5))), "row"),
    (lambda p: p.add_body(broken(data=(1, 5.0))), "symmetr"),
    (lambda p: p.add_body([[1, np.inf], [np.inf, 1]]), "not a finite number"),
    (lambda p: p.add_body(n=0), "n"),
    (lambda p: p.add_body(n=1, load=[np.nan]), "NaN|nan|finite"),
    (lambda p: p.add_contact([[1.0]]), "no body|unknown|outside"),
    (lambda p: (p.add_body([[1.0]]), p.add_contact({3: [[1.0]]})), "body 3"),
    (lambda p: (p.add_body([[1.0]]), p.add_contact([[0, 1.0]])), "outside|unknown"),
    (lambda p: (p.add_body([[1.0]]), p.displacement()), "answer"),
    (lambda p: p.solve(), "body"),
])  # fmt: skip
def test_wrong_numbers_raise_with_the_text_of_the_library(wrong, says):
    with pytest.raises(fc.FetiError, match=says) as caught:
        wrong(fc.Problem())
    assert caught.value.status < 0 and caught.value.name.startswith("FETI_") and caught.value.function.startswith("feti_")


@pytest.mark.parametrize("wrong", [
    lambda p, body: body.coordinates([[0.0]], [2**32 + 1], [1]),
    lambda p, body: body.coordinates([[0.0]], [1], [-(2**31) - 1]),
    lambda p, body: p.set(threads=2**64 + 1),
    lambda p, body: fc.Problem().add_body(n=2**64 + 1),
    lambda p, body: p.add_contact({2**64: [[1.0]]}),
])  # fmt: skip
def test_integers_that_do_not_fit_are_refused_not_cut(wrong):
    p = fc.Problem()
    body = p.add_body([[1.0]], load=[1.0])
    p.solve()
    with pytest.raises((OverflowError, TypeError), match="fit|too large|not integers"):
        wrong(p, body)


def test_indices_outside_do_not_end_the_process_in_scipy():
    for form, index in (("csc", "indices"), ("csc", "indptr"), ("coo", "coords"), ("bsr", "indices")):
        B = sp.csr_matrix(np.ones((2, 3))).asformat(form)
        spoiled = getattr(B, index)[0].copy() if index == "coords" else getattr(B, index).copy()
        spoiled[-1] = 10**6
        setattr(B, index, (spoiled, B.col) if index == "coords" else spoiled)
        p = fc.Problem()
        p.add_body(np.eye(3))
        with pytest.raises(ValueError):
            p.add_contact(B)
    with pytest.raises(TypeError, match="dofs: a sparse matrix"):
        fc.Problem().add_body(n=2).elements(chain(2), [np.eye(2)])


def test_lists_integers_and_strided_arrays_are_converted():
    wide = np.zeros((6, 4))
    wide[::2, ::2] = [[1, -1], [-1, 1], [0, 0]]
    p = fc.Problem()
    body = p.add_body(wide[:4:2, ::2], load=np.arange(0, -4, -1, dtype=np.int16)[:2], null_space=np.ones(9)[:4:2])
    p.add_contact(sp.csr_matrix([[-1, 0]], dtype=np.int8))
    p.solve()
    np.testing.assert_allclose(body.displacement(), [0, -1], atol=1e-12)
    p.add_equality(np.asfortranarray([[1.0, 0], [0, 1]])[::-1], rhs=[-1, 0])
    p.solve()
    np.testing.assert_allclose(body.displacement(), [0, -1], atol=1e-12)


def test_a_closed_problem_refuses_every_call_and_closes_again(spring):
    p, body, _ = spring
    with p:
        p.solve()
    p.close()
    for use in (p.solve, p.displacement, p.diagnosis, body.displacement, lambda: body.info, p.save, lambda: p.add_body([[1.0]]), p.cancel):
        with pytest.raises(fc.FetiError) as caught:
            use()
        assert caught.value.name == "FETI_HANDLE"
    assert repr(p) == "<Problem, closed>"


def test_a_second_thread_gets_FETI_BUSY_and_the_first_its_answer(spring):
    p, *_ = spring
    seen = []

    def other():
        for use in (p.solve, p.close, p.displacement):
            try:
                use()
            except fc.FetiError as error:
                seen.append(error.name)

    def progress(now):
        if not seen:
            thread = threading.Thread(target=other)
            thread.start()
            thread.join()

    assert p.solve(progress=progress)
    assert seen == ["FETI_BUSY"] * 3 and p.displacement().shape == (3,)


def test_an_exception_of_the_host_is_not_taken_by_a_second_thread(spring):
    p, *_ = spring
    solved = []

    def fail(now):
        solved.append(now)
        thread = threading.Thread(target=lambda: pytest.raises(fc.FetiError, p.solve, progress=print))
        raise_first = KeyError("first")
        p._calls.error = raise_first  # as if another function had failed already
        thread.start()
        thread.join()
        return True

    with pytest.raises(KeyError, match="first"):
        p._run("solve", p._handle, None, watch=lambda now: (fail(now), 1 / 0))
    assert solved and p.solve()


def test_threads_solve_their_own_problems_at_once():
    answers = {}

    def work(k):
        p, *_ = spring_and_block()
        for _ in range(20):
            p.solve(start="cold")
        answers[k] = p.displacement().tobytes()

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert len(answers) == 8 and len(set(answers.values())) == 1


@pytest.mark.parametrize("where", ["progress", "operator", "log"])
def test_an_exception_of_a_function_of_the_host_comes_out_of_the_solve(where, caplog, monkeypatch):
    def fail(*_):
        raise KeyError("of the host")

    p, _, block = spring_and_block()
    if where == "operator":
        block.operator([4000, 4000], fail, fail)
        block.null_space([1, 1])
    if where == "log":
        caplog.set_level("INFO", "feti_contact")
        monkeypatch.setattr(fc.problem.LOG, "log", fail)
    with pytest.raises(KeyError, match="of the host"):
        p.solve(progress=fail if where == "progress" else None)
    monkeypatch.undo()
    block.stiffness([[4000, -4000], [-4000, 4000]])
    assert p.solve() and np.allclose(p.displacement(), [-0.1, -0.6, -0.625])


INTERRUPTED = """
import os, signal, time
import numpy as np, scipy.sparse as sp
import feti_contact as fc
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored below a shell that runs the tests in the background
n = 20
e = sp.diags([np.full(n, 2.0), np.full(n - 1, -1.0), np.full(n - 1, -1.0)], [0, 1, -1])
one = sp.identity(n)
K = sp.csr_matrix(sp.kron(sp.kron(e, one), one) + sp.kron(sp.kron(one, e), one) + sp.kron(sp.kron(one, one), e))
def made():
    p = fc.Problem(threads=1)
    for k in range(6):
        p.add_body(K * (1 + k / 7), load=-np.linspace(0.5, 1, n**3), null_space=None)
    p.add_contact(sp.csr_matrix((np.ones(300), (np.arange(300), np.arange(300) * 311 % n**3)), shape=(300, 6 * n**3)), gap=-0.1)
    return p
def timed(p, **options):
    begin = time.process_time()
    try:
        p.solve(**options)
    except KeyboardInterrupt:
        print("interrupted")
    return time.process_time() - begin
begun = []
def strike(now):
    if not begun:
        begun.append(os.kill(os.getpid(), signal.SIGINT))
p, whole = made(), made()
cut, full = timed(p, progress=strike), timed(whole)
print("early", cut < full)
p.solve()
print("same", (p.displacement() == whole.displacement()).all())
"""


def test_ctrl_c_ends_a_solve_that_has_begun_and_the_next_one_gives_the_answer():
    output = subprocess.check_output([sys.executable, "-c", INTERRUPTED], text=True)
    assert output.split() == ["interrupted", "early", "True", "same", "True"]


def test_progress_is_shown_by_tqdm(capsys):
    spring_and_block()[0].solve(progress=True)
    shown = capsys.readouterr().err
    assert "setup" in shown and "100%" in shown, shown


def test_collection_in_any_order_frees_problems_and_keeps_what_is_in_use():
    arrays = chain(1000, "csr")
    for order in ([0, 1, 2], [2, 1, 0], [1, 0, 2], [1, 2, 0]):
        K = sp.csr_matrix(sp.tril(arrays))
        p, body = chain_at_wall(K, "lower", copy=False)
        p.solve()
        things = [p, body, K]
        del p, body, K
        for k in order[:2]:
            things[k] = None
            gc.collect()
        if isinstance(things[order[2]], fc.Body):
            np.testing.assert_allclose(things[1].displacement()[-1], -999)
        things[order[2]] = None
        gc.collect()
    cycle = [spring_and_block()[0]]
    cycle.append(cycle)
    del cycle
    gc.collect()


def test_lent_arrays_are_read_only_and_used_without_a_copy():
    K = sp.csr_matrix(sp.tril(chain(50)))
    p, body = chain_at_wall(K, "lower", copy=False)
    assert body.info.borrowed == 2
    with pytest.raises(ValueError, match="read-only"):
        K.data[0] = 3
    p.solve()
    body.values(2 * K.data)
    p.solve()
    np.testing.assert_allclose(body.displacement()[-1], -24.5)
    K = sp.csr_matrix(chain(50))  # both triangles: the library copies, the arrays stay as they were
    p, body = chain_at_wall(K, "full", copy=False)
    assert body.info.borrowed == 0 and K.data.flags.writeable


MEMORY = """
import resource, sys, tracemalloc
import numpy as np, scipy.sparse as sp
import feti_contact as fc
n = 5_000_000
ptr = np.arange(0, 2 * n + 1, 2, dtype=np.int32) - 1
ptr[0] = 0
col = np.empty(2 * n - 1, dtype=np.int32)
col[0], col[1::2], col[2::2] = 0, np.arange(n - 1), np.arange(1, n)
val = np.where(np.arange(2 * n - 1) % 2, -1.0, 2.0)
K = sp.csr_matrix((val, col, ptr), shape=(n, n))
load = np.zeros(n)
tracemalloc.start()
p = fc.Problem()
body = p.add_body(n=n)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
body.stiffness(K, "lower", copy=False)
lent, peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, tracemalloc.get_traced_memory()[1]
body.load(load)
print(peak / (val.nbytes + col.nbytes), lent * 1024 / (val.nbytes + col.nbytes), body.info.borrowed, len(val))
"""


def test_matrices_of_1e7_entries_are_passed_without_a_copy():
    of_python, of_process, borrowed, entries = map(float, subprocess.check_output([sys.executable, "-c", MEMORY], text=True).split())
    assert (borrowed, entries) == (2, 9_999_999)
    assert of_python < 1e-3, "of the arrays, allocated by numpy"
    assert of_process < 0.8, "of the arrays, taken by the library: row pointers"


def test_a_problem_in_a_fork_is_left_alone():
    p, *_ = spring_and_block()
    p.solve()
    child = os.fork()
    if child == 0:
        os._exit(0 if np.allclose(p.displacement(), [-0.1, -0.6, -0.625]) else 1)
    assert os.waitpid(child, 0)[1] == 0
