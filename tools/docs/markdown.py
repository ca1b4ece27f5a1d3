"""Links, headings and code of a Markdown text, as far as the documents of this repository use the language."""

import re

FENCE = re.compile(r" {0,3}(```+|~~~+)")
INDENTED = re.compile(r" {4,}\S")
HEADING = re.compile(r"(#{1,6})\s+(.*?)\s*#*$")
DEFINITION = re.compile(r"(?m)^ {0,3}\[([^\]]+)\]:\s*<?([^\s>]+)>?")
CODE = r"(?P<ticks>`+)(?P<code>(?:[^`]|(?!(?P=ticks)(?!`))`)+)(?P=ticks)(?!`)"
TEXT = r"(?:[^\[\]`]|`[^`]*`|!?\[[^\]]*\](?:\([^)]*\))?)*"
LINK = r"(?P<open>!?\[" + TEXT + r"\]\(\s*<?)(?P<target>[^)\s>]+)(?P<close>>?(?:\s+\"[^\"]*\")?\s*\))"
INLINE = re.compile(CODE + "|" + LINK)
ANCHOR = re.compile(r"<a\s[^>]*(?:id|name)=\"([^\"]+)\"")


def blocks(text):
    """(line, is code, block): the text cut into code blocks and what lies between them; lines count from 1."""
    lines = text.splitlines(keepends=True)
    start, code, fence, blank = 0, False, None, True
    cuts = []
    for number, line in enumerate(lines):
        mark = FENCE.match(line)
        if fence:
            if mark and mark.group(1).startswith(fence) and not line.strip().strip(fence[0]):
                fence = None
            inside = True
        elif mark:
            fence = mark.group(1)
            inside = True
        else:
            inside = bool(INDENTED.match(line)) and (blank or code)
        if inside != code:
            cuts.append((start, code, number))
            start, code = number, inside
        blank = not line.strip()
    cuts.append((start, code, len(lines)))
    return [(a + 1, code, "".join(lines[a:b])) for a, code, b in cuts if a < b]


def links(text):
    """(line, target) of every link and image."""
    found = []
    for first, code, block in blocks(text):
        if code:
            continue
        hits = [m for m in INLINE.finditer(block) if m.group("target")]
        hits = [(m.start("target"), m.group("target")) for m in hits]
        hits += [(m.start(2), m.group(2)) for m in DEFINITION.finditer(block)]
        found += [(first + block.count("\n", 0, at), target) for at, target in sorted(hits)]
    return found


def headings(text):
    """The text of every heading, in order."""
    found = []
    for _, code, block in blocks(text):
        if not code:
            found += [m.group(2) for m in map(HEADING.match, block.splitlines()) if m]
    return found


def anchors(text):
    """What `#...` may lead to: headings, in lower case, without punctuation, with hyphens; repeated ones are numbered."""
    found = set()
    for heading in headings(text):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = "".join(c for c in plain.lower() if c.isalnum() or c in " -_").replace(" ", "-")
        name, count = slug, 0
        while name in found:
            count += 1
            name = f"{slug}-{count}"
        found.add(name)
    for _, code, block in blocks(text):
        if not code:
            found.update(ANCHOR.findall(block))
    return found


def rewrite(text, link, code):
    """The text with `link(line, whole, open, target, close)` for every link, `code(whole, words)` for code between ticks."""
    out = []
    for first, is_code, block in blocks(text):
        if is_code:
            out.append(block)
            continue

        def replace(match, block=block, first=first):
            if match.group("target"):
                line = first + block.count("\n", 0, match.start())
                return link(line, match.group(0), *match.group("open", "target", "close"))
            start = block.rfind("\n", 0, match.start()) + 1
            return match.group(0) if block[start] == "#" else code(match.group(0), match.group("code"))

        out.append(INLINE.sub(replace, block))
    return "".join(out)
