#!/usr/bin/env python3
"""The table of results in README, from reports/published/results.json.

ci/results_table.py                 fails if README has another table than results.json gives
ci/results_table.py --check RUN     fails too if RUN has other numbers beyond noise
ci/results_table.py RUN             writes the numbers of RUN into results.json, and the table into README; times stay as they are
ci/results_table.py RUN TIMES       the same, with the times of the run TIMES

RUN is a finished run of the default suite, TIMES one that has the study `timing`. `ci/published` calls this.

An error is that of the engine's worst robot: the median over the robot's states, by the engine's usual method, against the truth. The usual
method is, as in the figures, the first of those with the most robots. A time is a ratio to ours: of each robot that of the engine's fastest
method, then the median over the robots. An invalid ratio is never used. Numbers are the same within the noise of ci/figures.py; counts of
known deviations within the same factor, where less than four counts as four. Times depend on the machine, and are not compared.
"""

from __future__ import annotations

import csv
import json
import math
import statistics
import sys
import textwrap
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TypedDict

from figures import FACTOR, same

ROOT = Path(__file__).resolve().parent.parent
README, RESULTS = Path("README.md"), Path("reports/published/results.json")
BEGIN, END = "<!-- results: ci/published writes these lines -->\n", "<!-- end of results -->\n"
OURS = "featherbench"
#: Quantities with an error, and those with a time.
ERRORS = {"id": "inverse dynamics", "fd": "forward dynamics", "mass_matrix": "mass matrix"}
TIMES = {"id": "inverse dynamics", "fd": "forward dynamics"}
#: The robots on which our own times are told.
ROBOTS = ("panda", "humanoid")
NONE = "–"
#: Of the lines of text.
WIDTH = 140

Row = dict[str, str]


class Engine(TypedDict):
    """What a run says of the answers of an engine."""

    name: str
    version: str
    robots: int
    errors: dict[str, float]
    deviations: int
    failures: int


class Ratio(TypedDict):
    """The time of an engine over ours."""

    median: float
    robots: int
    estimated: bool


class Times(TypedDict):
    """What a run says of times: ratios by engine and quantity; ours by robot and quantity, in nanoseconds."""

    date: str
    machine: str
    ratios: dict[str, dict[str, Ratio]]
    ours: dict[str, dict[str, float]]


class Results(TypedDict):
    """What is published."""

    date: str
    engines: list[Engine]
    times: Times


def rows_of(run: Path) -> list[Row]:
    """Read the rows of a run."""
    with (run / "rows.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def usual(rows: Iterable[Row]) -> list[Row]:
    """Return the rows of the usual method: of those with the most robots the first."""
    methods: dict[str, list[Row]] = {}
    for row in rows:
        methods.setdefault(row["method"], []).append(row)
    return max(methods.values(), key=len, default=[])


def engines(rows: list[Row]) -> list[Engine]:
    """Return what is said of each engine, from the smallest error of forward dynamics."""
    found: list[Engine] = []
    for name in dict.fromkeys(row["engine"] for row in rows if row["study"] == "accuracy"):
        mine = [row for row in rows if row["engine"] == name]
        errors: dict[str, float] = {}
        robots = 0
        for quantity in ERRORS:
            judged = usual(row for row in mine if is_error(row, quantity))
            if judged:
                errors[quantity] = worst(float(row["value"]) for row in judged)
                robots = max(robots, len(judged))
        verdicts = [row["verdict"] for row in mine]
        found.append(
            Engine(
                name=name,
                version=mine[0]["engine_version"],
                robots=robots,
                errors=errors,
                deviations=verdicts.count("deviation"),
                failures=verdicts.count("fail") + verdicts.count("error"),
            )
        )
    return sorted(found, key=lambda engine: engine["errors"].get("fd", float("inf")))


def worst(values: Iterable[float]) -> float:
    """Return the largest; NaN is larger than any number."""
    return max(values, key=lambda value: (math.isnan(value), value))


def is_error(row: Row, quantity: str) -> bool:
    """Whether a row is the error of a quantity, of one state at a time."""
    measured = row["study"] == "accuracy" and row["metric"] == "error_median" and row["quantity"] == quantity and row["value"] != ""
    return measured and row["precision"] == "f64" and row["method"] != "batch" and row["valid"] == "true"


def is_time(row: Row, metric: str) -> bool:
    """Whether a row is a valid time of one state at a time, over many distinct states."""
    measured = row["study"] == "timing" and row["metric"] == metric and row["cache"] == "stream" and row["value"] != ""
    return measured and row["precision"] == "f64" and row["method"] != "batch" and row["valid"] == "true"


def engine_of(timed: str, known: Iterable[str]) -> str:
    """Return the engine of which a timed one is a build: `pinocchio` of `pinocchio-clang`."""
    stem = timed.split("-")[0]
    return stem if stem in known else timed


def times(rows: list[Row], known: set[str], date: str, machine: str) -> Times:
    """Return the valid ratios of the engines, and our own times."""
    fastest: dict[tuple[str, str], dict[str, tuple[float, bool]]] = {}
    for row in rows:
        if is_time(row, "ratio") and row["engine"] != OURS and row["quantity"] in TIMES:
            of_robots = fastest.setdefault((engine_of(row["engine"], known), row["quantity"]), {})
            ratio = (float(row["value"]), row["estimated"] == "true")
            of_robots[row["robot"]] = min(ratio, of_robots.get(row["robot"], ratio))
    ratios: dict[str, dict[str, Ratio]] = {}
    for (name, quantity), of_robots in sorted(fastest.items()):
        median = statistics.median(ratio for ratio, _ in of_robots.values())
        estimated = any(estimate for _, estimate in of_robots.values())
        ratios.setdefault(name, {})[quantity] = Ratio(median=median, robots=len(of_robots), estimated=estimated)
    ours: dict[str, dict[str, float]] = {}
    for quantity in TIMES:
        about = [row for row in rows if row["study"] == "timing" and row["quantity"] == quantity]
        # Ratios name our usual method.
        methods = {f"{OURS} {row['method']}": row["method"] for row in about if row["engine"] == OURS}
        usual_methods = {methods.get(row["reference"], "") for row in about if row["metric"] == "ratio"}
        for row in about:
            is_ours = row["engine"] == OURS and row["robot"] in ROBOTS and row["method"] in usual_methods
            if is_ours and is_time(row, "ns_per_call"):
                ours.setdefault(row["robot"], {})[quantity] = float(row["value"])
    return Times(date=date, machine=machine, ratios=ratios, ours=ours)


def measured(run: Path, timed: Path | None, published: Results | None) -> Results:
    """Return what is published of a run; without a run of times, with the times that are published."""
    info = json.loads((run / "run.json").read_text(encoding="utf-8"))
    answers = engines(rows_of(run))
    if timed is not None:
        of = json.loads((timed / "run.json").read_text(encoding="utf-8"))
        of_times = times(rows_of(timed), {engine["name"] for engine in answers}, of["started"][:10], of["host"]["cpu"])
    elif published is not None:
        of_times = published["times"]
    else:
        of_times = Times(date="", machine="", ratios={}, ours={})
    return Results(date=info["started"][:10], engines=answers, times=of_times)


def ratio_cell(results: Results, name: str, quantity: str) -> str:
    """Return the cell of a time."""
    ratios = results["times"]["ratios"]
    if name == OURS:
        return "1"
    found = ratios.get(name, {}).get(quantity)
    return f"{'≈ ' if found['estimated'] else ''}{found['median']:.2g}" if found else NONE


def lines(results: Results) -> Iterator[str]:
    """Return the table, and what it means."""
    yield f"| engine | robots | {' | '.join(ERRORS.values())} | known deviations | failed | time, ID | time, FD |"
    yield f"|---|---:|{'---:|' * (len(ERRORS) + 4)}"
    for engine in results["engines"]:
        name = engine["name"]
        errors = [f"{engine['errors'][quantity]:.1e}" if quantity in engine["errors"] else NONE for quantity in ERRORS]
        cells = [f"{name} {engine['version']}", str(engine["robots"]), *errors, str(engine["deviations"]), str(engine["failures"])]
        yield f"| {' | '.join([*cells, *(ratio_cell(results, name, quantity) for quantity in TIMES)])} |"
    yield ""
    errors_are = (
        "*Errors* are free of units. They compare the engine's usual method with the truth in 32 digits. Each is the median over the "
        "states of that engine's worst robot. *Known deviations* and *failed* are numbers of rows, of all studies of the run "
        f"(default suite, {results['date']})."
    )
    times_are = (
        "*Times* of inverse (ID) and forward dynamics (FD) are ratios to ours. Each is the median over the robots, by the engine's fastest "
        f"method. An estimate has the mark ≈. Without a published valid ratio there is a dash ({NONE}). {ours(results['times'])}"
    )
    yield from textwrap.wrap(errors_are, WIDTH, break_on_hyphens=False)
    yield ""
    yield from textwrap.wrap(times_are, WIDTH, break_on_hyphens=False)


def ours(of: Times) -> str:
    """Return our own times as a sentence."""
    told = [
        f"`{robot}` {' and '.join(f'{nanoseconds / 1000:.2g} µs' for nanoseconds in quantities.values())}"
        for robot, quantities in of["ours"].items()
        if quantities.keys() == TIMES.keys()
    ]
    return f"Ours for one state, ID and FD ({of['machine']}, {of['date']}): {', '.join(told)}." if told else ""


def replaced(readme: str, results: Results) -> str:
    """Return README with the table."""
    if readme.count(BEGIN) != 1 or readme.count(END) != 1:
        raise SystemExit(f"{README} has no single place between {BEGIN.strip()} and {END.strip()}")
    head, rest = readme.split(BEGIN)
    tail = rest.split(END)[1]
    return head + BEGIN + "".join(f"{line}\n" for line in lines(results)) + END + tail


def differences(old: Results, new: Results) -> list[str]:
    """What differs beyond noise, in words."""
    was, now = ({engine["name"]: engine for engine in results["engines"]} for results in (old, new))
    if was.keys() != now.keys():
        return [f"the engines are {', '.join(now)}, and were {', '.join(was)}"]
    found = []
    for name, before in was.items():
        after = now[name]
        exact = (
            ("version", before["version"], after["version"]),
            ("robots", before["robots"], after["robots"]),
            ("failed", before["failures"], after["failures"]),
        )
        found += [f"{name}: {what}: {new_one}, and was {old_one}" for what, old_one, new_one in exact if new_one != old_one]
        fewer, more = sorted(max(FACTOR, count) for count in (before["deviations"], after["deviations"]))
        if more > FACTOR * fewer:
            found.append(f"{name}: known deviations: {after['deviations']}, and were {before['deviations']}")
        for quantity in ERRORS:
            error, again = (str(engine["errors"].get(quantity, NONE)) for engine in (before, after))
            if not same(error, again):
                found.append(f"{name}: error of {quantity}: {again}, and was {error}")
    return found


def main(arguments: list[str], root: Path = ROOT) -> int:
    """Write or check."""
    readme, place = root / README, root / RESULTS
    check = not arguments or arguments[0] == "--check"
    runs = [Path(argument) for argument in arguments if argument != "--check"]
    if len(runs) > (1 if check else 2):
        raise SystemExit(__doc__)
    published: Results | None = json.loads(place.read_text(encoding="utf-8")) if place.is_file() else None
    text = readme.read_text(encoding="utf-8")
    if not check:
        results = measured(runs[0], runs[1] if len(runs) > 1 else None, published)
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        readme.write_text(replaced(text, results), encoding="utf-8")
        return 0
    if published is None:
        raise SystemExit(f"there is no {RESULTS}")
    found = [] if replaced(text, published) == text else [f"the table in {README} is not that of {RESULTS}"]
    if runs:
        found += differences(published, measured(runs[0], None, published))
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
