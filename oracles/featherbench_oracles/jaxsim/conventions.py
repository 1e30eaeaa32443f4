"""The conventions of JaxSim. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import jaxsim.api as js
import numpy as np
from jaxsim import VelRepr
from jaxsim.math import Inertia
from jaxsim.parsers.descriptions import JointDescription, JointType, LinkDescription, ModelDescription

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import AXIS, COM, MASS, MOMENTS, WRONG_R, WXYZ, Claims, P, R, V, W, about, claim

SIX = np.array(Inertia.to_sixd(MASS, COM, MOMENTS))
TURN, WEIGHT = about(AXIS, 0.8), 3.7


def floating(representation: VelRepr) -> tuple[Any, Any]:
    """Make a body that floats, at a state given in a representation."""
    link = LinkDescription(name="body", mass=MASS, inertia=SIX)
    described = ModelDescription.build_model_from("one", [link], [], fixed_base=False, base_link_name="body")
    model = js.model.JaxSimModel.build(described, gravity=-WEIGHT)
    given = {"base_position": P, "base_quaternion": WXYZ / np.linalg.norm(WXYZ), "base_linear_velocity": V, "base_angular_velocity": W}
    return model, js.data.JaxSimModelData.build(model, velocity_representation=representation, **given)


def slide(**gravity: float) -> float:
    """Make a body on a slide along the z axis of a turned joint, and find what holds it."""
    base = LinkDescription(name="base", mass=0.0, inertia=np.zeros((6, 6)))
    link = LinkDescription(name="body", mass=MASS, inertia=SIX)
    pose = np.eye(4)
    pose[:3, :3] = TURN
    joint = JointDescription("joint", axis=np.array([0.0, 0.0, 1.0]), pose=pose, jtype=JointType.Prismatic, parent=base, child=link)
    described = ModelDescription.build_model_from("one", [base, link], [joint], fixed_base=True, base_link_name="base")
    model = js.model.JaxSimModel.build(described, **gravity)
    data = js.data.JaxSimModelData.build(model)
    return float(js.model.free_floating_bias_forces(model, data)[6])


def _in_world(representation: VelRepr) -> Array:
    model, data = floating(representation)
    return np.array(js.link.velocity(model, data, link_index=0, output_vel_repr=VelRepr.Mixed))


def jaxsim_free_q() -> Claims:
    """Origin, and quaternion (w, x, y, z)."""
    _, data = floating(VelRepr.Body)
    yield claim(data._link_transforms[0][:3, :3], R, WRONG_R)
    yield claim(data._link_transforms[0][:3, 3], P, R.T @ P)


def jaxsim_body_v() -> Claims:
    """The body representation is [linear; angular] in the base's axes."""
    yield claim(_in_world(VelRepr.Body), np.append(R @ V, R @ W), np.append(V, W), np.append(R @ W, R @ V))


def jaxsim_mixed_v() -> Claims:
    """The mixed representation, the default, is [linear; angular] of the base's origin in the axes of the world."""
    yield claim(_in_world(VelRepr.Mixed), np.append(V, W), np.append(R @ V, R @ W), np.append(W, V))


def jaxsim_inertial_v() -> Claims:
    """The inertial representation has the velocity of the point of the body at the world's origin."""
    yield claim(_in_world(VelRepr.Inertial), np.append(V + np.cross(W, P), W), np.append(V, W))


def jaxsim_axis() -> Claims:
    """In the joint's frame, whose matrix takes its axes to the parent's."""
    yield claim([slide(gravity=-WEIGHT)], [MASS * WEIGHT * TURN[2, 2]], [MASS * WEIGHT])


def jaxsim_gravity() -> Claims:
    """`JaxSimModel.build` takes the acceleration along z with its sign, and its default lifts the robot."""
    yield claim([slide(gravity=-WEIGHT)], [MASS * WEIGHT * TURN[2, 2]], [-MASS * WEIGHT * TURN[2, 2]])
    yield claim([slide() / (MASS * TURN[2, 2])], [-9.81], [9.81], close=1e-2 / 2)


def jaxsim_inertia() -> Claims:
    """A link's six by six matrix is about its origin, linear first."""
    model, data = floating(VelRepr.Body)
    mass = np.array(js.model.free_floating_mass_matrix(model, data))
    about_origin = SIX[3:, 3:]
    yield claim(mass[3:6, 3:6], about_origin, MOMENTS)
    yield claim(mass[:3, :3], MASS * np.eye(3), about_origin)


def jaxsim_precision() -> Claims:
    """Importing it makes JAX compute in double precision, in the whole process."""
    yield claim([jnp.array(0.1).dtype.itemsize], [8], [4])
