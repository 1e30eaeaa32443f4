"""Every method refuses arrays that do not fit, and names the argument: shape, dtype, byte order, type, states, numbers not finite."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import featherbench

Arrays = dict[str, NDArray[np.float64]]

ROBOT = featherbench.Robot.generated("humanoid")
NQ, NV = ROBOT.nq, ROBOT.nv
FRAME = ROBOT.bodies[-1]
STATES = 3

Q, V, A, TAU = ("q", NQ), ("v", NV), ("a", NV), ("tau", NV)
# Each method with arrays: what comes before and after the arrays, and the arrays with their lengths.
METHODS = {
    "inverse_dynamics": ((), [Q, V, A], {}),
    "forward_dynamics": ((), [Q, V, TAU], {}),
    "bias_force": ((), [Q, V], {}),
    "mass_matrix": ((), [Q], {}),
    "solve": ((), [Q, ("b", NV)], {}),
    "placement": ((), [Q], {"frame": FRAME}),
    "motion": ((), [Q, V, A], {"frame": FRAME}),
    "jacobian": ((), [Q], {"frame": FRAME}),
    "inverse_dynamics_derivatives": ((), [Q, V, A], {}),
    "forward_dynamics_derivatives": ((), [Q, V, TAU], {}),
    "integrate": ((), [Q, V], {}),
    "difference": ((), [("start", NQ), ("end", NQ)], {}),
    **{f"{way}_{engine}": ((), [Q], {}) for way in ("to", "from") for engine in ("pinocchio", "mujoco", "drake")},
    "velocity_to": (("mujoco",), [Q, V], {}),
    "velocity_from": (("mujoco",), [Q, V], {}),
    "acceleration_to": (("mujoco",), [Q, V, A], {}),
    "acceleration_from": (("mujoco",), [Q, V, A], {}),
    "force_to": (("mujoco",), [Q, TAU], {}),
    "force_from": (("mujoco",), [Q, TAU], {}),
}
# Those that take no array.
OTHERS = {"from_urdf", "from_mjcf", "from_json", "to_json", "generated", "neutral", "random"}
WITH_OUT = ("inverse_dynamics", "forward_dynamics")
WITH_THREADS = [name for name in METHODS if "threads" in (getattr(featherbench.Robot, name).__text_signature__ or "")]
CASES = [(method, argument) for method, (_, arguments, _) in METHODS.items() for argument, _ in arguments]


def good(method: str) -> Arrays:
    """Give arrays that fit, of several states."""
    rng = np.random.default_rng(4)
    of_q = {
        "q": ROBOT.random(seed=4, states=STATES),
        "start": ROBOT.random(seed=5, states=STATES),
        "end": ROBOT.random(seed=6, states=STATES),
    }
    return {name: of_q[name] if name in of_q else rng.uniform(-1, 1, (STATES, size)) for name, size in METHODS[method][1]}


def call(method: str, arrays: Mapping[str, Any], **more: Any) -> Any:
    before, _, after = METHODS[method]
    return getattr(ROBOT, method)(*before, **arrays, **after, **more)


def refused(error: type[Exception], method: str, arrays: Mapping[str, Any], text: str, **more: Any) -> None:
    with pytest.raises(error, match=text) as caught:
        call(method, arrays, **more)
    assert type(caught.value) is error


def test_every_method_is_here() -> None:
    public = {name for name in dir(featherbench.Robot) if not name.startswith("_") and callable(getattr(featherbench.Robot, name))}
    assert public == set(METHODS) | OTHERS


@pytest.mark.parametrize("method", METHODS)
def test_what_fits_is_computed(method: str) -> None:
    arrays = good(method)
    many = call(method, arrays)
    assert many.shape[0] == STATES
    assert np.isfinite(many).all()
    strided = {name: np.repeat(x, 2, axis=0)[::2] for name, x in arrays.items()}
    assert np.array_equal(call(method, strided), many)
    for x in arrays.values():
        x.flags.writeable = False
    assert np.array_equal(call(method, arrays), many)


@pytest.mark.parametrize(("method", "argument"), CASES)
def test_shapes(method: str, argument: str) -> None:
    arrays = good(method)
    x = arrays[argument]
    for bad, shape in [
        (x[:, 1:].copy(), f"({STATES}, {x.shape[1] - 1})"),
        (x[None], f"(1, {STATES}, {x.shape[1]})"),
        (np.array(1.0), "()"),
    ]:
        refused(
            featherbench.Error, method, arrays | {argument: bad}, rf"^{argument} has shape {re.escape(shape)}; give \({x.shape[1]},\) or "
        )


@pytest.mark.parametrize(("method", "argument"), CASES)
def test_dtypes(method: str, argument: str) -> None:
    arrays = good(method)
    x = arrays[argument]
    swapped = x.astype(x.dtype.newbyteorder())
    for bad, text in [
        (x.astype(int), f"^{argument} has dtype int64; give float64 or float32"),
        (x.astype(complex), f"^{argument} has dtype complex128"),
        (x.astype(object), f"^{argument} has dtype object"),
        (swapped, f"^{argument} has dtype .f8; .* in the byte order of the machine"),
        (x.tolist(), f"^{argument} is of type list; give a numpy array"),
        (None, f"^{argument} is of type NoneType"),
    ]:
        refused(TypeError, method, arrays | {argument: bad}, text)


@pytest.mark.parametrize(("method", "argument"), CASES)
def test_single_precision(method: str, argument: str) -> None:
    arrays = good(method)
    if method in WITH_OUT and argument == "q":
        # Then it is another argument that has another dtype than q.
        refused(TypeError, method, arrays | {"q": arrays["q"].astype(np.float32)}, "^v has another dtype than q; give float32")
    else:
        refused(TypeError, method, arrays | {argument: arrays[argument].astype(np.float32)}, rf"^{argument} .*; give float64$")


@pytest.mark.parametrize(("method", "argument"), CASES)
def test_numbers_of_states(method: str, argument: str) -> None:
    arrays = good(method)
    if len(arrays) == 1:
        return  # nothing to disagree with
    names = list(arrays)
    told = names[1] if argument == names[0] else argument
    refused(featherbench.Error, method, arrays | {argument: arrays[argument][:2].copy()}, f"^{told} has . states; {names[0]} has . states")
    refused(featherbench.Error, method, arrays | {argument: arrays[argument][0].copy()}, rf"^{told} has .*states; {names[0]} has .*states")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(("method", "argument"), CASES)
def test_numbers_that_are_not_finite(method: str, argument: str, bad: float) -> None:
    arrays = good(method)
    arrays[argument][1, 2] = bad
    word = {"nan": "NaN", "inf": "inf", "-inf": "-inf"}[str(bad)]
    refused(featherbench.Error, method, arrays, rf"\bstate 1: .*\b{argument}\b.* is {word}")
    one = {name: x[1].copy() for name, x in arrays.items()}
    refused(featherbench.Error, method, one, rf"\b{argument}\[2\] is {word}; give a finite number$")


# MuJoCo's quaternions begin at the same place, Drake's at the first number.
QUATERNIONS = [
    (method, name, slice(0, 4) if method == "from_drake" else slice(3, 7)) for method, name in CASES if name in ("q", "start", "end")
]


@pytest.mark.parametrize(("method", "argument", "place"), QUATERNIONS)
def test_quaternions_of_zeros(method: str, argument: str, place: slice) -> None:
    arrays = good(method)
    if method == "from_drake":
        arrays["q"] = ROBOT.to_drake(arrays["q"])
    arrays[argument][1, place] = 0
    refused(featherbench.Error, method, arrays, rf"\bstate 1: .*(\b{argument}\b.*no rotation|quaternions that are not zero)")
    one = {name: x[1].copy() for name, x in arrays.items()}
    refused(featherbench.Error, method, one, rf"\b{argument}\[{place.start}\]: the quaternion of joint .*: no rotation; give length 1$")


@pytest.mark.parametrize("method", WITH_OUT)
def test_out(method: str) -> None:
    arrays = good(method)
    due = call(method, arrays)
    read_only = np.empty_like(due)
    read_only.flags.writeable = False
    for error, bad, text in [
        (featherbench.Error, read_only, "^out cannot be written: it is read-only"),
        (featherbench.Error, arrays["v"], "^out cannot be written: .* one of the other arguments"),
        (featherbench.Error, np.asfortranarray(due), "^out has gaps or another order"),
        (featherbench.Error, np.empty((2 * STATES, NV))[::2], "^out has gaps or another order"),
        (featherbench.Error, np.empty((STATES, NV + 1)), rf"^out has shape \({STATES}, {NV + 1}\); give \({STATES}, {NV}\)"),
        (featherbench.Error, np.empty(NV), rf"^out has shape \({NV},\); give \({STATES}, {NV}\)"),
        (TypeError, np.empty(due.shape, np.float32), "^out has another dtype than q; give float64"),
        (TypeError, np.empty(due.shape, int), "^out has dtype int64"),
        (TypeError, due.tolist(), "^out is of type list"),
    ]:
        refused(error, method, arrays, text, out=bad)


def test_methods_with_threads() -> None:
    assert len(WITH_THREADS) == 10


@pytest.mark.parametrize("method", WITH_THREADS)
@pytest.mark.parametrize("threads", [0, -1])
def test_threads(method: str, threads: int) -> None:
    refused(featherbench.Error, method, good(method), f"^threads is {threads}; give 1 or more", threads=threads)
    one = {name: x[0].copy() for name, x in good(method).items()}
    refused(featherbench.Error, method, one, f"^threads is {threads}; give 1 or more", threads=threads)


@pytest.mark.parametrize("method", ["placement", "motion", "jacobian"])
def test_frames(method: str) -> None:
    with pytest.raises(featherbench.Error, match="there is no body or frame 'no such frame'"):
        getattr(ROBOT, method)(*good(method).values(), "no such frame")


@pytest.mark.parametrize("method", [name for name, (before, _, _) in METHODS.items() if before])
def test_engines(method: str) -> None:
    with pytest.raises(featherbench.Error, match="^engine is 'bullet'; give 'pinocchio', 'mujoco' or 'drake'"):
        getattr(ROBOT, method)("bullet", *good(method).values())
