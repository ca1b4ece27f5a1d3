#!/usr/bin/env python3
"""check_links.py markdown ROOT   every Markdown file of the repository
   check_links.py html DIR        every HTML file below DIR

Relative links and their anchors have to lead somewhere; each that does not is an error with file and line. Links to
other hosts are counted, and listed with --external. Exit status 1 where a link is broken, 2 where there is no file."""

import functools
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import markdown

BUILT = {".git", "build", "target"}
LINES = re.compile(r"(\d+)-(\d+)$")


class Page(HTMLParser):
    """Links, as (line, target), and anchors of an HTML page; where it forwards to, if it does."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors, self.forward = [], set(), None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors.update(given[key] for key in ("id", "name") if given.get(key))
        # What is no link: a base, and scripts that a page can do without (rustdoc names some that it does not write).
        if tag == "base" or tag == "script" and "async" in given:
            return
        if tag == "meta" and given.get("http-equiv") == "refresh":
            self.forward = given["content"].partition("=")[2]
        self.links += [(self.getpos()[0], given[key]) for key in ("href", "src", "data") if given.get(key)]


class Text:
    """The same of a Markdown file."""

    def __init__(self, text):
        self.links, self.anchors, self.forward = markdown.links(text), markdown.anchors(text), None


@functools.lru_cache(maxsize=None)
def read(path):
    return KINDS[path.suffix](path.read_text(encoding="utf-8"))


KINDS = {".html": Page, ".md": Text}


def has_anchor(path, anchor):
    """Also `12-30`, lines of a source, where both are anchors; an anchor of a page that forwards is one of its target."""
    page = read(path)
    if page.forward:
        path = (path.parent / unquote(page.forward)).resolve()
        return path.is_file() and has_anchor(path, anchor)
    known = page.anchors
    lines = LINES.match(anchor)
    return anchor in known or unquote(anchor) in known or bool(lines and known.issuperset(lines.groups()))


def fault(root, path, link):
    """What is wrong with a link of the file `path`, or None."""
    parts = urlsplit(link)
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if not target.is_relative_to(root):
        return "leads out of the tree"
    if path.suffix == ".html" and target.is_dir():
        target /= "index.html"
    if not target.exists():
        return "no such file"
    if path.suffix == ".md" and BUILT.intersection(target.relative_to(root).parts):
        return "leads to what is built"
    anchor = parts.fragment
    if anchor and target.suffix in KINDS and not has_anchor(target, anchor):
        return "no such anchor"
    return None


def check(root, paths):
    """(errors, external): the broken links, as lines; where links to other hosts are, by link."""
    errors, external = [], {}
    for path in paths:
        for line, link in read(path).links:
            place = f"{path.relative_to(root)}:{line}"
            if urlsplit(link).scheme in ("http", "https"):
                external.setdefault(link, place)
            elif urlsplit(link).scheme in ("data", "mailto", "javascript"):
                continue
            elif link.startswith("/"):
                errors.append(f"{place}: {link}: not relative")
            elif what := fault(root, path, link):
                errors.append(f"{place}: {link}: {what}")
    return errors, external


def main(arguments):
    listed = "--external" in arguments
    arguments = [a for a in arguments if a != "--external"]
    if len(arguments) != 2 or arguments[0] not in ("markdown", "html"):
        print(__doc__, file=sys.stderr)
        return 2
    root = Path(arguments[1]).resolve()
    suffix = {"markdown": "md", "html": "html"}[arguments[0]]
    paths = sorted(root.rglob(f"*.{suffix}"))
    if suffix == "md":
        paths = [path for path in paths if not BUILT.intersection(path.relative_to(root).parts)]
    errors, external = check(root, paths)
    for error in errors:
        print(error, file=sys.stderr)
    if listed:
        for link, place in sorted(external.items()):
            print(f"external {link} ({place})")
    count = sum(len(read(path).links) for path in paths)
    print(f"{len(paths)} files, {count} links, {len(external)} of them to other hosts, {len(errors)} broken")
    return 2 if not paths else 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
