"""The compiler, as cargo starts it hundreds of times: it counts or times a call. So this file imports little."""

from __future__ import annotations

import itertools
import json
import os
import re
import resource
import subprocess
import threading
import time
from collections.abc import Iterable
from pathlib import Path

#: Set where cargo starts `ci/build-time` instead of the compiler: what to do, and the folder of the results.
MODE, FOLDER = "FEATHERBENCH_WRAPPER", "FEATHERBENCH_WRAPPER_FOLDER"
#: The names of our packages begin so.
OURS = "featherbench"
#: Types of crates in words. All others are libraries.
KINDS, LIBRARY = {"bin": "program", "proc-macro": "macros"}, "library"
#: Seconds between two readings of a compiler's CPU time.
SAMPLE = 0.25


def option(arguments: list[str], name: str) -> str | None:
    """Return the value of a compiler's option: `--name value` or `--name=value`."""
    for argument, following in itertools.zip_longest(arguments, arguments[1:]):
        if argument == name:
            return following
        if argument.startswith(f"{name}="):
            return argument.removeprefix(f"{name}=")
    return None


def compiles(arguments: list[str]) -> bool:
    """Whether cargo compiles a crate by this call. Others ask for the version, or are those of a build script."""
    return "dep-info" in (option(arguments, "--emit") or "").split(",") and option(arguments, "--crate-name") is not None


def kind(arguments: list[str]) -> str:
    """Tell what is compiled."""
    if (option(arguments, "--crate-name") or "").startswith("build_script_"):
        return "build script"
    if "--test" in arguments:
        return "tests"
    return KINDS.get(option(arguments, "--crate-type") or "", LIBRARY)


def functions(ir: Iterable[bytes]) -> list[tuple[str, int]]:
    """Return symbol and lines of each function in LLVM IR. A line is an instruction: labels, comments and continued lines are none."""
    found: list[tuple[str, int]] = []
    symbol, lines = None, 0
    for line in ir:
        if line.startswith(b"  "):
            lines += line[2:3] != b" "
        elif line.startswith(b"define "):
            name = re.search(rb'@(?:"([^"]*)"|([\w.$]+))\(', line)
            symbol, lines = (name[1] or name[2]).decode() if name else "?", 0
        elif symbol is not None and line.startswith(b"}"):
            found.append((symbol, lines))
            symbol = None
    return found


def archive(metadata: bytes) -> bytes:
    """Return a library file that has metadata and no machine code."""
    header = f"{'lib.rmeta/':16}{0:<12}{0:<6}{0:<6}{644:<8}{len(metadata):<10}`\n"
    return b"!<arch>\n" + header.encode() + metadata + b"\n" * (len(metadata) % 2)


def stand_in(arguments: list[str]) -> None:
    """Write the file that cargo and the crates that follow expect from the linker."""
    extra = next((argument.removeprefix("extra-filename=") for argument in arguments if argument.startswith("extra-filename=")), "")
    stem = f"{option(arguments, '--crate-name')}{extra}"
    folder = Path(option(arguments, "--out-dir") or ".")
    if kind(arguments) == "program":
        (folder / stem).touch(mode=0o755)
    else:
        (folder / f"lib{stem}.rlib").write_bytes(archive((folder / f"lib{stem}.rmeta").read_bytes()))


def name_of(package: str, crate: str, what: str) -> str:
    """Return the name of the file that has a crate's counts."""
    return f"{package} {crate} {what}.tsv"


def count_call(command: list[str], folder: Path) -> int:
    """Compile a crate to LLVM IR, and count it if it is ours. Build scripts and macros become machine code, because they run."""
    package, crate, what = os.environ.get("CARGO_PKG_NAME", ""), option(command, "--crate-name"), kind(command)
    runs = option(command, "--target") is None
    ours = package.startswith(OURS) and what != "build script"
    if runs and not ours:
        # The program's profile would optimise them.
        os.execvp(command[0], [*command, "-C", "opt-level=0"])
    ir = (folder / name_of(package, crate or "", what + " to run" * runs)).with_suffix(".ll") if ours else Path(os.devnull)
    emitted = [name for name in (option(command, "--emit") or "").split(",") if runs or name != "link"]
    emit = f"--emit={','.join(emitted)},llvm-ir={ir}"
    command = [emit if argument.startswith("--emit=") else argument for argument in command]
    # Cargo's jobserver is an open file that the compiler inherits.
    ended = subprocess.run([*command, "-C", "no-prepopulate-passes", "-C", "codegen-units=1"], close_fds=False)
    if ended.returncode != 0:
        return ended.returncode
    if not runs:
        stand_in(command)
    if ours:
        with ir.open("rb") as file:
            found = functions(file)
        ir.with_suffix(".tsv").write_text("".join(f"{symbol}\t{lines}\n" for symbol, lines in found))
        ir.unlink()
    return 0


def cpu_so_far(process: int) -> float | None:
    """Return the CPU seconds of a process and of its children that ended, if the system tells (Linux)."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def time_call(command: list[str], folder: Path) -> int:
    """Compile a crate, and write its CPU time over its wall time as a line of the log."""
    samples = [(time.monotonic(), 0.0)]
    compiler = subprocess.Popen(command, close_fds=False)
    ended = threading.Event()

    def sample() -> None:
        while not ended.wait(SAMPLE):
            if (cpu := cpu_so_far(compiler.pid)) is not None:
                samples.append((time.monotonic(), cpu))

    sampler = threading.Thread(target=sample, daemon=True)
    sampler.start()
    _, status, usage = os.wait4(compiler.pid, 0)
    ended.set()
    sampler.join()
    # A process that has been waited for has no file in /proc: no sample comes later.
    end = (time.monotonic(), usage.ru_utime + usage.ru_stime)
    # Samples come in ticks of 10 ms. Over a shorter time than this they tell nothing.
    kept = [sample for sample in samples[1:] if sample[0] < end[0] - SAMPLE / 2]
    own = resource.getrusage(resource.RUSAGE_SELF)
    call = {
        "package": os.environ.get("CARGO_PKG_NAME", ""),
        "kind": kind(command),
        "samples": [(round(at, 3), round(cpu, 3)) for at, cpu in [samples[0], *kept, end]],
        "wrapper": own.ru_utime + own.ru_stime,
    }
    # One write of a file that is opened to append does not mix with those of other calls.
    log = os.open(folder / "calls.jsonl", os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    os.write(log, (json.dumps(call) + "\n").encode())
    os.close(log)
    code = os.waitstatus_to_exitcode(status)
    return code if code >= 0 else 128 - code


def main(command: list[str]) -> int:
    """Be the compiler: the command is `rustc ARGUMENT…`."""
    if not compiles(command):
        os.execvp(command[0], command)
    return {"count": count_call, "time": time_call}[os.environ[MODE]](command, Path(os.environ[FOLDER]))
