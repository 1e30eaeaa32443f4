"""A rod in MuJoCo: rigid links with hinges whose joints have springs. MuJoCo 4.0 has no cable plugin and no `<composite>`."""

from __future__ import annotations

import mujoco as mj
import numpy as np

from featherbench_oracles.algebra import Array
from featherbench_oracles.rods import Rod, RodTable


class HingeChain:
    """Rigid links with a hinge in the middle of each element, whose spring is EI/h.

    Parameters
    ----------
    rod : Rod
        The rod.
    """

    def __init__(self, rod: Rod) -> None:
        self.dofs, h = rod.count, rod.length / rod.count
        spec = mj.MjSpec()
        spec.option.gravity = np.zeros(3)
        spec.compiler.autolimits = False
        body = spec.worldbody
        for link in range(rod.count):
            long = 0.5 * h if link + 1 == rod.count else h
            mass = rod.mass_per_length * long
            thin = mass * long**2 / 12
            body = body.add_body(name=f"link{link}", pos=[h if link else 0.5 * h, 0, 0])
            # The moment about the rod is at rest: MuJoCo asks for one that is not zero.
            body.mass, body.ipos, body.inertia, body.explicitinertial = mass, [0.5 * long, 0, 0], [1e-3 * thin, thin, thin], True
            joint = body.add_joint(name=f"hinge{link}", type=mj.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
            joint.stiffness = [rod.bending / h, 0, 0] if np.size(joint.stiffness) > 1 else rod.bending / h
        body.add_site(name="tip", pos=[0.5 * h, 0, 0])
        self.model = spec.compile()
        self.data = mj.MjData(self.model)
        self.last = self.model.nbody - 1

    def _place(self, q: Array) -> None:
        """Set the configuration at rest."""
        self.data.qpos, self.data.qvel = q, 0.0
        mj.mj_fwdPosition(self.model, self.data)
        mj.mj_fwdVelocity(self.model, self.data)

    def imbalance(self, q: Array, force: float) -> Array:
        """Add what the springs and a force along y at the tip leave."""
        self._place(q)
        applied = np.zeros(self.model.nv)
        mj.mj_applyFT(self.model, self.data, np.array([0, force, 0.0]), np.zeros(3), self.data.site_xpos[0], self.last, applied)
        return applied + self.data.qfrc_passive - self.data.qfrc_bias

    def tip(self, q: Array) -> Array:
        """Read the tip's place."""
        self._place(q)
        return self.data.site_xpos[0, :2].copy()

    def mass(self) -> Array:
        """Read M."""
        self._place(np.zeros(self.dofs))
        dense = np.zeros((self.model.nv, self.model.nv))
        mj.mj_fullM(self.model, self.data, dense)
        return dense

    def stiffness(self) -> Array:
        """Read the springs."""
        return np.diag(np.reshape(self.model.jnt_stiffness, (self.dofs, -1))[:, 0])

    def accelerate(self, q: Array) -> None:
        """Compute qacc."""
        self.data.qpos = q
        mj.mj_forward(self.model, self.data)


RODS: RodTable = {"hinge_chain": HingeChain}
