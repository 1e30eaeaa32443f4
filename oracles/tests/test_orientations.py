"""Every spelling of an orientation in an MJCF, over all engines: a file that MuJoCo compiles is refused by none that loads it.

An engine may read a spelling to a matrix that is no rotation, or to another rotation. Then its answer says so, or its description differs.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.loaded import is_rotation

from .readers import Readers, of_every_engine
from .test_session import status_of

DRAWS = 200 if os.environ.get("FEATHERBENCH_FULL") else 25
SPELLINGS = ("quat", "axisangle", "xyaxes", "zaxis", "euler")


def numbers(values: Array | list[float]) -> str:
    """Write numbers as in a file."""
    return " ".join(f"{x:.6g}" for x in values)


def orientation(rng: np.random.Generator, degrees: bool) -> str:
    """Draw an orientation in one of all spellings; vectors have any length."""
    kind = SPELLINGS[rng.integers(len(SPELLINGS))]
    scale = 1.0 if rng.integers(2) else float(rng.uniform(0.3, 4))
    vector = rng.normal(size=3)
    vector *= scale / np.linalg.norm(vector)
    angle = rng.uniform(-180, 180) if degrees else rng.uniform(-np.pi, np.pi)
    match kind:
        case "quat":
            quat = rng.normal(size=4)
            written = numbers(scale * quat / np.linalg.norm(quat))
        case "axisangle":
            written = numbers([*vector, angle])
        case "xyaxes":
            written = numbers([*vector, *(rng.uniform(0.5, 2) * np.cross(vector, rng.normal(size=3)) + 0.2 * vector)])
        case "zaxis":
            written = numbers(vector)
        case _:
            written = numbers(rng.uniform(-80, 80, 3) if degrees else rng.uniform(-1.4, 1.4, 3))
    return f'{kind}="{written}"'


def drawn(seed: int) -> str:
    """Draw a robot of three bodies with an orientation in the bodies, in an inertial and in a geom."""
    rng = np.random.default_rng(seed)
    degrees = bool(rng.integers(2))
    letters = "".join(letter.upper() if rng.integers(2) else letter for letter in rng.permutation(list("xyz")))
    order = f' eulerseq="{letters}"' if rng.integers(2) else ""
    turn = [orientation(rng, degrees) for _ in range(4)]
    return f"""<mujoco model="drawn">
  <compiler angle="{"degree" if degrees else "radian"}"{order}/>
  <worldbody>
    <body name="a" pos="0.1 0.2 0.3" {turn[0]}>
      <joint name="ja" type="hinge" axis="0 0 1"/>
      <inertial pos="0.1 0 0.02" {turn[1]} mass="2" diaginertia="0.02 0.03 0.04"/>
      <body name="b" pos="0.3 0.1 0.05" {turn[2]}>
        <joint name="jb" type="hinge" axis="0 1 0"/>
        <geom type="box" size="0.05 0.08 0.1" {turn[3]} mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>"""


@of_every_engine
def test_no_spelling_makes_an_engine_refuse(readers: Readers, engine: str) -> None:
    """Each engine that loads the file tells a robot, and notes each matrix of its own that is no rotation."""
    refused = []
    noted = 0
    for seed in range(DRAWS):
        path = readers.file(f"drawn{seed}.xml", drawn(seed))
        answer = readers.oracles[engine].ask({"op": "import", "format": "mjcf", "base": "fixed", "file": str(path)})
        if status_of(answer) != "ok":
            refused.append(f"seed {seed}: {answer[0]}")
            continue
        noted += sum(note["cause"] == "not_a_rotation" for note in answer[0]["notes"])
        for body in answer[0]["model"]["bodies"]:
            assert is_rotation(np.reshape(body["joint"]["placement"]["rotation"], (3, 3))), f"seed {seed}"
    assert not refused, f"{len(refused)} of {DRAWS}: {refused[:3]}"
    if engine == "mujoco":
        assert not noted


@pytest.mark.parametrize("spelling", ['quat="2 0 0 2"', 'axisangle="0 0 2 90"'])
def test_a_matrix_that_is_no_rotation_is_told_by_its_body(readers: Readers, spelling: str) -> None:
    """Where Pinocchio's placement is no rotation, a note names the body; the description has a rotation."""
    text = f"""<mujoco><worldbody><body name="a" {spelling}><joint name="j" axis="0 1 0"/>
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.02 0.02"/></body></worldbody></mujoco>"""
    path = readers.file("long.xml", text)
    answer = readers.oracles["pinocchio"].ask({"op": "import", "format": "mjcf", "base": "fixed", "file": str(path)})
    assert status_of(answer) == "ok", answer
    turned = np.reshape(answer[0]["model"]["bodies"][0]["joint"]["placement"]["rotation"], (3, 3))
    assert is_rotation(turned)
    about = [note["about"] for note in answer[0]["notes"] if note["cause"] == "not_a_rotation"]
    assert about == ["a"] or np.allclose(turned, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_an_engine_without_a_joint_is_told_so(readers: Readers) -> None:
    """Pinocchio keeps the first body of the world. Where that has no joint, it holds an empty robot and refuses nothing."""
    table = '<body name="table"><geom size="0.1"/></body>'
    arm = '<body name="arm"><joint name="swivel"/><geom size="0.1"/></body>'
    path = readers.file("table.xml", f"<mujoco><worldbody>{table}{arm}</worldbody></mujoco>")
    answer = readers.oracles["pinocchio"].ask({"op": "import", "format": "mjcf", "base": "fixed", "file": str(path)})
    assert status_of(answer) == "ok", answer
    assert answer[0]["model"]["bodies"] == []
    assert any(note["cause"] == "no_joints" and "swivel" in note["text"] for note in answer[0]["notes"])
