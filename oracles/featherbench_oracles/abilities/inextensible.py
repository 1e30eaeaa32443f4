"""Rods of nodes that do not stretch: the plane's coordinates are the angles of edges, and nodal forces act on them by virtual work."""

from __future__ import annotations

import numpy as np

from featherbench_oracles.abilities.rods import RodModel
from featherbench_oracles.core.algebra import Array

# The step of the stiffness by central differences. Forces are odd in the angles: an error of 1e-10, and roundings of 1e-11.
STEP = 1e-5


def nodes(angles: Array, edge: float) -> Array:
    """Place the nodes.

    Parameters
    ----------
    angles : ndarray
        The angles of the edges to x, of shape (n,), rad.
    edge : float
        The length of each, m.

    Returns
    -------
    ndarray
        x and y of the nodes, of shape (n + 1, 2); the first is the origin.
    """
    steps = edge * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


def on_angles(angles: Array, edge: float, forces: Array) -> Array:
    """Compute the generalized forces of nodal forces: an angle turns all that is beyond it.

    Parameters
    ----------
    angles : ndarray
        The angles of the edges, of shape (n,), rad.
    edge : float
        The length of each, m.
    forces : ndarray
        x and y of the nodes' forces, of shape (n + 1, 2), N.

    Returns
    -------
    ndarray
        The moments, of shape (n,), N m.
    """
    beyond = np.cumsum(forces[:0:-1], axis=0)[::-1]
    return edge * (np.cos(angles) * beyond[:, 1] - np.sin(angles) * beyond[:, 0])


def straight_mass(masses: Array, edge: float) -> Array:
    """Compute the mass matrix of the straight rod.

    Parameters
    ----------
    masses : ndarray
        The masses of the nodes, of shape (n + 1,), kg.
    edge : float
        The length of the edges, m.

    Returns
    -------
    ndarray
        M of the angles, of shape (n, n), kg m^2.
    """
    beyond = np.cumsum(masses[:0:-1])[::-1]
    count = np.arange(len(beyond))
    return edge**2 * beyond[np.maximum.outer(count, count)]


def straight_stiffness(model: RodModel) -> Array:
    """Differentiate the engine's elastic forces where the rod is straight.

    Parameters
    ----------
    model : RodModel
        The rod in the engine.

    Returns
    -------
    ndarray
        K, symmetric, N m.
    """
    columns = []
    for step in STEP * np.eye(model.dofs):
        columns.append((model.imbalance(-step, 0.0) - model.imbalance(step, 0.0)) / (2 * STEP))
    stiffness = np.array(columns)
    return 0.5 * (stiffness + stiffness.T)
