"""What each engine makes of joints that mimic others: drawn trees with chains of mimics, continuous followers, offsets and multipliers."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco as mj
import numpy as np
import pytest

from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.mimics import Mimic, written
from featherbench_oracles.testing.described import ENGINES

from .readers import Readers

DRAWN = 240 if "FEATHERBENCH_FULL" in os.environ else 40
LINK = """<link name="{}"><inertial><origin xyz="{} .01 .03"/><mass value="{}"/>
<inertia ixx="2e-3" ixy="1e-5" ixz="0" iyy="3e-3" iyz="0" izz="2.5e-3"/></inertial></link>"""


def drawn(seed: int) -> tuple[str, dict[str, Mimic]]:
    """Draw a URDF of three to eight joints, of which some mimic one that comes before in the tree, or in the file, or after it."""
    rng = np.random.default_rng([44, seed])
    count = int(rng.integers(3, 9))
    kinds = [str(rng.choice(["revolute", "continuous", "prismatic"])) for _ in range(count)]
    links, joints, mimics = ['<link name="base"/>'], [], {}
    order = rng.permutation(count)  # a mimic follows one that is earlier in this order: there is no circle
    for k in range(count):
        parent = "base" if k == 0 else f"link{rng.integers(k)}" if rng.random() < 0.8 else "base"
        tie, place = "", int(np.flatnonzero(order == k)[0])
        if place and rng.random() < 0.6:
            leader = int(order[rng.integers(place)])
            mimic = Mimic(f"joint{leader}", float(np.round(rng.uniform(-3, 3), 3)), float(np.round(rng.uniform(-1, 1), 2)))
            words = [f'joint="{mimic.leader}"', f'multiplier="{mimic.multiplier}"', f'offset="{mimic.offset}"']
            if rng.random() < 0.3:
                words, mimic = words[:1], Mimic(mimic.leader, 1.0, 0.0)
            mimics[f"joint{k}"] = mimic
            tie = f"<mimic {' '.join(words)}/>"
        x, y, z = rng.uniform(-0.3, 0.3, 3)
        limit = '<limit lower="-1" upper="2" effort="9" velocity="9"/>'
        joints.append(
            f'<joint name="joint{k}" type="{kinds[k]}"><parent link="{parent}"/><child link="link{k}"/><origin xyz="{x} {y} {z}"/>'
            f'<axis xyz="0 {rng.choice(["0 1", "0.6 0.8", "1 0"])}"/>{limit}{tie}</joint>'
        )
        links.append(LINK.format(f"link{k}", x, rng.uniform(0.1, 2)))
    return f'<robot name="drawn">{"".join(links)}{"".join(joints)}</robot>', mimics


@pytest.mark.parametrize("engine", [name for name in ENGINES if name in ("pinocchio", "mujoco", "drake", "dart")])
def test_each_mimic_is_told_once(readers: Readers, engine: str) -> None:
    """Each mimic of the file has one note. Pinocchio drops all; MuJoCo holds the numbers of the file."""
    told = 0
    for seed in range(DRAWN):
        text, mimics = drawn(seed)
        notes = [note for note in readers.read(engine, f"drawn{seed}.urdf", text).header["notes"] if note["cause"].startswith("mimic")]
        assert sorted(note["about"] for note in notes) == sorted(mimics), (seed, notes)
        assert all(right(engine, note, mimics[note["about"]]) for note in notes), (seed, notes)
        told += len(notes)
    assert told > DRAWN


def right(engine: str, note: Header, mimic: Mimic) -> bool:
    """Whether a note says what the engine does."""
    match engine:
        case "pinocchio":
            return bool(note["cause"] == "mimic_dropped")
        case "mujoco":
            return bool(note["cause"] == "mimic" and note["numbers"] == [mimic.multiplier, mimic.offset])
        case _:
            return bool(note["cause"] == "mimic")


def test_the_reduced_dynamics_of_mujoco_is_that_of_the_file(tmp_path: Path) -> None:
    """On q = G(leaders), MuJoCo's own constraints are at rest: its residuals are zero, and their Jacobian times G is zero."""
    file = tmp_path / "drawn.urdf"
    tied = 0
    for seed in range(DRAWN):
        text, mimics = drawn(seed)
        file.write_text(text)
        assert dict(written(file)) == mimics
        model = mj.MjModel.from_xml_path(str(file))
        data = mj.MjData(model)
        rng = np.random.default_rng(seed)
        place = {model.joint(j).name: int(model.jnt_qposadr[j]) for j in range(model.njnt)}
        q = {name: float(rng.uniform(-0.5, 0.5)) for name in place if name not in mimics}
        rows = {name: np.eye(len(q))[k] for k, name in enumerate(q)}
        while len(q) < len(place):  # each pass sets at least the followers of those that are set: there is no circle
            for name, mimic in mimics.items():
                if mimic.leader in q:
                    q[name] = mimic.offset + mimic.multiplier * q[mimic.leader]
                    rows[name] = mimic.multiplier * rows[mimic.leader]
        jacobian = np.zeros((model.nv, len(rows) - len(mimics)))
        for name, at in place.items():
            data.qpos[at] = q[name]
            jacobian[at] = rows[name]
        model.opt.jacobian = mj.mjtJacobian.mjJAC_DENSE
        mj.mj_forward(model, data)
        equal = data.efc_type[: data.nefc] == mj.mjtConstraint.mjCNSTR_EQUALITY
        held = np.reshape(data.efc_J[: data.nefc * model.nv], (data.nefc, model.nv))[equal]
        # products of up to seven multipliers of 3 are 2187 at most: the residual is rounding of that size
        assert len(held) == len(mimics)
        assert np.abs(data.efc_pos[: data.nefc][equal]).max(initial=0) <= 1e-12
        assert np.abs(held @ jacobian).max(initial=0) <= 1e-12
        tied += len(mimics)
    assert tied > DRAWN
