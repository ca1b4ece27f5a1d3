"""recipes.py ROOT: the recipes for conda and Spack and the Python package have the version, the Rust and the features of Cargo.toml, and
the conda recipe tests for every file that make install puts, and for no other."""

import fnmatch
import re
import subprocess
import sys
import types
from pathlib import Path

root = Path(sys.argv[1])
cargo = (root / "Cargo.toml").read_text()
version = re.search(r'^version = "(.*)"', cargo, re.M)[1]
rust = re.search(r'^rust-version = "(.*)"', cargo, re.M)[1]
features = re.search(r"^\[features\]\n(.*?)\n\n", cargo, re.M | re.S)[1]
licence = re.search(r'^license = "(.*)"', cargo, re.M)[1]
faults = []


def same(what, found, expected):
    if found != expected:
        faults.append(f"{what}: {found!r}, expected {expected!r}")


# ---- Python
wheel = root / "python/pyproject.toml"
if wheel.exists():
    same("python: version", re.search(r'^version = "(.*)"', wheel.read_text(), re.M)[1], version)

# ---- conda
recipe = (root / "packaging/conda/recipe.yaml").read_text()
value = lambda key: re.search(rf"^ +{key}: *\"?([^\"\n]*)", recipe, re.M)[1]
soname = version.rsplit(".", 1)[0] if version.startswith("0.") else version.split(".")[0]
same("conda: version", value("version"), version)
same("conda: name for the loader", value("soversion"), soname)
same("conda: licence", value("license"), licence)
same("conda: Rust", re.search(r"- rust >=(.*)", recipe)[1], rust)
block = re.search(r"^      files:\n((?:        - .*\n)+)", recipe, re.M)[1]
patterns = re.findall(r"- (.*)", block.replace("${{ version }}", version).replace("${{ soversion }}", soname))
# Folders that make sets if it calls this are not those of the recipe; manual pages are there only after make man.
environment = {"PATH": "/usr/bin:/bin", "PREFIX": "", "DESTDIR": "", "RELEASE": "."}
listed = subprocess.run([root / "tools/install.sh", "list"], env=environment, check=True, capture_output=True, text=True).stdout.split()
files = [file.lstrip("/") for file in listed if not re.search(r"/man/man[37]/", file)]


def matches(file, pattern):
    """A * stands for one name, as in the recipe."""
    parts = file.split("/"), pattern.split("/")
    return len(parts[0]) == len(parts[1]) and all(map(fnmatch.fnmatch, *parts))


same("conda: files without a test", [file for file in files if not any(matches(file, p) for p in patterns)], [])
same("conda: tests without a file", [p for p in patterns if not any(matches(file, p) for file in files)], [])
same("files that make install puts", len(files) > 100, True)

# ---- Spack: the package as Spack reads it, with directives that are noted
said = {}
note = lambda name: lambda *positional, **named: said.setdefault(name, []).append((positional, named))
spack = types.ModuleType("spack.package")
for name in ("license", "version", "variant", "requires", "depends_on", "make"):
    setattr(spack, name, note(name))
spack.which = lambda program, required=False: note(program)
spack.__all__ = [name for name in vars(spack) if not name.startswith("__")]
generic = types.ModuleType("spack_repo.builtin.build_systems.generic")
generic.Package = object
for name in ("spack", "spack_repo", "spack_repo.builtin", "spack_repo.builtin.build_systems"):
    sys.modules[name] = types.ModuleType(name)
sys.modules |= {"spack.package": spack, generic.__name__: generic}
names = {}
exec(compile((root / "packaging/spack/package.py").read_text(), "package.py", "exec"), names)
package = names["FetiContact"]
same("spack: version", [positional for positional, _ in said["version"]], [(version,)])
same("spack: place of the checksum", said["version"][0][1], {"sha256": "@SHA256@"})
same("spack: archive", package.url.rsplit("/", 1)[1], f"feti-contact-{version}.tar.gz")
same("spack: licence", said["license"], [((licence,), {})])
same("spack: Rust", [p[0] for p, _ in said["depends_on"] if p[0].startswith("rust")], [f"rust@{rust}:"])
variants = [positional[0] for positional, _ in said["variant"]]
same("spack: variants that are no features", [v for v in variants if not re.search(rf"^{v} = ", features, re.M)], [])
for variant in [None, *variants]:
    said["cargo"], said["make"] = [], []
    spec = types.SimpleNamespace(satisfies=lambda wanted: wanted == f"+{variant}")
    package.install(types.SimpleNamespace(), spec, "/opt/feti")
    extra = ("--features", variant) if variant else ()
    same(f"spack: cargo with {variant}", said["cargo"], [(("build", "--release", "--locked", "--offline", *extra), {})])
    same(f"spack: make with {variant}", said["make"], [(("install", "PREFIX=/opt/feti", "DESTDIR=", "CARGO=true"), {})])

print("\n".join(faults))
sys.exit(bool(faults))
