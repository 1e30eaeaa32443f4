"""The largest functions of a crate, over all their instances."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections import Counter

from build_time.cargo import FailedError
from build_time.counts import Symbols, count
from build_time.wrapper import OURS


def legacy(symbol: str) -> str | None:
    """Return the path in a symbol of the older mangling, or None: `_ZN4core3fmt5write17h0123456789abcdefE` is `core::fmt::write`."""
    rest = symbol.removeprefix("_ZN")
    if rest == symbol:
        return None
    parts = []
    while number := re.match(r"\d+", rest):
        end = number.end() + int(number[0])
        parts.append(rest[number.end() : end])
        rest = rest[end:]
    if parts and re.fullmatch("h[0-9a-f]{16}", parts[-1]):
        parts.pop()
    signs = {"SP": "@", "BP": "*", "RF": "&", "LT": "<", "GT": ">", "LP": "(", "RP": ")", "C": ","}
    text = "::".join(part[1:] if part.startswith("_$") else part for part in parts).replace("..", "::")
    text = re.sub(r"\$u([0-9a-f]+)\$", lambda found: chr(int(found[1], 16)), text)
    return re.sub(r"\$([A-Z]+)\$", lambda found: signs.get(found[1], found[0]), text)


def readable(symbols: list[str]) -> list[str]:
    """Return the names of functions. Symbols of the newer mangling need c++filt, and stay as they are without it."""
    newer = [symbol for symbol in symbols if symbol.startswith("_R")]
    names: dict[str, str] = {}
    if newer and shutil.which("c++filt"):
        ended = subprocess.run(["c++filt"], input="\n".join(newer) + "\n", capture_output=True, text=True)
        if ended.returncode == 0:
            names = dict(zip(newer, ended.stdout.splitlines(), strict=True))
    return [legacy(symbol) or names.get(symbol, symbol) for symbol in symbols]


def generic(name: str) -> str:
    """Return a function's name without generic arguments: `a::f::<b::C<d>>` is `a::f`, `<a::B<c> as d::E<f>>::g` is `<a::B as d::E>::g`."""
    # c++filt tells a crate's hash.
    name = re.sub(r"(?<=\w)\[[0-9a-f]{8,}\]", "", name)
    kept, depth = "", 0
    for at, sign in enumerate(name):
        before = name[at - 1] if at else " "
        if sign == "<" and (depth or before.isalnum() or before in "_:}"):
            depth += 1
            kept = kept if depth > 1 else kept.removesuffix("::")
        elif sign == ">" and depth and before != "-":
            depth -= 1
        elif not depth:
            kept += sign
    return kept


def origin(name: str) -> str:
    """Return the crate that a function's name begins with: `alloc` for `<alloc::vec::Vec as core::iter::Extend>::extend`."""
    first = re.search(r"(\w+)::", name)
    return first[1] if first else "others"


def largest(symbols: Symbols, number: int) -> list[str]:
    """Tell which crates wrote the lines, and make the table of the functions with the most lines over all instances."""
    lines: Counter[str] = Counter()
    instances: Counter[str] = Counter()
    origins: Counter[str] = Counter()
    for name, (_, more) in zip(readable([symbol for symbol, _ in symbols]), symbols, strict=True):
        lines[generic(name)] += more
        instances[generic(name)] += 1
        origins[origin(name)] += more
    total = max(lines.total(), 1)
    written = ", ".join(f"{name} {sum_ / total:.0%}" for name, sum_ in origins.most_common(8) if sum_ >= total / 100)
    table = ["| lines | share | instances | function |", "|---:|---:|---:|---|"]
    table += [f"| {sum_:,} | {sum_ / total:.1%} | {instances[name]:,} | `{name}` |" for name, sum_ in lines.most_common(number)]
    return [f"By the crate in which a function is written: {written}.", "", *table]


def show(asked: str, number: int) -> int:
    """Count, and print the largest functions of a crate."""
    ours = count().ours
    package = next((name for name in (asked, f"{OURS}-{asked}") if name in ours), None)
    if package is None:
        raise FailedError(f"{asked} is not on the path of the program. Crates: {', '.join(sorted(ours))}")
    lines = sum(lines for _, lines in ours[package])
    print(f"{package}: {lines:,} lines of LLVM IR in {len(ours[package]):,} functions. A row is one function in all its instances.\n")
    print("\n".join(largest(ours[package], number)))
    return 0
