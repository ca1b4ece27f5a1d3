#!/usr/bin/env python3
"""stage.py PAGES OUT: puts the sources of the book together in the folder OUT.

The chapters are those of docs/book/SUMMARY.md, read where they are; the reference pages are those of the folder PAGES
(feti-bindgen --pages, feti-reference). In OUT a chapter lies where docs/ has it, README.md as introduction.md, the reference
below reference/, a page for each source of the examples below examples_c/ and examples_fortran/. Links to chapters, examples
and pictures follow; a link to another file of the repository becomes its text; the name of a function between ticks becomes
a link to its page. Exit status 1 where a chapter is missing or a document is none."""

import os
import re
import shutil
import sys
from pathlib import Path

import markdown

ROOT = Path(__file__).resolve().parents[2]
SUMMARY = ROOT / "docs/book/SUMMARY.md"
ENTRY = re.compile(r"(?P<before>\s*- \[.*\]\()(?P<target>[^)]+)(?P<after>\).*)")
PICTURES = {".svg", ".png"}
# The script that colours programs in the book does not know these languages and says so on the console; docs/book/search.js
# colours Fortran.
UNCOLOURED = re.compile(r"^( *```)(fortran|cmake)$", re.M)
EXAMPLES = {"examples_c": "C", "examples_fortran": "Fortran"}
LANGUAGES = {".c": "c", ".h": "c", ".f90": "fortran", ".f": "fortran"}
# An example in a table: its number and its name.
NUMBERED = re.compile(r"(?<=[|,] )\d\d(?= [A-Za-z])")
# Parts of the documents that are not made from documents: where a link to their sources leads, from the book.
PARTS = {ROOT / "include/feti_contact.h": "reference/functions.md", ROOT / "include/fortran": "../fortran/module/feti_contact.html",
         ROOT / "src/lib.rs": "../rust/feti_contact/index.html"}
REFERENCE = ["functions", "types", "options", "statuses"]


def staged(path):
    """Where a document of the repository lies in the book."""
    path = path.relative_to(ROOT)
    return "introduction.md" if path.name == "README.md" else path.as_posix().removeprefix("docs/")


def chapters():
    """The documents that the table of contents names, in its order."""
    lines = SUMMARY.read_text(encoding="utf-8").splitlines()
    return [(SUMMARY.parent / m.group("target")).resolve() for m in map(ENTRY.match, lines) if m]


def faults(listed):
    """Chapters that are missing, documents that are no chapter."""
    shown = SUMMARY.relative_to(ROOT)
    missing = [path for path in listed if not path.is_file()]
    unlisted = sorted(set((ROOT / "docs").glob("*.md")) - set(listed))
    return [f"{shown}: no {path.relative_to(ROOT)}" for path in missing] + [
        f"{path.relative_to(ROOT)}: not in {shown}" for path in unlisted
    ]


def examples():
    """The sources of the examples, twins one after the other, then what they share."""
    found = [path for folder in EXAMPLES for path in (ROOT / folder).iterdir() if path.suffix in LANGUAGES]
    return sorted(found, key=lambda path: (not path.stem[0].isdigit(), path.stem, path.parent.name))


def numbered(number, folder):
    """The number of an example as a link from that folder to its first source."""
    path = next((path for path in examples() if path.name.startswith(f"{number}_")), None)
    return f"[{number}]({os.path.relpath(path, folder)})" if path else number


class Stage:
    """Writes the chapters, given those of the book and the functions that have a page."""

    def __init__(self, out, listed, functions):
        self.out, self.functions = out, functions
        self.places = {path: staged(path) for path in listed} | {path: f"{staged(path)}.md" for path in examples()} | PARTS

    def chapter(self, path):
        here = Path(self.places[path]).parent

        def link(_line, whole, opened, target, closed):
            return self.link(path, here, whole, opened, target, closed)

        def code(whole, words):
            page = self.functions.get(words)
            return f"[{whole}]({os.path.relpath(page, here)})" if page else whole

        text = path.read_text(encoding="utf-8")
        if path.name in ("README.md", "examples.md"):
            text = re.sub(r"^\|.*", lambda row: NUMBERED.sub(lambda number: numbered(number[0], path.parent), row[0]), text, flags=re.M)
        self.write(self.places[path], markdown.rewrite(text, link, code))

    def example(self, path):
        text = path.read_text(encoding="utf-8")
        twins = [twin for twin in examples() if twin.stem == path.stem and twin.parent != path.parent]
        beside = [f"[the same in {EXAMPLES[twin.parent.name]}](../{self.places[twin]})" for twin in twins]
        calls = [f"[`{name}`](../{page})" for name, page in self.functions.items() if re.search(rf"\b{name}\b", text)]
        head = ", ".join(["[All examples](../examples.md)", *beside]) + ("\n\nCalls " + ", ".join(calls) if calls else "")
        code = f'<div class="example">\n\n```{LANGUAGES[path.suffix]}\n{text}```\n\n</div>\n'
        self.write(self.places[path], f"# {path.name}\n\n{head}\n\n{code}")

    def link(self, path, here, whole, opened, target, closed):
        name, mark, anchor = target.partition("#")
        if not name or ":" in name:
            return whole
        file = (path.parent / name).resolve()
        if file in self.places:
            return opened + os.path.relpath(self.places[file], here) + mark + anchor + closed
        if file.suffix in PICTURES:
            place = staged(file)
            (self.out / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, self.out / place)
            return opened + os.path.relpath(place, here) + closed
        return opened[opened.index("[") + 1 : opened.rindex("]")]

    def summary(self, pages):
        lines = []
        for line in SUMMARY.read_text(encoding="utf-8").splitlines():
            entry = ENTRY.match(line)
            if entry:
                file = (SUMMARY.parent / entry.group("target")).resolve()
                line = entry.group("before") + self.places[file] + entry.group("after")
            lines.append(line)
            if entry and file.name == "examples.md":
                lines += [f"  - [{path.name}]({self.places[path]})" for path in examples()]
        lines += ["", "# Reference", ""]
        for name in REFERENCE:
            lines.append(f"- [{title(pages / f'{name}.md')}](reference/{name}.md)")
            if name == "functions":
                lines += [f"  - [{name}]({page})" for name, page in self.functions.items()]
        self.write("SUMMARY.md", "\n".join(lines) + "\n")

    def write(self, place, text):
        file = self.out / place
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(UNCOLOURED.sub(r"\1text,\2", text), encoding="utf-8")


def in_order(pages):
    """The functions that have a page, as functions.md lists them."""
    listed = re.findall(r"\((feti_\w+)\.md\)", (pages / "functions.md").read_text(encoding="utf-8"))
    names = [page.stem for page in sorted(pages.glob("feti_*.md"))]
    return sorted(names, key=lambda name: listed.index(name) if name in listed else len(listed))


def title(page):
    return markdown.headings(page.read_text(encoding="utf-8"))[0]


def main(pages, out):
    listed = chapters()
    if wrong := faults(listed):
        print("\n".join(wrong), file=sys.stderr)
        return 1
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(pages, out / "reference", ignore=shutil.ignore_patterns("man"))
    names = in_order(pages)
    for page in (out / "reference").glob("*.md"):
        page.write_text(UNCOLOURED.sub(r"\1text,\2", page.read_text(encoding="utf-8")), encoding="utf-8")
    stage = Stage(out, listed, {name: f"reference/{name}.md" for name in names})
    for path in listed:
        stage.chapter(path)
    for path in examples():
        stage.example(path)
    stage.summary(pages)
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()))
