"""MuJoCo's two writers of MJCF: that of a spec, and that of the last compiled model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco as mj

from featherbench_oracles.core.messages import Header


def rewrite(path: Path, into: Path) -> list[Header]:
    """Write a file again as `abilities.WritesFiles` says, by each writer from a reading of its own."""
    writers: dict[str, Callable[[Path, Path], None]] = {"MjSpec.to_xml": _spec, "mj_saveLastXML": _last}
    written: list[Header] = []
    for by, writer in writers.items():
        file = into / f"{path.stem}-{by.replace('.', '-')}.xml"
        try:
            writer(path, file)
        except (ValueError, mj.FatalError) as reason:
            written.append({"by": by, "reason": str(reason)})
        else:
            written.append({"by": by, "file": str(file)})
    return written


def _spec(path: Path, file: Path) -> None:
    spec = mj.MjSpec.from_file(str(path))
    spec.compile()
    file.write_text(spec.to_xml(), encoding="utf-8")


def _last(path: Path, file: Path) -> None:
    mj.mj_saveLastXML(str(file), mj.MjModel.from_xml_path(str(path)))
