#!/usr/bin/env python3
"""vary.py [GROUP::NAME ...]   every threshold of src/numbers, or those named, times 10 and a tenth of it: `make vary`

A copy of the working tree is built once, in which a threshold is a function that reads the variable NUMBER; then the
batteries run with each value (BATTERY problems each, 150). A line for each value that changes how many problems end solved,
their products, or whether the tests of the batteries pass, goes to standard output and to varied.txt beside this file, from which
`make numbers` has the last columns of docs/numbers.md."""

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.dont_write_bytecode = True
from run import ROOT, write_tree

WORK = ROOT / "build/vary"
ENTRY = re.compile(r"^pub const ([A-Z0-9_]+): f64 = (.+);$", re.M)
# Limits of options are constants of a table.
FIXED = {"data::NO_LIMIT", "data::MANY"}
TESTS = ["every_random_problem", "every_varied_problem", "every_hard_problem", "problems_with_friction"]
SWITCH = """
/// The value of threshold `k`: that of the variable NUMBER, `K VALUE`, or its own.
pub fn varied(k: usize, own: f64) -> f64 {
    static ON: std::sync::OnceLock<Option<(usize, f64)>> = std::sync::OnceLock::new();
    let on = ON.get_or_init(|| {
        let text = std::env::var("NUMBER").ok()?;
        let (k, value) = text.split_once(' ')?;
        Some((k.parse().ok()?, value.parse().ok()?))
    });
    on.filter(|on| on.0 == k).map_or(own, |on| on.1)
}
"""


def entries():
    """GROUP::NAME -> value, in the order of the files."""
    files = sorted((ROOT / "src/numbers").glob("*.rs"))
    found = [(f"{path.stem}::{name}", value) for path in files for name, value in ENTRY.findall(path.read_text())]
    return {name: value for name, value in found if name not in FIXED}


def called(text, named):
    """The text with a call for every use of a threshold; in a constant and in a text the constant `NAME_` stays."""
    qualified = {name.partition("::")[2]: name for name in named if name.startswith("rounding::")}
    groups = {name.partition("::")[::2] for name in named}
    local = set()
    for group, names in re.findall(r"use crate::numbers::(\w+)::(\{[^}]*\}|\w+);", text):
        local |= {name for name in re.findall(r"\w+", names) if (group, name) in groups}
    lines, item = [], ""
    for line in text.splitlines(keepends=True):
        item = "use" if re.match(r"\s*(pub )?use ", line) else item
        item = "const" if re.match(r"\s*(pub(\(\w+\))? )?const [A-Z_]+: ", line) else item
        if item != "use" and not line.lstrip().startswith("//"):
            mark = "_" if item == "const" else "()"
            line = re.sub(r"\{([A-Z0-9_]+)(:[^}]*)?\}", lambda m: m[0].replace(m[1], m[1] + "_") if m[1] in local else m[0], line)
            line = re.sub(r"(?<![\w.:{])([A-Z][A-Z0-9_]*)\b(?!\()", lambda m: m[0] + mark if m[1] in local else m[0], line)
            line = re.sub(r"\brounding::([A-Z]+)\b", lambda m: m[0] + mark if m[1] in qualified else m[0], line)
        lines.append(line)
        item = "" if line.rstrip().endswith(";") else item
    text = "".join(lines)
    both = {name for name in local if f"{name}_" in text}
    for name in both:
        group = next(group for group, entry in groups if entry == name and re.search(rf"numbers::{group}::[^;]*\b{name}\b", text))
        text = re.sub(r"^use crate::", f"use crate::numbers::{group}::{name}_;\nuse crate::", text, count=1, flags=re.M)
    return text


def copy_tree(all_entries):
    number = {name: k for k, name in enumerate(all_entries)}
    new = {}
    for path in sorted((ROOT / "src").rglob("*.rs")):
        def switch(m):
            entry = f"{path.stem}::{m[1]}"
            if entry not in number:
                return m[0]
            return (f"#[allow(dead_code)]\npub const {m[1]}_: f64 = {m[2]};\n"
                    f"#[allow(non_snake_case)]\npub fn {m[1]}() -> f64 {{\n    super::varied({number[entry]}, {m[2]})\n}}")
        text = path.read_text()
        is_numbers = path.parent.name == "numbers"
        new[path] = ENTRY.sub(switch, text) if is_numbers else called(text, number)
    new[ROOT / "src/numbers/mod.rs"] += SWITCH
    write_tree(new, WORK / "tree")
    return number


def build():
    command = [os.environ.get("CARGO", "cargo"), "test", "--release", "--locked", "--test", "batteries", "--no-run"]
    done = subprocess.run(command, cwd=WORK / "tree", env={**os.environ, "CARGO_TARGET_DIR": str(WORK / "target")},
                          stderr=subprocess.PIPE, text=True)
    program = re.search(r"Executable .*\((.+)\)", done.stderr)
    if done.returncode or not program:
        sys.exit(done.stderr)
    return WORK / "tree" / program[1]


def measured(program, number):
    """Costs of each battery, and which tests fail."""
    environment = {"BATTERY": "150", "RUST_TEST_THREADS": "1", "RAYON_NUM_THREADS": "1", **os.environ, "NUMBER": number}
    def run(*arguments):
        command = [program, *arguments, "--nocapture"]
        try:
            return subprocess.run(command, env=environment, capture_output=True, text=True, errors="replace", timeout=300).stdout
        except subprocess.TimeoutExpired:
            return "test takes_too_long ... FAILED\n"
    costs = re.findall(r"^(\w+): \d+ problems, (\d+) solved, (\d+) products", run("what_many_answers_cost", "--ignored"), re.M)
    failed = sorted(set(re.findall(r"^    \S+::(\w+)$", run(*TESTS), re.M)))
    return {name: (int(solved), int(products)) for name, solved, products in costs}, failed


def told(before, now):
    """What differs, in words."""
    costs, failed = now
    parts = []
    for name, (solved, products) in before[0].items():
        own = costs.get(name)
        if own is None:
            parts.append(f"{name} does not end")
            continue
        more, change = own[0] - solved, f"{100 * (own[1] / products - 1):+.1f} %"
        words = [f"{more:+} solved"] * (more != 0) + [f"products {change}"] * (own[1] != products)
        parts += [f"{name} {', '.join(words)}"] * bool(words)
    return "; ".join(parts + [f"fails {test}" for test in failed if test not in before[1]]) or "nothing"


def main(arguments):
    all_entries = entries()
    number = copy_tree(all_entries)
    program = build()
    before = measured(program, "")
    print("as they are:", before, flush=True)
    tried = [(name, f"{factor * float(value.replace('_', '')):.4g}") for name, value in all_entries.items()
             if not arguments or name in arguments for factor in (10, 0.1)]
    lines = []
    with ThreadPoolExecutor(int(os.environ.get("JOBS", os.cpu_count() or 1))) as pool:
        results = pool.map(lambda one: measured(program, f"{number[one[0]]} {one[1]}"), tried)
        for (name, value), now in zip(tried, results):
            lines.append(f"{name} {value}: {told(before, now)}")
            print(lines[-1], flush=True)
    if not arguments:
        Path(__file__).with_name("varied.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
