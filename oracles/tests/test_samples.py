"""Pinocchio's loop over uncertain masses: a pendulum, whose acceleration does not depend on its mass, and two, where it does."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from featherbench_oracles.pinocchio.samples import accelerations


def chain(links: int) -> pin.Model:
    """Make a chain of point masses of 1 kg on rods of 1 m that hang sideways."""
    model = pin.Model()
    for k in range(links):
        place = pin.SE3(np.eye(3), np.array([1.0 if k else 0.0, 0.0, 0.0]))
        index = model.addJoint(k, pin.JointModelRY(), place, f"joint {k}")
        model.appendBodyToJoint(index, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.zeros((3, 3))), pin.SE3.Identity())
    return model


def test_a_point_mass_falls_alike_whatever_its_mass() -> None:
    """The acceleration is g/l for every mass: 4 ulp for the quotient and the sine."""
    model = chain(1)
    found, seconds = accelerations(model, 100, seed=3)
    assert seconds > 0.0
    assert np.abs(found / 9.81 - 1.0).max() < 4 * np.finfo(float).eps


def test_masses_reach_the_answers_and_are_restored() -> None:
    """Bent, two point masses fall as the equations of the double pendulum say; afterwards the model has its masses."""
    model = chain(2)
    for joint in (1, 2):
        model.jointPlacements[joint].rotation = pin.utils.rotate("y", 0.5)
    found, _ = accelerations(model, 200, seed=3)
    factors = np.random.default_rng(3).uniform(0.8, 1.2, (200, 3))
    m1, m2 = factors[:, 1], factors[:, 2]
    c, g = np.cos(0.5), 9.81
    # M(θ) θ̈ = torque of gravity, with the second angle relative to the first; the rods point down by 0.5 and 1.
    m11, m12, m22 = m1 + m2 * (2.0 + 2.0 * c), m2 * (1.0 + c), m2
    near, far = np.cos(0.5), np.cos(1.0)
    t1, t2 = g * (m1 * near + m2 * (near + far)), g * m2 * far
    det = m11 * m22 - m12 * m12
    due = np.stack([(m22 * t1 - m12 * t2) / det, (m11 * t2 - m12 * t1) / det], axis=1)
    # κ of this 2 × 2 matrix is below 100.
    assert np.abs(found - due).max() < 100 * 9.81 * np.finfo(float).eps * 10
    assert found.std(axis=0).min() > 1e-3
    assert [inertia.mass for inertia in model.inertias][1:] == [1.0, 1.0]
