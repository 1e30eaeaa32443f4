"""The package against Pinocchio, which reads the same URDF by its own parser.

Joints of the file are in the order of their names, so the parser's order of dofs is ours. No joint is continuous.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import featherbench

pin = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")

Doubles = NDArray[np.float64]
# The robot, Pinocchio's model, and random states of both.
Pair = tuple[featherbench.Robot, Any, Doubles, Doubles, Doubles]

URDF = Path(__file__).parents[2] / "guide" / "arm.urdf"
STATES = 50
TREES = 40
# Both sides round some hundred operations on numbers below a hundred.
FORMED = 1e-12
# Solutions with M, whose condition number is below a thousand here.
SOLVED = 1e-10


def close(ours: Doubles, theirs: Doubles, tolerance: float) -> None:
    assert ours.shape == theirs.shape
    assert np.all(np.abs(ours - theirs) <= tolerance * (1 + np.abs(theirs)))


@pytest.fixture(params=[False, True], ids=["fixed", "floating"])
def pair(request: pytest.FixtureRequest) -> Pair:
    """Give the robot, Pinocchio's model, and random states of both."""
    robot = featherbench.Robot.from_urdf(URDF, floating=request.param)
    joint = (pin.JointModelFreeFlyer(),) if request.param else ()
    model = pin.buildModelFromUrdf(str(URDF), *joint)
    assert (model.nq, model.nv) == (robot.nq, robot.nv)
    rng = np.random.default_rng(1)
    q = robot.random(seed=1, states=STATES)
    v, a = rng.uniform(-1, 1, (2, STATES, robot.nv))
    return robot, model, q, v, a


def test_inverse_dynamics(pair: Pair) -> None:
    robot, model, q, v, a = pair
    data = model.createData()
    close(robot.inverse_dynamics(q, v, a), np.array([pin.rnea(model, data, *state).copy() for state in zip(q, v, a, strict=True)]), FORMED)


def test_forward_dynamics(pair: Pair) -> None:
    robot, model, q, v, tau = pair
    data = model.createData()
    theirs = np.array([pin.aba(model, data, *state).copy() for state in zip(q, v, tau, strict=True)])
    close(robot.forward_dynamics(q, v, tau), theirs, SOLVED)


def test_mass_matrix_and_solution(pair: Pair) -> None:
    robot, model, q, _, b = pair
    data = model.createData()
    upper = np.triu(np.array([pin.crba(model, data, x).copy() for x in q]))
    theirs = upper + np.triu(upper, 1).transpose(0, 2, 1)
    close(robot.mass_matrix(q), theirs, FORMED)
    close(robot.solve(q, b), np.linalg.solve(theirs, b[..., None])[..., 0], SOLVED)


@pytest.mark.parametrize("frame", ["upper", "lower", "rail", "tool"])
def test_placements_jacobians_and_motions(pair: Pair, frame: str) -> None:
    robot, model, q, v, a = pair
    data, index = model.createData(), model.getFrameId(frame)
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    places, jacobians, motions = [], [], []
    for state in zip(q, v, a, strict=True):
        pin.forwardKinematics(model, data, *state)
        pin.updateFramePlacements(model, data)
        places.append(data.oMf[index].homogeneous.copy())
        jacobians.append(np.roll(pin.computeFrameJacobian(model, data, state[0], index, axes), 3, axis=0))
        velocity = pin.getFrameVelocity(model, data, index, axes)
        acceleration = pin.getFrameClassicalAcceleration(model, data, index, axes)
        motions.append([np.concatenate([x.angular, x.linear]) for x in (velocity, acceleration)])
    close(robot.placement(q, frame), np.array(places), FORMED)
    close(robot.jacobian(q, frame), np.array(jacobians), FORMED)
    close(robot.motion(q, v, a, frame), np.array(motions), FORMED)


def test_derivatives(pair: Pair) -> None:
    robot, model, q, v, a = pair
    data = model.createData()
    theirs = []
    for state in zip(q, v, a, strict=True):
        by_q, by_v, by_a = pin.computeRNEADerivatives(model, data, *state)
        theirs.append([by_q.copy(), by_v.copy(), np.triu(by_a) + np.triu(by_a, 1).T])
    close(robot.inverse_dynamics_derivatives(q, v, a), np.array(theirs), FORMED)
    theirs = []
    for state in zip(q, v, a, strict=True):
        pin.computeABADerivatives(model, data, *state)
        theirs.append([data.ddq_dq.copy(), data.ddq_dv.copy(), np.triu(data.Minv) + np.triu(data.Minv, 1).T])
    close(robot.forward_dynamics_derivatives(q, v, a), np.array(theirs), SOLVED)


def test_configurations(pair: Pair) -> None:
    robot, model, q, v, _ = pair
    close(robot.integrate(q, v), np.array([pin.integrate(model, *state) for state in zip(q, v, strict=True)]), FORMED)
    start, end = q[:-1], q[1:]
    close(robot.difference(start, end), np.array([pin.difference(model, *way) for way in zip(start, end, strict=True)]), FORMED)
    close(robot.neutral(), pin.neutral(model), 0)
    assert np.array_equal(robot.to_pinocchio(q), q)


def test_conversions_are_refused_where_the_order_is_another(tmp_path: Path) -> None:
    """Random trees with fixed joints between, whose names are in no order."""
    rng, refused = np.random.default_rng(), 0
    for case in range(TREES):
        file = tmp_path / f"{case}.urdf"
        file.write_text(random_tree(rng, links=int(rng.integers(3, 8))))
        theirs = [name for name in pin.buildModelFromUrdf(str(file)).names if name != "universe"]
        robot = featherbench.Robot.from_urdf(file)
        if [joint.name for joint in robot.joints] == theirs:
            assert np.array_equal(robot.to_pinocchio(robot.neutral()), robot.neutral()), file.read_text()
        else:
            refused += 1
            with pytest.raises(featherbench.Error, match="sorts siblings by the names of their joints"):
                robot.to_pinocchio(robot.neutral())
    # Of such trees both kinds are common.
    assert 0 < refused < TREES


def random_tree(rng: np.random.Generator, links: int) -> str:
    """Write a URDF whose links hang on earlier ones, by revolute or fixed joints; the first joint moves."""
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    parts = ['<robot name="tree"><link name="l0"/>']
    for link, name in enumerate(rng.permutation(links - 1), start=1):
        kind = "revolute" if link == 1 or rng.random() < 0.6 else "fixed"
        parts.append(f'''<link name="l{link}">{inertial}</link>
            <joint name="{"jJ"[rng.integers(2)]}{name}" type="{kind}"><parent link="l{rng.integers(link)}"/><child link="l{link}"/>
            <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>''')
    return "".join(parts) + "</robot>"
