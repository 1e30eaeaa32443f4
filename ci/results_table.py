#!/usr/bin/env python3
"""The table of results in README, from reports/published/results.json: the ranking of a run's engines, as its report has it.

ci/results_table.py                 fails if README has another table than results.json gives
ci/results_table.py --check FILE    fails too if the ranking FILE has other numbers beyond noise
ci/results_table.py FILE            writes FILE into results.json, and the table into README

FILE is what `featherbench report RUN --json` prints of a finished run of the default suite; crates/studies/registry/src/ranking says what
each number is. `ci/published` calls this. Errors are the same within the noise of ci/figures.py; counts of known deviations within the same
factor, where less than four counts as four. Times depend on the machine, and are not compared.
"""

from __future__ import annotations

import json
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TypedDict

from figures import FACTOR, same

ROOT = Path(__file__).resolve().parent.parent
README, RESULTS = Path("README.md"), Path("reports/published/results.json")
BEGIN, END = "<!-- results: ci/published writes these lines -->\n", "<!-- end of results -->\n"
OURS = "featherbench"
#: Quantities with errors.
QUANTITIES = ("fd", "id", "mass_matrix")
#: Quantities with times, in the order of the columns.
TIMED = {"fd": "FD", "id": "ID", "mass_matrix": "M", "fd_dq": "∂FD"}
NONE = "–"
#: The spacing of doubles at one: the unit of errors.
EPSILON = 2.0**-52
#: Of the lines of text.
WIDTH = 140


class Errors(TypedDict):
    """The errors of an engine's usual method."""

    method: str
    robots: int
    states: int
    median: float
    worst: float
    worst_robot: str
    of_bound: float | None


class Times(TypedDict):
    """The times of an engine over ours."""

    robots: int
    median: float
    least: float
    most: float
    estimated: bool
    machines: int


class Engine(TypedDict):
    """What a run says of an engine."""

    name: str
    version: str
    asked: int
    right: int
    known: int
    errors: dict[str, Errors]
    times: dict[str, Times]
    gravest: str


class Ranking(TypedDict):
    """What a run says of its engines."""

    suite: str
    started: str
    machine: str
    engines: list[Engine]


def short(value: float) -> str:
    """Write two digits, in scientific form where it is shorter."""
    if value and not 1e-3 <= abs(value) < 1e6:
        return f"{value:.1e}".replace(".0e", "e").replace("e+0", "e").replace("e-0", "e-").replace("e+", "e")
    return f"{value:.0f}" if abs(value) >= 100 else f"{float(f'{value:.2g}'):g}"


def error_cells(engine: Engine, quantity: str) -> list[str]:
    """Return the cells of the errors of a quantity."""
    errors = engine["errors"].get(quantity)
    if errors is None:
        return [NONE, NONE]
    return [short(errors["median"] / EPSILON), f"{short(errors['worst'] / EPSILON)}, {errors['worst_robot']}"]


def time_cell(engine: Engine, quantity: str) -> str:
    """Return the cell of a time."""
    if engine["name"] == OURS:
        return "1"
    times = engine["times"].get(quantity)
    if times is None:
        return NONE
    return f"{'≈ ' if times['estimated'] else ''}{short(times['median'])} ({short(times['least'])} to {short(times['most'])})"


def right_cell(engine: Engine) -> str:
    """Return the share of answers within their bound, to the digit that tells that not all are."""
    if not engine["asked"]:
        return NONE
    percent = 100 * engine["right"] / engine["asked"]
    words = "100 %" if engine["right"] == engine["asked"] else "> 99.9 %" if percent > 99.9 else f"{percent:.1f} %"
    return f"{words} of {engine['asked']}"


def lines(ranking: Ranking) -> Iterator[str]:
    """Return the table, and what it means."""
    times_of = [f"time {of}" for of in TIMED.values()]
    heads = ["engine", "right", "FD error", "worst, on", "ID error", "M error", *times_of, "gravest finding"]
    yield f"| {' | '.join(heads)} |"
    yield f"|---|---|{'---:|' * (len(heads) - 3)}---|"
    for engine in ranking["engines"]:
        errors = [*error_cells(engine, "fd"), *(error_cells(engine, quantity)[0] for quantity in ("id", "mass_matrix"))]
        times = (time_cell(engine, quantity) for quantity in TIMED)
        name = f"{engine['name']} {engine['version']}".rstrip()
        yield f"| {' | '.join([name, right_cell(engine), *errors, *times, engine['gravest'] or NONE])} |"
    of_errors = [errors for engine in ranking["engines"] for errors in engine["errors"].values()]
    of_times = [times for engine in ranking["engines"] if engine["name"] != OURS for times in engine["times"].values()]
    robots, states = (max((errors[key] for errors in of_errors), default=0) for key in ("robots", "states"))
    timed, machines = (max((times[key] for times in of_times), default=0) for key in ("robots", "machines"))
    errors_are = (
        f"The suite is {ranking['suite']}, the day {ranking['started'][:10]}. *Right* is the share of answers within their bound. "
        "FD is forward dynamics, ∂FD its derivative by q, ID inverse dynamics, M the mass matrix. "
        "*Errors* are those of the engine's usual method against the "
        f"truth in 32 digits, in units of 2⁻⁵². Each is the median over up to {robots} robots at {states} states. "
        "The worst is that of the robot with the largest error."
    )
    times_are = (
        f"*Times* are those of the engine's fastest method over ours. Each is the median over up to {timed} robots, with the least and the "
        f"most, recorded on {machines} machines (`datasets/speed`). An estimate, through Python, has the mark ≈."
        if of_times
        else f"*Times* are those of the engine's fastest method over ours. Without a ratio that counts there is a dash ({NONE})."
    )
    yield ""
    yield from textwrap.wrap(errors_are, WIDTH, break_on_hyphens=False)
    yield ""
    yield from textwrap.wrap(times_are.replace(" 1 machines", " one machine"), WIDTH, break_on_hyphens=False)


def replaced(readme: str, ranking: Ranking) -> str:
    """Return README with the table."""
    if readme.count(BEGIN) != 1 or readme.count(END) != 1:
        raise SystemExit(f"{README} has no single place between {BEGIN.strip()} and {END.strip()}")
    head, rest = readme.split(BEGIN)
    tail = rest.split(END)[1]
    return head + BEGIN + "".join(f"{line}\n" for line in lines(ranking)) + END + tail


def wrong(engine: Engine) -> int:
    """Return the number of answers that are beyond their bound, or missing, for no known cause."""
    return engine["asked"] - engine["right"] - engine["known"]


def differences(old: Ranking, new: Ranking) -> list[str]:
    """What differs beyond noise, in words."""
    was, now = ({engine["name"]: engine for engine in ranking["engines"]} for ranking in (old, new))
    if was.keys() != now.keys():
        return [f"the engines are {', '.join(now)}, and were {', '.join(was)}"]
    found = []
    for name, before in was.items():
        after = now[name]
        exact = (("version", before["version"], after["version"]), ("failed", wrong(before), wrong(after)))
        found += [f"{name}: {what}: {new_one}, and was {old_one}" for what, old_one, new_one in exact if new_one != old_one]
        fewer, more = sorted(max(FACTOR, engine["known"]) for engine in (before, after))
        if more > FACTOR * fewer:
            found.append(f"{name}: known deviations: {after['known']}, and were {before['known']}")
        for quantity in QUANTITIES:
            errors, again = before["errors"].get(quantity), after["errors"].get(quantity)
            if (errors is None) != (again is None):
                found.append(f"{name}: errors of {quantity}: {'none' if again is None else 'some'} now")
            if errors is None or again is None:
                continue
            if errors["robots"] != again["robots"]:
                found.append(f"{name}: robots of {quantity}: {again['robots']}, and were {errors['robots']}")
            found += [
                f"{name}: {which} error of {quantity}: {new_one}, and was {old_one}"
                for which, old_one, new_one in (("median", errors["median"], again["median"]), ("worst", errors["worst"], again["worst"]))
                if not same(str(old_one), str(new_one))
            ]
    return found


def main(arguments: list[str], root: Path = ROOT) -> int:
    """Write or check."""
    readme, place = root / README, root / RESULTS
    check = not arguments or arguments[0] == "--check"
    files = [Path(argument) for argument in arguments if argument != "--check"]
    if len(files) > 1:
        raise SystemExit(__doc__)
    text = readme.read_text(encoding="utf-8")
    new: Ranking | None = json.loads(files[0].read_text(encoding="utf-8")) if files else None
    if not check and new is not None:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(json.dumps(new, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        readme.write_text(replaced(text, new), encoding="utf-8")
        return 0
    if not place.is_file():
        raise SystemExit(f"there is no {RESULTS}")
    published: Ranking = json.loads(place.read_text(encoding="utf-8"))
    found = [] if replaced(text, published) == text else [f"the table in {README} is not that of {RESULTS}"]
    if new is not None:
        found += differences(published, new)
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
