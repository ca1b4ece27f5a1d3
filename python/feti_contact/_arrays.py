"""Arrays and matrices as the library takes them: what fits is passed as it is, what loses digits is refused."""

from ctypes import byref, c_int64
from typing import Any, Optional

import numpy as np

from ._library import call


def numbers(x, name, shape=None):
    """float64 in one piece, by rows; integers and arrays with gaps are copied, everything else of numpy is a TypeError."""
    a = np.asarray(x)
    if a.size == 0 and a.dtype == object or a.dtype.kind not in "fiub" or a.dtype.kind == "f" and a.dtype.itemsize != 8:
        raise TypeError(f"{name}: numbers of type {a.dtype}, not float64; convert them if you mean it, float32 has lost digits")
    return np.ascontiguousarray(fitting(a, name, shape), dtype=np.float64)


def integers(x, name, shape=None, dtype=None):
    """int32 or int64 in one piece, by rows; other integers are copied to int64, everything else is a TypeError."""
    a = np.asarray(x)
    if a.size == 0 and a.dtype == np.float64:
        a = a.astype(np.int64)
    if a.dtype.kind not in "iu":
        raise TypeError(f"{name}: numbers of type {a.dtype}, not integers")
    dtype = np.dtype(dtype or (a.dtype.newbyteorder("=") if a.dtype.kind == "i" and a.dtype.itemsize in (4, 8) else np.int64))
    if a.size and not np.can_cast(a.dtype, dtype) and not np.iinfo(dtype).min <= int(a.min()) <= int(a.max()) <= np.iinfo(dtype).max:
        raise OverflowError(f"{name}: numbers from {a.min()} to {a.max()} do not fit into {8 * dtype.itemsize} bits")
    return np.ascontiguousarray(fitting(a, name, shape), dtype=dtype)


def fitting(a, name, shape):
    if shape is not None and (a.ndim != len(shape) or any(want not in (None, has) for want, has in zip(shape, a.shape))):
        want = ", ".join("any" if n is None else str(n) for n in shape)
        raise ValueError(f"{name}: shape {a.shape}, not ({want}{',' if len(shape) == 1 else ''})")
    return a


def filled(shape, name, *arguments, dtype=np.float64):
    """An array of this shape that feti_NAME fills, its last argument; 0 where it writes nothing."""
    out = np.zeros(shape, dtype)
    call(name, *arguments, out)
    return out


def written(name, *arguments, of=(c_int64,), by=call):
    """What feti_NAME writes to its last arguments, of these types: a number or a report, or a tuple of several."""
    out = [kind() for kind in of]
    by(name, *arguments, *map(byref, out))
    values = tuple(getattr(x, "value", x) for x in out)
    return values if len(values) > 1 else values[0]


def one_of(table, key, name):
    if key not in table:
        raise ValueError(f"{name}: {key!r}, not one of {', '.join(map(repr, table))}")
    return table[key]


def optional(x: Any, name: str, shape) -> Optional[np.ndarray]:
    """Numbers of this shape, also from one number for all; None remains None."""
    if x is None:
        return None
    return numbers(np.full(shape, float(x)) if np.ndim(x) == 0 and np.asarray(x).dtype.kind in "fiu" else x, name, shape)


def is_sparse(matrix):
    return hasattr(matrix, "tocsr")


def as_csr(matrix, name):
    """scipy ends the process if it converts a matrix whose indices are outside: they are checked before."""
    if matrix.format == "coo":
        for index, n in zip((matrix.row, matrix.col), matrix.shape):
            if index.shape != matrix.data.shape or index.size and not 0 <= index.min() <= index.max() < n:
                raise ValueError(f"{name}: rows or columns of the triplets are outside {matrix.shape}, or not as many as values")
    elif matrix.format != "csr" and hasattr(matrix, "check_format"):
        matrix.check_format(full_check=True)
    return matrix.tocsr()


def listed(x, name):
    """A sequence of arrays; a sparse matrix is none."""
    if is_sparse(x):
        raise TypeError(f"{name}: a sparse matrix, not a sequence of arrays")
    return list(x)


def compressed(ptr, col, val, n, name):
    """Pointers, indices and values of a compressed matrix with n rows, of lengths that C may rely on."""
    ptr, col, val = integers(ptr, name + ".indptr", (n + 1,)), integers(col, name + ".indices", (None,)), numbers(val, name + ".data", (None,))
    if not 0 <= ptr[-1] <= min(col.size, val.size):
        raise ValueError(f"{name}: indptr ends with {ptr[-1]}, but there are {col.size} indices and {val.size} values")
    return ptr, col, val


def rows_of(matrix, name):
    """(row pointers, columns, values, rows, columns of all) of a scipy.sparse matrix or of a dense one; duplicates are summed by the library."""
    if is_sparse(matrix):
        matrix = as_csr(matrix, name)
        ptr, col, val = compressed(matrix.indptr, matrix.indices, matrix.data, matrix.shape[0], name)
        return ptr, col, val, *matrix.shape
    dense = numbers(matrix, name)
    dense = fitting(dense.reshape(1, -1) if dense.ndim == 1 else dense, name, (None, None))
    row, col = np.nonzero(dense)
    ptr = np.concatenate([[0], np.cumsum(np.count_nonzero(dense, axis=1))])
    return ptr, col, dense[row, col], *dense.shape


def constraint_rows(rows, name):
    """Row pointers, bodies (None: unknowns of the whole model), unknowns and values, from a matrix or {body: matrix}."""
    if not isinstance(rows, dict):
        ptr, col, val, m, _ = rows_of(rows, name)
        return m, ptr, None, col, val
    parts = [(int(body), *rows_of(matrix, f"{name}[{int(body)}]")) for body, matrix in rows.items()]
    heights = [part[4] for part in parts]
    if len(set(heights)) != 1:
        raise ValueError(f"{name}: the matrices of the bodies have {heights} rows")
    m, entries = heights[0], []
    for body, ptr, col, val, *_ in parts:
        end = ptr[-1]
        entries.append((np.repeat(np.arange(m), np.diff(ptr)), np.full(end, body, dtype=np.int64), col[:end].astype(np.int64), val[:end]))
    row, body, dof, val = map(np.concatenate, zip(*entries))
    order = np.argsort(row, kind="stable")
    ptr = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=m))])
    return m, ptr, body[order], dof[order], val[order]


def outward(faces, x, inside):
    """Faces (m, k), corners first, turned so that `inside` (m, dim), a point of the element of each, is behind them.

    x (nodes, dim). In the plane the body is then on the left of a line; in space corners go counterclockwise seen from outside.
    Mid nodes stay with their edges: lines of 2 and 3 nodes, triangles of 3 and 6, quadrilaterals of 4, 8 and 9."""
    faces, x, inside = integers(faces, "faces", (None, None)), numbers(x, "x", (None, None)), numbers(inside, "inside", (None, None))
    k, start = faces.shape[1], x[faces[:, 0]]
    along, to_body = x[faces[:, 1]] - start, inside - start
    if x.shape[1] == 2:
        wrong = along[:, 0] * to_body[:, 1] < along[:, 1] * to_body[:, 0]
        order = [1, 0, *range(2, k)]
    else:
        wrong = np.einsum("ij,ij->i", np.cross(along, x[faces[:, 2]] - start), to_body) > 0
        corners = 3 if k in (3, 6) else 4
        edges = [corners + e for e in reversed(range(corners - 1))] + [2 * corners - 1] if k > corners else []
        order = [*reversed(range(corners)), *edges, *range(2 * corners, k)]
    return np.where(wrong[:, None], faces[:, order], faces)
