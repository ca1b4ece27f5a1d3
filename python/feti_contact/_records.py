"""Reports of the library as objects with the fields of the C structs (feti_contact.h has their meaning) and a readable repr."""

import ctypes

from . import _raw
from ._library import LIBRARY


class Record(ctypes.Structure):
    """Fields that are 0 or do not apply (-1, NaN) are left out of the repr."""

    def __init__(self):
        super().__init__()
        self.struct_size = ctypes.sizeof(self)

    def as_dict(self):
        """The fields that are not 0 and apply, by name."""
        values = {name: getattr(self, name) for name, _ in self._fields_ if name != "struct_size"}
        values = {name: tuple(value) if isinstance(value, ctypes.Array) else value for name, value in values.items()}
        says = lambda x: any(y == y and y for y in x) if isinstance(x, tuple) else x == x and x not in (0, -1)  # noqa: E731
        return {name: value for name, value in values.items() if says(value) or name in ("status", "passed")}

    def __repr__(self):
        text = lambda x: f"{x:.6g}" if isinstance(x, float) else f"({', '.join(map(text, x))})" if isinstance(x, tuple) else str(x)  # noqa: E731
        fields = {name: text(value) for name, value in self.as_dict().items()}
        if "status" in fields:
            fields["status"] = LIBRARY.feti_status_name(self.status).decode()
        return f"{type(self).__name__}({', '.join(f'{name}={value}' for name, value in fields.items())})"

    def __reduce__(self):
        return type(self)._of, (bytes(self),)

    @classmethod
    def _of(cls, data):
        return cls.from_buffer_copy(data)


class Info(Record):
    """What a solve did and how good the answer is: feti_info. `worst` <= 1: the certificate passes. Truth value: the answer is complete."""

    _fields_ = _raw.feti_info._fields_

    @property
    def name(self):
        """Name of the status, such as "FETI_OK"."""
        return LIBRARY.feti_status_name(self.status).decode()

    def __bool__(self):
        return self.status == 0
