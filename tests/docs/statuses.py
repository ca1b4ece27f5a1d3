"""docs/statuses.md has every status of the header with its number, once, and no other."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main():
    header = (ROOT / "include/feti_contact.h").read_text(encoding="utf-8")
    section = header[header.index("/* ==== Statuses and version ====") :]
    defined = re.findall(r"^#define (FETI_\w+) (-?\d+)$", section, re.M)
    page = (ROOT / "docs/statuses.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| `(FETI_\w+)` \| (-?\d+) \|", page, re.M)
    assert len(defined) > 20, defined
    assert sorted(listed) == sorted(defined), set(listed) ^ set(defined)


main()
