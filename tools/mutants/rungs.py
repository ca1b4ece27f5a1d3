#!/usr/bin/env python3
"""What each second try saves: adds the lines of `what_each_second_try_saves` (standard input) to a log, and prints the table.

The log has the sums of all runs so far, one line for each kind of problem and second try. Runs with other seeds continue it; seeds
that it has are not counted again. When the method changes, begin a new one. "saves" counts the problems that are not solved, or solved wrongly, without the second
try; a few are chance, since any other order of roundings moves as many.
"""
import collections
import math
import pathlib
import sys


def lines(text):
    """(kind, seeds, name, what) and (made, unsolved, wrong, products) of each line."""
    for line in text.splitlines():
        if line.startswith("rung\t"):
            _, kind, seeds, name, what, *numbers = line.split("\t")
            yield (kind, seeds, name, what), [float(number) for number in numbers]


def ranges(seeds):
    """[first, end] of each range of a text such as "0..10 20..30"."""
    return [[int(n) for n in of.split("..")] for of in seeds.split()]


def added(known, new):
    """The sums of both, without new lines of seeds that are known."""
    seeds, sums = collections.defaultdict(list), collections.defaultdict(lambda: [0.0] * 4)
    for is_new, part in [(False, known), (True, new)]:
        before = {kind: list(of) for kind, of in seeds.items()}
        for (kind, own, name, what), numbers in part:
            first, end = ranges(own)[0]
            if is_new and any(first < e and f < end for f, e in before.get(kind, [])):
                continue
            sums[kind, name, what] = [a + b for a, b in zip(sums[kind, name, what], numbers)]
            if name == "all":
                seeds[kind] += ranges(own)
    for kind, of in seeds.items():
        merged = []
        for first, end in sorted(of):
            if merged and merged[-1][1] == first:
                merged[-1][1] = end
            else:
                merged.append([first, end])
        seeds[kind] = merged
    text = {kind: " ".join(f"{first}..{end}" for first, end in of) for kind, of in seeds.items()}
    return {(kind, text[kind], name, what): numbers for (kind, name, what), numbers in sums.items()}


def table(sums):
    """One line for each second try: problems that made it, what it saves of all, change of their products without it."""
    total, own = collections.Counter(), collections.defaultdict(lambda: [0.0] * 4)
    for (kind, _, name, what), numbers in sums.items():
        if name == "all":
            total[kind] += int(numbers[0])
        else:
            own[name, what] = [a + b for a, b in zip(own[name, what], numbers)]
    yield f"{sum(total.values())} problems: " + ", ".join(f"{n} {kind}" for kind, n in total.items())
    yield ""
    yield "| second try | made in | saves | products without it |"
    yield "|---|---|---|---|"
    for (name, what), (made, unsolved, wrong, products) in own.items():
        more = 100 * (math.exp(products / made) - 1) if made else 0.0
        parts = [f"{unsolved:.0f} unsolved" if unsolved else "", f"{wrong:.0f} wrong" if wrong else ""]
        saves = ", ".join(part for part in parts if part) or "0"
        yield f"| {name} ({what}) | {made:.0f} | {saves} | {more:+.0f} % |"


def main():
    log = pathlib.Path(sys.argv[1])
    known = lines(log.read_text()) if log.exists() else []
    sums = added(known, lines(sys.stdin.read()))
    text = [
        "\t".join(["rung", *key, *(f"{n:.0f}" for n in numbers[:3]), f"{numbers[3]:.3f}"])
        for key, numbers in sums.items()
    ]
    log.write_text("\n".join(text) + "\n")
    print("\n".join(table(sums)))


main()
