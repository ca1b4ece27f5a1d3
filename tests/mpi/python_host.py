"""Hosts in Python with mpi4py: the bars of example 16, a body per rank, against one rank without MPI; ranks that serve; errors and Ctrl-C.

Rank 0 prints what does not depend on the number of ranks; every failure ends all ranks. Whole messages, and cut at 4096 bytes."""

import contextlib
import os
import pickle
import signal
import tempfile
import time
import traceback
import warnings

import numpy as np
from mpi4py import MPI

import feti_contact as fc
from feti_contact import _mpi

WORLD = MPI.COMM_WORLD
RANK, SIZE = WORLD.rank, WORLD.size
BARS, N = 4, 200
OWN = range(RANK, BARS, SIZE)


def chain(n, k=1.0):
    d = np.full(n, 2 * k)
    d[[0, -1]] = k
    return np.diag(d) + np.diag(np.full(n - 1, -k), 1) + np.diag(np.full(n - 1, -k), -1)


def bars(p, own):
    """Bars that stand on each other, the lowest 1 mm above the ground; a row names unknowns of the bar below by their numbers."""
    for b in own:
        body = p.add_body(chain(N, 1e4 * (N - 1)), load=np.full(N, -0.5 / N), null_space=np.ones(N))
        body.numbering(b * N + np.arange(N))
        row = np.zeros((1, BARS * N))
        row[0, b * N] = -1
        row[0, b * N - 1] = 1 if b else 0
        p.add_contact(row, gap=0.0 if b else 1e-3)
    return p


def answers(p, own):
    """The bytes of the answer, bar by bar, and the sum of the forces."""
    forces = p.multipliers()
    return {b: (body.displacement().tobytes(), forces[k].tobytes()) for k, (b, body) in enumerate(zip(own, p.bodies))}


@contextlib.contextmanager
def parts(comm=WORLD):
    """A problem with the bars of this rank; closed, because a rank with a part of a problem cannot serve."""
    with fc.Problem(communicator=comm) as p:
        yield bars(p, OWN)


def a_body_per_rank(p):
    alone = bars(fc.Problem(), range(BARS))
    serial_info = alone.solve()
    info, state = p.solve(), p.save()
    assert info and info.ranks == SIZE and info.bodies == BARS
    merged = {b: found for part in WORLD.allgather(answers(p, OWN)) for b, found in part.items()}
    assert merged == answers(alone, range(BARS)), "the bits are those of one rank"
    verdict = p.check()
    assert verdict.passed == 1 and verdict.worst == alone.check().worst
    u = p.displacement(BARS * N)
    assert all(np.array_equal(u[b * N : (b + 1) * N], body.displacement()) for b, body in zip(OWN, p.bodies))
    for body in p.bodies:
        body.load(np.zeros(N))
    p.restore(state), p.solve(start="cold")
    assert answers(p, OWN) == {b: merged[b] for b in OWN}
    if RANK == 0:
        print("forces", *(f"{np.frombuffer(merged[b][1])[0]:.12f}" for b in range(BARS)), "steps", info.steps, serial_info.steps)
    if SIZE > 1:
        try:
            pickle.dumps(p)
            raise AssertionError("pickled")
        except TypeError:
            pass


def a_number_that_nobody_has(p, mistaken):
    if RANK == mistaken:
        p.add_contact(np.eye(1, 2 * BARS * N, 2 * BARS * N - 1))
    try:
        p.solve()
        heard = None
    except fc.FetiError as error:
        heard = (error.status, str(error), error.place)
    told = WORLD.allgather(heard)
    assert heard and all(one == heard for one in told), told
    assert SIZE == 1 or heard[2]["rank"] == mistaken, heard


def ranks_that_serve():
    """A problem, and one from a file, of which rank 0 lends bodies."""
    if RANK == 0:
        n, found = 600, []
        K = np.eye(n) + 1 / (1 + abs(np.subtract.outer(np.arange(n), np.arange(n))))  # full: enough work to be lent
        alone, p = fc.Problem(), fc.Problem(communicator=WORLD)
        for problem in (alone, p):
            for k in range(4):
                problem.add_body(K * (1 + k / 3), load=np.linspace(1, 2, n), null_space=None)
            problem.add_contact({0: np.eye(30, n, 7), 3: -np.eye(30, n)}, gap=np.linspace(-1e-3, 1e-3, 30))
        with tempfile.TemporaryDirectory() as folder:
            alone.write(f"{folder}/problem.feti")
            again = fc.Problem.read(f"{folder}/problem.feti", communicator=WORLD)
        for problem in (alone, p, again):
            info = problem.solve()
            found.append((problem.displacement().tobytes(), problem.multipliers().tobytes(), info.steps))
        assert info.ranks == SIZE and found[0] == found[1] == found[2]
        assert SIZE == 1 or info.messages > 10 and info.message_bytes > 1e5, (info.messages, "nothing is lent")
        print("served", f"{sum(p.multipliers()):.15e}", "steps", info.steps)
    fc.serve(WORLD)


def a_communicator_that_is_freed():
    comm = WORLD.Dup()
    with parts(comm) as p:
        comm.Free()
        try:
            p.solve()
            assert SIZE == 1
        except fc.FetiError as error:
            assert error.name == "FETI_COMMUNICATION" and "freed" in str(error.__cause__), error
    try:
        fc.Problem(communicator=MPI.COMM_NULL)
        raise AssertionError("taken")
    except fc.FetiError as error:
        assert error.name == "FETI_COMMUNICATION"


def strike(now):
    """The thread of the call sleeps, and the main thread cancels it."""
    if now.phase == 1:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)


def ctrl_c(p):
    """It breaks off no message, so that the ranks stay together; all of them end the solve, and the rank that it struck raises it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    heard = ""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            heard = p.solve(progress=strike if RANK == 0 else None).name
        except KeyboardInterrupt:
            heard = "KeyboardInterrupt"
    assert heard == ("FETI_CANCELLED" if RANK else "KeyboardInterrupt") and len(caught) == (RANK > 0), (heard, caught)
    assert p.solve()


def all_cases():
    for mistaken in range(SIZE):
        with parts() as problem:
            a_number_that_nobody_has(problem, mistaken)
    for chunk in (_mpi.CHUNK, 4096):
        _mpi.CHUNK = chunk
        for case in [a_body_per_rank] + [ctrl_c, a_body_per_rank] * (MPI.Query_thread() >= MPI.THREAD_SERIALIZED):
            with parts() as problem:
                case(problem)
        ranks_that_serve()
    a_communicator_that_is_freed()


try:
    all_cases()
except BaseException:
    traceback.print_exc()
    WORLD.Abort(1)
