"""SDF as Drake reads it, which is the reference, and as DART and PyBullet do: trees drawn at random."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.reading import Place

from .readers import Readers, same
from .test_import_usd import drawn_place

ROUNDED = 1e-13  # relative; angles become rotations, and some ten products follow
KINDS = ("revolute", "prismatic")
Held = tuple[float, Array, Array]


def angles(matrix: Array) -> Array:
    """Find roll, pitch and yaw of a rotation Rz Ry Rx."""
    return np.array(
        [
            np.arctan2(matrix[2, 1], matrix[2, 2]),
            np.arctan2(-matrix[2, 0], np.hypot(matrix[2, 1], matrix[2, 2])),
            np.arctan2(matrix[1, 0], matrix[0, 0]),
        ]
    )


def pose(place: Place, more: str = "") -> str:
    """Write a placement."""
    return f"<pose{more}>{' '.join(repr(float(x)) for x in (*place.translation, *angles(place.rotation)))}</pose>"


class Drawn:
    """A tree drawn at random, as a text and as what it holds."""

    def __init__(self, seed: int, relative: bool, chain: bool = False) -> None:
        rng = np.random.default_rng(seed)
        poses: list[Place] = []
        self.due, links, joints = [], [], []
        for k in range(int(rng.integers(2, 6))):
            parent = int(rng.integers(k - 1 if chain else 0, k)) if k else -1
            place, kind = drawn_place(rng), str(rng.choice(KINDS))
            poses.append((poses[parent] if k else Place()) @ place)
            axis, anchor, spread = rng.normal(size=3), rng.uniform(-0.3, 0.3, 3), rng.uniform(0.1, 1, 3)
            axis /= np.linalg.norm(axis)
            turn = drawn_place(rng).rotation
            inertia = (turn * (spread.sum() - spread)) @ turn.T
            held = float(rng.uniform(0.2, 3)), rng.uniform(-0.3, 0.3, 3), inertia
            self.due.append((f"b{k}", parent, kind, poses[-1], axis, anchor, held))
            where = pose(place, f' relative_to="b{parent}"') if relative and k else pose(poses[-1])
            links.append(f'<link name="b{k}">{where}{inertial(held)}</link>')
            numbers = " ".join(repr(float(x)) for x in axis)
            joints.append(
                f'<joint name="j{k}" type="{kind}"><parent>{f"b{parent}" if k else "world"}</parent><child>b{k}</child>'
                f"{pose(Place(translation=anchor))}<axis><xyz>{numbers}</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis></joint>"
            )
        version = "1.9" if relative else "1.6"
        self.text = f'<sdf version="{version}"><model name="r">{"".join(links)}{"".join(joints)}</model></sdf>'


def inertial(held: Held) -> str:
    """Write mass, centre of mass and inertia."""
    mass, com, tensor = held
    names = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), tensor[np.triu_indices(3)], strict=True)
    numbers = "".join(f"<{name}>{float(x)!r}</{name}>" for name, x in names)
    return f"<inertial>{pose(Place(translation=com))}<mass>{mass!r}</mass><inertia>{numbers}</inertia></inertial>"


@pytest.mark.parametrize(("engine", "relative"), [("drake", False), ("drake", True), ("dart", False)])
@pytest.mark.parametrize("seed", range(4))
def test_trees_are_read_as_written(readers: Readers, engine: str, relative: bool, seed: int) -> None:
    """Placements, axes, limits and inertias, with poses in the model's frame or relative to the parent's."""
    drawn = Drawn(seed, relative, chain=engine == "dart")
    read = readers.read(engine, "tree.sdf", drawn.text)
    assert read.names() == [name for name, *_ in drawn.due] or sorted(read.names()) == sorted(name for name, *_ in drawn.due)
    origins: dict[str, Place] = {}
    for name, parent, kind, world, axis, anchor, (mass, com, inertia) in sorted(drawn.due, key=lambda due: read.names().index(due[0])):
        body = read.body(name)
        joint = body["joint"]
        assert (read.bodies[body["parent"]]["name"] if body["parent"] >= 0 else None) == (f"b{parent}" if parent >= 0 else None)
        assert joint["type"] == kind
        assert [joint["lower"], joint["upper"]] == [[-1.0], [2.0]]
        assert same(joint["axis"], axis, ROUNDED)
        shift = anchor if kind == "revolute" else np.zeros(3)
        origins[name] = origins.get(f"b{parent}", Place()) @ Place.of(joint["placement"])
        assert same(origins[name].translation, (world @ Place(translation=shift)).translation, ROUNDED)
        assert same(origins[name].rotation, world.rotation, ROUNDED)
        assert same(body["mass"], mass, ROUNDED)
        assert same(body["com"], com - shift, ROUNDED)
        assert same(body["inertia"], inertia[np.triu_indices(3)], ROUNDED)


def test_dart_keeps_the_order_of_the_file(readers: Readers) -> None:
    """Links that are not depth-first are not offered: their coordinates would be others."""
    drawn = Drawn(0, relative=False)
    path, oracle = readers.file("tree.sdf", drawn.text), readers.oracles["dart"]
    answer = oracle.ask({"op": "import", "file": str(path), "format": "sdf", "base": "fixed"})[0]
    assert answer["status"] == "unsupported"
    assert "depth-first" in answer["reason"]


def test_dart_loses_the_rotation_of_an_inertial(readers: Readers) -> None:
    """The moments of a turned inertial are those of the file in DART, in the axes of the link. Drake turns them."""
    turn = rotation(np.array([0.0, 0.0, 0.6, 0.8]))
    held = "<mass>2</mass><inertia><ixx>0.3</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.4</iyy><iyz>0</iyz><izz>0.5</izz></inertia>"
    joint = '<joint name="j" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz></axis></joint>'
    text = f'<sdf version="1.6"><model name="r"><link name="a"><inertial>{pose(Place(turn))}{held}</inertial></link>{joint}</model></sdf>'
    moments = np.diag([0.3, 0.4, 0.5])
    right, lost = ((turn @ moments @ turn.T)[np.triu_indices(3)], moments[np.triu_indices(3)])
    assert same(readers.read("drake", "turned.sdf", text).bodies[0]["inertia"], right, ROUNDED)
    assert same(readers.read("dart", "turned.sdf", text).bodies[0]["inertia"], lost, ROUNDED)


def test_pybullet_does_not_read_a_joint_to_the_world(readers: Readers) -> None:
    """It is unsupported, by name; a model with a base of its own is read."""
    drawn = Drawn(0, relative=False)
    oracle = readers.oracles["pybullet"]
    request = {"op": "import", "format": "sdf", "base": "fixed"}
    answer = oracle.ask({**request, "file": str(readers.file("world.sdf", drawn.text))})[0]
    assert answer["status"] == "unsupported"
    assert "no joint of an SDF to the world" in answer["reason"]
