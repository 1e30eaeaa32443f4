"""A build whose compiler is `ci/build-time`."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from build_time.wrapper import FOLDER, MODE

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "ci/build-time"


class FailedError(Exception):
    """Why there is no answer."""


def compiler() -> str:
    """Tell the compiler's version, with its commit: `1.97.0 (0123456 2026-01-01)`."""
    # In the project's folder rustup uses the compiler of rust-toolchain.toml.
    try:
        ended = subprocess.run(["rustc", "--version"], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise FailedError("`rustc --version` failed") from error
    return ended.stdout.strip().removeprefix("rustc ")


def environment(mode: str, folder: Path, target: Path) -> dict[str, str]:
    """Return the environment in which cargo starts this script as the compiler."""
    return {**os.environ, "CARGO_TARGET_DIR": str(target), "RUSTC_WRAPPER": str(SCRIPT), MODE: mode, FOLDER: str(folder)}
