"""JaxSim as an oracle: hinges and slides, on a fixed base or on one that floats.

In JaxSim's body representation the velocities of a floating base are ours: [linear; angular] in its axes. JaxSim's gravity is along z. So
the robot stands in a world that is turned by `upright` until gravity is, and what is told in axes of the world is turned back.
"""

from __future__ import annotations

import importlib.metadata
from typing import Any

import jax
import jax.numpy as jnp
import jaxsim.api as js
import numpy as np
from jaxsim import VelRepr
from jaxsim.math import Inertia
from jaxsim.parsers.descriptions import JointDescription, JointType, LinkDescription, ModelDescription

from featherbench_oracles.core.algebra import Array, quaternion, rotation, skew
from featherbench_oracles.core.protocol import Quantities, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description

KINDS = {"revolute": JointType.Revolute, "prismatic": JointType.Prismatic}


class JaxSimRobot:
    """A robot in JaxSim. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    JaxSim numbers links breadth first, and joints as their links. Its six-vectors are [linear; angular].

    Parameters
    ----------
    robot : Description
        The robot.
    """

    def __init__(self, robot: Description) -> None:
        self.robot = robot
        self.floats = bool(robot.bodies) and robot.bodies[0].joint.type == "free"
        self.upright = upright(robot.gravity)
        base = LinkDescription(name="world", mass=0.0, inertia=np.zeros((6, 6)))
        links = [] if self.floats else [base]
        joints = []
        for k, body in enumerate(robot.bodies):
            joint = body.joint
            if joint.armature.any():
                raise Unsupported(f"the oracle has no armature for JaxSim (joint {joint.name})")
            link = LinkDescription(name=f"link{k}", mass=body.mass, inertia=np.array(Inertia.to_sixd(body.mass, body.com, body.inertia)))
            links.append(link)
            if self.floats and k == 0:
                continue
            if joint.type not in KINDS:
                raise Unsupported(f"JaxSim has hinges and slides, and one floating base: joint {joint.name} is {joint.type}")
            if self.floats and body.parent < 0:
                raise Unsupported(f"JaxSim has one base, and body {body.name} is on the world")
            parent = links[body.parent + (0 if self.floats else 1)]
            place = frame(joint.rotation, joint.translation)
            joints.append(JointDescription(f"joint{k}", axis=joint.axis, pose=place, jtype=KINDS[joint.type], parent=parent, child=link))
        described = ModelDescription.build_model_from("robot", links, joints, fixed_base=not self.floats, base_link_name=links[0].name)
        self.model = js.model.JaxSimModel.build(described, gravity=-float(np.linalg.norm(robot.gravity)))
        first = 1 if self.floats else 0
        names = self.model.joint_names()
        self.joints = np.array([names.index(f"joint{k}") for k in range(first, len(robot.bodies))], dtype=np.intp)
        self.links = [self.model.link_names().index(f"link{k}") for k in range(len(robot.bodies))]
        base_rows = np.arange(6) if self.floats else np.zeros(0, dtype=np.intp)
        self.own = np.append(base_rows, 6 + self.joints)  # where our velocities are among its own
        self.held: tuple[Any, Any] = (None, None)
        self.made = jax.jit(lambda given: js.data.JaxSimModelData.build(self.model, velocity_representation=VelRepr.Body, **given))

    def readback(self) -> list[Array]:
        """Read back each link's inertia, and each joint's frame on its parent."""
        rows = []
        parameters = self.model.kin_dyn_parameters
        for k, body in enumerate(self.robot.bodies):
            six = np.array(js.link.spatial_inertia(self.model, link_index=self.links[k]))
            mass = six[0, 0]
            com = np.array([six[5, 1], six[3, 2], six[4, 0]]) / mass if mass else body.com
            inertia = six[3:, 3:] + mass * skew(com) @ skew(com)
            place = frame(body.joint.rotation, body.joint.translation)
            if not (self.floats and k == 0):
                place = np.array(parameters.joint_model.λ_H_pre[self.links[k]])
            rows.append(readback_row(mass, com, inertia, place[:3, :3], place[:3, 3]))
        return rows

    # ---- the state

    def _data(self, ask: State) -> Any:
        """Make JaxSim's data of q and v; several questions about one state share it."""
        if self.held[0] is not ask:
            given: dict[str, Any] = {"joint_positions": self._joints(ask.q, 7), "joint_velocities": self._joints(ask.v, 6)}
            turn, origin = np.eye(3), np.zeros(3)
            if self.floats:
                joint = self.robot.bodies[0].joint
                turn, origin = joint.rotation @ rotation(ask.q[3:7]), joint.translation + joint.rotation @ ask.q[:3]
                given |= {"base_linear_velocity": ask.v[:3], "base_angular_velocity": ask.v[3:6]}
            given |= {"base_position": self.upright @ origin, "base_quaternion": np.roll(quaternion(self.upright @ turn), 1)}
            self.held = ask, self.made({name: jnp.array(value) for name, value in given.items()})
        return self.held[1]

    def _joints(self, whole: Array, base: int) -> Array:
        """Put numbers of our joints, after those of a floating base, in JaxSim's order."""
        ours = np.zeros(len(self.joints))
        ours[self.joints] = whole[base:] if self.floats else whole
        return ours

    def _base(self, ours: Array) -> Array:
        return ours[:6] if self.floats else np.zeros(6)

    def _back(self, pair: Any) -> Array:
        """Put what it tells of the base and of joints in our order."""
        return np.append(np.array(pair[0]).ravel(), np.array(pair[1]).ravel())[self.own]

    def _in_world(self, linear_first: Array) -> Array:
        """Turn a six-vector in axes of its world, or a matrix of them, to ours: [angular; linear]."""
        return np.concatenate([self.upright.T @ linear_first[3:], self.upright.T @ linear_first[:3]])

    # ---- dynamics

    def inverse(self, ask: State) -> Array:
        """Answer `id` by inverse_dynamics."""
        return self._inverse(ask, ask.a, None)

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by inverse_dynamics with forces of links in their own axes."""
        forces = np.zeros((self.model.number_of_links(), 6))
        for k, wrench in enumerate(ask.wrench):
            forces[self.links[k]] = np.roll(wrench, 3)
        return self._inverse(ask, ask.a, jnp.array(forces))

    def bias(self, ask: State) -> Array:
        """Answer `bias` by free_floating_bias_forces."""
        return np.array(js.model.free_floating_bias_forces(self.model, self._data(ask)))[self.own]

    def _inverse(self, ask: State, a: Array, forces: Any) -> Array:
        joints, base = jnp.array(self._joints(a, 6)), jnp.array(self._base(a))
        given = {"joint_accelerations": joints, "base_acceleration": base, "link_forces": forces}
        return self._back(js.model.inverse_dynamics(self.model, self._data(ask), **given))

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by free_floating_mass_matrix."""
        return np.array(js.model.free_floating_mass_matrix(self.model, self._data(ask)))[np.ix_(self.own, self.own)]

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def aba(self, ask: State) -> Array:
        """Answer `fd` by forward_dynamics_aba."""
        return self._forward(ask, js.model.forward_dynamics_aba)

    def by_mass_matrix(self, ask: State) -> Array:
        """Answer `fd` by forward_dynamics_crb."""
        return self._forward(ask, js.model.forward_dynamics_crb)

    def _forward(self, ask: State, method: Any) -> Array:
        forces = None
        if self.floats:  # it has no force of the base but that of links
            forces = np.zeros((self.model.number_of_links(), 6))
            forces[self.links[0]] = ask.tau[:6]
        return self._back(method(self.model, self._data(ask), joint_forces=jnp.array(self._joints(ask.tau, 6)), link_forces=forces))

    # ---- energy, momentum, kinematics

    def kinetic(self, ask: State) -> float:
        """Answer `kinetic_energy` by kinetic_energy."""
        self._needs_masses()
        return float(js.model.kinetic_energy(self.model, self._data(ask)))

    def _needs_masses(self) -> None:
        if not self.floats or not all(body.mass for body in self.robot.bodies):
            raise Unsupported("JaxSim's energy, momentum and centre of mass are no numbers where a link, as a fixed base, has no mass")

    def com(self, ask: State) -> Array:
        """Answer `com` by com_position."""
        self._needs_masses()
        return self.upright.T @ np.array(js.com.com_position(self.model, self._data(ask)))

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by centroidal_momentum in the mixed representation."""
        self._needs_masses()
        data = self._data(ask)
        with data.switch_velocity_representation(VelRepr.Mixed):
            return self._in_world(np.array(js.com.centroidal_momentum(self.model, data)))

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by the transforms of its forward kinematics."""
        frames = np.array(self._data(ask)._link_transforms)[self.links]  # link.transform compiles for each link
        return [np.append((self.upright.T @ at[:3, :3]).ravel(), self.upright.T @ at[:3, 3]) for at in frames]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by link.velocity in the mixed representation."""
        data = self._data(ask)
        moves = [js.link.velocity(self.model, data, link_index=link, output_vel_repr=VelRepr.Mixed) for link in self.links]
        return [self._in_world(np.array(move)) for move in moves]

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by link.jacobian from the body to the mixed representation."""
        link = self.links[ask.body]
        found = js.link.jacobian(self.model, self._data(ask), link_index=link, output_vel_repr=VelRepr.Mixed)
        return self._in_world(np.array(found)[:, self.own])


def frame(turn: Array, origin: Array) -> Array:
    """Make a homogeneous matrix of a rotation and an origin."""
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = turn, origin
    return made


def upright(gravity: Array) -> Array:
    """Make a rotation that takes gravity to −z; none if there is no gravity, or if it is along −z."""
    size = np.linalg.norm(gravity)
    if size == 0.0 or not gravity[:2].any() and gravity[2] < 0.0:
        return np.eye(3)
    down = gravity / size
    middle = down - np.array([0.0, 0.0, 1.0])
    if middle @ middle < 1e-2:  # nearly along +z: first half a turn about x
        half = np.diag([1.0, -1.0, -1.0])
        return upright(half @ gravity) @ half
    about_bisector: Array = 2.0 * np.outer(middle, middle) / (middle @ middle) - np.eye(3)
    return about_bisector


class JaxSim:
    """The engine JaxSim, for `session.serve`."""

    name = "jaxsim"
    version = importlib.metadata.version("jaxsim")
    build = {"language": "Python (JAX)", "jax": importlib.metadata.version("jax")}
    quantities: Quantities = {
        "id": {"inverse_dynamics": JaxSimRobot.inverse},
        "id_wrench": {"inverse_dynamics": JaxSimRobot.inverse_wrench},
        "bias": {"free_floating_bias_forces": JaxSimRobot.bias},
        "mass_matrix": {"free_floating_mass_matrix": JaxSimRobot.mass_matrix},
        "mass_matrix_sparse": {"free_floating_mass_matrix": JaxSimRobot.mass_matrix},
        "mass_matrix_probe": {"free_floating_mass_matrix": JaxSimRobot.probe},
        "fd": {"forward_dynamics_aba": JaxSimRobot.aba, "forward_dynamics_crb": JaxSimRobot.by_mass_matrix},
        "kinetic_energy": {"kinetic_energy": JaxSimRobot.kinetic},
        "com": {"com_position": JaxSimRobot.com},
        "momentum": {"centroidal_momentum": JaxSimRobot.momentum},
        "body_placement": {"forward_kinematics": JaxSimRobot.placement},
        "body_velocity": {"link_velocity": JaxSimRobot.velocity},
        "body_jacobian": {"link_jacobian": JaxSimRobot.jacobian},
    }

    def prepare(self, description: Description) -> JaxSimRobot:
        """Build the robot, and forget the code that was compiled for the one before."""
        jax.clear_caches()
        return JaxSimRobot(description)
