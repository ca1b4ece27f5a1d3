"""The shared library: where it is, calls that raise, and calls that Ctrl-C ends."""

import ctypes
import os
import threading
from concurrent.futures import Future
from pathlib import Path

import numpy as np

from . import _raw

#: ctypes takes the last bits of numbers beyond these.
LIMITS = {ctypes.c_int32: 2**31, ctypes.c_int64: 2**63}
PLACES = ("body", "component", "dof", "row", "entry", "element", "node", "pair", "face", "rank")


def load() -> ctypes.CDLL:
    """The library of FETI_CONTACT_LIBRARY if this is set, otherwise the one of the package."""
    beside = [path for ending in ("so", "dylib") for path in Path(__file__).parent.glob(f"libfeti_contact.{ending}")]
    path = os.environ.get("FETI_CONTACT_LIBRARY") or (beside and beside[0])
    if not path:
        raise ImportError("the package has no libfeti_contact: install it by pip, or set FETI_CONTACT_LIBRARY to the path of the library")
    library = ctypes.CDLL(str(path))
    for name, (result, arguments) in _raw.FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


LIBRARY = load()


class FetiError(Exception):
    """What the library refused or could not do, in its own words.

    status: number below 0 (above 0 where an incomplete answer has been made an error); name: "FETI_LOAD_NOT_HELD", ...
    place: what the numbers of the text name, such as {"body": 1, "row": 1, "entry": 2}; they count from 0
    function, argument, value, limit: C function, its refused argument (0: none; the handle is 1), the number found, its limit (None: none)"""

    def __init__(self, status: int, text: str = "", detail=None):
        super().__init__(text or LIBRARY.feti_status_text(status).decode())
        self.status, self.name = status, LIBRARY.feti_status_name(status).decode()
        detail = detail if detail is not None and detail.status == status else None
        self.place = {key: getattr(detail, key) for key in PLACES if getattr(detail, key) >= 0} if detail else {}
        self.function = detail.function.decode() if detail else ""
        self.argument = detail.argument if detail else 0
        number = lambda x: None if x != x else x  # noqa: E731
        self.value, self.limit = (number(detail.value), number(detail.limit)) if detail else (None, None)

    def __reduce__(self):
        return FetiError, (self.status, str(self)), self.__dict__


class FetiWarning(UserWarning):
    """An answer is incomplete: the status of a solve is above 0."""


def last_error(status: int) -> FetiError:
    """The error that the library has kept for this thread."""
    text = ctypes.create_string_buffer(LIBRARY.feti_last_error(None, 0) + 1)
    LIBRARY.feti_last_error(text, len(text))
    detail = _raw.feti_error_detail(struct_size=ctypes.sizeof(_raw.feti_error_detail))
    LIBRARY.feti_last_error_detail(ctypes.byref(detail))
    return FetiError(status, text.value.decode(errors="replace") if detail.status == status else "", detail)


def call(name: str, *arguments) -> int:
    """Calls feti_NAME; a status below 0 is a FetiError. Arguments as ctypes takes them, and arrays in one piece.

    NAME_*: the function for the integers of the arrays, which are copied only if their types differ."""
    if name.endswith("*"):
        integers = [a for a in arguments if isinstance(a, np.ndarray) and a.dtype.kind == "i"]
        kind = np.result_type(np.int32, *integers)
        arguments = [np.ascontiguousarray(a, kind) if any(a is one for one in integers) else a for a in arguments]
        name = name[:-1] + f"i{8 * kind.itemsize}"
    function, kept = getattr(LIBRARY, "feti_" + name), arguments
    assert all(a.flags.c_contiguous for a in kept if isinstance(a, np.ndarray))
    arguments = [a.ctypes.data if isinstance(a, np.ndarray) else a for a in kept]
    for kind, argument in zip(function.argtypes, arguments):
        if kind in LIMITS and isinstance(argument, int) and not -LIMITS[kind] <= argument < LIMITS[kind]:
            raise OverflowError(f"feti_{name}: {argument} does not fit into {8 * ctypes.sizeof(kind)} bits")
    try:
        status = function(*arguments)
    except ctypes.ArgumentError as wrong:
        raise TypeError(f"feti_{name}: {wrong}") from None
    if status < 0:
        raise last_error(status)
    return status


def interruptible(work, cancel):
    """`work()`, which a signal handler that raises, as that of Ctrl-C, ends by `cancel()` at the next place where the library can stop.

    Python runs signal handlers on the main thread alone, and never inside a call of C: there `work` has a thread of its own."""
    if threading.current_thread() is not threading.main_thread():
        return work()
    outcome, stopped = Future(), []

    def run():
        try:
            outcome.set_result(None if stopped else work())
        except BaseException as error:  # handed over
            outcome.set_exception(error)

    worker = threading.Thread(target=run, name="feti_contact", daemon=True)
    try:
        worker.start()
        return outcome.result()
    except BaseException:
        stopped.append(True)
        while worker.is_alive() and not outcome.done():  # the arrays in use must not go, however often Ctrl-C is pressed
            try:
                cancel()
                worker.join(0.02)
            except BaseException:
                pass
        raise
    finally:
        del outcome  # the traceback of its error has this frame
