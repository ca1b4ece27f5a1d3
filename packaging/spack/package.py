# Spack package of feti-contact, for Spack 1.0 or newer. `make release` writes it with the checksum of the source archive, which has all
# crates and lies in the folder in which spack is called. tests/packaging/recipes.py compares it with Cargo.toml.
import os

from spack_repo.builtin.build_systems.generic import Package

from spack.package import *


class FetiContact(Package):
    """Contact mechanics for finite and boundary element codes by FETI duality, for C, C++, Fortran and FORTRAN 77."""

    manual_download = True
    url = f"file://{os.getcwd()}/feti-contact-0.2.0.tar.gz"

    license("MIT OR Apache-2.0")
    version("0.2.0", sha256="@SHA256@")

    variant("metis", default=False, description="Order by METIS 5, not for hosts under GPL version 2 only")

    requires("platform=linux")
    depends_on("c", type="build")
    depends_on("gmake", type="build")
    depends_on("rust@1.85:", type="build")
    depends_on("metis@5", when="+metis")

    def install(self, spec, prefix):
        features = ["--features", "metis"] if spec.satisfies("+metis") else []
        which("cargo", required=True)("build", "--release", "--locked", "--offline", *features)
        make("install", f"PREFIX={prefix}", "DESTDIR=", "CARGO=true")
