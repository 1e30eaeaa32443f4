"""A complete oracle, to begin your own from: tau and M of fixed-base chains of revolute joints, by Newton's and Euler's equations."""

import json
import math
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Header = dict[str, Any]


class Unsupported(Exception):  # noqa: N818 (no error: it is the protocol's answer `unsupported`)
    """A robot, quantity or method that this oracle does not have."""


def inverse_dynamics(model: Header, q: Array, v: Array, a: Array, gravity: float = 1.0) -> Array:
    """Compute tau = M(q) a + h(q, v) in world axes, armature included. Gravity is an acceleration of the world by -g."""
    turned, origin, omega, alpha, acc, passed = np.eye(3), *np.zeros((3, 3)), -gravity * np.array(model["gravity"]), []
    for body, angle, rate, push in zip(model["bodies"], q, v, a, strict=True):
        joint, (xx, xy, xz, yy, yz, zz) = body["joint"], body["inertia"]
        step, (x, y, z) = turned @ joint["placement"]["translation"], joint["axis"]
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # exp(angle cross) is the turn about the axis
        spin = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        acc, origin = acc + np.cross(alpha, step) + np.cross(omega, np.cross(omega, step)), origin + step
        turned = turned @ np.reshape(joint["placement"]["rotation"], (3, 3)) @ spin
        axis = turned @ joint["axis"]
        alpha, omega = alpha + push * axis + rate * np.cross(omega, axis), omega + rate * axis
        c, inertia = turned @ body["com"], turned @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ turned.T
        force = body["mass"] * (acc + np.cross(alpha, c) + np.cross(omega, np.cross(omega, c)))
        passed.append((axis, origin, origin + c, force, inertia @ alpha + np.cross(omega, inertia @ omega), joint["armature"][0] * push))

    def carried(o: Array, links: list[Any]) -> Any:
        return sum(moment + np.cross(at - o, force) for _, _, at, force, moment, _ in links)

    return np.array([axis @ carried(o, passed[i:]) + rotor for i, (axis, o, *_, rotor) in enumerate(passed)])


def mass_matrix(model: Header, q: Array, v: Array, a: Array) -> Array:
    """Row i of M is tau at rest without gravity for a = e_i."""
    return np.array([inverse_dynamics(model, q, 0 * v, unit, gravity=0.0) for unit in np.eye(len(q))])


def readback(body: Header) -> list[float]:
    """List the 22 numbers of one body: mass, centre of mass, inertia, and the placement of its joint."""
    place = body["joint"]["placement"]
    return [body["mass"], *body["com"], *body["inertia"], *place["rotation"], *place["translation"]]


METHODS: dict[str, dict[str, Callable[[Header, Array, Array, Array], Array]]] = {
    "id": {"newton_euler": inverse_dynamics},
    "mass_matrix": {"newton_euler": mass_matrix},
}
# What the last prepare and the last states gave.
model: Header | None = None
states: list[Array] = []


def answer(ask: Header, blocks: dict[str, Array]) -> tuple[Header, tuple[str, Array] | None]:
    """Header and block of the answer to one request."""
    global model, states
    if ask["op"] == "hello":
        build = {"language": "Python", "numpy": np.__version__}
        return {"protocol": 1, "engine": "chain", "version": "1", "build": build, "methods": {k: list(METHODS[k]) for k in METHODS}}, None
    if ask["op"] == "prepare":
        model, states = None, []
        if ask["model"]["format"] != 1:
            raise ValueError(f"the description has the format {ask['model']['format']}, not 1")
        for i, body in enumerate(ask["model"]["bodies"]):
            if body["joint"]["type"] != "revolute" or body["parent"] != i - 1:
                raise Unsupported(f"chain has revolute joints without branches only, not {body['joint']['type']} {body['joint']['name']}")
        held = np.reshape([readback(body) for body in ask["model"]["bodies"]], (-1, 22))
        model = ask["model"]
        return {"nq": len(held), "nv": len(held)}, ("readback", held)
    if ask["op"] == "states":
        if model is None:
            raise ValueError("no model was prepared")
        states, shape = [], (ask["count"], len(model["bodies"]))
        states = [blocks[name].reshape(shape) for name in ("q", "v", "a")]
        return {}, None
    if ask["op"] != "evaluate":
        raise ValueError(f"there is no op {ask['op']}")
    if ask["method"] not in METHODS.get(ask["quantity"], {}):
        raise Unsupported(f"chain does not answer {ask['quantity']} by '{ask['method']}'")
    if model is None or not states:
        raise ValueError("no model and states were given before")
    if not 0 <= ask["first"] <= ask["first"] + ask["count"] <= len(states[0]):
        raise ValueError(f"there are no states {ask['first']} to {ask['first'] + ask['count']}")
    chosen = [numbers[ask["first"] : ask["first"] + ask["count"]] for numbers in states]
    return {}, ("value", np.array([METHODS[ask["quantity"]][ask["method"]](model, *state) for state in zip(*chosen, strict=True)]))


while line := sys.stdin.buffer.readline():
    block = None
    try:
        ask = json.loads(line)
        # A request's blocks are read first: bytes left in the pipe would be taken for the next request.
        raw = {b["name"]: (b["shape"], sys.stdin.buffer.read(8 * math.prod(b["shape"]))) for b in ask.get("blocks", [])}
        header, block = answer(ask, {name: np.frombuffer(data, "<f8").reshape(shape) for name, (shape, data) in raw.items()})
        header["status"] = "ok"
    except Unsupported as reason:
        header = {"status": "unsupported", "reason": str(reason)}
    except Exception as reason:  # a failure is an answer, and the oracle continues
        header = {"status": "error", "reason": f"{type(reason).__name__}: {reason}"}
    data = np.array([] if block is None else block[1], "<f8")
    if block is not None:
        header["blocks"] = [{"name": block[0], "shape": data.shape}]
    sys.stdout.buffer.write(json.dumps(header).encode() + b"\n" + data.tobytes())
    sys.stdout.buffer.flush()
