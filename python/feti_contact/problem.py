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
from ctypes import byref, c_double, c_int32, c_int64, c_void_p
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _raw
from ._arrays import at, constraint_rows, counted, filled, integers, listed, numbers, reported, rows_of, together
from ._library import LIBRARY, FetiError, FetiWarning, call, interruptible
from ._records import Certificate, Findings, Info, Progress
from .parts import KINDS, METHODS, SHAPES, Body, Pair, Surface, one_of, optional

LOG = logging.getLogger("feti_contact")
FOUND = object()  # null_space: the library finds it


def _option_types():
    option = _raw.feti_option(struct_size=ctypes.sizeof(_raw.feti_option))
    for k in range(LIBRARY.feti_option_count()):
        LIBRARY.feti_option_at(k, byref(option))
        yield option.name.decode(), option.type


OPTIONS = dict(_option_types())


class _Calls:
    """What the library calls back. An exception is kept and ends the call; it holds no reference to the problem."""

    def __init__(self):
        self.error, self.watch = None, None
        self.on_log = _raw.feti_log_fn(lambda _, level, text: self.catch(lambda: self.write(level, text), -1))
        self.on_progress = _raw.feti_progress_fn(lambda _, now: self.catch(lambda: int(bool(self.watch(Progress._of(bytes(now.contents))))), -1))

    def catch(self, work, failed):
        try:
            return work() or 0
        except BaseException as error:  # raised again by the call that runs
            self.error = self.error or error
            return failed

    def write(self, level, text):
        LOG.log({1: logging.INFO, 2: logging.DEBUG}.get(level, 5), text.decode(errors="replace"))


class Problem:
    """Bodies, rows, options and the last answer. One thread at a time; several may use different problems. Keywords are options (docs/options.md).

    `with` or close() frees its memory at once, otherwise the garbage collection does; every call on a closed problem is a FetiError."""

    def __init__(self, **options):
        self._handle, self._kept, self._width, self._calls = c_void_p(), {}, None, _Calls()
        self._bodies, self._alone = [], threading.Lock()
        call("problem_create", byref(self._handle))
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

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        if not self._handle:
            return "<Problem, closed>"
        return "<Problem: {} bodies, {} unknowns, {} contact rows, {} equality rows>".format(*self._counts())

    def __reduce__(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "problem.feti")
            self.write(path)
            with open(path, "rb") as file:
                return _unpickled, (file.read(), self._width)

    def write(self, path: Union[str, os.PathLike]) -> None:
        """Writes all input to a problem file; not the answer, surfaces (their rows are written), saved states and functions."""
        call("problem_write", self._handle, os.fsencode(path))

    @classmethod
    def read(cls, path: Union[str, os.PathLike], width: Optional[int] = None) -> Problem:
        """The problem of a file. width: largest number of the host + 1, for arrays over all bodies, if bodies have numbers."""
        p = cls()
        call("problem_read", p._handle, os.fsencode(path))
        p._width = width
        for number in range(p._counts()[0]):
            body = Body(p, number, 0)
            body.n = body.info.unknowns
            p._bodies.append(body)
        return p

    def _keep(self, what, number, objects):
        self._kept[what, number] = objects

    def _widen(self, n):
        self._width = max(self._width or 0, n)

    @property
    def _catch(self):
        return self._calls.catch

    def _counts(self):
        four = [c_int64() for _ in range(4)]
        call("counts", self._handle, *map(byref, four))
        return [n.value for n in four]

    def _nodes(self) -> Tuple[int, int]:
        nodes, dim = c_int64(), c_int32()
        call("friction_counts", self._handle, byref(nodes), byref(dim))
        return nodes.value, dim.value

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
            return interruptible(lambda: call(name, self._handle, *arguments), lambda: LIBRARY.feti_cancel(self._handle))
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
            kind, key = OPTIONS.get(name), name.encode()
            if kind == _raw.FETI_OPTION_F64:
                call("set_f64", self._handle, key, float(value))
            elif kind == _raw.FETI_OPTION_I64:
                call("set_i64", self._handle, key, integers(int(value) if isinstance(value, bool) else value, name).item())
            else:
                call("set_str", self._handle, key, str(value).encode())

    def get(self, name: str) -> Union[int, float, str]:
        """The present value of an option."""
        key, kind = name.encode(), OPTIONS.get(name)
        if kind in (_raw.FETI_OPTION_F64, _raw.FETI_OPTION_I64):
            value = (c_double if kind == _raw.FETI_OPTION_F64 else c_int64)()
            call("get_f64" if kind == _raw.FETI_OPTION_F64 else "get_i64", self._handle, key, byref(value))
            return value.value
        size, text = c_int64(), ctypes.create_string_buffer(1000)
        call("get_str", self._handle, key, text, len(text), byref(size))
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
        body = Body(self, counted("body_add", self._handle, operator.index(n)), n)
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

    def load(self, f, n: Optional[int] = None) -> None:
        """Gives the loads of all bodies (see displacement)."""
        f = numbers(f, "load", (self._all(n),))
        call("body_load", self._handle, _raw.FETI_ALL, f.size, at(f))

    def dof_table(self, number, terms=None, constant=None) -> None:
        """Names all n unknowns of the host: number (n) in K, below 0: eliminated, u = constant + terms u; terms (n, n) sparse or dense."""
        number = integers(number, "number", (None,), np.int64)
        n, ptr, term, factor = number.size, None, None, None
        if terms is not None:
            ptr, term, factor, rows, columns = rows_of(terms, "terms")
            if (rows, columns) != (n, n):
                raise ValueError(f"terms: shape {(rows, columns)}, not {(n, n)}")
            ptr, term = ptr.astype(np.int64), term.astype(np.int64)
        constant = optional(constant, "constant", (n,))
        call("dof_table_i64", self._handle, n, at(number), at(ptr), at(term), at(factor), at(constant), 0)
        self._width = n

    # ---- rows
    def _add_rows(self, kind, rows, rhs, compliance):
        m, ptr, body, dof, val = constraint_rows(rows, "rows")
        rhs, compliance = optional(rhs, "right-hand side", (m,)), optional(compliance, "compliance", (m,))
        (ptr, body, dof), ending = together(ptr, body, dof)
        first = counted(f"rows_add_{ending}", self._handle, KINDS[kind], m, at(ptr), at(body), at(dof), at(val), 0, at(rhs))
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

    def set_rhs(self, kind: str, rhs, first: int = 0) -> None:
        """Replaces c or h of rows from `first` on. kind: "contact" or "equality"."""
        rhs = numbers(rhs, "rhs", (None,))
        call("rows_rhs", self._handle, one_of(KINDS, kind, "kind"), first, rhs.size, at(rhs))

    def set_compliance(self, kind: str, inv_k, first: int = 0) -> None:
        """Replaces 1/k of rows from `first` on, length / force; of nodes with friction (kind "tangential") 1/k_t."""
        inv_k, number = numbers(inv_k, "compliance", (None,)), one_of(KINDS, kind, "kind")
        of = ("friction_compliance", self._handle) if kind == "tangential" else ("rows_compliance", self._handle, number)
        call(*of, first, inv_k.size, at(inv_k))

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
        (contact, ptr, body, dof), ending = together(contact, ptr, body, dof)
        arrays = map(at, (contact, ptr, body, dof, val))
        first = counted(f"friction_add_{ending}", self._handle, nodes, m // nodes if nodes else 1, *arrays, 0, at(law[0]), at(law[1]))
        if law[2] is not None:
            self.set_compliance("tangential", law[2], first)
        return range(first, first + nodes)

    def set_friction(self, coefficient=None, bound=None, first: int = 0, nodes: Optional[int] = None) -> None:
        """Replaces the law of nodes from `first` on: arrays, or a number for all."""
        sizes = [np.size(x) for x in (coefficient, bound) if np.ndim(x)]
        nodes = nodes if nodes is not None else sizes[0] if sizes else self._nodes()[0] - first
        law = optional(coefficient, "coefficient", (nodes,)), optional(bound, "bound", (nodes,))
        call("friction_law", self._handle, first, nodes, at(law[0]), at(law[1]))

    def commit_friction(self) -> None:
        """Ends a load step: slips count from the last answer."""
        call("friction_commit", self._handle)

    # ---- surfaces and pairs
    def add_surface(self, x, dof=None, faces=(), body: Union[Body, int, None] = None) -> Surface:
        """A surface over nodes at x (nodes, dim), length, with the unknowns dof (nodes, dim) of the body, below 0: held.

        Without body: unknowns of all bodies, by number or of the table. Without dof: a tool. faces: an array (m, k) of nodes from 0, or a
        list of such arrays; k = 2, 3 in the plane, 3, 6, 4, 8, 9 in space; the outside is where `outward` turns them. k = 1: points without faces."""
        x = numbers(x, "x", (None, None))
        dof = None if dof is None else integers(dof, "dof", x.shape, np.int64)
        faces = [integers(f, "faces", (None, None), np.int64) for f in ([faces] if isinstance(faces, np.ndarray) else listed(faces, "faces"))]
        shapes = [one_of(SHAPES, (x.shape[1], f.shape[1]), "dimensions and nodes of a face") for f in faces]
        of, dim = _raw.FETI_ALL if body is None else int(body), x.shape[1]
        number = counted("surface_add_i64", self._handle, of, dim, len(x), at(x), dim, at(dof), dim, 0)
        for shape, nodes in zip(shapes, faces):
            call("surface_faces_i64", self._handle, number, shape, len(nodes), at(nodes), 0)
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
        return Surface(self, counted("surface_rigid", self._handle, dim, shape, at(data)), data.shape)

    def add_pair(self, slave: Surface, master: Surface, distance: float, method: str = "mortar", tied: bool = False, **numbers_by_name) -> Pair:
        """A pair that may meet; nodes up to `distance`, length, have a partner. method: "mortar" or "node_to_face"; keywords: see Pair.set."""
        pair, first = c_int64(), c_int64()
        way = one_of(METHODS, method, "method") + (_raw.FETI_TIED if tied else 0)
        call("pair_add", self._handle, int(slave), int(master), way, distance, byref(pair), byref(first))
        made = Pair(self, pair.value, slave, first.value)
        made.set(**numbers_by_name)
        return made

    def find_pairs(self) -> None:
        """Finds partners at the present positions and makes the rows of all pairs."""
        self._run("pairs_find")

    def commit_pairs(self) -> None:
        """Begins the next load step at the present positions."""
        call("pairs_commit", self._handle)

    # ---- solve
    def setup(self) -> None:
        """Null spaces and factors; solve makes them when they are due."""
        self._run("setup")

    def solve(self, *, progress: Any = None, **options) -> Info:
        """Solves, and returns the report. Keywords are options, which stay.

        No answer: FetiError. An incomplete answer (info.status above 0, bool(info) is False): FetiWarning, which
        warnings.simplefilter("error", FetiWarning) makes an exception. Ctrl-C: KeyboardInterrupt; the problem can be solved again.
        progress: True shows a line by tqdm, if it is installed; a function gets a Progress, a true result cancels."""
        self.set(**options)
        info = Info()
        with contextlib.ExitStack() as stack:
            self._run("solve", byref(info), watch=stack.enter_context(_bar()) if progress is True else progress or None)
        if info.status:
            warnings.warn(f"{info.name}: {LIBRARY.feti_status_text(info.status).decode()}", FetiWarning, stacklevel=2)
        return info

    def cancel(self) -> None:
        """Ends the setup or solve that runs, from any thread: it returns with FETI_CANCELLED."""
        call("cancel", self._handle)

    # ---- answers
    def _all(self, n):
        return n if n is not None else self._width if self._width is not None else self._counts()[1]

    def displacement(self, n: Optional[int] = None) -> np.ndarray:
        """u of all bodies, length: one after the other, or by number or of the table (0 where a number has no unknown); n: its length."""
        u = np.zeros(self._all(n))
        call("displacement", self._handle, _raw.FETI_ALL, u.size, at(u))
        return u

    def reaction(self, kind: str = "all", n: Optional[int] = None) -> np.ndarray:
        """Force of the rows on all bodies: K u = f + r; of one kind: "contact", "equality", "tangential"."""
        r = np.zeros(self._all(n))
        call("reaction", self._handle, one_of(KINDS, kind, "kind"), _raw.FETI_ALL, r.size, at(r))
        return r

    def multipliers(self, kind: str = "contact") -> np.ndarray:
        """Forces of rows: lambda >= 0 (rows) of "contact", mu (rows) of "equality", lambda_t (nodes, dim) of "tangential"."""
        size = self._size(kind)
        values = filled(size, "multipliers", self._handle, KINDS[kind], size)
        return values.reshape(self._nodes()) if kind == "tangential" else values

    def gaps(self) -> np.ndarray:
        """Open gap c - B u (+ lambda/k) of each contact row, length."""
        rows = self._size("contact")
        return filled(rows, "gaps", self._handle, rows)

    def active(self) -> np.ndarray:
        """State of each contact row: 0 open, 1 closed, 2 touches without a force, 3 unknown."""
        rows = self._size("contact")
        return filled(rows, "active", self._handle, rows, dtype=np.int32)

    def slips(self) -> np.ndarray:
        """Slip (nodes, dim) of the nodes with friction, length."""
        shape = self._nodes()
        return filled(shape, "friction_slips", self._handle, *shape)

    def friction_states(self) -> np.ndarray:
        """State of each node with friction: 0 open, 1 sticks, 2 slips, 3 at its bound without a slip, 4 unknown."""
        nodes = self._nodes()[0]
        return filled(nodes, "friction_states", self._handle, nodes, dtype=np.int32)

    def check(self, u=None, contact=None, equality=None, tangential=None) -> Certificate:
        """The certificate of an answer, by default the last one: u of all bodies, one after the other, and forces as multipliers gives them."""
        if u is None:
            u = np.concatenate([body.displacement() for body in self._bodies])
            contact, equality, tangential = (self.multipliers(kind) for kind in ("contact", "equality", "tangential"))
        given, sizes = (contact, equality, tangential), [self._size(kind) for kind in ("contact", "equality", "tangential")]
        contact, equality, tangential = (numbers(np.ravel(np.zeros(m) if x is None else x), "force", (m,)) for x, m in zip(given, sizes))
        u, out = numbers(u, "u", (self._counts()[1],)), Certificate()
        rows = [x for a in (u, contact, equality) for x in (a.size, at(a))]
        self._run("check_friction", *rows, *self._nodes(), at(tangential), byref(out))
        return out

    def start_from(self, kind: str, values) -> None:
        """Start values of the next solve: forces as multipliers gives them."""
        values = numbers(np.ravel(values), "values", (self._size(kind),))
        call("start_from", self._handle, KINDS[kind], values.size, at(values))

    # ---- states, diagnosis
    def save(self) -> int:
        """Saves loads, rows, friction, forces; returns the number for restore and drop."""
        return counted("state_save", self._handle)

    def restore(self, state: int) -> None:
        """Goes back to a saved state, which stays saved."""
        call("state_restore", self._handle, state)

    def drop(self, state: int) -> None:
        """Drops a saved state."""
        call("state_drop", self._handle, state)

    def diagnosis(self) -> Findings:
        """What the last solve, or the last failed setup, found out."""
        return reported(Findings, "diagnosis", self._handle)

    def diagnosis_rows(self, kind: str = "contact") -> Tuple[np.ndarray, np.ndarray]:
        """Rows that contradict each other, or repeat another one, and their weights."""
        count = c_int64()
        call("diagnosis_rows", self._handle, one_of(KINDS, kind, "kind"), 0, byref(count), None, None)
        row, weight = np.empty(count.value, dtype=np.int64), np.empty(count.value)
        call("diagnosis_rows", self._handle, KINDS[kind], row.size, byref(count), at(row), at(weight))
        return row, weight

    def phases(self) -> Dict[str, Tuple[float, int]]:
        """Seconds and bytes of each phase of the last setup or solve."""
        phase, out = _raw.feti_phase(struct_size=ctypes.sizeof(_raw.feti_phase)), {}
        for k in range(counted("phase_count", self._handle)):
            call("phase_at", self._handle, k, byref(phase))
            out[phase.name.decode()] = (phase.seconds, phase.bytes)
        return out


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
        path = os.path.join(folder, "problem.feti")
        with open(path, "wb") as file:
            file.write(data)
        return Problem.read(path, width)
