#!/usr/bin/env python3
"""Builds CalculiX 2.20 with glue.c, and runs its decks with static contact, each by CalculiX's own contact and by feti-contact.

    run.py BUILD STAGE PAGE [deck ..]

BUILD: a folder for sources, program and results; STAGE: where feti-contact is installed; PAGE: the table is written between its marks, if all decks
run. Sources and decks come from Debian, as this system's apt knows it; nothing of the system changes. Ends with status 1 if a deck does not end.

Four runs of each deck, one thread: CalculiX's own contact; the same with springs 1e4 times as stiff and hardly any adhesion, which is nearer to contact
that does not yield; feti-contact; feti-contact with `compliance`, so that LINEAR surfaces yield as CalculiX's. Displacements are
compared at the end of the last static step, relative to the largest.
"""
import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

FREE = """beamcontact bolt contact1 contact10 contact11 contact2 contact3 contact4 contact6 contactenergy cubespring hueeber1 hueeber2 hueeber3
    hueeber4 plate punch1 punch2 ring1 ring2 scheibe2f2f scheibe2n2f thread ringfcontact2""".split()
FRICTION = """changefric changesurfbeh fricloop friction1 friction2 metalforming metalformingmortar ringfcontact1 ringfcontact3
    ringfcontact4""".split()
HERE = Path(__file__).resolve().parent
FLAGS = "-O2 -I/usr/include/spooles -DARCH=Linux -DSPOOLES -DARPACK -DMATRIXSTORAGE -DUSE_MT=1"
BEGIN, END = "<!-- decks -->\n", "<!-- end of decks -->\n"


def sh(command, where, **more):
    subprocess.run(command, cwd=where, check=True, stdout=subprocess.DEVNULL, **more)


def fetch(build):
    """Sources and decks, by lists of packages of our own: the system's, with sources."""
    apt = build / "apt"
    (apt / "lists/partial").mkdir(parents=True, exist_ok=True)
    (apt / "cache/archives/partial").mkdir(parents=True, exist_ok=True)
    (apt / "sources.d").mkdir(exist_ok=True)
    for given in [Path("/etc/apt/sources.list"), *Path("/etc/apt/sources.list.d").glob("debian*")]:
        if given.exists():
            text = re.sub(r"(?m)^Types:.*", "Types: deb deb-src", given.read_text())
            text = re.sub(r"(?m)^deb (.*)", r"deb \1\ndeb-src \1", text)
            (apt / "sources.d" / (given.name if given.suffix else given.name + ".list")).write_text(text)
    (apt / "apt.conf").write_text(f'Dir::State::lists "{apt}/lists";\nDir::Cache "{apt}/cache";\n'
                                  f'Dir::Etc::sourcelist "/dev/null";\nDir::Etc::sourceparts "{apt}/sources.d";\nAPT::Sandbox::User "root";\n')
    own = dict(os.environ, APT_CONFIG=str(apt / "apt.conf"))
    sh(["apt-get", "-q", "update"], build, env=own)
    sh(["apt-get", "-q", "source", "calculix-ccx=2.20-1"], build, env=own)
    sh(["apt-get", "-q", "download", "calculix-ccx-test"], build, env=own)
    sh(["dpkg-deb", "-x", str(next(build.glob("calculix-ccx-test*.deb"))), "decks"], build)
    decks = build / "decks/usr/share/doc/calculix-ccx-test/examples/test"
    sh(["gunzip", "-f", *(str(p) for p in decks.glob("*.inp.gz"))], build)
    return decks


def make(build, stage):
    """The program: CalculiX as Debian builds it, and nonlingeo.c with the calls of glue.c."""
    source = next(build.glob("calculix-ccx-2.20*/ccx_2.20/src"))
    for name in ("glue.c", "glue.h"):
        shutil.copy(HERE / name, source)
    if not (source / "nonlingeo.own").exists():
        shutil.copy(source / "nonlingeo.c", source / "nonlingeo.own")
    shutil.copy(source / "nonlingeo.own", source / "nonlingeo.c")
    subprocess.run([sys.executable, str(HERE / "insert.py"), str(source)], check=True)
    jobs = f"-j{os.cpu_count()}"
    sh(["make", jobs, f"CFLAGS={FLAGS}", "FFLAGS=-O2 -fallow-argument-mismatch -w", "ccx_2.20.a"], source, stderr=subprocess.DEVNULL)
    sh(["sh", "-c", f"cc {FLAGS} -c ccx_2.20.c && cc {FLAGS} -I{stage}/include -c glue.c && gfortran -o {build}/ccx ccx_2.20.o glue.o ccx_2.20.a"
        f" -L{stage}/lib -Wl,-rpath,{stage}/lib -lfeti_contact -lspooles -larpack -llapack -lblas -lpthread -lm -fopenmp"], source)
    return build / "ccx"


def deck(text, stiffer):
    """Displacements of every static step are printed; with `stiffer`, slopes and the stiffness of sticking times 1e4, adhesion times 1e-6."""
    out, is_static, law = [], False, None
    for line in text.splitlines():
        key = line.upper().replace(" ", "")
        if key.startswith("*") and not key.startswith("**"):
            is_static = not key.startswith("*STEP") and (is_static or key.startswith("*STATIC"))
            law = None
            if stiffer and key.startswith("*FRICTION"):
                law = "friction"
            elif stiffer and key.startswith("*SURFACEBEHAVIOR") and "TIED" not in key:
                law = "exponential" if "EXPONENTIAL" in key else "linear"
                line = key.replace("EXPONENTIAL", "LINEAR").replace("SURFACEBEHAVIOR", "SURFACE BEHAVIOR")
            if key.startswith("*ENDSTEP") and is_static:
                out += ["*NODE FILE", "U"]
        elif law and not key.startswith("**"):
            number = [float(n) for n in line.split(",") if n.strip()]
            if law == "friction":
                number = [number[0], 1e4 * number[1]]
            elif law == "exponential":
                number = [1e4 * number[1] / number[0], 1e-6 * number[1]]
            else:
                number = [1e4 * number[0], *(1e-6 * n for n in number[1:2])]
            line, law = ",".join(f"{n:.8g}" for n in number), None
        out.append(line)
    return "\n".join(out) + "\n"


def displacements(path):
    """Of the last static step; frequencies may follow."""
    steps, now = [], None
    for line in path.read_text(errors="replace").splitlines() if path.exists() else []:
        if "1PMODE" in line:
            break
        if line.startswith(" -4"):
            now = {} if line.split()[1] == "DISP" else None
            steps += [now] if now is not None else []
        elif line.startswith(" -1") and now is not None:
            now[int(line[3:13])] = [float(line[13 + 12 * k:25 + 12 * k]) for k in range(3)]
        elif line.startswith(" -3"):
            now = None
    return steps[-1] if steps else {}


class Run:
    def __init__(self, build, name, text, wish):
        where = build / "runs" / name / (wish or ("stiffer" if wish is None else "own"))
        shutil.rmtree(where, ignore_errors=True)
        where.mkdir(parents=True)
        (where / f"{name}.inp").write_text(deck(text, wish is None))
        own = dict(os.environ, OMP_NUM_THREADS="1")
        own.pop("CCX_CONTACT", None)
        if wish:
            own["CCX_CONTACT"] = wish
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(where / "log", "wb") as log:
            try:
                subprocess.run([str(build / "ccx"), name], cwd=where, env=own, stdout=log, stderr=log, timeout=200, check=False)
            except subprocess.TimeoutExpired:
                pass
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        log = (where / "log").read_text(errors="replace")
        self.seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.ended = "Job finished" in log
        self.increments, self.iterations = (self.lines(where / f"{name}.{kind}") for kind in ("sta", "cvg"))
        self.status = re.findall(r"feti-contact: (FETI_\w+)", log)
        last = {pair: depths for pair, *depths in re.findall(r"pair (\d+): .* depth (\S+), of the master (\S+)", log)}
        self.depths = [max(float(d) for d in side) for side in zip(*last.values())] or [0.0, 0.0]
        self.u = displacements(where / f"{name}.frd")

    @staticmethod
    def lines(path):
        return sum(1 for line in path.open() if re.match(r" +\d", line)) if path.exists() else 0

    def off(self, other):
        """The largest difference of displacements, relative to the largest of `other`."""
        if not (self.ended and other.ended):
            return None
        largest = max(abs(x) for v in other.u.values() for x in v) or 1.0
        return max(abs(x - y) for n in other.u for x, y in zip(other.u[n], self.u[n])) / largest


def short(x):
    return "-" if x is None else "0" if x == 0.0 else f"{x:.0e}".replace("e-0", "e-").replace("e+0", "e")


def main():
    build, stage, page = (Path(p).resolve() for p in sys.argv[1:4])
    build.mkdir(parents=True, exist_ok=True)
    if not list(build.glob("decks/usr")):
        fetch(build)
    decks = build / "decks/usr/share/doc/calculix-ccx-test/examples/test"
    make(build, stage)
    rows, wrong, longer = [], [], []
    for name in sys.argv[4:] or FREE + FRICTION:
        text = (decks / f"{name}.inp").read_text(errors="replace")
        own, feti, yielding, stiffer = (Run(build, name, text, wish) for wish in ("", "feti", "compliance", None))
        points = [float(line.split(",")[k]) for line in text.splitlines() if re.match(r" *\d+ *,( *[-+.\dEe]+ *,){2} *[-+.\dEe]+ *$", line) for k in (1, 2, 3)]
        size = max(max(points[k::3]) - min(points[k::3]) for k in range(3)) if points else 1.0
        slave, master = (short(depth / size) for depth in feti.depths)
        again = feti.status.count("FETI_INDEFINITE")
        bad = sorted({s[5:] for s in feti.status} - {"OK", "MARGINAL", "INDEFINITE"})
        if not feti.ended:
            wrong.append(name)
        if feti.iterations > own.iterations or feti.increments > own.increments:
            longer.append(name)
        rows.append(f"| {name} | {own.increments}, {own.iterations} | {feti.increments}, {feti.iterations}{f' + {again}' if again else ''} | "
                    f"{short(yielding.off(own))} | {short(feti.off(stiffer))} | {slave}, {master} | {feti.seconds / own.seconds:.2f} | "
                    f"{'' if feti.ended else 'does not end; '}{', '.join(bad)} |")
        print(rows[-1], flush=True)
    print(f"{len(rows) - len(wrong)} of {len(rows)} end; not:", *wrong or ["none"], "; with more iterations or increments:", *longer or ["none"])
    if not sys.argv[4:] and page.exists():
        text = page.read_text()
        page.write_text(text[:text.index(BEGIN) + len(BEGIN)] + "\n".join([
            "| deck | increments, iterations: own | feti-contact | off, both yield | off, neither yields | depth: slave, master | time |  |", "|" + "---|" * 8, *rows])
            + "\n" + text[text.index(END):])
    sys.exit(1 if wrong else 0)


main()
