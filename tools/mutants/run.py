#!/usr/bin/env python3
"""run.py [--places] [NUMBER ...]   every change of list.txt, or those numbered, against the Rust tests: `make mutants`

A copy of the working tree is built once, with a switch at every place that the list names; the variable MUTANT says which
change is on. The copy first passes all tests without any; then they run for every change, the shortest program first,
until one fails, ends otherwise or takes too long. A line for each change goes to standard output and to table.txt beside
the copy. --places: says where the changes are, builds nothing.

Exit status 1 where fewer than GOAL of the changes are caught or one survives that the list gives no reason for, 2 where
the list does not fit the sources, or the copy does not build or fails without any change. JOBS changes run at a time."""

import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIST = Path(__file__).with_name("list.txt")
WORK = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "mutants"
GOAL = 0.9
SOURCES = ["src", "c/src"]
PACKAGES = ["feti-contact", "feti-contact-c", "feti-contact-c-rlib"]
# Programs that see the sources, not the library, or build their own.
LEFT_OUT = {"documents", "cholmod"}
# Programs of several subjects, which run one by one.
OF_SUBJECTS = {"claims", "batteries"}
# Sizes of the long tests, where nothing else is asked for; one thread for each change that runs.
SIZES = {"BATTERY": "300", "LIARS": "130", "RUST_TEST_THREADS": "1", "RUST_BACKTRACE": "0"}
# A program hangs after so many times the processor time it takes without any change, and some seconds; one that waits after
# so many times this by the clock, for the machine may have other work.
PATIENCE, AT_LEAST, WAITING = 5, 10, 10

SWITCH = """
/// Whether change number `n` of tools/mutants/list.txt is on: that of the variable MUTANT.
pub fn mutant(n: usize) -> bool {
    static ON: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    *ON.get_or_init(|| std::env::var("MUTANT").ok()?.parse().ok()) == Some(n)
}
"""


class Misfit(Exception):
    """The list does not fit the sources, or these do not build."""


class Change:
    """One change: its number, the claim in words, its places as (before, old, after, new), why it may survive."""

    def __init__(self, number, claim):
        self.number, self.claim, self.places, self.reason = number, claim, [], None


def read_list(text):
    changes, piece = [], None
    for at, line in enumerate(text.splitlines(), 1):
        word, _, rest = line.partition(" ")
        fault = f"{LIST.name}:{at}: "
        if not line.strip() or word.startswith("#"):
            continue
        if word.isdecimal():
            changes.append(Change(int(word), rest))
        elif word == "in" and changes and piece is None:
            piece = re.fullmatch(r"(.*)«(.+)»(.*)", rest)
            if not piece:
                raise Misfit(f"{fault}no « » around what is changed")
        elif word == "by" and piece:
            changes[-1].places.append((*piece.groups(), rest))
            piece = None
        elif word == "survives" and changes:
            changes[-1].reason = rest
        else:
            raise Misfit(f"{fault}not understood: {line}")
    numbers = [change.number for change in changes]
    if len(numbers) != len(set(numbers)):
        raise Misfit("a number is given twice")
    if any(not change.places for change in changes):
        raise Misfit("a change has no place")
    return changes


def dense(text):
    """The text without blanks, and where each of its characters stands."""
    places = [at for at, letter in enumerate(text) if not letter.isspace()]
    return "".join(text[at] for at in places), places


def find(sources, number, before, old, after):
    """The file that has the piece, and the range of what is changed; it must be the only one."""
    head, body, tail = (dense(part)[0] for part in (before, old, after))
    found = []
    for path, (text, places) in sources.items():
        start = text.find(head + body + tail)
        while start >= 0:
            first = start + len(head)
            found.append((path, places[first], places[first + len(body) - 1] + 1))
            start = text.find(head + body + tail, start + 1)
    if len(found) != 1:
        where = ", ".join(str(path.relative_to(ROOT)) for path, _, _ in found) or "nowhere"
        raise Misfit(f"change {number}: «{old}» of its piece is to be found once, is found {len(found)} times: {where}")
    return found[0]


def edits(changes):
    """What to write into every file: (start, end, text), and the places for who wants to read them."""
    texts = {path: path.read_text() for folder in SOURCES for path in sorted((ROOT / folder).rglob("*.rs"))}
    sources = {path: dense(text) for path, text in texts.items()}
    at, faults = {}, []
    for change in changes:
        for before, old, after, new in change.places:
            try:
                path, start, end = find(sources, change.number, before, old, after)
            except Misfit as misfit:
                faults.append(str(misfit))
                continue
            at.setdefault(path, []).append((start, end, change.number, new))
    if faults:
        raise Misfit("\n".join(faults))
    return texts, at


def switched(text, places, of):
    """The text with a switch at every place; `of`: the crate that has the switch, as the text names it."""
    places = sorted(places)
    for (_, end, number, _), (start, *_) in zip(places, places[1:]):
        if start < end:
            raise Misfit(f"the place of change {number} and the next one lie in each other")
    for start, end, number, new in reversed(places):
        old = text[start:end]
        switch = f"if {of}::mutant({number}) {{ {new} }} else {{ {old} }}"
        text = text[:start] + (switch if old.endswith(";") else f"({switch})") + text[end:]
    return text


def write_tree(new, tree):
    """The files of the working tree that git knows or does not ignore, below `tree`, with the texts `new` by path in place of
    theirs; what has not changed is left."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True)
    kept = set()
    for name in listed.stdout.decode().splitlines():
        source, target = ROOT / name, tree / name
        if not source.is_file():
            continue
        content = new[source].encode() if source in new else source.read_bytes()
        kept.add(target)
        if not target.is_file() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            shutil.copymode(source, target)
    for target in tree.rglob("*"):
        if target.is_file() and target not in kept:
            target.unlink()


def copy_tree(changes):
    """The working tree with the switches."""
    texts, at = edits(changes)
    library = ROOT / "src"
    of = {path: "crate" if library in path.parents else "feti_contact" for path in texts}
    new = {path: switched(text, at.get(path, []), of[path]) for path, text in texts.items()}
    new[ROOT / "src/lib.rs"] += SWITCH
    write_tree(new, WORK / "tree")


def build():
    """The test programs by name, or their subjects, each with its arguments."""
    command = [os.environ.get("CARGO", "cargo"), "test", "--release", "--locked", "--quiet", "--lib", "--tests", "--no-run"]
    command += [word for package in PACKAGES for word in ("-p", package)]
    environment = {**os.environ, "CARGO_TARGET_DIR": str(WORK / "build")}
    done = subprocess.run([*command, "--message-format=json"], cwd=WORK / "tree", env=environment, stdout=subprocess.PIPE)
    messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith(b"{")]
    if done.returncode:
        shown = [m["message"]["rendered"] for m in messages if m.get("message", {}).get("level") == "error"]
        raise Misfit("the copy does not build:\n" + "\n".join(shown[:10]))
    made = [m for m in messages if m.get("executable") and m["profile"]["test"]]
    # the unit tests of library and C interface have one name
    name = {id(m): m["target"]["name"] + " of C" * m["manifest_path"].endswith("c/Cargo.toml") for m in made}
    programs = {name[id(m)]: m["executable"] for m in made if m["target"]["name"] not in LEFT_OUT}
    commands = {}
    for name, program in programs.items():
        listed = subprocess.run([program, "--list"], capture_output=True, text=True, check=True).stdout
        subjects = sorted(set(re.findall(r"^(\w+::)\S+: test$", listed, re.M))) if name in OF_SUBJECTS else [""]
        commands.update({subject.rstrip(":") or name: [program, *filter(None, [subject])] for subject in subjects})
    return commands


def run(program, number, limit):
    """The first test that fails, or how else the program ends; nothing where all is well."""
    environment = {**SIZES, **os.environ, "MUTANT": str(number), "CARGO_MANIFEST_DIR": str(WORK / "tree")}
    limited = ["sh", "-c", 'ulimit -t "$0"; exec "$@"', f"{limit:.0f}", *program]
    child = subprocess.Popen(limited, cwd=WORK / "tree", env=environment, stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True, errors="replace", start_new_session=True)

    def end():
        try:
            os.killpg(child.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    late = threading.Event()
    timer = threading.Timer(WAITING * limit, lambda: (late.set(), end()))
    timer.start()
    last = failed = None
    for line in child.stdout:
        name = re.match(r"test (\S+)", line)
        last = name.group(1) if name else last
        if name and line.rstrip().endswith("FAILED"):
            failed = last
            end()
            break
    status = child.wait()
    timer.cancel()
    child.stdout.close()
    if failed:
        return failed
    if late.is_set() or status in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"{last} (more than {limit:.0f} s)"
    return f"{last} (ends with {status})" if status else None


def processor_time():
    """Of all programs that have ended, seconds."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def judged(change, programs):
    """Which test catches the change, none where it survives."""
    for name, (program, limit) in programs.items():
        caught = run(program, change.number, limit)
        if caught:
            return f"{name}: {caught}"
    return None


def main(arguments):
    begun = time.monotonic()
    changes = read_list(LIST.read_text())
    if "--places" in arguments:
        for path, places in edits(changes)[1].items():
            print(f"{path.relative_to(ROOT)}: {' '.join(str(place[2]) for place in places)}")
        return 0
    picked = [change for change in changes if not arguments or str(change.number) in arguments]
    copy_tree(changes)
    programs, times = build(), {}
    print(f"{len(programs)} test programs, {len(changes)} switches: built in {time.monotonic() - begun:.0f} s", flush=True)
    for name, program in programs.items():
        started = processor_time()
        failed = run(program, 0, 3600)
        if failed:
            raise Misfit(f"without any change {name}: {failed} fails")
        times[name] = processor_time() - started
    order = sorted(times, key=times.get)
    print("without any change all pass: " + ", ".join(f"{name} {times[name]:.1f} s" for name in order), flush=True)
    programs = {name: (programs[name], PATIENCE * times[name] + AT_LEAST) for name in order}
    survivors, table = [], []
    with ThreadPoolExecutor(int(os.environ.get("JOBS", os.cpu_count() or 1))) as pool:
        for change, caught in zip(picked, pool.map(lambda change: judged(change, programs), picked)):
            line = f"{change.number:3}  {change.claim}: " + (caught or "SURVIVES" + (f", {change.reason}" if change.reason else ""))
            print(line, flush=True)
            table.append(line)
            if not caught:
                survivors.append(change)
            elif change.reason:
                table.append(f"     the list gives a reason why {change.number} survives: it does not")
                print(table[-1], flush=True)
    share = 1 - len(survivors) / max(len(picked), 1)
    unexplained = [str(change.number) for change in survivors if not change.reason]
    table.append(f"mutants {len(picked)} caught {len(picked) - len(survivors)} ({100 * share:.0f} %) goal {100 * GOAL:.0f} % "
                 f"unexplained {' '.join(unexplained) or 'none'} minutes {(time.monotonic() - begun) / 60:.0f}")
    print(table[-1])
    (WORK / "table.txt").write_text("\n".join(table) + "\n")
    return 1 if share < GOAL or unexplained else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Misfit as misfit:
        print(f"mutants: {misfit}", file=sys.stderr)
        sys.exit(2)
