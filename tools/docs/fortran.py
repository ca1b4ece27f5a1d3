#!/usr/bin/env python3
"""fortran.py sources OUT: the Fortran sources as a host sees them, for the pages of their documentation.
fortran.py pages FOLDER: the pages that ford has made of them in FOLDER, without requests to the network.

In OUT a procedure has the name by which module feti_contact exports it; what the modules share among themselves, the
interfaces of the C functions and the modules of the FORTRAN 77 face are left out. The pages that ford makes load styles,
a script and formulas from servers; here they get the style docs/book/fortran.css and need neither script nor formulas.
"""

import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "include/fortran"
STYLE = ROOT / "docs/book/fortran.css"
WHOLE, C = "feti_contact", "feti_contact_c"
# What ford writes into the head of a page: everything from the first style on, and scripts elsewhere.
HEAD = re.compile(r"<!-- Bootstrap -->.*?</head>", re.S)
# What a module uses of the other modules and of the compiler.
USES = re.compile(r'<div class="card mb-4">\s*<h3 class="card-header card-title bg-light">Uses</h3>.*?</ul>\s*</div>\s*</div>', re.S)
START = '<li class="nav-item"><a class="nav-link" href="{}../index.html">All documents</a></li>'
SCRIPT = re.compile(r"[ \t]*<script\b.*?</script>\n?", re.S)


def exports():
    """The names by which module feti_contact exports those of the other modules: {module: {name there: name of a host}}."""
    text = joined((SOURCES / f"{WHOLE}.f90").read_text(encoding="utf-8"))
    found = {}
    for module, names in re.findall(r"^ *use (\w+), only: (.*)$", text, re.M):
        pairs = [name.split("=>") for name in names.replace(" ", "").split(",") if name]
        found[module] = {pair[-1]: pair[0] for pair in pairs}
    return found


def joined(text):
    """Code without comments, a statement per line."""
    return re.sub(r"&\s*\n\s*", "", re.sub(r"^ *!.*\n", "", text, flags=re.M))


def typed(text, names):
    """A module of the typed face: names with their prefix; what a host has no name for is private."""
    def public(match):
        kept = [names[name] for name in re.split(r"[ ,]+", match[2].strip()) if name in names]
        return f"{match[1]}{', '.join(kept)}\n" if kept else ""

    text = re.sub(r"^( *public :: )(.*)\n", public, text, flags=re.M)
    renamed = {name: new for name, new in names.items() if name != new}
    if not renamed:
        return text
    # A component or an argument may have the name of a procedure; a declaration of a result is that of its procedure.
    word = re.compile(r"(?<![%\w'])(" + "|".join(sorted(renamed, key=len, reverse=True)) + r")(?![\w'])")
    lines = []
    for line in text.splitlines():
        declares = re.match(r" *(abstract )?(interface|end (subroutine|function)|public|module procedure)\b", line)
        heads = re.match(r" *((recursive|pure|elemental|logical|integer|type\([^)]*\)|character\([^)]*\)|real\([^)]*\)"
                         r"|integer\([^)]*\)) +)*(subroutine|function) +(?=\w+)", line)
        if heads:
            line = line[:heads.end()] + word.sub(lambda m: renamed[m[0]], line[heads.end():], count=1)
        elif declares or re.match(r" *procedure\(", line):
            line = word.sub(lambda m: renamed[m[0]], line)
        elif re.match(r" *(integer|logical|real|character|type)\b.*:: ", line):
            line = result(line, renamed, text)
        lines.append(line)
    return "\n".join(lines) + "\n"


def result(line, renamed, text):
    """The declaration of a function's result, which has the name of the function."""
    before, _, after = line.partition(":: ")
    name = re.match(r"\w+", after)
    if name and name[0] in renamed and re.search(rf"function +{name[0]}\([^)]*\) *(bind.*)?$", text, re.M):
        return f"{before}:: {renamed[name[0]]}{after[name.end():]}"
    return line


def marked(text):
    """Comments as Markdown: a paragraph of indented lines is a program or a formula, a line `call name(...): ` begins an item."""
    def block(match):
        lines = re.findall(r"^ *!>(.*)\n", match[0], re.M)
        start = re.match(" *!>", match[0])[0]
        if all(line.startswith("  ") for line in lines):
            return "".join(f"{start}  {line}\n" for line in lines)
        out = []
        for line in lines:
            call = re.match(r" (call \w+\(.*?\))(: .*)", line)
            out += ["", f" - `{call[1]}`{call[2]}"] if call else [line]
        return "".join(f"{start}{line}\n" for line in out)

    return re.sub(r"(^ *!> .*\n)+", block, text, flags=re.M)


def of_c(text, names):
    """Types and constants alone of the interfaces of the C functions."""
    text = re.sub(r"^  (abstract )?interface\n.*?^  end interface\n", "", text, flags=re.M | re.S)
    text = re.sub(r"^  public :: \w+\n", "", text, flags=re.M)
    return re.sub(r"^!> Interfaces of the C functions.*\n", "!> Types and constants of module feti_contact.\n", text, flags=re.M)


def listed(text, exported):
    """The module of a host: a list of what it has, by the modules that describe it."""
    lines = ["", " ### Procedures and types", ""]
    for module, names in exported.items():
        if module != C:
            lines.append(f" - [[{module}(module)]]: " + ", ".join(f"[[{name}]]" for name in names.values()))
    lines.append(f" - [[{C}(module)]]: constants")
    return text.replace(f"\nmodule {WHOLE}\n", "\n" + "".join(f"!>{line}\n" for line in lines) + f"module {WHOLE}\n", 1)


def external(text, _names):
    """The external procedures of the FORTRAN 77 face, without the module before them."""
    return re.sub(r"^module .*?^end module\n", "", text, flags=re.M | re.S)


def sources(out):
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    exported = exports()
    for file in sorted(SOURCES.glob("*.f90")):
        name, text = file.stem, file.read_text(encoding="utf-8")
        if name.endswith("_f77_base"):
            continue
        if name != WHOLE:
            change = of_c if name == C else external if "_f77_" in name else typed
            text = change(text, exported.get(name, {}))
        text = marked(text)
        if name == WHOLE:
            text = listed(text, exported)
        (out / file.name).write_text(text, encoding="utf-8")


def anchored(text):
    """Links to the specific procedures of an interface, whose anchors ford names otherwise where they stand."""
    def anchor(match):
        stands = re.search(rf'id="((?:interface|proc)-{match[1]}(?:~\d+)?)"', text)
        return f'#{stands[1]}"' if stands else match[0]

    return re.sub(r'#moduleprocedure-(\w+)(?:~\d+)?"', anchor, text)


def pages(folder):
    shutil.copyfile(STYLE, folder / "css" / STYLE.name)
    for page in folder.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        up = "../" * len(page.relative_to(folder).parents[:-1])
        text = HEAD.sub(f'<link href="{up}css/{STYLE.name}" rel="stylesheet">\n    '
                        f'<link href="{up}css/pygments.css" rel="stylesheet">\n  </head>', text)
        text = SCRIPT.sub("", text)
        text = re.sub(r'<button type="button" class="navbar-toggler".*?</button>', "", text, flags=re.S)
        text = re.sub(r'<ul class="list-inline".*?</ul>', "", text, flags=re.S)  # numbers of statements
        text = USES.sub("", text)
        text = re.sub(r"<h3>\s*private ", "<h3>", text)  # a specific procedure, which a host calls by its generic name
        text = text.replace('<ul class="navbar-nav">', f'<ul class="navbar-nav">\n{START.format(up)}', 1)
        page.write_text(anchored(text), encoding="utf-8")
    (folder / "search.html").unlink(missing_ok=True)
    for unused in ("js", "webfonts"):
        shutil.rmtree(folder / unused, ignore_errors=True)
    for style in (folder / "css").glob("*.css"):
        if style.name not in (STYLE.name, "pygments.css"):
            style.unlink()


if __name__ == "__main__":
    ways = {"sources": sources, "pages": pages}
    if len(sys.argv) != 3 or sys.argv[1] not in ways:
        sys.exit(__doc__)
    ways[sys.argv[1]](Path(sys.argv[2]).resolve())
