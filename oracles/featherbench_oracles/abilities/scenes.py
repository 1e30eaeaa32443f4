"""Scenes: the operations `scene` and `scene_derivative`, bodies of spheres and boxes over level ground."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from featherbench_oracles.abilities.heard import heard
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header
from featherbench_oracles.core.protocol import Unsupported

# The most steps of a motion.
MOST_STEPS = 1_000_000


@dataclass(frozen=True)
class Shape:
    """What touches.

    Attributes
    ----------
    at : ndarray, shape (3,)
        The centre in body axes, m.
    radius : float or None
        Of a sphere, m.
    half : ndarray or None
        Half edges of a box, m.
    """

    at: Array
    radius: float | None
    half: Array | None


@dataclass(frozen=True)
class Body:
    """A free body whose origin is its centre of mass and whose axes are principal.

    Attributes
    ----------
    name : str
        Its name.
    mass : float
        kg.
    inertia : ndarray, shape (3,)
        Principal moments, kg m².
    position, orientation : ndarray
        m; (x, y, z, w), body to world.
    linear, angular : ndarray, shape (3,)
        World axes, m/s and rad/s.
    force : ndarray, shape (3,)
        A constant force at the centre of mass, world axes, N.
    shapes : tuple of Shape
        What touches.
    """

    name: str
    mass: float
    inertia: Array
    position: Array
    orientation: Array
    linear: Array
    angular: Array
    force: Array
    shapes: tuple[Shape, ...]


@dataclass(frozen=True)
class Scene:
    """Bodies over the ground z <= 0.

    Attributes
    ----------
    gravity : ndarray, shape (3,)
        m/s².
    friction : float
        mu of every contact.
    restitution : float
        e of every contact.
    bodies : tuple of Body
        The bodies.
    """

    gravity: Array
    friction: float
    restitution: float
    bodies: tuple[Body, ...]


@dataclass(frozen=True)
class Stepping:
    """How a scene is stepped.

    Attributes
    ----------
    dt : float
        The step, s.
    steps : int
        How many.
    every : int
        Steps of a sample.
    """

    dt: float
    steps: int
    every: int


@dataclass(frozen=True)
class Motion:
    """What an engine answers.

    Attributes
    ----------
    samples : list of list of ndarray
        Of each sample and body thirteen numbers: position, quaternion (x, y, z, w), linear and angular velocity in world axes.
    contacts : list of ndarray
        Of the last step's contacts eight numbers: the body, the other (-1 is the ground), the point, the force on the body.
    """

    samples: list[list[Array]]
    contacts: list[Array]


@dataclass(frozen=True)
class Derivative:
    """The derivative of a body's vertical motion.

    Attributes
    ----------
    state : ndarray, shape (2,)
        z and its rate at the end.
    matrix : ndarray, shape (2, 2)
        The derivative of `state` by both at the start.
    """

    state: Array
    matrix: Array


@dataclass(frozen=True)
class Variant:
    """A contact model with its solver.

    Attributes
    ----------
    simulate : callable
        Simulates a scene.
    settings : dict
        The engine's own parameters, for rows.
    """

    simulate: Callable[[Scene, Stepping], Motion]
    settings: dict[str, Any]


@dataclass(frozen=True)
class DerivativeVariant:
    """A way to differentiate a motion.

    Attributes
    ----------
    differentiate : callable
        `(scene, stiffness, stepping) -> Derivative`.
    settings : dict
        The engine's own parameters, for rows.
    """

    differentiate: Callable[[Scene, float, Stepping], Derivative]
    settings: dict[str, Any]


def read(scene: Any) -> Scene:
    """Read a scene of a request.

    Raises
    ------
    ValueError
        If a number is missing or cannot be.
    """

    def vector(of: Any, key: str, size: int, *, positive: bool = False) -> Array:
        numbers = np.array(of[key], dtype=float)
        if numbers.shape != (size,) or not np.isfinite(numbers).all() or (positive and (numbers <= 0).any()):
            raise ValueError(f"{key} must be {size} finite numbers{', all positive' if positive else ''}")
        return numbers

    def number(of: Any, key: str, low: float, high: float) -> float:
        value = float(of[key])
        if not (np.isfinite(value) and low <= value <= high):
            raise ValueError(f"{key} must be in [{low:g}, {high:g}]")
        return value

    def shape(of: Any) -> Shape:
        at = vector(of, "at", 3)
        if of["kind"] == "sphere":
            return Shape(at, number(of, "radius", 1e-12, np.inf), None)
        if of["kind"] == "box":
            return Shape(at, None, vector(of, "half", 3, positive=True))
        raise ValueError(f"there is no shape {of['kind']}")

    def body(of: Any) -> Body:
        turn = vector(of, "orientation", 4)
        if abs(turn @ turn - 1) > 1e-9:
            raise ValueError("orientation must be a unit quaternion")
        mass, inertia = number(of, "mass", 1e-12, np.inf), vector(of, "inertia", 3, positive=True)
        linear, angular, force = (vector(of, key, 3) for key in ("linear", "angular", "force"))
        position, shapes = vector(of, "position", 3), tuple(map(shape, of["shapes"]))
        return Body(str(of["name"]), mass, inertia, position, turn, linear, angular, force, shapes)

    try:
        friction, restitution = number(scene, "friction", 0, np.inf), number(scene, "restitution", 0, 1)
        read = Scene(vector(scene, "gravity", 3), friction, restitution, tuple(map(body, scene["bodies"])))
    except (KeyError, TypeError) as error:
        raise ValueError(f"the scene is malformed: {error!r}") from error
    if not read.bodies:
        raise ValueError("a scene has bodies")
    return read


class Scenes:
    """The operation `scene` of a session.

    Parameters
    ----------
    engine : str
        The engine's name.
    variants : mapping of str to Variant
        By the variant's name.
    derivatives : mapping of str to DerivativeVariant
        The same of derivatives.
    """

    def __init__(self, engine: str, variants: Mapping[str, Variant], derivatives: Mapping[str, DerivativeVariant]) -> None:
        self.engine, self.variants, self.derivatives = engine, variants, derivatives

    def hello(self) -> dict[str, Any]:
        """Tell what the engine offers, with the settings."""
        offered: dict[str, Mapping[str, Any]] = {"scenes": self.variants, "scene_derivatives": self.derivatives}
        return {key: {name: one.settings for name, one in table.items()} for key, table in offered.items() if table}

    def _asked(self, header: Header, table: Mapping[str, Any]) -> tuple[Any, Scene, Stepping]:
        """Read variant, scene and steps of a request."""
        variant = header["variant"]
        if variant not in table:
            raise Unsupported(f"{self.engine} has no variant {variant} of contact")
        dt, steps, every = header["dt"], header["steps"], header.get("every", 1)
        if not (isinstance(steps, int) and isinstance(every, int) and 0 < every <= steps <= MOST_STEPS):
            raise ValueError(f"steps and every must be whole numbers with 0 < every <= steps <= {MOST_STEPS}")
        if not (isinstance(dt, int | float) and np.isfinite(dt) and dt > 0):
            raise ValueError("dt must be positive and finite")
        return table[variant], read(header["scene"]), Stepping(float(dt), steps, every)

    def differentiate(self, header: Header, _blocks: Blocks) -> Answer:
        """Differentiate the vertical motion of one body: blocks `state` of shape (2,) and `derivative` of shape (2, 2)."""
        variant, scene, stepping = self._asked(header, self.derivatives)
        stiffness = float(header["stiffness"])
        if not (np.isfinite(stiffness) and stiffness > 0):
            raise ValueError("stiffness must be positive and finite")
        if len(scene.bodies) != 1:
            raise Unsupported("a derivative is of a scene of one body")
        with heard(self.engine):
            found = variant.differentiate(scene, stiffness, stepping)
        return {}, {"state": np.array(found.state), "derivative": np.array(found.matrix)}

    def simulate(self, header: Header, _blocks: Blocks) -> Answer:
        """Simulate a scene: blocks `motion` of shape (samples, bodies, 13) and `contacts` of shape (contacts, 8)."""
        variant, scene, stepping = self._asked(header, self.variants)
        with heard(self.engine):
            motion = variant.simulate(scene, stepping)
        samples = np.array(motion.samples, dtype=float).reshape(stepping.steps // stepping.every, len(scene.bodies), 13)
        contacts = np.array(motion.contacts, dtype=float).reshape(len(motion.contacts), 8)
        return {}, {"motion": samples, "contacts": contacts}
