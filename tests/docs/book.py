"""The sources of the book, put together from the documents as they are and three reference pages."""

import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
import check_links  # noqa: E402
import markdown  # noqa: E402
import stage  # noqa: E402


def every_document_is_a_chapter():
    listed = stage.chapters()
    assert not stage.faults(listed), stage.faults(listed)
    assert stage.faults(listed + [ROOT / "docs/no.md"]) == ["docs/book/SUMMARY.md: no docs/no.md"]
    first = next(path for path in listed if path.parent == ROOT / "docs")
    listed.remove(first)
    assert stage.faults(listed) == [f"docs/{first.name}: not in docs/book/SUMMARY.md"]


def every_link_of_the_book_leads_somewhere():
    with tempfile.TemporaryDirectory() as folder:
        pages, book = Path(folder).resolve() / "pages", Path(folder).resolve() / "book"
        pages.mkdir()
        for name in stage.REFERENCE + ["feti_solve", "feti_gaps"]:
            (pages / f"{name}.md").write_text(f"# Title of {name}\n", encoding="utf-8")
        listed = "# Title of functions\n\n[feti_solve](feti_solve.md) [feti_gaps](feti_gaps.md)\n"
        (pages / "functions.md").write_text(listed, encoding="utf-8")
        assert stage.main(pages, book) == 0
        for part in ("fortran/module/feti_contact.html", "rust/feti_contact/index.html"):
            (book.parent / part).parent.mkdir(parents=True)
            (book.parent / part).touch()
        errors, _ = check_links.check(book.parent, sorted(book.rglob("*.md")))
        assert not errors, errors
        summary = (book / "SUMMARY.md").read_text(encoding="utf-8")
        assert "- [Where to begin](start.md)" in summary and "  - [feti_solve](reference/feti_solve.md)" in summary
        assert summary.index("feti_solve.md") < summary.index("feti_gaps.md"), "the order of functions.md"
        assert "- [Title of statuses](reference/statuses.md)" in summary
        shown = {path.relative_to(book).as_posix() for path in book.glob("examples_*/*.md")}
        sources = [path for folder in stage.EXAMPLES for path in (ROOT / folder).iterdir() if path.name != "Makefile"]
        assert shown == {f"{path.parent.name}/{path.name}.md" for path in sources} and all(page in summary for page in shown)
        example = (book / "examples_c/01_spring_and_block.c.md").read_text(encoding="utf-8")
        assert "the same in Fortran](../examples_fortran/01_spring_and_block.f90.md)" in example
        assert "[`feti_solve`](../reference/feti_solve.md)" in example
        assert (ROOT / "examples_c/01_spring_and_block.c").read_text(encoding="utf-8") in example
        assert "| [20](examples_fortran/20_skyline_host.f.md) skyline host |" in (book / "examples.md").read_text(encoding="utf-8")


def links_follow_and_names_of_functions_become_links():
    page, here = ROOT / "docs/a.md", ROOT / "docs/certificate.md"
    with tempfile.TemporaryDirectory() as folder:
        book = stage.Stage(Path(folder), [here, ROOT / "README.md"], {"feti_solve": "reference/feti_solve.md"})

        def staged(text):
            code = lambda whole, words: f"[{whole}]({book.functions[words]})" if words in book.functions else whole
            link = lambda _line, *parts: book.link(page, Path("."), *parts)
            return markdown.rewrite(text, link, code)

        assert staged("[c](certificate.md#x) [r](../README.md)") == "[c](certificate.md#x) [r](introduction.md)"
        assert staged("see [`l`](../src/error.rs), `feti_solve`") == "see `l`, [`feti_solve`](reference/feti_solve.md)"
        assert staged("[f](../include/fortran) [e](../examples_c/demo.h)") == "[f](../fortran/module/feti_contact.html) [e](examples_c/demo.h.md)"
        assert staged("# On `feti_solve`\n\n    `feti_solve`\n") == "# On `feti_solve`\n\n    `feti_solve`\n"
        assert staged("[t](https://example.org) [`feti_solve`](#x)") == "[t](https://example.org) [`feti_solve`](#x)"


for test in (every_document_is_a_chapter, every_link_of_the_book_leads_somewhere,
             links_follow_and_names_of_functions_become_links):
    test()
