#!/usr/bin/env python3
"""Counts the instructions of each of our kernels under callgrind and compares them with the committed baseline.

    python ci/instructions.py             exit 1 if a kernel needs more than 2 % above ci/instructions.csv

    python ci/instructions.py --accept    make the counts the baseline of this compiler

    python ci/instructions.py --out FILE  write the counts as CSV, and judge nothing

Instructions do not depend on other load or on the processor's frequency. So they can gate a change, while times only inform. The build is
for x86-64-v3, in its own target folder, because valgrind cannot read AVX-512. Each compiler has its own baseline. Without a baseline, the
counts inform. Prints a Markdown table.

A count is that of one state. For a batch it is that of a full call, divided by the states of the call.

If nothing can be counted, it prints `not counted:` and the reason. That is a failure, except for a comparison on a machine without valgrind
or of another architecture. With FEATHERBENCH_REQUIRE_ALL set, as in CI, this and a missing baseline are failures too.
"""

import argparse
import csv
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BASELINE = ROOT / "ci/instructions.csv"
TARGET = ROOT / "target/instructions"
COLUMNS = ["rustc", "kernel", "model", "instructions"]
# Inlining decisions elsewhere in a file change counts by tenths of a percent; a lost vectorisation or a bounds check by several percent.
TOLERANCE = 0.02
FUNCTION = "instructions::featherbench_measured"
Counts = dict[tuple[str, str], int]  # (kernel, model) -> instructions per state


class NotCountedError(Exception):
    """Why there are no counts."""


def missing() -> str | None:
    """Say what is missing on this machine, if anything."""
    if platform.machine() != "x86_64":
        return f"the counts are those of x86-64, and this machine is {platform.machine()}"
    if shutil.which("valgrind") is None:
        return "there is no valgrind (Debian: apt-get install valgrind)"
    return None


def run(command: list[str], folder: pathlib.Path, capture: bool = True, environment: dict[str, str] | None = None) -> str:
    """Run a command, and return what it prints; if it fails, raise `NotCountedError`."""
    try:
        ended = subprocess.run(command, cwd=folder, env=environment, capture_output=capture, text=True)
    except OSError as error:
        raise NotCountedError(f"{command[0]} cannot be started: {error.strerror}") from error
    if ended.returncode != 0:
        told = ended.stderr.strip()[-400:] if capture else "mend what it says above"
        raise NotCountedError(f"`{' '.join(command)}` failed ({ended.returncode}): {told}")
    return ended.stdout or ""


def compiler() -> str:
    """Tell the compiler's version, with its commit: `1.97.0 (0123456 2026-01-01)`."""
    # In the project's folder rustup uses the compiler of rust-toolchain.toml.
    return run(["rustc", "--version"], ROOT).strip().removeprefix("rustc ")


def build() -> pathlib.Path:
    """Build the program that runs the kernels, and return its path."""
    environment = {**os.environ, "RUSTFLAGS": "-C target-cpu=x86-64-v3 -C no-vectorize-slp", "CARGO_TARGET_DIR": str(TARGET)}
    command = ["cargo", "build", "--release", "--quiet", "-p", "featherbench-engines", "--example", "instructions"]
    run(command, ROOT, capture=False, environment=environment)
    return TARGET / "release/examples/instructions"


def count(program: pathlib.Path) -> Counts:
    """Count instructions per state as {(kernel, model): number}: callgrind writes one file each time the measured function is left."""
    with tempfile.TemporaryDirectory() as folder:
        flags = ["--tool=callgrind", f"--toggle-collect={FUNCTION}", f"--dump-after={FUNCTION}", "--callgrind-out-file=out", "--quiet"]
        runs = [line.split(",") for line in run(["valgrind", *flags, str(program)], pathlib.Path(folder)).splitlines()]
        files = sorted(pathlib.Path(folder).glob("out.*"), key=lambda path: int(path.suffix[1:]))
        counted = [
            int(number) for path in files for number in re.findall(r"^(?:totals|summary): (\d+)", path.read_text(), re.MULTILINE)[:1]
        ]
    totals = [total for total in counted if total > 0]
    if not runs or len(runs) != len(totals):
        raise NotCountedError(
            f"{len(runs)} kernels ran, callgrind told of {len(totals)}: is '{FUNCTION}' still the measured function's name?"
        )
    return {(kernel, model): round(total / int(states)) for (kernel, model, states), total in zip(runs, totals, strict=True)}


def read(path: pathlib.Path, rustc: str) -> Counts:
    """Read the counts of one compiler."""
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        return {(row["kernel"], row["model"]): int(row["instructions"]) for row in csv.DictReader(file) if row["rustc"] == rustc}


def write(path: pathlib.Path, rustc: str, counts: Counts, keep: bool) -> None:
    """Write the counts in one step, with the rows of other compilers where they are kept."""
    rows = []
    if keep and path.exists():
        with path.open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["rustc"] != rustc]
    rows += [{"rustc": rustc, "kernel": kernel, "model": model, "instructions": number} for (kernel, model), number in counts.items()]
    temporary = path.with_suffix(".tmp")
    with temporary.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    temporary.replace(path)


def compare(baseline: Counts, counts: Counts) -> tuple[list[str], list[str]]:
    """Make lines of a Markdown table, and what is wrong: kernels that need more, and kernels that are gone."""
    lines = ["| kernel | robot | baseline | now | change |", "|---|---|---:|---:|---:|"]
    wrong = []
    for (kernel, model), now in counts.items():
        before = baseline.get((kernel, model))
        change = None if before is None else now / before - 1
        said = "new" if change is None else f"{change:+.2%}"
        if change is not None and change > TOLERANCE:
            said = f"**{said}**"
            wrong.append(f"{kernel} on {model}: {said}")
        lines.append(f"| {kernel} | {model} | {before if before is not None else '–'} | {now} | {said} |")
    for kernel, model in baseline.keys() - counts.keys():
        lines.append(f"| {kernel} | {model} | {baseline[kernel, model]} | – | gone |")
        wrong.append(f"{kernel} on {model} is no longer counted")
    return lines, wrong


def main() -> None:
    """Count, and compare or accept."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--accept", action="store_true", help="make what is counted now the baseline")
    parser.add_argument("--out", type=pathlib.Path, help="write the counts here, and judge nothing")
    arguments = parser.parse_args()
    required = "FEATHERBENCH_REQUIRE_ALL" in os.environ
    if reason := missing():
        print(f"not counted: {reason}")
        # `--accept` and `--out` ask for numbers, and there are none.
        sys.exit(1 if required or arguments.accept or arguments.out else 0)
    try:
        rustc = compiler()
        counts = count(build())
    except NotCountedError as error:
        print(f"not counted: {error}")
        sys.exit(1)
    if arguments.out:
        write(arguments.out, rustc, counts, keep=False)
        return
    baseline = read(BASELINE, rustc)
    lines, wrong = compare(baseline, counts)
    print(f"Instructions per state, rustc {rustc}\n")
    print("\n".join(lines))
    if arguments.accept:
        write(BASELINE, rustc, counts, keep=True)
        print(f"\naccepted: {len(counts)} counts in {BASELINE.relative_to(ROOT)}")
    elif not baseline:
        print(f"\nnot judged: {BASELINE.relative_to(ROOT)} does not have this compiler. `python ci/instructions.py --accept` adds it.")
        sys.exit(1 if required else 0)
    elif wrong:
        print(f"\n{len(wrong)} above the baseline by more than {TOLERANCE:.0%}, or gone:\n- " + "\n- ".join(wrong))
        print("\nWhere that is meant, `python ci/instructions.py --accept` makes it the baseline.")
        sys.exit(1)


if __name__ == "__main__":
    main()
