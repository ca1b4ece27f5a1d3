"""Bodies, surfaces and pairs: numbers of a problem with the calls that are about them."""

from __future__ import annotations

from ctypes import byref, c_int64
from dataclasses import dataclass
from typing import Any, Callable, Tuple

import numpy as np

from . import _raw
from ._arrays import as_csr, compressed, filled, fitting, integers, is_sparse, listed, numbers, one_of, optional
from ._library import call
from ._methods import FIELDS, MOTIONS, STORAGE, BodyCalls, PairCalls

TURNED = {"full": "full", "lower": "upper", "upper": "lower"}
# (dim, nodes of a face): shape of the library
SHAPES = {(dim, 1): _raw.FETI_POINT for dim in (2, 3)}
SHAPES.update({(2, 2): _raw.FETI_LINE2, (2, 3): _raw.FETI_LINE3, (3, 3): _raw.FETI_TRI3, (3, 6): _raw.FETI_TRI6})
SHAPES.update({(3, 4): _raw.FETI_QUAD4, (3, 8): _raw.FETI_QUAD8, (3, 9): _raw.FETI_QUAD9})


@dataclass(frozen=True, repr=False)
class Part:
    """`int(part)` is its number in the problem."""

    problem: Any
    number: int

    def __index__(self):
        return self.number

    @property
    def _handle(self):
        return self.problem._handle

    def _call(self, name, *arguments):
        return call(name, self._handle, self.number, *arguments)


@dataclass(frozen=True, repr=False)
class Body(BodyCalls, Part):
    """A body with `n` unknowns. f, u, r are vectors (n); force and length are in units of the host."""

    n: int

    def __repr__(self):
        return f"<Body {self.number}: {self.n} unknowns>"

    def stiffness(self, K: Any, storage: str = "full", copy: bool = True) -> None:
        """Gives K (n, n), force per length: scipy.sparse or dense; of CSR no column of a row twice, of COO what is at one place is added.

        storage: "full", "lower" or "upper": the triangle that is given. copy=False lends the arrays of a lower triangle in CSR with int32,
        ascending columns and every diagonal entry; they become read-only and are kept until K is replaced or the problem closed."""
        one_of(STORAGE, storage, "storage")
        lent = []
        if not is_sparse(K):
            K = numbers(K, "K", (self.n, self.n))
            self._call("body_stiffness_dense", self.n, K, self.n, STORAGE[TURNED[storage]], _raw.FETI_COPY)
        elif fitting(K, "K", (self.n, self.n)).format == "coo":
            row, col = integers(K.row, "K.row", (None,)), integers(K.col, "K.col", (None,))
            val = numbers(K.data, "K.data", row.shape)
            self._call("body_stiffness_triplets_*", self.n, val.size, row, col, val, 0, STORAGE[storage], _raw.FETI_COPY)
        else:
            storage = TURNED[storage] if K.format == "csc" else storage  # rows of K' = K
            K = K if K.format == "csc" else as_csr(K, "K")
            ptr, col, val = compressed(K.indptr, K.indices, K.data, self.n, "K")
            self._call("body_stiffness_*", self.n, ptr, col, val, 0, STORAGE[storage], _raw.FETI_COPY if copy else _raw.FETI_BORROW)
            lent = [] if copy else [val, col][: self.info.borrowed]
        for array in lent:
            array.flags.writeable = False
        self.problem._kept[self.number] = lent

    def skyline(self, ptr, values, diagonal=None, up: bool = False) -> None:
        """Gives K by its profile: column j of the upper triangle has values[ptr[j]:ptr[j + 1]], downwards or (up) from the diagonal upwards.

        ptr (n + 1) from 0; diagonal (n): the columns are without it."""
        ptr, values = integers(ptr, "ptr", (self.n + 1,)), numbers(values, "values", (None,))
        if not 0 <= ptr[-1] <= values.size:
            raise ValueError(f"ptr ends with {ptr[-1]}, but there are {values.size} values")
        diagonal = optional(diagonal, "diagonal", (self.n,))
        self._call("body_stiffness_skyline_*", self.n, diagonal, ptr, values, 0, int(up), _raw.FETI_COPY)
        self.problem._kept.pop(self.number, None)

    def values(self, K: Any) -> None:
        """Gives new values of K in the pattern and order of the first: a matrix of the same form, or its values alone. The analysis is kept."""
        if is_sparse(K) or np.ndim(K) == 1:
            val = numbers(K.data if is_sparse(K) else K, "values", (None,))
            self._call("body_values", val.size, val)
            kept = self.problem._kept.get(self.number)
            if kept:  # the values of a matrix that is lent are replaced by these
                val.flags.writeable = False
                kept[0] = val
        else:
            K = numbers(K, "K", (self.n, self.n))
            self._call("body_values_dense", self.n, K, self.n)

    def elements(self, dofs, matrices, storage: str = "full") -> None:
        """Gives K by its elements: dofs (elements, k) and matrices (elements, k, k), or lists of arrays of several sizes. dofs below 0 are held.

        Option `pieces` and coordinates come before. The matrices are symmetric; only the triangle `storage` is read."""
        dofs, matrices = [integers(d, "dofs", (None,), np.int64) for d in listed(dofs, "dofs")], listed(matrices, "matrices")
        ptr = np.concatenate([[0], np.cumsum([d.size for d in dofs], dtype=np.int64)])
        dof = np.concatenate([np.empty(0, dtype=np.int64), *dofs])
        if len(matrices) != len(dofs):
            raise ValueError(f"matrices: {len(matrices)} for {len(dofs)} elements")
        ke = [numbers(m, f"matrices[{e}]", (d.size, d.size)) for e, (m, d) in enumerate(zip(matrices, dofs))]
        part = one_of({"full": lambda n: slice(n), "lower": np.tril_indices, "upper": np.triu_indices}, storage, "storage")
        self._call("body_mesh_*", len(dofs), ptr, dof, 0)
        ke = np.concatenate([np.empty(0), *(m[part(len(m))].ravel() for m in ke)])
        self._call("body_elements", 0, len(dofs), ke, STORAGE[TURNED[storage]])  # by rows, not by columns
        self.problem._kept.pop(self.number, None)

    def operator(self, diagonal, kplus: Callable, k: Callable, concurrent: bool = False) -> None:
        """Gives K by functions: k(X) and kplus(X) return K X and K+ X for X (n, columns). The null space must be given, too.

        diagonal (n): that of K. concurrent: they may run on several threads at once. Their exceptions come out of the solve."""
        diagonal = numbers(diagonal, "diagonal", (self.n,))
        functions = [_raw.feti_operator_fn(self._applied(f, self.problem._calls.catch)) for f in (kplus, k)]
        self._call("body_operator", self.n, diagonal, *functions, int(concurrent), None)
        self.problem._kept[self.number] = functions

    @staticmethod
    def _applied(function, catch):
        view = lambda p, n, m, ld: np.ctypeslib.as_array((_raw.c_double * (ld * m)).from_address(p)).reshape(m, ld)[:, :n].T  # noqa: E731

        def run(_, body, n, m, x, ldx, y, ldy):
            def work():
                X = view(x, n, m, ldx)
                X.flags.writeable = False
                view(y, n, m, ldy)[...] = np.asarray(function(X)).reshape(n, m)

            return catch(work, -1)

        return run

    def null_space(self, R: Any, kind: str = "exact") -> None:
        """Gives the motions R (n, r) or (n) that K does not resist; None: there are none. kind: "exact", "candidates" or "soft" (weakly resisted)."""
        if R is None:
            self._call("body_no_null_space")
            return
        R = np.asarray(R)
        R = fitting(numbers(R.reshape(-1, 1) if R.ndim == 1 else R, "null_space"), "null_space", (self.n, None))
        columns = np.ascontiguousarray(R.T)
        self._call("body_null_space", R.shape[1], self.n, columns, self.n, one_of(MOTIONS, kind, "kind"))

    def coordinates(self, xyz, node=None, direction=None, kind: str = "candidates") -> None:
        """Gives the places from which the library makes rigid motions: of nodes with an unknown for each direction, xyz (n / dim, dim), or of
        each unknown, xyz (n, dim) with its label node (n) and direction (n): 1 to 3 displacement along x, y, z, 4 to 6 rotation."""
        xyz = numbers(xyz, "coordinates", (None, None))
        dim = xyz.shape[1]
        if node is None and direction is None:
            fitting(xyz, "coordinates", (self.n // max(dim, 1), dim))
            node, direction = np.repeat(np.arange(len(xyz)), dim), np.tile(np.arange(1, dim + 1), len(xyz))
            xyz = np.repeat(xyz, dim, axis=0)
        xyz = fitting(xyz, "coordinates", (self.n, dim))
        node, direction = integers(node, "node", (self.n,), np.int32), integers(direction, "direction", (self.n,), np.int32)
        self._call("body_coordinates_flags", one_of(MOTIONS, kind, "kind"))
        self._call("body_coordinates", dim, self.n, node, direction, xyz, dim)

    def numbering(self, number) -> None:
        """Gives the host's number of each unknown (n), from 0: for rows of the whole model and for arrays over all bodies."""
        number = integers(number, "number", (self.n,))
        self._call("body_numbering_*", self.n, number, 0)
        self.problem._width = max(self.problem._width or 0, int(number.max()) + 1)

    def motions(self) -> np.ndarray:
        """The null space that the library uses, (n, r); makes a setup if one is due."""
        r = c_int64()
        self._call("body_null_space_get", self.n, byref(r), None, 0)
        R = np.empty((r.value, self.n))
        self._call("body_null_space_get", self.n, byref(r), R, self.n)
        return R.T

    def surface(self, x, dof=None, faces=()) -> Surface:
        """A surface over nodes of the body: see Problem.add_surface."""
        return self.problem.add_surface(x, dof, faces, body=self)


@dataclass(frozen=True, repr=False)
class Surface(Part):
    """A surface with its positions x (nodes, dim), or a rigid shape."""

    shape: Tuple[int, ...]

    def __repr__(self):
        return f"<Surface {self.number}: {'%d nodes in %d dimensions' % self.shape if len(self.shape) == 2 else 'rigid'}>"

    def move(self, x) -> None:
        """Gives new positions: x (nodes, dim), length, or the numbers of a rigid shape."""
        x = numbers(x, "x", self.shape)
        self._call("surface_move", x, x.shape[-1])


@dataclass(frozen=True, repr=False)
class Pair(PairCalls, Part):
    """A pair of surfaces; its rows `first` to `first + rows - 1` are contact rows, of a tie equality rows."""

    slave: Surface
    first: int

    def __repr__(self):
        return f"<Pair {self.number}: {self.info!r}>"

    def set(self, **numbers_by_name) -> None:
        """friction, cohesion, offset, compliance (a number, or one for each slave node), adjust, on, angle, depth, thickness, axisymmetric."""
        for name, value in numbers_by_name.items():
            value = fitting(np.atleast_1d(numbers(value, name)), name, (None,))
            if value.size not in (1, self.slave.shape[0]):
                raise ValueError(f"{name}: {value.size} numbers, not 1 or {self.slave.shape[0]}, the nodes of the slave")
            self._call("pair_set_f64", name.encode(), value.size, value)

    def field(self, name: str) -> np.ndarray:
        """force, pressure, gap, area, closed (nodes) or shear, slip, normal (nodes, dim) at the nodes of the slave; 0 without a partner."""
        field = one_of(FIELDS, name, "field")
        shape = self.slave.shape if name in ("shear", "slip", "normal") else self.slave.shape[:1]
        return filled(shape, "pair_field", self._handle, self.number, field, int(np.prod(shape)))
