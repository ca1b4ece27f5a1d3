#!/usr/bin/env python3
"""names.py DOCS: writes DOCS/book/names.js, what the search of the start page finds: names and headings of the book, names of the Fortran
modules, of the crate, of statuses and options, each as [name, kind, page]."""

import html
import json
import re
import sys
from pathlib import Path

HEADING = re.compile(r'<h[1-4] id="([^"]+)"><a class="header" href="[^"]*">(.*?)</a></h')
ROW = re.compile(r"^\| `(\w+)` \|", re.M)
ITEM = re.compile(r'<a href="([\w/]*?(\w+)\.\w+\.html)">([^<]*::[^<]*)</a>')
METHOD = re.compile(r'id="method\.(\w+)"')


def plain(text):
    return html.unescape(re.sub(r"<[^>]+>", "", text))


def of_book(book):
    for page in sorted(book.rglob("*.html")):
        place = page.relative_to(book).as_posix()
        found = [(anchor, plain(text)) for anchor, text in HEADING.findall(page.read_text(encoding="utf-8"))]
        if not found or place in ("index.html", "print.html", "toc.html", "404.html"):
            continue
        title = found[0][1]
        if place.startswith("examples_"):
            yield title, "example in C" if place.startswith("examples_c") else "example in Fortran", place
        elif place.startswith("reference/feti_"):
            yield title, "C function", place
        else:
            yield title, "page", place
            yield from ((text, title, f"{place}#{anchor}") for anchor, text in found[1:])


def of_tables(source):
    """Statuses and options: the row of the page that explains it, else of the reference."""
    for kind, explained in (("statuses", "statuses"), ("options", "options")):
        rows = [set(ROW.findall((source / f"{page}.md").read_text(encoding="utf-8"))) for page in (f"reference/{kind}", explained)]
        for name in sorted(rows[0]):
            page = explained if name in rows[1] else f"reference/{kind}"
            yield name, {"statuses": "status", "options": "option"}[kind], f"{page}.html#:~:text={name}"


def of_fortran(fortran):
    for kind in ("module", "interface", "type", "proc"):
        for page in sorted((fortran / kind).glob("*.html")):
            name = page.stem.upper() if page.stem.startswith("ft") else page.stem
            if "~" not in name:
                yield name, f"Fortran {kind}" if kind in ("module", "type") else "Fortran", f"../fortran/{kind}/{page.name}"


def of_rust(crate):
    for place, kind, name in ITEM.findall((crate / "all.html").read_text(encoding="utf-8")):
        yield name, f"Rust {kind}", f"../rust/{crate.name}/{place}"
        own = re.split('id="(?:deref-methods|trait-implementations)', (crate / place).read_text(encoding="utf-8"), maxsplit=1)[0]
        yield from ((f"{name.split('::')[-1]}::{method}", "Rust", f"../rust/{crate.name}/{place}#method.{method}") for method in METHOD.findall(own))


def main(docs):
    parts = [of_book(docs / "book"), of_tables(docs / "source"), of_fortran(docs / "fortran"), of_rust(docs / "rust/feti_contact")]
    names = [sorted(set(part)) for part in parts]
    lines = ",\n".join(json.dumps(entry, ensure_ascii=False) for part in names for entry in part)
    (docs / "book/names.js").write_text(f"window.NAMES = [\n{lines}\n];\n", encoding="utf-8")
    missing = [len(part) for part in names].count(0)
    return f"names.py: {missing} parts without a name" if missing else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1]).resolve()))
