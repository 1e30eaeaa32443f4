"""The conversions against those of the oracles, whose rows the engines themselves are asked (`oracles/tests/test_conventions.py`)."""

import json
from importlib import import_module
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import featherbench

Engine = Literal["pinocchio", "mujoco", "drake"]
ROOT = Path(__file__).parents[2]
# Quaternions of length one and angles of size one: a few roundings, and Drake's arc tangents near ±90° of pitch.
TOLERANCE = 1e-12


@pytest.mark.parametrize(("engine", "package"), [("pinocchio", "pinocchio"), ("mujoco", "mujoco"), ("drake", "pydrake")])
@pytest.mark.parametrize("name", ["humanoid", "joints-common-fixed", "chain-spatial-12-free"])
def test_conversions_are_those_of_the_oracles(engine: Engine, package: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip(package, reason=f"{package} is not installed")
    monkeypatch.syspath_prepend(str(ROOT / "oracles"))
    coordinates = import_module(f"featherbench_oracles.{engine}.coordinates")
    read = import_module("featherbench_oracles.core.robot").Description.read
    path = ROOT / "datasets" / "models" / f"{name}.json"
    robot, data = featherbench.Robot.from_json(path), json.loads(path.read_text())
    for body, joint in zip(data["bodies"], robot.joints, strict=True):
        body["joint"].setdefault("armature", [0.0] * (joint.v[1] - joint.v[0]))  # a file may leave out what is zero
    description = read(data)
    rng = np.random.default_rng(3)
    for q in robot.random(seed=3, states=20):
        v = rng.uniform(-1, 1, robot.nv)
        ours = getattr(robot, f"to_{engine}")(q)
        theirs = coordinates.to_engine_q(description, q)
        # A quaternion and its opposite are one rotation: compare by the way between the configurations.
        back = getattr(robot, f"from_{engine}")
        assert ours.shape == theirs.shape
        assert np.allclose(robot.difference(back(theirs), q), 0, atol=TOLERANCE)
        change = coordinates.change_of_velocities(description, q, v)
        t = np.eye(robot.nv)
        for place, block in change.blocks:
            t[place, place] = block
        assert np.allclose(robot.velocity_to(engine, q, v), t @ v, atol=TOLERANCE)
        assert np.allclose(robot.force_to(engine, q, v), np.linalg.solve(t.T, v), atol=TOLERANCE)
