"""Rods in MuJoCo: links with hinges that have springs, and a flex of edges. MuJoCo 4.0 has no cable plugin and no `<composite>`."""

from __future__ import annotations

import mujoco as mj
import numpy as np

from featherbench_oracles.abilities.inextensible import nodes, on_angles, straight_mass, straight_stiffness
from featherbench_oracles.abilities.rods import Rod, RodTable
from featherbench_oracles.core.algebra import Array


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


# The section of a flex: its radius over the rod's length enters by E alone.
RADIUS = 0.01
# An edge within the wall, over the length of the others: with it the first vertex is clamped, and its hinge has 2EI/h.
WALL = 1e-6


class FlexRod:
    """A flex of edges whose vertices have MuJoCo's bending forces, and masses of half the edges beside them.

    MuJoCo keeps the edges' length by constraints. Here the coordinates are the edges' angles, so that they keep it exactly.

    Parameters
    ----------
    rod : Rod
        The rod.
    """

    def __init__(self, rod: Rod) -> None:
        self.dofs, self.edge = rod.count, rod.length / rod.count
        young = rod.bending / (np.pi * (RADIUS * rod.length) ** 4 / 4)
        places = [-WALL * self.edge, *(self.edge * vertex for vertex in range(rod.count + 1))]
        points = " ".join(f"{place!r} 0 0" for place in places)
        edges = " ".join(f"{vertex} {vertex + 1}" for vertex in range(rod.count + 1))
        self.model = mj.MjModel.from_xml_string(
            f"""<mujoco><option gravity="0 0 0"/><worldbody>
            <flexcomp name="rod" type="direct" dim="1" point="{points}" element="{edges}" radius="{RADIUS * rod.length!r}"
              mass="{rod.mass_per_length * rod.length!r}">
            <contact selfcollide="none" contype="0" conaffinity="0"/><edge equality="false" stiffness="0"/>
            <elasticity young="{young!r}" poisson="0" thickness="{2 * RADIUS * rod.length!r}"/><pin id="0 1"/>
            </flexcomp></worldbody></mujoco>"""
        )
        self.masses = np.full(rod.count + 1, rod.mass_per_length * self.edge)
        self.masses[[0, -1]] *= 0.5
        bodies = self.model.flex_vertbodyid[2:]
        self.model.body_mass[bodies] = self.masses[1:]
        self.data = mj.MjData(self.model)
        mj.mj_setConst(self.model, self.data)
        # The slides of each free vertex along x, y and z.
        first = self.model.body_dofadr[bodies]
        self.slides, self.rest = np.stack([first, first + 1], axis=1), nodes(np.zeros(rod.count), self.edge)

    def _place(self, q: Array) -> None:
        """Set the configuration at rest."""
        self.data.qpos[self.slides] = (nodes(q, self.edge) - self.rest)[1:]
        self.data.qvel = 0.0
        mj.mj_fwdPosition(self.model, self.data)
        mj.mj_fwdVelocity(self.model, self.data)

    def imbalance(self, q: Array, force: float) -> Array:
        """Add what bending and a force along y at the tip leave."""
        self._place(q)
        forces = np.zeros((self.dofs + 1, 2))
        forces[1:] = (self.data.qfrc_passive - self.data.qfrc_bias)[self.slides]
        forces[-1, 1] += force
        return on_angles(q, self.edge, forces)

    def tip(self, q: Array) -> Array:
        """Read the tip's place."""
        self._place(q)
        return self.data.flexvert_xpos[-1, :2].copy()

    def mass(self) -> Array:
        """Read the vertices' masses."""
        return straight_mass(np.concatenate([self.masses[:1], self.model.body_mass[self.model.flex_vertbodyid[2:]]]), self.edge)

    def stiffness(self) -> Array:
        """Differentiate the bending forces."""
        return straight_stiffness(self)

    def accelerate(self, q: Array) -> None:
        """Compute qacc."""
        self._place(q)
        mj.mj_forward(self.model, self.data)


RODS: RodTable = {"hinge_chain": HingeChain, "flex_rod": FlexRod}
