"""Each method names the argument that it refuses."""

import numpy as np
import pytest

import featherbench

ROBOT = featherbench.Robot.generated("humanoid")
FRAME = ROBOT.bodies[-1]
# The arrays that each method takes, and what it takes besides.
METHODS = {
    "inverse_dynamics": (("q", "v", "a"), {}),
    "forward_dynamics": (("q", "v", "tau"), {}),
    "bias_force": (("q", "v"), {}),
    "mass_matrix": (("q",), {}),
    "solve": (("q", "b"), {}),
    "placement": (("q",), {"frame": FRAME}),
    "motion": (("q", "v", "a"), {"frame": FRAME}),
    "jacobian": (("q",), {"frame": FRAME}),
    "inverse_dynamics_derivatives": (("q", "v", "a"), {}),
    "forward_dynamics_derivatives": (("q", "v", "tau"), {}),
    "integrate": (("q", "v"), {}),
    "difference": (("start", "end"), {}),
    "to_pinocchio": (("q",), {}),
    "to_mujoco": (("q",), {}),
    "to_drake": (("q",), {}),
    "from_pinocchio": (("q",), {}),
    "from_mujoco": (("q",), {}),
    "velocity_to": (("q", "v"), {"engine": "mujoco"}),
    "force_to": (("q", "tau"), {"engine": "mujoco"}),
}
CASES = [(method, name) for method, (names, _) in METHODS.items() for name in names]


def arguments(method, states):
    names, others = METHODS[method]
    q = ROBOT.random(seed=4, states=states)
    v = np.random.default_rng(4).uniform(-1, 1, (states, ROBOT.nv))
    arrays = {name: q.copy() if name in ("q", "start", "end") else v.copy() for name in names}
    if method.startswith("from_"):
        arrays["q"] = getattr(ROBOT, method.replace("from_", "to_"))(q)
    return arrays, others


def test_every_method_of_arrays_is_here():
    known = {"from_urdf", "from_mjcf", "from_json", "generated", "neutral", "random", "to_json", "from_drake"}
    public = {name for name in dir(featherbench.Robot) if not name.startswith("_") and callable(getattr(featherbench.Robot, name))}
    assert public - known == set(METHODS)


@pytest.mark.parametrize(("method", "name"), CASES)
def test_a_wrong_array_is_named(method, name):
    arrays, others = arguments(method, 3)
    call = getattr(ROBOT, method)
    call(*arrays.values(), *others.values()) if not others or method in ("placement", "motion", "jacobian") else call(
        *others.values(), *arrays.values()
    )

    def refused(error, value, states=None):
        bad = {key: array if states is None else array[states] for key, array in arrays.items()} | {name: value}
        with pytest.raises(error, match=rf"\b{name}\b"):
            call(**bad, **others)

    x = arrays[name]
    refused(featherbench.Error, x[:, 1:].copy())
    refused(featherbench.Error, np.hstack([x, x]))
    refused(featherbench.Error, x[None])
    refused(featherbench.Error, np.array(1.0))
    refused(TypeError, x.astype(int))
    refused(TypeError, x.astype(x.dtype.newbyteorder()))
    refused(TypeError, x.tolist())
    refused(TypeError, None)
    if len(arrays) > 1:
        with pytest.raises(featherbench.Error, match="states"):
            call(**{**arrays, name: x[:2].copy()}, **others)
    for bad in (np.nan, np.inf, -np.inf):
        y = x.copy()
        y[1, -1] = bad
        refused(featherbench.Error, y)
        refused(featherbench.Error, y[1], 1)


@pytest.mark.parametrize("method", [method for method, (_, others) in METHODS.items() if "frame" in others])
def test_an_unknown_frame_is_named(method):
    arrays, _ = arguments(method, 1)
    with pytest.raises(featherbench.Error, match="'hand'"):
        getattr(ROBOT, method)(**arrays, frame="hand")


@pytest.mark.parametrize(("method", "name"), CASES)
def test_strides_and_read_only_arrays_are_read(method, name):
    arrays, others = arguments(method, 6)
    call = getattr(ROBOT, method)
    due = call(**arrays, **others)
    for change in (np.asfortranarray, lambda x: np.repeat(x, 2, axis=0)[::2], lambda x: np.hstack([x, x])[:, : x.shape[1]]):
        changed = change(arrays[name])
        changed.flags.writeable = False
        assert np.array_equal(call(**{**arrays, name: changed}, **others), due)
