"""The check of links against trees with known faults."""

import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools/docs"))
import check_links  # noqa: E402


def broken(files):
    """The faults that are found in a tree of these files, by name."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve() / "root"
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        (root.parent / "outside.md").write_text("", encoding="utf-8")
        paths = sorted(path for path in root.rglob("*") if path.suffix in check_links.KINDS)
        return check_links.check(root, paths)[0]


def expect(files, *faults):
    found = broken(files)
    assert found == list(faults), f"{files}\nexpected {faults}\nfound    {found}"


def markdown_is_checked():
    other = {"b.md": "# The `k` of B, [twice](a.md)\n\n# x\n\n# x\n\n<a id=\"here\"></a>\n"}
    expect(other | {"a.md": "[t](b.md) [t](b.md#the-k-of-b-twice) [t](b.md#x) [t](b.md#x-1) [t](b.md#here) [t](.)\n"})
    expect(other | {"a.md": "\n[over two\nlines](c.md)\n"}, "a.md:3: c.md: no such file")
    expect(other | {"a.md": "[t](b.md#x-2)\n"}, "a.md:1: b.md#x-2: no such anchor")
    expect(other | {"a.md": "![t](p.svg) [`code`](d/) [n]\n\n[n]: e.md\n"}, *[
        f"a.md:{line}: {to}: no such file" for line, to in ((1, "p.svg"), (1, "d/"), (3, "e.md"))])
    expect(other | {"a.md": "[t](../outside.md)\n"}, "a.md:1: ../outside.md: leads out of the tree")
    expect(other | {"a.md": "[t](/b.md)\n"}, "a.md:1: /b.md: not relative")
    expect(other | {"a.md": "[t](build/x)\n", "build/x": ""}, "a.md:1: build/x: leads to what is built")


def code_has_no_links_and_no_anchors():
    expect({"a.md": "```c\n[t](no.md)\n```\n\n    [t](no.md)\n\n`[t](no.md)` ``[t](`no.md)`` [t](a.md)\n"})
    expect({"a.md": "```sh\n# x\n```\n\n[t](#x)\n"}, "a.md:5: #x: no such anchor")
    expect({"a.md": "````text\n```\n````\n\n[t](no.md)\n"}, "a.md:5: no.md: no such file")


def html_is_checked():
    other = {"d/index.html": '<p id="x">', "s.html": '<a id="1"></a><a id="9"></a><a id="A%3CT%3E">'}
    expect(other | {"a.html": '<a href="d/#x"></a><a href="s.html#1-9">1</a><a href="s.html#A%3CT%3E"><img src="https://example.org/x">'})
    expect(other | {"a.html": '\n<a href="d/#y">'}, "a.html:2: d/#y: no such anchor")
    expect(other | {"a.html": '<a href="s.html#1-8">'}, "a.html:1: s.html#1-8: no such anchor")
    expect(other | {"a.html": '<img src="p%20q.svg">'}, "a.html:1: p%20q.svg: no such file")


for test in (markdown_is_checked, code_has_no_links_and_no_anchors, html_is_checked):
    test()
