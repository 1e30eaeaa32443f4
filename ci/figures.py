#!/usr/bin/env python3
"""Whether two folders have the same figures beyond noise: `ci/figures.py OLD NEW`. Exit code 1, and a line for each difference, if not.

A figure is its texts and its data. The texts of the drawings are compared without their ticks, which follow the data. Numbers are the same
within what `featherbench diff` calls noise: a factor of 4, where less than four roundings counts as zero.
"""

from __future__ import annotations

import csv
import math
import re
import sys
from pathlib import Path

#: As in crates/harness/results/src/diff.rs.
FACTOR, FLOOR = 4.0, 8.9e-16


def texts(svg: str) -> list[str]:
    """Titles and names of a drawing."""
    found = re.findall(r"<(?:text|title)\b[^>]*>([^<]*)<", svg)
    return [text for text in found if re.search("[A-Za-z]", text)]


def same(old: str, new: str) -> bool:
    """Whether two fields of data are the same beyond noise."""
    try:
        a, b = (max(abs(float(field)), FLOOR) for field in (old, new))
    except ValueError:
        return old == new
    # max() hides a NaN that comes second: each of both must be finite.
    return math.isfinite(float(old)) and math.isfinite(float(new)) and max(a, b) <= FACTOR * min(a, b)


def values(path: Path) -> dict[tuple[str, str], str]:
    """The measured number of each series and robot or place.

    Which robot is the worst at a place, and which share of the answers is better, may change by rounding: they are left out.
    """
    with path.open(encoding="utf-8", newline="") as file:
        head, *rest = csv.reader(file)
    of_robots = head[-1].startswith("share")
    return {(line[0], line[1] if of_robots else line[2]): line[2] if of_robots else line[3] for line in rest}


def differences(old: Path, new: Path) -> list[str]:
    """What is different, in words."""
    names = [sorted(path.name for path in folder.iterdir()) for folder in (old, new)]
    if names[0] != names[1]:
        return [f"the files are {', '.join(names[1])}, and were {', '.join(names[0])}"]
    found = []
    for name in names[0]:
        if name.endswith(".svg"):
            was, now = (texts((folder / name).read_text(encoding="utf-8")) for folder in (old, new))
            if was != now:
                found.append(f"{name}: the texts are {now}, and were {was}")
            continue
        before, after = values(old / name), values(new / name)
        if before.keys() != after.keys():
            found.append(f"{name}: {sorted(after.keys() ^ before.keys())} are in one of both alone")
            continue
        found += [f"{name}: {key} is {after[key]}, and was {was}" for key, was in before.items() if not same(was, after[key])]
    return found


def main() -> int:
    """Compare and tell."""
    old, new = map(Path, sys.argv[1:])
    found = differences(old, new)
    for line in found[:20]:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
