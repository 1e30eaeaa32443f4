"""Pinocchio's Coriolis matrix with a universal joint, whose motion subspace depends on q: C v + g is not the bias force."""

import numpy as np
import pinocchio as pin

from featherbench_oracles.pinocchio.reproductions.coriolis import coriolis_deviation


def deviation(seed: int) -> float:
    """|C v + g - h| / |h|."""
    return coriolis_deviation(pin.JointModelUniversal(*np.eye(3)[:2]), seed)
