"""Shapes, dtypes, strides, threads and what is refused."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import featherbench

Doubles = NDArray[np.float64]

ROBOT = featherbench.Robot.generated("humanoid")
NQ, NV = ROBOT.nq, ROBOT.nv


def states(count: int) -> tuple[Doubles, Doubles, Doubles]:
    rng = np.random.default_rng(2)
    return ROBOT.random(seed=2, states=count), *rng.uniform(-1, 1, (2, count, NV))


def test_a_batch_has_the_results_of_its_states() -> None:
    q, v, a = states(200)
    for quantity in (ROBOT.inverse_dynamics, ROBOT.forward_dynamics):
        one_by_one = np.array([quantity(*state) for state in zip(q, v, a, strict=True)])
        # The batch has another kernel: a few roundings, which M of the humanoid enlarges by its condition number, some thousands.
        assert np.allclose(quantity(q, v, a), one_by_one, rtol=1e-10, atol=1e-10)
    one_by_one = np.array([ROBOT.mass_matrix(x) for x in q])
    assert np.array_equal(ROBOT.mass_matrix(q), one_by_one)


def test_threads_change_no_bit() -> None:
    q, v, a = states(333)
    for threads in (2, 3, None):
        assert np.array_equal(ROBOT.inverse_dynamics(q, v, a), ROBOT.inverse_dynamics(q, v, a, threads=threads))
        assert np.array_equal(ROBOT.jacobian(q, ROBOT.bodies[-1]), ROBOT.jacobian(q, ROBOT.bodies[-1], threads=threads))
    with pytest.raises(featherbench.Error, match="threads is 0"):
        ROBOT.inverse_dynamics(q, v, a, threads=0)


def test_single_precision() -> None:
    q, v, a = (x.astype(np.float32) for x in states(40))
    tau = ROBOT.inverse_dynamics(q, v, a)
    assert tau.dtype == np.float32
    # Single precision has 6e-8 in each operation; the errors of a path of ten joints add up.
    assert np.allclose(tau, ROBOT.inverse_dynamics(*(x.astype(np.float64) for x in (q, v, a))), rtol=1e-4, atol=1e-3)
    assert np.allclose(ROBOT.inverse_dynamics(q[0], v[0], a[0]), tau[0], rtol=1e-5, atol=1e-5)


def test_strides_and_orders_have_the_same_results() -> None:
    q, v, a = states(20)
    tau = ROBOT.inverse_dynamics(q, v, a)
    changes: list[Callable[[Doubles], Doubles]] = [
        np.asfortranarray,
        lambda x: np.repeat(x, 2, axis=0)[::2],
        lambda x: np.hstack([x, x])[:, : x.shape[1]],
    ]
    for change in changes:
        assert np.array_equal(ROBOT.inverse_dynamics(change(q), change(v), change(a)), tau)
    assert np.array_equal(ROBOT.inverse_dynamics(q[::-1], v[::-1], a[::-1]), tau[::-1])
    q.flags.writeable = False
    assert np.array_equal(ROBOT.inverse_dynamics(q, v, a), tau)


def test_out_is_written() -> None:
    q, v, a = states(20)
    out = np.empty_like(v)
    assert ROBOT.inverse_dynamics(q, v, a, out=out) is out
    assert np.array_equal(out, ROBOT.inverse_dynamics(q, v, a))
    read_only = np.empty_like(v)
    read_only.flags.writeable = False
    for bad, text in [
        (read_only, "out cannot be written"),
        (v, "out cannot be written"),
        (np.asfortranarray(out), "out has gaps"),
        (out[1:], r"out has shape \(19, "),
    ]:
        with pytest.raises(featherbench.Error, match=text):
            ROBOT.inverse_dynamics(q, v, a, out=bad)


@pytest.mark.parametrize("name", ["q", "v", "a"])
def test_what_is_refused_is_named(name: str) -> None:
    good = dict(zip("qva", states(3), strict=True))

    def refused(error: type[Exception], text: str, value: Any) -> None:
        with pytest.raises(error, match=text):
            ROBOT.inverse_dynamics(**{**good, name: value})

    x = good[name]
    refused(featherbench.Error, rf"{name} has shape \(3, {x.shape[1] - 1}\); give \({x.shape[1]},\) or", x[:, 1:].copy())
    refused(featherbench.Error, rf"{name} has shape \(1, 3, ", x[None])
    refused(TypeError, f"{name} has dtype int64", np.zeros(x.shape, dtype=int))
    refused(TypeError, f"{name} has dtype complex128", x.astype(complex))
    refused(TypeError, f"{name} is of type list", x.tolist())
    refused(featherbench.Error, "states", x[:2].copy())
    bad = x.copy()
    bad[1, 2] = np.nan
    refused(featherbench.Error, rf"state 1: entry 2 of its part of .*\b{name} is NaN", bad)
    if name != "q":
        refused(TypeError, f"{name} has another dtype than q", x.astype(np.float32))
    one = {key: value[0] for key, value in good.items()}
    with pytest.raises(featherbench.Error, match=rf"{name}\[2\] is NaN; give a finite number"):
        ROBOT.inverse_dynamics(**{**one, name: bad[1]})


def test_a_quaternion_of_zeros_is_refused() -> None:
    q = ROBOT.neutral()
    q[3:7] = 0
    zero = np.zeros(NV)
    with pytest.raises(featherbench.Error, match="no rotation"):
        ROBOT.inverse_dynamics(q, zero, zero)
    with pytest.raises(featherbench.Error, match="quaternions that are not zero"):
        ROBOT.inverse_dynamics(q[None], zero[None], zero[None])


def test_no_states_are_no_error() -> None:
    q, v, a = states(0)
    assert ROBOT.inverse_dynamics(q, v, a).shape == (0, NV)
    assert ROBOT.mass_matrix(q).shape == (0, NV, NV)


def test_one_robot_serves_many_threads() -> None:
    q, v, a = states(64)
    due, found = ROBOT.inverse_dynamics(q, v, a), {}

    def work(k: int) -> None:
        found[k] = [ROBOT.inverse_dynamics(q, v, a) for _ in range(20)] + [ROBOT.mass_matrix(q[k])]

    workers = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 4
    for k, (*forces, matrix) in found.items():
        assert all(np.array_equal(tau, due) for tau in forces)
        assert np.array_equal(matrix, ROBOT.mass_matrix(q[k]))


def test_files_and_names() -> None:
    with pytest.raises(featherbench.Error, match=r"no_such\.urdf"):
        featherbench.Robot.from_urdf(Path("no_such.urdf"))
    with pytest.raises(featherbench.Error, match="there is no body or frame 'hand'"):
        ROBOT.jacobian(ROBOT.neutral(), "hand")
    assert ROBOT.joints[0].kind == "free"
    assert ROBOT.joints[0].q == (0, 7)
    assert [joint.body for joint in ROBOT.joints] == ROBOT.bodies


def test_conversions_lead_back() -> None:
    q, v, tau = states(10)
    for to, back in [
        (ROBOT.to_pinocchio, ROBOT.from_pinocchio),
        (ROBOT.to_mujoco, ROBOT.from_mujoco),
        (ROBOT.to_drake, ROBOT.from_drake),
    ]:
        # Roundings of quaternions of length one.
        assert np.allclose(ROBOT.difference(q, back(to(q))), 0, atol=1e-14)
    for engine in ("pinocchio", "mujoco", "drake"):
        power = np.sum(ROBOT.velocity_to(engine, q, v) * ROBOT.force_to(engine, q, tau), axis=1)
        assert np.allclose(power, np.sum(v * tau, axis=1), atol=1e-13)
    with pytest.raises(featherbench.Error, match="engine is 'bullet'"):
        ROBOT.velocity_to("bullet", q, v)  # type: ignore[arg-type]
