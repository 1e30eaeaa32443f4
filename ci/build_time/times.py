"""Where the time of a build goes."""

from __future__ import annotations

import dataclasses
import itertools
import json
import os
import re
import shutil
import subprocess
import time
from collections import defaultdict
from collections.abc import Iterable

from build_time.cargo import ROOT, FailedError, environment

TIME = ROOT / "target/build-time"
#: With fewer busy cores on average, one is busy: the middle between one and two.
ONE_CORE = 1.5
#: What needs less than this share of the CPU time, and of the time alone, is in one row together.
SMALL = 0.005
#: A build alone on its machine gets more than this share of the cores that it asks for: the rest is reading, linking and ticks.
UNDISTURBED = 0.85


@dataclasses.dataclass(frozen=True)
class Call:
    """One start of the compiler: what it compiled, and its CPU seconds so far at times of a common clock."""

    package: str
    kind: str
    samples: list[tuple[float, float]]

    @property
    def cpu(self) -> float:
        """CPU seconds."""
        return self.samples[-1][1]

    @property
    def wall(self) -> float:
        """Wall seconds."""
        return self.samples[-1][0] - self.samples[0][0]


@dataclasses.dataclass(frozen=True)
class Span:
    """A time in which the same calls ran, and the cores that they kept busy."""

    begin: float
    end: float
    cores: float
    calls: frozenset[int]

    @property
    def one(self) -> bool:
        """Whether at most one core is busy."""
        return self.cores < ONE_CORE

    @property
    def seconds(self) -> float:
        """Wall seconds."""
        return self.end - self.begin


def calls_of(log: Iterable[str]) -> list[Call]:
    """Read a log."""
    return [Call(entry["package"], entry["kind"], [(at, cpu) for at, cpu in entry["samples"]]) for entry in map(json.loads, log)]


def spans(calls: list[Call]) -> list[Span]:
    """Divide the time of a build. A call keeps at least one core busy: with less CPU time it waits for the core or for the linker."""
    begins: dict[float, list[tuple[int, float]]] = defaultdict(list)
    ends: dict[float, list[int]] = defaultdict(list)
    for index, call in enumerate(calls):
        for (begin, before), (end, after) in itertools.pairwise(call.samples):
            if end > begin:
                begins[begin].append((index, max(1.0, (after - before) / (end - begin))))
                ends[end].append(index)
    busy: dict[int, float] = {}
    found = []
    for begin, end in itertools.pairwise(sorted(begins.keys() | ends.keys())):
        for index in ends[begin]:
            del busy[index]
        busy.update(begins[begin])
        found.append(Span(begin, end, sum(busy.values()), frozenset(busy)))
    return found


def within(stretch: list[Span]) -> dict[int, float]:
    """Return the seconds of each call in some spans."""
    seconds: dict[int, float] = defaultdict(float)
    for span in stretch:
        for index in span.calls:
            seconds[index] += span.seconds
    return seconds


def alone(divided: list[Span]) -> dict[int, float]:
    """Return the seconds in which each call was the only one and kept one core busy."""
    return within([span for span in divided if span.one and len(span.calls) == 1])


def longest(divided: list[Span]) -> list[Span]:
    """Return the longest stretch in which at most one core was busy."""
    stretches = [list(stretch) for one, stretch in itertools.groupby(divided, key=lambda span: span.one) if one]
    return max(stretches, key=lambda stretch: stretch[-1].end - stretch[0].begin, default=[])


def table(calls: list[Call], cpu: float) -> list[str]:
    """Make the table of what was compiled, and say when one core was busy."""
    divided = spans(calls)
    single = alone(divided)
    sums: dict[tuple[str, str], list[float]] = defaultdict(lambda: [0.0, 0.0, 0.0])
    for index, call in enumerate(calls):
        for at, value in enumerate((call.cpu, call.wall, single[index])):
            sums[call.package, call.kind][at] += value
    rows = ["| crate | what | CPU s | wall s | alone s | alone |", "|---|---|---:|---:|---:|---:|"]
    small, few = [0.0, 0.0, 0.0], 0
    for (package, what), of in sorted(sums.items(), key=lambda item: -item[1][0]):
        if of[0] >= SMALL * cpu or of[2] >= SMALL * cpu:
            rows.append(f"| {package} | {what} | {of[0]:.1f} | {of[1]:.1f} | {of[2]:.1f} | {of[2] / of[1]:.0%} |")
        else:
            small, few = [a + b for a, b in zip(small, of, strict=True)], few + 1
    if few:
        rows.append(f"| {few} smaller | | {small[0]:.1f} | {small[1]:.1f} | {small[2]:.1f} | |")
    one = sum(span.seconds for span in divided if span.one)
    said = [f"At most one core was busy for {one:.0f} s."]
    if stretch := longest(divided):
        most = sorted(within(stretch).items(), key=lambda item: -item[1])[:5]
        names = ", ".join(f"{calls[index].package} ({calls[index].kind}) {seconds:.0f} s" for index, seconds in most)
        after = stretch[0].begin - divided[0].begin
        said.append(f"The longest such stretch took {stretch[-1].end - stretch[0].begin:.0f} s, after {after:.0f} s: {names}.")
    asked = sum(span.cores * span.seconds for span in divided)
    if (got := sum(call.cpu for call in calls)) < UNDISTURBED * asked:
        said.append(f"Something else used the machine: the compiler got {got / asked:.0%} of the cores that it asked for. Trust CPU times.")
    return [" ".join(said), "", *rows]


def asked_build(which: str, readme: str) -> str:
    """Return the command that is measured."""
    if which == "run":
        return "cargo build --release"
    block = re.search(r"^```sh test\n(.*?)^```", readme, re.MULTILINE | re.DOTALL)
    command = block[1].strip() if block else ""
    if not re.fullmatch(r"cargo test\b[^\n]*", command):
        raise FailedError(f"README's block `sh test` is not one command `cargo test`: {command!r}")
    return f"{command} --no-run"


def show(which: str) -> int:
    """Build from nothing, and print where the time went."""
    command = asked_build(which, (ROOT / "README.md").read_text())
    folder = TIME / which
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    load, begin = os.getloadavg()[0], time.monotonic()
    build = subprocess.Popen(["bash", "-euo", "pipefail", "-c", command], cwd=ROOT, env=environment("time", folder, folder / "cargo"))
    _, status, usage = os.wait4(build.pid, 0)
    wall = time.monotonic() - begin
    if status != 0:
        raise FailedError(f"`{command}` failed ({os.waitstatus_to_exitcode(status)}), as it says above")
    log = (folder / "calls.jsonl").read_text().splitlines()
    cpu = usage.ru_utime + usage.ru_stime - sum(json.loads(line)["wrapper"] for line in log)
    shutil.rmtree(folder / "cargo")
    told = f"**{cpu:.0f} s of CPU, {wall:.0f} s of wall time** on {os.cpu_count()} cores (load before: {load:.1f})"
    print(f"`{command}` from nothing: {told}.", end=" ")
    print("\n".join(table(calls_of(log), cpu)))
    print(f"\nEach start of the compiler is a line of {(folder / 'calls.jsonl').relative_to(ROOT)}.")
    return 0
