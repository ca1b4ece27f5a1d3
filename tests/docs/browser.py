"""Each kind of fault that tools/docs/browser.py is to find, in a page of its own, and a page without any."""

import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
import browser  # noqa: E402

LONG = "x = y + " * 60
PAGES = {
    "request": ('<script src="http://example.org/a.js"></script>', "request to http://example.org/a.js"),
    "missing": ('<img src="no.png">', "not loaded"),
    "console": ("<script>console.error('wrong')</script>", "console: ['wrong']"),
    "exception": ("<script>nothing()</script>", "exception: ReferenceError"),
    "wide": ('<div style="width: 3000px">a</div>', "the page is"),
    "cut": (f'<p style="overflow: hidden; white-space: nowrap">{LONG}</p>', "cut: x = y"),
    "scrolled": (f'<pre style="overflow-x: auto">{LONG}</pre>', "has to be scrolled to be read"),
    "good": (f'<p>a</p><pre style="white-space: pre-wrap">{LONG}</pre>', None),
}


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        for name, (body, _) in PAGES.items():
            text = f'<!DOCTYPE html><html><head><meta charset="utf-8"></head><body>{body}</body></html>'
            (Path(folder) / f"{name}.html").write_text(text, encoding="utf-8")
        faults, number = browser.check(Path(folder), program)
    assert number == len(PAGES), number
    for name, (_, expected) in PAGES.items():
        found = [line for line in faults if line.startswith(f"{name}.html")]
        assert (any(expected in line for line in found) if expected else not found), (name, found)


main(sys.argv[1])
