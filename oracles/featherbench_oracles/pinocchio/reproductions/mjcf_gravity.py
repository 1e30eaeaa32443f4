"""Pinocchio's MJCF reader ignores the file's gravity."""

import tempfile

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """|gravity held - gravity of the file| over the latter."""
    gravity = np.random.default_rng(seed).uniform(1, 5, 3)
    text = f"""<mujoco><option gravity="{gravity[0]} {gravity[1]} {gravity[2]}"/><worldbody><body name="rod">
        <inertial pos="0 0 0.5" mass="1" diaginertia="1 1 1"/><joint name="hinge" axis="0 1 0"/></body></worldbody></mujoco>"""
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(text)
        file.flush()
        model = pin.buildModelFromMJCF(file.name)
    return float(np.linalg.norm(model.gravity.linear - gravity) / np.linalg.norm(gravity))
