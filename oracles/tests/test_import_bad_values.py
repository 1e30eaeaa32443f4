"""Armature, damping and friction that no joint can have: told as a finding about the file, with line and value; the rest is compared."""

from __future__ import annotations

import os
import re

import numpy as np
import pytest

from .readers import Readers

DRAWN = 240 if "FEATHERBENCH_FULL" in os.environ else 40
ENGINES = ("pinocchio", "mujoco", "drake", "dart")
INERTIAL = '<inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>'
MASS = '<inertial><origin xyz=".1 0 0"/><mass value="1"/><inertia ixx=".02" iyy=".03" izz=".04" ixy="0" ixz="0" iyz="0"/></inertial>'
FIELDS = {"armature": "armature", "damping": "damping", "frictionloss": "friction", "friction": "friction"}


def drawn(seed: int) -> tuple[str, str, str, str, str, int]:
    """Draw a chain with one bad value: the file's name and text, the joint, the attribute, the value, and its line."""
    rng = np.random.default_rng([45, seed])
    form = str(rng.choice(["xml", "urdf"]))
    count = int(rng.integers(1, 5))
    wrong = int(rng.integers(count))
    words = ["damping", "friction"] if form == "urdf" else ["armature", "damping", "frictionloss"]
    attribute = str(rng.choice(words))
    value = str(rng.choice([f"{-rng.uniform(1e-9, 5):.6g}", "-1e3", "nan", "inf", "-inf"], p=[0.6, 0.1, 0.1, 0.1, 0.1]))
    said = [f'{attribute}="{value}"' if k == wrong else "" for k in range(count)]
    if form == "urdf":
        lines = ['<robot name="r"><link name="link"/>']
        for k in range(count):
            parent = f"link{k - 1}" if k else "link"
            lines += [f'<link name="link{k}">{MASS}</link><joint name="joint{k}" type="continuous">', f'<parent link="{parent}"/>']
            lines += [f'<child link="link{k}"/><axis xyz="0 1 0"/>', f"<dynamics {said[k]}/>", "</joint>"]
        lines.append("</robot>")
    else:
        lines = ['<mujoco><option gravity="0 0 -3"/><worldbody>']  # so MuJoCo has a variant: that without it
        for k in range(count):
            lines += [f'<body name="body{k}" pos="0 0 1">', f'<joint name="joint{k}" axis="0 1 0" {said[k]}/>', INERTIAL]
        lines += ["</body>" * count, "</worldbody></mujoco>"]
    line = next(number for number, text in enumerate(lines, 1) if said[wrong] in text)
    return f"bad{seed}.{form}", "\n".join(lines), f"joint{wrong}", attribute, value, line


@pytest.mark.parametrize("engine", ENGINES)
def test_a_bad_value_is_told_with_its_line_and_left_out(readers: Readers, engine: str) -> None:
    """An engine that accepts the file computes with what it tells, without the value. One that refuses it says so in its own words."""
    accepted = 0
    for seed in range(DRAWN):
        name, text, joint, attribute, value, line = drawn(seed)
        path, oracle = readers.file(name, text), readers.oracles[engine]
        form = "mjcf" if name.endswith(".xml") else "urdf"
        answer = oracle.ask({"op": "import", "file": str(path), "format": form, "base": "fixed"})[0]
        if answer["status"] != "ok":
            assert not re.search("the model:|which no joint", answer["reason"]), (seed, answer)
            continue
        accepted += 1
        read = readers.read(engine, name, text)
        told = [note for note in read.header["notes"] if note["cause"] == "bad_value"]
        assert [note["about"] for note in told] == [joint], (seed, told)
        assert f"line {line}: joint '{joint}' has {attribute}=\"{value}\"" in told[0]["text"], (seed, told)
        held = next(body["joint"] for body in read.bodies if body["joint"]["name"] == joint)
        assert held[FIELDS[attribute]] == [0.0], (seed, held)
        for other in readers.variants(name, text) if (engine, form) == ("mujoco", "mjcf") else []:
            joints = [body["joint"] for body in other["model"]["bodies"]]
            assert all(min(value) >= 0 for joint in joints for value in [joint.get(FIELDS[attribute], [0.0])]), (seed, other)
    assert accepted > DRAWN // 8
