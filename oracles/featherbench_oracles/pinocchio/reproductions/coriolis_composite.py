"""Pinocchio's Coriolis matrix with a composite of two hinges, which is what its MJCF reader makes of a body with two joints."""

import pinocchio as pin

from featherbench_oracles.pinocchio.reproductions.coriolis import coriolis_deviation


def deviation(seed: int) -> float:
    """|C v + g - h| / |h|."""
    joint = pin.JointModelComposite(2)
    joint.addJoint(pin.JointModelRX())
    joint.addJoint(pin.JointModelRZ())
    return coriolis_deviation(joint, seed)
