"""Builds the shared library by cargo and puts it, without debug information, beside the modules of the package.

FETI_CONTACT_PROFILE: profile of cargo, release without it, as for `make lib`, whose build is then taken."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "wheel"


def library():
    """The path of the library that cargo has built, as cargo names it."""
    command = [os.environ.get("CARGO", "cargo"), "build", "--locked", "--profile", os.environ.get("FETI_CONTACT_PROFILE", "release")]
    command += ["--package", "feti-contact-c", "--message-format", "json-render-diagnostics"]
    made = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    artifacts = [item for item in map(json.loads, made.splitlines()) if "cdylib" in item.get("target", {}).get("kind", [])]
    return Path(next(name for name in artifacts[-1]["filenames"] if name.endswith((".so", ".dylib"))))


class Build(build_py):
    def run(self):
        super().run()
        folder = Path("feti_contact") if self.editable_mode else Path(self.build_lib, "feti_contact")
        built = library()
        target = folder / built.name
        shutil.copyfile(built, target)
        subprocess.run(["strip", "--strip-unneeded" if sys.platform == "linux" else "-x", target], check=True)
        for licence in ROOT.glob("LICENSE-*"):  # they go with every binary
            shutil.copy(licence, folder)


class Wheel(bdist_wheel):
    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        """Any Python 3; on Linux with the glibc that the library asks for."""
        platform = super().get_tag()[2]
        for path in Path(self.bdist_dir or "", "..").resolve().glob("**/feti_contact/libfeti_contact.so"):
            versions = re.findall(rb"GLIBC_2\.(\d+)", path.read_bytes())
            if versions:
                platform = platform.replace("linux_", f"manylinux_2_{max(map(int, versions))}_")
        return "py3", "none", platform


WORK.mkdir(parents=True, exist_ok=True)
setup(
    cmdclass={"build_py": Build, "bdist_wheel": Wheel},
    options={"build": {"build_base": str(WORK)}, "egg_info": {"egg_base": str(WORK)}},
)
