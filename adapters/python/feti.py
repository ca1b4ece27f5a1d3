"""feti-contact from Python: the C functions that the three hosts of this folder call, by ctypes and numpy. It is no package: copy it.

    p = feti.Problem()
    body = p.body_add(n)               # p.NAME(...) calls feti_NAME(p, ...) with the arguments of C, less those that C writes: these are returned
    p.body_load(body, n, load)         # an array has the type of the C function and lies in one piece: no copy is made in silence
    info = p.solve()                   # an answer that is incomplete has info.status above 0; all else is an exception with the text of the library

The library: FETI_CONTACT_LIBRARY, or the one that pkg-config knows, or that of the system."""

import ctypes
import os
import subprocess

import numpy as np

FULL, COPY, ALL = 0, 0, -1
LINE2, LINE3, QUAD4 = 1, 2, 5
NODE_TO_FACE, MORTAR = 1, 2
FORCE, PRESSURE, SHEAR, GAP, SLIP, AREA, NORMAL, CLOSED = range(1, 9)

INTEGER, NUMBER = ctypes.c_int64, ctypes.c_double


def struct(**fields):
    """The first fields of a struct of the library, which writes no more than `struct_size` bytes."""
    return type("Struct", (ctypes.Structure,), {"_fields_": [("struct_size", INTEGER), *fields.items()]})


def integers(names):
    return dict.fromkeys(names.split(), INTEGER)


Info = struct(
    status=ctypes.c_int32, reserved=ctypes.c_int32, **integers("bodies dofs rows equalities floating_modes active undetermined steps"),
    **integers("cg_steps expansions releases dual_applications coarse_solves factorisations analyses"), worst=NUMBER,
)  # fmt: skip
PairFacts = struct(
    **integers("rows without closed sticking slipping"), force=NUMBER * 3, moment=NUMBER * 3, closed_area=NUMBER, pressure=NUMBER,
    pressure_node=INTEGER, angle=NUMBER, angle_node=INTEGER, depth=NUMBER, depth_node=INTEGER, master_depth=NUMBER,
)  # fmt: skip

# Arguments after the handle: i 32 bits, l 64 bits, d number, s text, I and D arrays, - NULL; out: > 64 bits, or a struct.
ARRAY = {"I": np.ctypeslib.ndpointer(np.int32, flags="C"), "D": np.ctypeslib.ndpointer(np.float64, flags="C")}
TYPES = {"i": ctypes.c_int32, "l": INTEGER, "d": NUMBER, "s": ctypes.c_char_p, "-": ctypes.c_void_p, **ARRAY}
CALLS = {
    "body_add": "l>", "body_stiffness_i32": "llIIDiii", "body_load": "llD", "displacement": "llD",
    "surface_add_i32": "lilDlIli>", "surface_faces_i32": "lilIi", "surface_move": "lDl",
    "pair_add": "llid>-", "pair_set_f64": "lslD", "pairs_find": "", "pairs_commit": "", "pair_field": "lilD",
    "solve": [Info], "pair_info": ["l", PairFacts],
}  # fmt: skip


class Error(Exception):
    """What the library refused, in its own words; `name` is that of the status."""

    def __init__(self, status):
        text = ctypes.create_string_buffer(2000)
        LIBRARY.feti_last_error(text, INTEGER(len(text)))
        super().__init__(text.value.decode())
        self.name = LIBRARY.feti_status_name(ctypes.c_int32(status)).decode()


def path():
    if given := os.environ.get("FETI_CONTACT_LIBRARY"):
        return given
    try:
        folder = subprocess.check_output(["pkg-config", "--variable=libdir", "feti_contact"], text=True, stderr=subprocess.DEVNULL)
        return os.path.join(folder.strip(), "libfeti_contact.so")
    except (OSError, subprocess.CalledProcessError):
        return "libfeti_contact.so.0.2"  # its soname, where the system has its libraries


LIBRARY = ctypes.CDLL(path())
LIBRARY.feti_status_name.restype = ctypes.c_char_p


class Problem:
    def __init__(self):
        self.handle = ctypes.c_void_p()
        if status := LIBRARY.feti_problem_create(ctypes.byref(self.handle)):
            raise Error(status)

    def __del__(self):
        LIBRARY.feti_problem_destroy(ctypes.byref(self.handle))

    def __getattr__(self, name):
        if name not in CALLS:
            raise AttributeError(f"feti_{name} is not in CALLS of {__file__}")
        kinds, function = CALLS[name], LIBRARY["feti_" + name]  # a function object of its own, whose types belong to this call

        def call(*given):
            given, out, arguments, types = iter(given), [], [], []
            for kind in kinds:
                made = INTEGER() if kind == ">" else kind(struct_size=ctypes.sizeof(kind)) if isinstance(kind, type) else None
                if made is not None:
                    out.append(made)
                types.append(ctypes.c_void_p if made is not None else TYPES[kind])
                arguments.append(ctypes.byref(made) if made is not None else None if kind == "-" else next(given))
            function.argtypes = [ctypes.c_void_p, *types]
            status = function(self.handle, *arguments)
            if status < 0:
                raise Error(status)
            return getattr(out[0], "value", out[0]) if out else None

        return call


def outward(faces, x, inside):
    """Faces (m, k) with their corners first, turned so that `inside` (m, dim), a point of each element, is behind them.

    In the plane the body is then on the left of a line with 2 or 3 nodes; in space corners go counterclockwise seen from outside."""
    start = x[faces[:, 0]]
    along, to_body = x[faces[:, 1]] - start, inside - start
    if x.shape[1] == 2:
        wrong = along[:, 0] * to_body[:, 1] < along[:, 1] * to_body[:, 0]
        turned = faces[:, [1, 0, *range(2, faces.shape[1])]]
    else:
        wrong = np.einsum("ij,ij->i", np.cross(along, x[faces[:, 2]] - start), to_body) > 0
        turned = faces[:, ::-1]
    return np.ascontiguousarray(np.where(wrong[:, None], turned, faces), dtype=np.int32)
