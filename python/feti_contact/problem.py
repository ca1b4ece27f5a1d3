"""The problem: bodies, rows, friction, surfaces, options, the solve and its answer."""

from __future__ import annotations

import contextlib
import ctypes
import logging
import operator
import os
import tempfile
import threading
import warnings
from ctypes import byref, c_double, c_int64, c_void_p
from pathlib import Path
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _raw
from ._arrays import constraint_rows, filled, integers, listed, numbers, one_of, optional, rows_of, written
from ._library import LIBRARY, FetiError, FetiWarning, call, interruptible
from ._methods import KINDS, METHODS, BodyInfo, Certificate, Option, Phase, ProblemCalls, Progress
from ._records import Info
from .parts import SHAPES, Body, Pair, Surface

LOG = logging.getLogger("feti_contact")
FOUND = object()  # null_space: the library finds it

OPTIONS = {option.name.decode(): option.type for option in (written("option_at", k, of=(Option,)) for k in range(LIBRARY.feti_option_count()))}
# of options: ending of the C functions, type and conversion of their values
WAYS = {_raw.FETI_OPTION_F64: ("f64", c_double, float), _raw.FETI_OPTION_I64: ("i64", c_int64, operator.index)}
TEXT = ("str", None, lambda value: str(value).encode())


class _Calls:
    """What the library calls back. An exception is kept and ends the call; it holds no reference to the problem."""

    def __init__(self):
        self.error, self.watch = None, None
        levels = {1: logging.INFO, 2: logging.DEBUG}
        self.on_log = _raw.feti_log_fn(lambda _, level, text: self.catch(lambda: LOG.log(levels.get(level, 5), text.decode(errors="replace")), -1))
        self.on_progress = _raw.feti_progress_fn(lambda _, now: self.catch(lambda: int(bool(self.watch(Progress._of(bytes(now.contents))))), -1))

    def catch(self, work, failed):
        try:
            return work() or 0
        except BaseException as error:  # raised again by the call that runs
            self.error = self.error or error
            return failed


class Problem(ProblemCalls, contextlib.AbstractContextManager):
    """Bodies, rows, options and the last answer. One thread at a time; several may use different problems. Keywords are options (docs/options.md).

    communicator: one of mpi4py, on each rank that has a part of the problem (docs/machines.md); rank 0 lends bodies to the ranks in `serve`.
    `with` or close() frees its memory at once, otherwise the garbage collection does; every call on a closed problem is a FetiError."""

    def __init__(self, *, communicator: Any = None, **options):
        self._handle, self._kept, self._width, self._calls = c_void_p(), {}, None, _Calls()
        self._bodies, self._alone, self._stream = [], threading.Lock(), None
        call("problem_create", byref(self._handle))
        if communicator is not None:
            from ._mpi import stream_of

            self._stream = stream_of(communicator)
            call("communicator_set", self._handle, byref(self._stream.table))
        self.set(**options)

    # ---- life
    def close(self) -> None:
        """Frees all memory; a second time it does nothing. FETI_BUSY while another thread solves."""
        if self._handle:
            call("problem_destroy", byref(self._handle))
            self._kept.clear()

    def __del__(self):
        if getattr(self, "_handle", None):
            LIBRARY.feti_problem_destroy(byref(self._handle))

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        if not self._handle:
            return "<Problem, closed>"
        return "<Problem: {} bodies, {} unknowns, {} contact rows, {} equality rows>".format(*self._counts())

    def __reduce__(self):
        if self._stream:
            raise TypeError("a problem of several ranks cannot be pickled; all ranks can `write` it")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "problem.feti")
            self.write(path)
            return _unpickled, (path.read_bytes(), self._width)

    def write(self, path: Union[str, os.PathLike]) -> None:
        """Writes all input to a problem file; not the answer, surfaces (their rows are written), saved states and functions."""
        self._run("problem_write", self._handle, os.fsencode(path))

    @classmethod
    def read(cls, path: Union[str, os.PathLike], width: Optional[int] = None, communicator: Any = None) -> Problem:
        """The problem of a file. width: largest number of the host + 1, for arrays over all bodies, if bodies have numbers."""
        p = cls(communicator=communicator)
        call("problem_read", p._handle, os.fsencode(path))
        p._width = width
        for number in range(p._counts()[0]):
            p._bodies.append(Body(p, number, written("body_info", p._handle, number, of=(BodyInfo,)).unknowns))
        return p

    def _size(self, kind):
        return self._counts()[1 + KINDS[kind]] if one_of(KINDS, kind, "kind") in (1, 2) else int(np.prod(self._nodes()))

    def _run(self, name, *arguments, watch=None):
        """A call that may take long: Ctrl-C cancels it, exceptions of functions of the host come out of it."""
        if not self._alone.acquire(blocking=False):  # another thread, or a function of the host, which must not take the first one's exception
            raise FetiError(_raw.FETI_BUSY)
        level = 3 if LOG.isEnabledFor(5) else 2 if LOG.isEnabledFor(logging.DEBUG) else int(LOG.isEnabledFor(logging.INFO))
        calls, self._calls.error, self._calls.watch = self._calls, None, watch
        try:
            call("on_log", self._handle, calls.on_log if level else _raw.feti_log_fn(), level, None)
            call("on_progress", self._handle, calls.on_progress if watch else _raw.feti_progress_fn(), None)
            run = self._stream.run if self._stream else interruptible
            return run(lambda: call(name, *arguments), lambda: LIBRARY.feti_cancel(self._handle))
        except FetiError as failed:
            if calls.error is not None:
                raise calls.error from failed
            raise
        finally:
            calls.error = calls.watch = None
            self._alone.release()

    # ---- options
    def set(self, **options) -> None:
        """Sets options by name; they stay until they are set again."""
        for name, value in options.items():
            ending, _, given = WAYS.get(OPTIONS.get(name), TEXT)
            call(f"set_{ending}", self._handle, name.encode(), given(value))

    def get(self, name: str) -> Union[int, float, str]:
        """The present value of an option."""
        ending, kind, _ = WAYS.get(OPTIONS.get(name), TEXT)
        if kind:
            return written(f"get_{ending}", self._handle, name.encode(), of=(kind,))
        text = ctypes.create_string_buffer(1000)
        written("get_str", self._handle, name.encode(), text, len(text))
        return text.value.decode()

    # ---- bodies
    def add_body(self, K: Any = None, *, n: Optional[int] = None, load=None, null_space: Any = FOUND, coordinates=None, storage="full", copy=True) -> Body:
        """A body of K (n, n), force per length: scipy.sparse or dense; without K, of n unknowns, for the calls of Body.

        load (n), force; null_space (n, r), or None: K is not singular, without it the library finds the motions; coordinates (nodes, dim),
        length, of nodes with an unknown for each direction; storage, copy: see Body.stiffness. If K or another argument is refused, the body
        stays without it: `p.bodies[-1]` takes another one."""
        if K is not None and not hasattr(K, "tocsr"):
            K = numbers(K, "K", (None, None))
        n = K.shape[0] if n is None and K is not None else n
        if n is None:
            raise TypeError("add_body needs K or n")
        body = Body(self, written("body_add", self._handle, operator.index(n)), n)
        self._bodies.append(body)
        if K is not None:
            body.stiffness(K, storage, copy)
        if null_space is not FOUND:
            body.null_space(null_space)
        if coordinates is not None:
            body.coordinates(coordinates)
        if load is not None:
            body.load(load)
        return body

    @property
    def bodies(self) -> Tuple[Body, ...]:
        """The bodies in their order."""
        return tuple(self._bodies)

    def dof_table(self, number, terms=None, constant=None) -> None:
        """Names all n unknowns of the host: number (n) in K, below 0: eliminated, u = constant + terms u; terms (n, n) sparse or dense."""
        number = integers(number, "number", (None,))
        n, ptr, term, factor = number.size, None, None, None
        if terms is not None:
            ptr, term, factor, rows, columns = rows_of(terms, "terms")
            if (rows, columns) != (n, n):
                raise ValueError(f"terms: shape {(rows, columns)}, not {(n, n)}")
        constant = optional(constant, "constant", (n,))
        call("dof_table_*", self._handle, n, number, ptr, term, factor, constant, 0)
        self._width = n

    # ---- rows
    def _add_rows(self, kind, rows, rhs, compliance):
        m, ptr, body, dof, val = constraint_rows(rows, "rows")
        rhs, compliance = optional(rhs, "right-hand side", (m,)), optional(compliance, "compliance", (m,))
        first = written("rows_add_*", self._handle, KINDS[kind], m, ptr, body, dof, val, 0, rhs)
        if compliance is not None:
            self.set_compliance(kind, compliance, first)
        return range(first, first + m)

    def add_contact(self, rows: Any, gap=None, compliance=None) -> range:
        """Contact rows B u <= c. rows: {body: B (m, unknowns of the body)}, or B over the unknowns of all bodies, one after the other, by
        their numbers (Body.numbering) or of the table; sparse or dense. gap: c (m) or one number, length, may be +inf; zeros without it.
        compliance: 1/k (m), length / force. Returns the numbers of the rows."""
        return self._add_rows("contact", rows, gap, compliance)

    def add_equality(self, rows: Any, rhs=None, compliance=None) -> range:
        """Equality rows H u = h (supports, ties), as add_contact; rhs: h (m)."""
        return self._add_rows("equality", rows, rhs, compliance)

    def set_compliance(self, kind: str, inv_k, first: int = 0) -> None:
        """Replaces 1/k of rows from `first` on, length / force; of nodes with friction (kind "tangential") 1/k_t."""
        inv_k, number = numbers(inv_k, "compliance", (None,)), one_of(KINDS, kind, "kind")
        of = ("friction_compliance", self._handle) if kind == "tangential" else ("rows_compliance", self._handle, number)
        call(*of, first, inv_k.size, inv_k)

    def clear(self, kind: str) -> None:
        """Removes all rows of a kind but those of pairs; "contact" also removes the nodes with friction, which "tangential" removes alone."""
        call(*(("friction_clear", self._handle) if kind == "tangential" else ("rows_clear", self._handle, one_of(KINDS, kind, "kind"))))

    def add_friction(self, contact, rows: Any, coefficient=None, bound=None, compliance=None) -> range:
        """Nodes with friction, |lambda_t| <= bound + coefficient lambda_n. contact (nodes): number of the contact row of each node, -1: none.

        rows: T (dim nodes, unknowns), as in add_contact: dim rows, 1 in the plane and 2 in space, for a node; coefficient (nodes) or a number,
        no unit; bound (nodes) or a number, force; compliance 1/k_t, length / force. Returns the numbers of the nodes."""
        contact = integers(np.atleast_1d(np.asarray(contact)), "contact", (None,))
        m, ptr, body, dof, val = constraint_rows(rows, "rows")
        nodes = contact.size
        if nodes and m % nodes:
            raise ValueError(f"rows: {m} for {nodes} nodes")
        law = [optional(x, name, (nodes,)) for x, name in ((coefficient, "coefficient"), (bound, "bound"), (compliance, "compliance"))]
        first = written("friction_add_*", self._handle, nodes, m // nodes if nodes else 1, contact, ptr, body, dof, val, 0, law[0], law[1])
        if law[2] is not None:
            self.set_compliance("tangential", law[2], first)
        return range(first, first + nodes)

    def set_friction(self, coefficient=None, bound=None, first: int = 0, nodes: Optional[int] = None) -> None:
        """Replaces the law of nodes from `first` on: arrays, or a number for all."""
        sizes = [np.size(x) for x in (coefficient, bound) if np.ndim(x)]
        nodes = nodes if nodes is not None else sizes[0] if sizes else self._nodes()[0] - first
        law = optional(coefficient, "coefficient", (nodes,)), optional(bound, "bound", (nodes,))
        call("friction_law", self._handle, first, nodes, law[0], law[1])

    # ---- surfaces and pairs
    def add_surface(self, x, dof=None, faces=(), body: Union[Body, int, None] = None) -> Surface:
        """A surface over nodes at x (nodes, dim), length, with the unknowns dof (nodes, dim) of the body, below 0: held.

        Without body: unknowns of all bodies, by number or of the table. Without dof: a tool. faces: an array (m, k) of nodes from 0, or a
        list of such arrays; k = 2, 3 in the plane, 3, 6, 4, 8, 9 in space; the outside is where `outward` turns them. k = 1: points without faces."""
        x = numbers(x, "x", (None, None))
        dof = None if dof is None else integers(dof, "dof", x.shape)
        faces = [integers(f, "faces", (None, None)) for f in ([faces] if isinstance(faces, np.ndarray) else listed(faces, "faces"))]
        shapes = [one_of(SHAPES, (x.shape[1], f.shape[1]), "dimensions and nodes of a face") for f in faces]
        of, dim = _raw.FETI_ALL if body is None else int(body), x.shape[1]
        number = written("surface_add_*", self._handle, of, dim, len(x), x, dim, dof, dim, 0)
        for shape, nodes in zip(shapes, faces):
            call("surface_faces_*", self._handle, number, shape, len(nodes), nodes, 0)
        return Surface(self, number, x.shape)

    def add_plane(self, point, normal) -> Surface:
        """A rigid plane through a point with its outward normal, in 2 or 3 dimensions."""
        return self._rigid(_raw.FETI_PLANE, len(point), point, np.reshape(numbers(normal, "normal"), (len(point),)))

    def add_sphere(self, centre, radius: float) -> Surface:
        """A rigid sphere, in the plane a circle; a radius below 0 is a hole."""
        return self._rigid(_raw.FETI_SPHERE, len(centre), centre, [radius])

    def add_cylinder(self, point, axis, radius: float) -> Surface:
        """A rigid cylinder without ends; a radius below 0 is a hole."""
        return self._rigid(_raw.FETI_CYLINDER, 3, numbers(point, "point", (3,)), numbers(axis, "axis", (3,)), [radius])

    def _rigid(self, shape, dim, *data):
        data = numbers(np.concatenate([np.atleast_1d(np.asarray(d)) for d in data]), "data", (None,))
        return Surface(self, written("surface_rigid", self._handle, dim, shape, data), data.shape)

    def add_pair(self, slave: Surface, master: Surface, distance: float, method: str = "mortar", tied: bool = False, **numbers_by_name) -> Pair:
        """A pair that may meet; nodes up to `distance`, length, have a partner. method: "mortar" or "node_to_face"; keywords: see Pair.set."""
        way = one_of(METHODS, method, "method") + (_raw.FETI_TIED if tied else 0)
        number, first = written("pair_add", self._handle, int(slave), int(master), way, distance, of=(c_int64, c_int64))
        made = Pair(self, number, slave, first)
        made.set(**numbers_by_name)
        return made

    # ---- solve
    def solve(self, *, progress: Any = None, **options) -> Info:
        """Solves, and returns the report. Keywords are options, which stay.

        No answer: FetiError. An incomplete answer (info.status above 0, bool(info) is False): FetiWarning, which
        warnings.simplefilter("error", FetiWarning) makes an exception. Ctrl-C: KeyboardInterrupt; the problem can be solved again.
        progress: True shows a line by tqdm, if it is installed; a function gets a Progress, a true result cancels."""
        self.set(**options)
        with _bar() if progress is True else contextlib.nullcontext(progress or None) as watch:
            info = written("solve", self._handle, of=(Info,), by=lambda *arguments: self._run(*arguments, watch=watch))
        if info.status:
            warnings.warn(f"{info.name}: {LIBRARY.feti_status_text(info.status).decode()}", FetiWarning, stacklevel=2)
        return info

    # ---- answers
    def _all(self, n):
        return n if n is not None else self._width if self._width is not None else self._counts()[1]

    def multipliers(self, kind: str = "contact") -> np.ndarray:
        """Forces of rows: lambda >= 0 (rows) of "contact", mu (rows) of "equality", lambda_t (nodes, dim) of "tangential"."""
        size = self._size(kind)
        values = filled(size, "multipliers", self._handle, KINDS[kind], size)
        return values.reshape(self._nodes()) if kind == "tangential" else values

    def check(self, u=None, contact=None, equality=None, tangential=None) -> Certificate:
        """The certificate of an answer, by default the last one: u of all bodies, one after the other, and forces as multipliers gives them."""
        if u is None:
            u = np.concatenate([np.empty(0), *(body.displacement() for body in self._bodies)])
            contact, equality, tangential = (self.multipliers(kind) for kind in ("contact", "equality", "tangential"))
        given, sizes = (contact, equality, tangential), [self._size(kind) for kind in ("contact", "equality", "tangential")]
        contact, equality, tangential = (numbers(np.ravel(np.zeros(m) if x is None else x), "force", (m,)) for x, m in zip(given, sizes))
        u = numbers(u, "u", (self._counts()[1],))
        rows = [x for a in (u, contact, equality) for x in (a.size, a)]
        return written("check_friction", self._handle, *rows, *self._nodes(), tangential, of=(Certificate,), by=self._run)

    def diagnosis_rows(self, kind: str = "contact") -> Tuple[np.ndarray, np.ndarray]:
        """Rows that contradict each other, or repeat another one, and their weights."""
        count = c_int64()
        for _ in range(2):  # how many there are, then they
            row, weight = np.empty(count.value, dtype=np.int64), np.empty(count.value)
            call("diagnosis_rows", self._handle, one_of(KINDS, kind, "kind"), row.size, byref(count), row, weight)
        return row, weight

    def phases(self) -> Dict[str, Tuple[float, int]]:
        """Seconds and bytes of each phase of the last setup or solve."""
        phases = [written("phase_at", self._handle, k, of=(Phase,)) for k in range(written("phase_count", self._handle))]
        return {phase.name.decode(): (phase.seconds, phase.bytes) for phase in phases}


@contextlib.contextmanager
def _bar():
    """A function that shows progress by tqdm, or None without tqdm."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(total=100, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}") as bar:

        def show(now):
            setup = now.fraction == now.fraction
            bar.n = 100 * now.fraction if setup else 100
            bar.set_description("setup" if setup else f"step {now.steps}, {now.active} closed, residual {now.residual:.1e}", refresh=False)
            bar.update(0)

        yield show
        bar.n = 100
        bar.refresh()


def _unpickled(data, width):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "problem.feti")
        path.write_bytes(data)
        return Problem.read(path, width)


def serve(communicator: Any) -> None:
    """On ranks other than 0: works for the problems of rank 0, until rank 0 makes this call, too. Every rank makes it once. communicator: of mpi4py."""
    from ._mpi import stream_of

    stream = stream_of(communicator)
    stream.run(lambda: call("serve", byref(stream.table)), lambda: None)
