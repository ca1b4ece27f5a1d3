"""The sources of the Fortran pages name every procedure and type as a host does, and nothing that a host cannot use."""

import re
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
import fortran  # noqa: E402

HEAD = r"^ *(?:(?:recursive|pure|elemental|integer|logical|real|character|type|abstract)(?:\([^)]*\))? +)*"
DEFINED = re.compile(HEAD + r"(?:(?:subroutine|function) (\w+)\(|interface (\w+)$|type(?:, \w+(?:\(C\))?)*(?: ::)? (\w+)$)", re.M)


def main():
    with tempfile.TemporaryDirectory() as folder:
        fortran.sources(Path(folder) / "sources")
        staged = {file.stem: file.read_text(encoding="utf-8") for file in (Path(folder) / "sources").glob("*.f90")}
    exported = fortran.exports()
    host = {name for names in exported.values() for name in names.values()}
    assert {"feti_body_add", "feti_set", "feti_option", "FETI_OK"} <= host, host
    for module, names in exported.items():
        text = staged[module]
        public = set(re.findall(r"\w+", " ".join(re.findall(r"^ *public :: (.*)", text, re.M))))
        assert public <= host, (module, public - host)
        if module == fortran.C:
            assert not re.search(r"^ *(abstract )?interface\b|^ *function ", text, re.M), "an interface of a C function"
            continue
        assert set(names.values()) <= public, (module, set(names.values()) - public)
        defined = {name for found in DEFINED.findall(text) for name in found if name}
        from_c = {"feti_option", "feti_info", "feti_certificate", "feti_phase", "feti_findings", "feti_body_facts", "feti_pair_facts", "feti_progress",
                  "feti_communicator"}
        assert public - from_c <= defined, (module, public - from_c - defined)
    assert not [module for module in staged if module.endswith("_f77_base")]
    assert not [module for module, text in staged.items() if "_f77_" in module and re.search(r"^module ", text, re.M)]
    one = staged["feti_contact_stiffness"]
    assert "- `call feti_body_stiffness(p, body, k, storage)`: the whole matrix" in one, "calls are items of a list"
    assert "!>     minimise 1/2 u'Ku" in staged["feti_contact"], "a formula is a block of its own"


main()
