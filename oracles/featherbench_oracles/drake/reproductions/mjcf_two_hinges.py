"""Drake's MJCF reader on a body with two hinges and a pose: the body stands where MuJoCo does not put it."""

import mujoco
import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant


def deviation(seed: int) -> float:
    """Distance of the body's origin from where MuJoCo has it with both hinges at 1 rad, over the pose's length."""
    x, y, z = (float(value) for value in np.random.default_rng(seed).uniform(0.5, 1, 3))
    text = f"""<mujoco model="r"><worldbody><body name="rod" pos="{x} {y} {z}"><inertial pos="0 0 0.5" mass="1" diaginertia="1 1 1"/>
        <joint name="first" axis="1 0 0"/><joint name="second" axis="0 1 0"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos = [1, 1]
    mujoco.mj_kinematics(model, data)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "xml")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    for name in ("first", "second"):
        plant.GetJointByName(name).set_angle(context, 1.0)
    found = plant.EvalBodyPoseInWorld(context, plant.GetBodyByName("rod")).translation()
    return float(np.linalg.norm(found - data.body("rod").xpos) / np.linalg.norm([x, y, z]))
