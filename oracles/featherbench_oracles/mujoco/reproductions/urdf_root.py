"""MuJoCo's URDF reader welds the root link to the world: its mass takes no part, floating robots stand fixed."""

import mujoco
import numpy as np


def deviation(seed: int) -> float:
    """The share of the file's mass that belongs to no moving body, the root being a third of it or more."""
    root, rod = np.random.default_rng(seed).uniform(2, 3), np.random.default_rng(seed + 1).uniform(1, 2)
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    text = f"""<robot name="r"><link name="base"><inertial><mass value="{root}"/>{inertia}</inertial></link>
        <link name="rod"><inertial><mass value="{rod}"/>{inertia}</inertial></link>
        <joint name="hinge" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""
    model = mujoco.MjModel.from_xml_string(text)
    return float(1 - model.body_mass[1:].sum() / (root + rod))
