"""Measures of residuals, and their tolerances. A residual has no unit.

::

    quantity       scaled by
    M              its diagonal
    force          the sum of the magnitudes of its terms
    acceleration   the norm of M
    all other      the largest number of its kind in that state (the robots are about a metre long)
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks
from featherbench_oracles.core.robot import Description


def tolerance_scale(text: str) -> float:
    """Read the factor on every tolerance. At 0 each residual but zero fails.

    Parameters
    ----------
    text : str
        A number.

    Returns
    -------
    float
        The factor.

    Raises
    ------
    ValueError
        If it is not a finite number or less than 0: that would turn a comparison off.
    """
    try:
        scale = float(text)
    except ValueError:
        scale = math.nan
    if not (math.isfinite(scale) and scale >= 0):
        raise ValueError(f"FEATHERBENCH_TOL_SCALE is '{text}': it must be a finite number, 0 or more")
    return scale


TOLERANCE_SCALE = tolerance_scale(os.environ.get("FEATHERBENCH_TOL_SCALE", "1"))


def within(tolerance: float) -> float:
    """Scale a tolerance by FEATHERBENCH_TOL_SCALE."""
    return tolerance * TOLERANCE_SCALE


EXACT = within(2e-13)  # for algorithms that lose a few digits in sums
INVERSE = within(1e-9)  # for id after fd, where an explicit inverse loses the condition number of M
DIFFERENCE = within(1e-8)  # for differences of fourth order


def ratio(difference: Array, scale: Array | float = 1.0) -> float:
    """Compute max |difference| / max |scale|; if the difference is 0, the result is 0 for any scale.

    Parameters
    ----------
    difference : ndarray
        Of any shape.
    scale : ndarray or float
        Of any shape, in the unit of the difference.

    Returns
    -------
    float
        Without unit.
    """
    top = np.abs(difference).max()
    return 0.0 if top == 0 else float(top / np.abs(scale).max())


def residual(quantity: str, x: Array, y: Array, reference: Reference) -> float:
    """Measure the worst difference of x from y over the states.

    Parameters
    ----------
    quantity : str
        The quantity.
    x : ndarray, shape (states, *shape of the quantity)
        One answer.
    y : ndarray, shape (states, *shape of the quantity)
        The other.
    reference : Reference
        The scales.

    Returns
    -------
    float
        Without unit.
    """
    worst = []
    for k, (xk, yk) in enumerate(zip(x, y, strict=True)):
        m, force = reference.mass[k], reference.force[k]
        d = np.sqrt(np.diag(m))
        if quantity == "mass_matrix":
            worst.append(ratio((xk - yk) / np.outer(d, d)))
        elif quantity == "mass_matrix_probe":
            worst.append(np.max([ratio((xk - yk)[i] / d, yk[i] / d) for i in range(6)]))  # max() would lose a NaN
        elif quantity in ("id", "id_wrench", "bias"):
            worst.append(ratio((xk - yk) / force))
        elif quantity == "fd":
            condition = np.linalg.cond(m / np.outer(d, d))  # |force / d| is what a must be found from
            error, size = np.sqrt([(xk - yk) @ m @ (xk - yk), yk @ m @ yk])
            worst.append(error / (size + np.linalg.norm(force / d)) / condition)
        elif quantity == "body_placement":
            worst.append(ratio((xk - yk)[:, :9]) + ratio((xk - yk)[:, 9:], yk[:, 9:]))
        else:
            scale = {"potential_energy": y, "body_acceleration": reference.acceleration[k]}.get(quantity, yk)
            worst.append(ratio(xk - yk, scale))
    return float(np.max(worst))


@dataclass(frozen=True)
class Reference:
    """The scales of residuals at each state: M, and for other quantities the sum of the magnitudes of their terms.

    `id` is inverse dynamics by Newton's and Euler's equations for every body, with one oracle's kinematics:
    tau = Σ J' (I α + ω × I ω + c × m (a_c - g); m (a_c - g)) + armature a.
    """

    mass: Array
    id: Array
    force: Array
    acceleration: Array

    @classmethod
    def make(cls, robot: Description, states: Blocks, x: Blocks, jacobians: Array) -> Reference:
        """Make the reference from one oracle's values.

        Parameters
        ----------
        robot : Description
            The robot.
        states : dict of str to ndarray
            As of `draws.random_states`.
        x : dict of str to ndarray
            The values by quantity.
        jacobians : ndarray, shape (bodies, states, 6, nv)
            Of each body.

        Returns
        -------
        Reference
            The reference.
        """
        acceleration = np.abs(x["body_acceleration"]).max(axis=(1, 2)) + (x["body_velocity"] ** 2).max(axis=(1, 2))
        tau = np.concatenate([body.joint.armature for body in robot.bodies]) * states["a"]
        force = np.abs(tau) + np.abs(np.einsum("kij,kj->ki", x["mass_matrix"], states["a"]))
        for k, b in np.ndindex(len(tau), len(robot.bodies)):
            body, r = robot.bodies[b], x["body_placement"][k, b, :9].reshape(3, 3)
            inertia, c = r @ body.inertia @ r.T, r @ body.com
            (omega, v), (alpha, a) = (x[name][k, b].reshape(2, 3) for name in ("body_velocity", "body_acceleration"))
            push = body.mass * (a + np.cross(alpha, c) + np.cross(omega, np.cross(omega, c)) - robot.gravity)
            moments = inertia @ alpha, np.cross(omega, inertia @ omega), np.cross(c, push)
            tau[k] += jacobians[b, k].T @ np.append(sum(moments), push)
            spatial = body.mass * np.linalg.norm(omega) * np.linalg.norm(v)  # m ω × v, a term that cancels in spatial algorithms
            wrench = np.linalg.norm(states["wrench"][k, b].reshape(2, 3), axis=1)
            # Rounding of a product of vectors is relative to the product of their lengths, also if it cancels, as for parallel vectors.
            gyroscopic = np.linalg.norm(omega) * np.linalg.norm(inertia @ omega)
            thrust = np.linalg.norm(push) + body.mass * acceleration[k]
            sizes = wrench + spatial + [np.linalg.norm(moments[0]) + gyroscopic + np.linalg.norm(c) * thrust, thrust]
            force[k] += np.abs(jacobians[b, k].T) @ np.repeat(sizes, 3)
        return cls(x["mass_matrix"], tau, force, acceleration)
