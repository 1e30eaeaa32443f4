"""Drake's URDF reader gives a link of 0 kg that has a rotational inertia a mass of its own choice, with a warning only."""

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def deviation(seed: int) -> float:
    """The mass that the link then has, kg."""
    inertia = np.random.default_rng(seed).uniform(0.01, 0.02)
    text = f"""<robot name="r"><link name="base"/><link name="rod"><inertial><mass value="0"/>
        <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="hinge" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "urdf")
    plant.Finalize()
    return float(plant.GetBodyByName("rod").default_mass())
