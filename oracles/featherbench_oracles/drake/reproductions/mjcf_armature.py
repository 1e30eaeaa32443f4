"""Drake's MJCF reader drops the armature of a joint that no actuator drives."""

import mujoco
import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def deviation(seed: int) -> float:
    """|M of Drake - M of MuJoCo| over the armature, for one hinge."""
    armature = float(np.random.default_rng(seed).uniform(0.5, 1))
    text = f"""<mujoco model="r"><worldbody><body name="rod"><inertial pos="0 0 0.5" mass="1" diaginertia="1 1 1"/>
        <joint name="hinge" axis="0 1 0" armature="{armature}"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, mass)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "xml")
    plant.Finalize()
    found = plant.CalcMassMatrix(plant.CreateDefaultContext())
    return float(abs(found[0, 0] - mass[0, 0]) / armature)
