"""Pinocchio's Coriolis matrix with a spherical joint in ZYX angles, whose motion subspace depends on q."""

import pinocchio as pin

from featherbench_oracles.pinocchio.reproductions.coriolis import coriolis_deviation


def deviation(seed: int) -> float:
    """|C v + g - h| / |h|."""
    return coriolis_deviation(pin.JointModelSphericalZYX(), seed)
