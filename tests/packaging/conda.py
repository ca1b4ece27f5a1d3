"""conda.py ROOT WORK: rattler-build builds the recipe with the compilers, Rust and make of the system, from no channel, and finds in the
package the files for which the recipe tests. Optimisation is left out: it is the recipe that counts."""

import json
import os
import shutil
import sys
from pathlib import Path

from rattler_build import EnvironmentIsolation, Stage0Recipe, ToolConfiguration, VariantConfig

root, work = Path(sys.argv[1]), Path(sys.argv[2])
shutil.rmtree(work, ignore_errors=True)
for platform in ("noarch", "linux-64"):
    folder = work / "channel" / platform
    folder.mkdir(parents=True)
    info = {"info": {"subdir": platform}, "packages": {}, "packages.conda": {}, "repodata_version": 1}
    (folder / "repodata.json").write_text(json.dumps(info))
os.environ |= {"CARGO_PROFILE_RELEASE_OPT_LEVEL": "0", "CARGO_PROFILE_RELEASE_DEBUG": "0"}
recipe = Stage0Recipe.from_file(root / "packaging/conda/recipe.yaml")
try:
    results = recipe.run_build(
        VariantConfig.from_yaml("system_tools: [true]\n"),
        ToolConfiguration(test_strategy="native"),
        output_dir=work / "output",
        channels=[(work / "channel").as_uri()],
        env_isolation=EnvironmentIsolation.NONE,
    )
except Exception:
    for log in work.glob("output/bld/*/work/conda_build.log"):
        print(log.read_text())
    raise
for result in results:
    print(*result.packages)
