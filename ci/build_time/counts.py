"""What the program asks of the compiler, beside a baseline."""

from __future__ import annotations

import csv
import dataclasses
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from build_time import wrapper
from build_time.cargo import ROOT, FailedError, compiler, environment
from build_time.wrapper import OURS

BASELINE = ROOT / "ci/build-size.csv"
SIZE = ROOT / "target/build-size"
COLUMNS = ["rustc", "whose", "package", "versions", "lines", "functions"]
PROGRAM = "featherbench"
TRIPLE = "x86_64-unknown-linux-gnu"
#: A change may add a function or two to a crate. A second instance of a kernel or of a reader adds more.
CRATE_TOLERANCE = 0.10
#: What one crate gains by a move another loses, so the sum varies less. It is what a cold build costs.
TOTAL_TOLERANCE = 0.03
Symbols = list[tuple[str, int]]


@dataclasses.dataclass(frozen=True)
class Crate:
    """What one crate asks of the compiler."""

    lines: int
    functions: int


@dataclasses.dataclass(frozen=True)
class Build:
    """What the program asks of the compiler: our crates, and the number of versions of each package of others."""

    crates: dict[str, Crate] = dataclasses.field(default_factory=dict)
    others: dict[str, int] = dataclasses.field(default_factory=dict)

    def lines(self) -> int:
        """Lines of all our crates."""
        return sum(crate.lines for crate in self.crates.values())

    def functions(self) -> int:
        """Instances of functions in all our crates."""
        return sum(crate.functions for crate in self.crates.values())


@dataclasses.dataclass(frozen=True)
class Counted:
    """Symbol and lines of each function of our packages, and the versions of the packages of others."""

    ours: dict[str, Symbols]
    others: dict[str, set[str]]

    def build(self) -> Build:
        """Sums of it."""
        crates = {name: Crate(sum(lines for _, lines in symbols), len(symbols)) for name, symbols in self.ours.items()}
        return Build(crates, {name: len(versions) for name, versions in self.others.items()})


def package_of(identity: str) -> tuple[str, str]:
    """Return name and version of a package: `registry+https://…#name@1.2.3`, or `path+file:///…/name#1.2.3`."""
    url, _, rest = identity.partition("#")
    name, at, version = rest.rpartition("@")
    return (name, version) if at else (url.partition("?")[0].rpartition("/")[2], rest)


def heavier(baseline: Build, now: Build, same_compiler: bool) -> list[str]:
    """Tell in which respects a build is heavier than the baseline."""
    found = []
    if same_compiler:
        before, after = baseline.lines(), now.lines()
        if after > before * (1 + TOTAL_TOLERANCE):
            found.append(f"all crates together: {change(before, after)} lines, and {TOTAL_TOLERANCE:.0%} is the limit")
        for name, crate in now.crates.items():
            if (was := baseline.crates.get(name)) and crate.lines > was.lines * (1 + CRATE_TOLERANCE):
                found.append(f"{name}: {change(was.lines, crate.lines)} lines, and {CRATE_TOLERANCE:.0%} is the limit")
    found += [f"{name} is not in the baseline" for name in now.crates if name not in baseline.crates]
    before, after = sum(baseline.others.values()), sum(now.others.values())
    if after > before:
        more = [name for name, versions in now.others.items() if versions > baseline.others.get(name, 0)]
        found.append(f"{after} packages of others, and were {before}. With more versions, or new: {', '.join(sorted(more))}")
    return found


def change(before: int, after: int) -> str:
    """Tell a relative change."""
    return f"{after / before - 1:+.2%}" if before else "new"


def sizes(baseline: Build, now: Build) -> list[str]:
    """Make the table of our crates, the largest first."""
    lines = ["| crate | lines | functions | lines of the baseline | change |", "|---|---:|---:|---:|---:|"]
    for name, crate in sorted(now.crates.items(), key=lambda item: -item[1].lines):
        was = baseline.crates.get(name)
        lines.append(row(name, crate, was.lines if was else None))
    lines += [f"| {name} | – | – | {was.lines:,} | gone |" for name, was in baseline.crates.items() if name not in now.crates]
    return [*lines, row("**all**", Crate(now.lines(), now.functions()), baseline.lines() if baseline.crates else None)]


def row(name: str, crate: Crate, before: int | None) -> str:
    """Make a row of that table."""
    told = ("–", "new") if before is None else (f"{before:,}", change(before, crate.lines))
    return f"| {name} | {crate.lines:,} | {crate.functions:,} | {told[0]} | {told[1]} |"


def read(path: Path) -> tuple[str, Build]:
    """Read a baseline, and the compiler that it is of."""
    if not path.exists():
        return "", Build()
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    ours = {line["package"]: Crate(int(line["lines"]), int(line["functions"])) for line in rows if line["whose"] == "ours"}
    others = {line["package"]: int(line["versions"]) for line in rows if line["whose"] == "others"}
    return rows[0]["rustc"] if rows else "", Build(ours, others)


def write(path: Path, rustc: str, build: Build) -> None:
    """Write a baseline in one step. Rows of another compiler go: rust-toolchain.toml names one."""
    temporary = path.with_suffix(".tmp")
    with temporary.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows([rustc, "ours", name, 1, crate.lines, crate.functions] for name, crate in sorted(build.crates.items()))
        writer.writerows([rustc, "others", name, versions, "", ""] for name, versions in sorted(build.others.items()))
    temporary.replace(path)


def count() -> Counted:
    """Count the program."""
    # Cargo does not know that another version of the wrapper counts in another way.
    stamp, own = SIZE / "wrapper", hashlib.sha256(Path(wrapper.__file__).read_bytes()).hexdigest()
    if not stamp.exists() or stamp.read_text() != own:
        shutil.rmtree(SIZE, ignore_errors=True)
    (SIZE / "counts").mkdir(parents=True, exist_ok=True)
    stamp.write_text(own)
    settings = environment("count", SIZE / "counts", SIZE / "cargo")
    # What this machine sets does not enter.
    personal = re.compile("CARGO_(PROFILE_|TARGET_(?!DIR)|ENCODED_|BUILD_(?!JOBS))|RUSTC_WORKSPACE_WRAPPER")
    settings = {name: value for name, value in settings.items() if not personal.match(name)}
    settings |= {"CARGO_INCREMENTAL": "0", "RUSTFLAGS": "-C target-cpu=x86-64-v3"}
    # With a target, what runs during the build is compiled apart from what becomes the program. Debug information adds no instruction.
    command = ["cargo", "build", "--release", "-p", PROGRAM, "--target", TRIPLE, "--message-format=json-render-diagnostics"]
    command += ["--config", "profile.release.debug=false", *["--quiet"] * (not sys.stderr.isatty())]
    try:
        built = subprocess.run(command, cwd=ROOT, env=settings, stdout=subprocess.PIPE, text=True)
    except OSError as error:
        raise FailedError(f"cargo cannot be started: {error.strerror}") from error
    if built.returncode != 0:
        raise FailedError(f"`{' '.join(command)}` failed ({built.returncode}), as it says above")
    versions: dict[str, set[str]] = defaultdict(set)
    ours: dict[str, Symbols] = defaultdict(list)
    # Cargo names what it compiled, and what it had.
    for artifact in (message for message in map(json.loads, built.stdout.splitlines()) if message["reason"] == "compiler-artifact"):
        name, version = package_of(artifact["package_id"])
        versions[name].add(version)
        if name.startswith(OURS) and artifact["target"]["kind"] != ["custom-build"]:
            ours[name] += counted(name, artifact["target"]["name"].replace("-", "_"), artifact["target"]["kind"][0])
    return Counted(dict(ours), {name: those for name, those in versions.items() if name not in ours})


def counted(package: str, crate: str, what: str) -> Symbols:
    """Return symbol and lines of each function that a crate of ours is compiled to."""
    kind = wrapper.KINDS.get(what, wrapper.LIBRARY)
    found = (SIZE / "counts" / wrapper.name_of(package, crate, of) for of in (kind, f"{kind} to run"))
    files = [path for path in found if path.exists()]
    if not files:
        raise FailedError(f"{package} was not counted: remove {SIZE.relative_to(ROOT)}, and count again")
    fields = (line.rsplit("\t", 1) for path in files for line in path.read_text().splitlines())
    return [(symbol, int(lines)) for symbol, lines in fields]


def packages(baseline: int | None, others: dict[str, set[str]]) -> list[str]:
    """Tell how many packages of others there are, and which have several versions."""
    now = sum(map(len, others.values()))
    several = [f"- {name} {', '.join(sorted(versions))}" for name, versions in sorted(others.items()) if len(versions) > 1]
    before = "no baseline" if baseline is None else f"{baseline} in the baseline"
    return [f"Packages of others: {now} ({before}). With more than one version:", *(several or ["- none"])]


def compare(accept: bool) -> int:
    """Count, print, and judge or accept."""
    rustc, counted = compiler(), count()
    now = counted.build()
    of, baseline = read(BASELINE)
    found = heavier(baseline, now, of == rustc) if of and not accept else []
    path = BASELINE.relative_to(ROOT)
    if accept:
        write(BASELINE, rustc, now)
        told = f"**Accepted**: these counts are {path} now."
    elif found:
        told = "**Heavier than the baseline**:\n\n- " + "\n- ".join(found) + "\n\nIn all"
    elif not of:
        told = f"**Not judged**: there is no {path}. `ci/build-time --accept` makes it."
    elif of != rustc:
        told = f"**Lines not judged**: {path} is that of rustc {of}. `ci/build-time --accept` renews it."
    else:
        told = "**As light as the baseline.**"
    print(f"{told} {now.lines():,} lines of LLVM IR in {now.functions():,} functions, rustc {rustc}.\n")
    print("\n".join([*sizes(baseline, now), "", *packages(sum(baseline.others.values()) if of else None, counted.others)]))
    if found:
        print("\n`ci/build-time --functions CRATE` tells what is large. Where it is meant, `ci/build-time --accept` renews the baseline.")
    elif of == rustc and not accept and now.lines() < baseline.lines() * (1 - TOTAL_TOLERANCE):
        print("\nWhat is gained is kept by `ci/build-time --accept`.")
    return int(bool(found) or ("FEATHERBENCH_REQUIRE_ALL" in os.environ and not accept and of != rustc))
