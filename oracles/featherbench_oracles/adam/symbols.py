"""adam's expressions of the quantities of a robot. Each is made of calls of adam's interface, at symbols of CasADi."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as cs
import numpy as np
from adam import Representations
from adam.casadi import KinDynComputations

from featherbench_oracles.adam import urdf
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description

BASE = 6  # velocities of the base, which stand before those of the joints


@dataclass(frozen=True)
class Robot:
    """A robot in adam, and the symbols of its state.

    ::

        input     symbol  shape        unit             meaning
        base      h       (4, 4)       -, m             H of `coordinates`
        position  s       (joints,)    rad              angles of the joints
        velocity  v       (nv,)        m/s or rad/s     of the base, if it floats, and of the joints
        force     tau     (nv,)        N or N m         dual to `velocity`

    Attributes
    ----------
    floats : bool
        Whether the base floats.
    model : KinDynComputations
        adam's interface to the robot.
    inputs : dict of str to cs.SX
        The symbols. Without a floating base there is no `base`.
    h, s, v_base, v_joints, tau_base, tau_joints : cs.SX
        What adam's interface takes. Those of a base that does not float are numbers.
    """

    floats: bool
    model: KinDynComputations
    inputs: dict[str, cs.SX]
    h: cs.SX
    s: cs.SX
    v_base: cs.SX
    v_joints: cs.SX
    tau_base: cs.SX
    tau_joints: cs.SX

    @classmethod
    def of(cls, robot: Description) -> Robot:
        """Read a robot, as URDF.

        Parameters
        ----------
        robot : Description
            The robot.

        Returns
        -------
        Robot
            The robot, with symbols.

        Raises
        ------
        Unsupported
            If adam cannot hold it.
        """
        floats = urdf.floats(robot)
        names = [urdf.joint(k) for k in range(len(robot.bodies)) if k > 0 or not floats]
        if not names:
            raise Unsupported("adam's algorithms fail on a robot without joints")
        model = KinDynComputations(urdf.text(robot), names, gravity=np.append(robot.gravity, np.zeros(3)))
        model.set_frame_velocity_representation(Representations.BODY_FIXED_REPRESENTATION)
        s, v, tau = cs.SX.sym("s", len(names)), cs.SX.sym("v", robot.nv), cs.SX.sym("tau", robot.nv)
        inputs = {"position": s, "velocity": v, "force": tau}
        if not floats:
            return cls(floats, model, inputs, cs.SX.eye(4), s, cs.SX.zeros(BASE), v, cs.SX.zeros(BASE), tau)
        h = cs.SX.sym("h", 4, 4)
        return cls(floats, model, {"base": h, **inputs}, h, s, v[:BASE], v[BASE:], tau[:BASE], tau[BASE:])

    def moving(self, rows: cs.SX) -> cs.SX:
        """Take the rows that belong to the robot's velocities: without those of a base that does not float."""
        return rows if self.floats else rows[BASE:, :]

    def bias(self) -> cs.SX:
        """Make h, shape (nv, 1), by `bias_force`: adam's recursive Newton-Euler algorithm without accelerations."""
        return self.moving(self.model.bias_force(self.h, self.s, self.v_base, self.v_joints))

    def mass(self) -> cs.SX:
        """Make M, shape (nv, nv), by `mass_matrix`: adam's composite rigid body algorithm."""
        return self.moving(self.moving(self.model.mass_matrix(self.h, self.s)).T)

    def aba(self) -> cs.SX:
        """Make the accelerations, shape (nv, 1), by `aba`. The base's force is an external wrench on the root, in its axes.

        Raises
        ------
        Unsupported
            If the base does not float: adam's algorithm has the base's acceleration among its unknowns.
        """
        if not self.floats:
            raise Unsupported("adam's articulated body algorithm is that of a floating base")
        root = {self.model.rbdalgos.root_link: self.tau_base}
        return self.model.aba(self.h, self.s, self.v_base, self.v_joints, self.tau_joints, root)

    def crba_ldl(self) -> cs.SX:
        """Make the accelerations, shape (nv, 1), of M a = tau - h by CasADi's sparse factors L D L' of adam's M."""
        mass, rest = self.mass(), cs.vertcat(self.tau_base, self.tau_joints) if self.floats else self.tau_joints
        # Factors of symbols: those of the expressions themselves take CasADi minutes to simplify.
        m, f = cs.SX.sym("m", mass.sparsity()), cs.SX.sym("f", mass.shape[0])
        solve = cs.Function("solve", [m, f], [cs.ldl_solve(f, *cs.ldl(m))])
        return solve(mass, rest - self.bias())

    def com(self) -> cs.SX:
        """Make the centre of mass, shape (3, 1), by `CoM_position`."""
        return self.model.CoM_position(self.h, self.s)

    def momentum(self) -> cs.SX:
        """Make the momentum, shape (6, 1), by `centroidal_momentum_matrix`: [linear; angular] about the centre of mass, in base axes."""
        matrix = self.model.centroidal_momentum_matrix(self.h, self.s)
        return cs.mtimes(matrix, cs.vertcat(self.v_base, self.v_joints))

    def placement(self) -> cs.SX:
        """Make the frames of all bodies, shape (4, 4 bodies), by `forward_kinematics`."""
        frames = [self.model.forward_kinematics(name, self.h, self.s) for name in self.links()]
        return cs.horzcat(*frames)

    def jacobian(self, body: int) -> cs.SX:
        """Make the Jacobian of a body, shape (6, nv), by `jacobian`: [linear; angular] of its origin, in the body's axes.

        Raises
        ------
        Unsupported
            If the robot has two joints: adam 0.5.0 takes two columns for halves of one vector, and puts one below the other.
        """
        if self.s.numel() == 2:
            raise Unsupported("adam's Jacobian fails on a robot of two joints")
        return self.moving(self.model.jacobian(self.links()[body], self.h, self.s).T).T

    def links(self) -> list[str]:
        """Name the links of the bodies, in their order."""
        joints = len(self.model.rbdalgos.model.actuated_joints)
        return [urdf.link(k) for k in range(joints + self.floats)]


Expression = Callable[[Robot], cs.SX]
