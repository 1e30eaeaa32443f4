"""MJCF files of installed packages, read by featherbench and compiled by MuJoCo: the same M and bias forces."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import featherbench

ROOT = Path(__file__).parents[2]
PACKAGES = ROOT / "target" / "oracles" / "packages"
# MuJoCo diagonalises inertias, which costs 1e-15 of the largest moment, and a slim body has moments 1e-4 of that.
# Errors are of the largest number: some roundings for each of up to a hundred bodies.
TOLERANCE = 1e-11
# MuJoCo takes inertial axes within 1e-6 of the body's for the body's (`oracles/featherbench_oracles/mujoco/building.py`).
ALIGNED = 1e-5


def files():
    return sorted(PACKAGES.rglob("*.xml")) if PACKAGES.is_dir() else []


def test_files_mean_what_mujoco_makes_of_them(monkeypatch):
    pytest.importorskip("mujoco", reason="mujoco is not installed")
    if not files():
        pytest.skip("the robots' packages are not installed")
    monkeypatch.syspath_prepend(str(ROOT / "oracles"))
    reading = import_module("featherbench_oracles.mujoco.reading")
    read, refused, worst = 0, {}, {}
    for path in files():
        try:
            robot = featherbench.Robot.from_mjcf(path)
        except featherbench.Error as error:
            refused[path.name] = str(error)
            continue
        try:
            theirs = reading.read(path, "mjcf", "fixed", lambda description, model: None)
        except Exception as error:  # MuJoCo's compiler refuses what misses meshes, which inertials do not need
            refused[path.name] = str(error)
            continue
        description = theirs.model
        assert [body["name"] for body in description["bodies"]] == [joint.body for joint in robot.joints], path
        q, rng = robot.random(seed=1, states=5), np.random.default_rng(1)
        held = featherbench.Robot.from_json(written(description, path))
        v = rng.uniform(-1, 1, (5, robot.nv))
        for quantity in (lambda r: r.mass_matrix(q), lambda r: r.bias_force(q, v)):
            ours, due = quantity(robot), quantity(held)
            worst[path.name] = max(worst.get(path.name, 0), np.max(np.abs(ours - due)) / max(np.max(np.abs(due)), 1e-300))
        read += 1
    print({name: f"{error:.1e}" for name, error in sorted(worst.items(), key=lambda item: -item[1])[:5]})
    print(refused)
    assert read >= 20, refused
    assert all(error <= TOLERANCE for error in worst.values()), worst


def written(description, path):
    import json
    import tempfile

    file = Path(tempfile.mkdtemp()) / f"{path.stem}.json"
    file.write_text(json.dumps(description))
    return file
