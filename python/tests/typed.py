"""A small program with types, which mypy checks against the stubs (`test_types.py`). It is run too."""

from pathlib import Path
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import featherbench
from featherbench import Comparison, Joint, Question, Robot

Doubles = NDArray[np.float64]
Singles = NDArray[np.float32]

robot = Robot.generated("humanoid")
joint: Joint = robot.joints[0]
first, end = joint.q
assert_type(joint.limits, list[tuple[float, float]])
assert_type(joint.parent, str | None)

q = robot.random(seed=1, states=5)
v, a = np.zeros((5, robot.nv)), np.zeros((5, robot.nv))
tau = robot.inverse_dynamics(q, v, a, threads=None)
assert_type(tau, Doubles)
q32, v32 = q.astype(np.float32), v.astype(np.float32)
assert_type(robot.forward_dynamics(q32, v32, v32, out=np.empty_like(v32)), Singles)
assert_type(robot.mass_matrix(q), Doubles)
assert_type(robot.velocity_from("drake", q, robot.velocity_to("drake", q, v)), Doubles)
assert tau.shape == (5, robot.nv)

question = Question("panda", "mujoco", "bodies that mean something else", 1, 0, holds=False, reason="one body has another mass")
answers = Comparison(Path("run"), (question,))
assert_type(answers.alike, bool)
assert_type(answers.differences, tuple[Question, ...])
assert answers.differences == (question,)

try:
    robot.jacobian(q, "no such frame")
except featherbench.Error as error:
    assert_type(error, featherbench.Error)
