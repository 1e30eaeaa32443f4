"""Pinocchio's rate in a loop over uncertain masses: `python -m featherbench_oracles.pinocchio.samples ROBOT.urdf [SAMPLES]`.

Each sample draws every mass uniformly within 20 % of its value, writes it into the model and asks `pin.aba` at one state. This is how a
user of Pinocchio samples; `featherbench uncertainty ROBOT.urdf --method random` is its counterpart. The time includes the loop in Python.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import pinocchio as pin

from featherbench_oracles.core.algebra import Array

SPREAD = 0.2


def accelerations(model: pin.Model, samples: int, seed: int) -> tuple[Array, float]:
    """Ask for the accelerations of sampled masses, at the zero state.

    Parameters
    ----------
    model : pin.Model
        The robot. Its masses are restored.
    samples : int
        The number of samples.
    seed : int
        The seed of the draws.

    Returns
    -------
    found : ndarray, shape (samples, nv)
        The accelerations, rad/s² or m/s².
    seconds : float
        The time of all calls, in s, the draws left out.
    """
    data = model.createData()
    q, zero = pin.neutral(model), np.zeros(model.nv)
    nominal = [inertia.mass for inertia in model.inertias]
    factors = np.random.default_rng(seed).uniform(1.0 - SPREAD, 1.0 + SPREAD, (samples, len(nominal)))
    masses = (factors * nominal).tolist()
    found = np.empty((samples, model.nv))
    links = range(1, len(nominal))
    inertias, aba = model.inertias, pin.aba
    start = time.perf_counter()
    for k, row in enumerate(masses):
        for i in links:
            inertias[i].mass = row[i]
        found[k] = aba(model, data, q, zero, zero)
    seconds = time.perf_counter() - start
    for i in links:
        inertias[i].mass = nominal[i]
    return found, seconds


def main() -> None:
    """Print the rate, and the moments that show that the masses reach the answers."""
    model = pin.buildModelFromUrdf(sys.argv[1])
    samples = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
    found, seconds = accelerations(model, samples, seed=1)
    print(f"{samples} samples in {seconds:.3f} s, {samples / seconds:.3e} per second on one core")
    for dof, (mean, deviation) in enumerate(zip(found.mean(axis=0), found.std(axis=0), strict=True)):
        print(f"dof {dof}: mean {mean:.6f}, deviation {deviation:.6f}")


if __name__ == "__main__":
    main()
