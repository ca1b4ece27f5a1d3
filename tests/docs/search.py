"""search.py DOCS CHROMIUM: what the start page of the documents finds, as a reader types it, and that each page is there."""

import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote, urlsplit

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools/docs"))
import browser  # noqa: E402

# What is typed, and the first page that is found, below the documents.
FOUND = {
    "feti_solve": "book/reference/feti_solve.html", "FETI_SLIDES": "book/statuses.html", "direct_limit": "book/options.html",
    "feti_body_stiffness": "fortran/interface/feti_body_stiffness.html", "FTBSKY": "fortran/proc/ftbsky.html",
    "problem::solve": "rust/feti_contact/solver/struct.Problem.html", "quadratic conv": "book/newton.html",
    "01_spring": "book/examples_c/01_spring_and_block.c.html", "module for newton": "book/start.html",
}
TYPE = """new Promise((done) => {
    const [input, list] = document.getElementById("names").children;
    input.value = TEXT;
    input.dispatchEvent(new Event("input"));
    const wait = () => list.children.length ? done([...list.querySelectorAll("a")].map((link) => link.href)) : setTimeout(wait, 20);
    wait();
})"""


def main(docs, program):
    docs = Path(docs).resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        window = browser.Browser(program, profile)
        try:
            window.begin()
            window.open(docs / "book/start.html", 1200, False)
            for text, expected in FOUND.items():
                found = window.call("Runtime.evaluate", expression=TYPE.replace("TEXT", repr(text)), returnByValue=True, awaitPromise=True)
                pages = [Path(unquote(urlsplit(link).path)) for link in found["result"]["value"]]
                assert pages[0] == docs / expected, (text, pages[0])
                assert all(page.is_file() for page in pages), (text, pages)
        finally:
            window.end()


main(*sys.argv[1:])
