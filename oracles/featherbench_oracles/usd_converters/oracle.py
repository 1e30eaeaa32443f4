"""The converters `urdf_usd_converter` and `mujoco_usd_converter`. They compute nothing and read nothing for comparison: they write."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import mujoco_usd_converter
import urdf_usd_converter

from featherbench_oracles.abilities import WritesFiles
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Quantities, Robot, Unsupported
from featherbench_oracles.core.robot import Description

CONVERTERS = {"urdf": urdf_usd_converter.Converter, "mjcf": mujoco_usd_converter.Converter}


class UsdConverters(WritesFiles):
    """The converters, for `session.serve`."""

    name = "usd_converters"
    version = importlib.metadata.version("urdf-usd-converter")
    build = {"language": "Python", "packages": f"mujoco-usd-converter {importlib.metadata.version('mujoco-usd-converter')}"}
    quantities: Quantities = {}

    def prepare(self, description: Description) -> Robot:
        """Refuse: they compute nothing."""
        raise Unsupported("a converter has no dynamics")

    def rewrite(self, path: Path, form: str, into: Path) -> list[Header]:
        """Write a URDF or an MJCF as one USD file."""
        if form not in CONVERTERS:
            raise Unsupported(f"there is no converter of {form.upper()} to USD here")
        by = f"{CONVERTERS[form].__module__.split('.')[0]}"
        try:
            asset = CONVERTERS[form](layer_structure=False).convert(str(path), str(into))
        except (RuntimeError, ValueError, OSError) as reason:
            return [{"by": by, "reason": str(reason)}]
        return [{"by": by, "file": str(Path(into) / Path(asset.path).name)}]
