"""USD as OpenUSD reads it, and as Newton does: trees drawn at random, written in any units, with joints either way round."""

from __future__ import annotations

from math import degrees

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Place
from featherbench_oracles.testing.measures import within

from .readers import Read, Readers, same

SINGLE = 1e-6  # relative; the schemas' numbers are single, and a product of placements rounds some ten times
HEAD = '#usda 1.0\n(\n    defaultPrim = "r"\n    {units}\n    upAxis = "Z"\n)\n'
BODY = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]


class Writer:
    """Writes a stage."""

    def __init__(self, length: float = 1.0, mass: float = 1.0) -> None:
        self.length, self.mass = length, mass
        self.text = (
            HEAD.format(units=f"metersPerUnit = {length!r}\n    kilogramsPerUnit = {mass!r}")
            + 'def Xform "r" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])\n{\n'
        )

    def prim(self, kind: str, name: str, schemas: list[str], *lines: str) -> None:
        """Write a prim."""
        applied = ", ".join(f'"{schema}"' for schema in schemas)
        self.text += f'def {kind} "{name}" (prepend apiSchemas = [{applied}])\n{{\n' + "\n".join(lines) + "\n}\n"

    def done(self) -> str:
        """Close the default prim."""
        return self.text + "}\n"

    def body(self, name: str, place: Place, held: tuple[float, Array, Array, Array], *more: str) -> None:
        """Write a body with mass, centre of mass, moments and the quaternion of their axes (x, y, z, w)."""
        mass, com, moments, axes = held
        lines = (
            f"double3 xformOp:translate = {numbers(place.translation / self.length)}",
            f"quatd xformOp:orient = {wxyz(quaternion(place.rotation))}",
            'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]',
            f"float physics:mass = {float(mass / self.mass)!r}",
            f"point3f physics:centerOfMass = {numbers(com / self.length)}",
            f"float3 physics:diagonalInertia = {numbers(moments / self.mass / self.length**2)}",
            f"quatf physics:principalAxes = {wxyz(axes)}",
        )
        self.prim("Xform", name, BODY, *lines, *more)

    def joint(self, kind: str, name: str, ends: tuple[str, str], places: tuple[Place, Place], *more: str) -> None:
        """Write a joint; the name of the world is empty."""
        lines = [f"rel physics:body{k} = </r/{end}>" for k, end in enumerate(ends) if end]
        for k, place in enumerate(places):
            lines += [f"point3f physics:localPos{k} = {numbers(place.translation / self.length)}"]
            lines += [f"quatf physics:localRot{k} = {wxyz(quaternion(place.rotation))}"]
        self.prim(f"Physics{kind}Joint", name, ["NewtonJointAPI"], *lines, *more)


def numbers(given: Array) -> str:
    """Write a tuple."""
    return "(" + ", ".join(repr(float(x)) for x in given) + ")"


def wxyz(xyzw: Array) -> str:
    """Write a quaternion."""
    return numbers(np.roll(xyzw, 1))


def quaternion(matrix: Array) -> Array:
    """Find the quaternion (x, y, z, w): an eigenvector of the largest eigenvalue."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    k = [[a - e - i, b + d, c + g, h - f], [0, e - a - i, f + h, c - g], [0, 0, i - a - e, d - b], [0, 0, 0, a + e + i]]
    return np.array(np.linalg.eigh(np.array(k), UPLO="U")[1][:, -1])


def drawn_place(rng: np.random.Generator) -> Place:
    """Draw a placement."""
    turn = rng.normal(size=4)
    return Place(rotation(turn / np.linalg.norm(turn)), rng.uniform(-1, 1, 3))


class Drawn:
    """A tree drawn at random, as a text and as what it holds."""

    def __init__(self, seed: int, plain: bool) -> None:
        rng = np.random.default_rng(seed)
        writer = Writer() if plain else Writer(float(rng.choice([1.0, 0.01, 0.0254])), float(rng.choice([1.0, 0.001])))
        poses, self.due = [Place()], []
        bodies: list[tuple[str, Place, tuple[float, Array, Array, Array]]] = []
        joints = []
        for k in range(int(rng.integers(2, 7))):
            parent = int(rng.integers(0 if plain else -1, k)) if k else -1
            inner, outer, kind = drawn_place(rng), drawn_place(rng), str(rng.choice(["Revolute", "Prismatic"]))
            place = outer @ inner.inverse()
            poses.append(poses[parent + 1] @ place)
            spread, turn = rng.uniform(0.1, 1, 3), rng.normal(size=4)
            moments, axes = spread.sum() - spread, turn / np.linalg.norm(turn)
            held = float(rng.uniform(0.2, 3)), rng.uniform(-0.3, 0.3, 3), moments, axes
            bodies.append((f"b{k}", poses[-1], held))
            token, backwards = int(rng.integers(3)), bool(rng.integers(2)) and parent >= 0 and not plain
            low, high = sorted(rng.uniform(-2, 2, 2))
            unit = degrees(1) if kind == "Revolute" else 1 / writer.length
            lines = [f'uniform token physics:axis = "{"XYZ"[token]}"']
            lines += [f"float physics:lowerLimit = {float(low * unit)!r}", f"float physics:upperLimit = {float(high * unit)!r}"]
            ends, places = (f"b{parent}" if parent >= 0 else "", f"b{k}"), (outer, inner)
            joints.append((kind, f"j{k}", ends[::-1] if backwards else ends, places[::-1] if backwards else places, *lines))
            axis = inner.rotation[:, token] * (-1 if backwards else 1)
            self.due.append(
                (f"b{k}", parent, kind.lower(), place, axis, inner.translation, held, (-high, -low) if backwards else (low, high))
            )
        for k in rng.permutation(len(bodies)):
            writer.body(*bodies[k])
        for k in rng.permutation(len(joints)):
            writer.joint(*joints[k])
        self.text = writer.done()

    def check(self, read: Read) -> None:
        """Compare what was read, as far as descriptions leave no choice."""
        assert sorted(read.names()) == sorted(name for name, *_ in self.due)
        poses: dict[str, Place] = {}  # of each link in the world, at zero
        origins: dict[str, Place] = {}  # of each body
        for name, parent, kind, place, axis, anchor, (mass, com, moments, axes), limits in self.due:
            body = read.body(name)
            joint = body["joint"]
            above = body["parent"]
            assert (read.bodies[above]["name"] if above >= 0 else None) == (f"b{parent}" if parent >= 0 else None)
            assert joint["type"] == kind
            assert same(joint["axis"], axis, SINGLE)
            assert same([joint["lower"][0], joint["upper"][0]], limits, SINGLE)
            shift = np.zeros(3) if kind == "prismatic" else anchor  # of the body's origin in the link's axes
            poses[name] = poses.get(f"b{parent}", Place()) @ place
            held = Place.of(joint["placement"])
            origin = poses[name] @ Place(translation=shift)
            above_origin = origins[f"b{parent}"] if parent >= 0 else Place()
            world = above_origin @ held
            origins[name] = world
            assert same(world.translation, origin.translation, SINGLE)
            assert same(world.rotation, origin.rotation, SINGLE)
            turn = rotation(axes)
            inertia = (turn * moments) @ turn.T
            assert same(body["mass"], mass, SINGLE)
            assert same(body["com"], com - shift, SINGLE)
            assert same(body["inertia"], inertia[np.triu_indices(3)], SINGLE)


@pytest.mark.parametrize("engine", ["openusd", "newton"])
@pytest.mark.parametrize("seed", range(6))
def test_trees_in_any_units(readers: Readers, engine: str, seed: int) -> None:
    """Bodies, axes, limits and inertias are those that were written, in SI units. Newton gets one tree in these, its joints forwards."""
    drawn = Drawn(seed, plain=engine == "newton")
    drawn.check(readers.read(engine, "tree.usda", drawn.text, replay=False))


def one(*lines: str, schemas: list[str] = BODY, more: str = "") -> str:
    """Write a stage with one body."""
    writer = Writer()
    writer.prim("Xform", "a", schemas, *lines)
    return writer.done() + more


def noted(read: Read, word: str) -> list[Header]:
    """List the notes with a word in them."""
    return [note for note in read.header["notes"] if word in note["text"]]


def test_shapes_give_what_is_not_said(readers: Readers) -> None:
    """A cube of 2 m of the density 3, moved: its mass, centre and inertia, by way of OpenUSD."""
    cube = 'def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n{\ndouble size = 2\ndouble3 xformOp:translate = (1, 2, 3)\n'
    cube += 'uniform token[] xformOpOrder = ["xformOp:translate"]\n}'
    read = readers.read("openusd", "cube.usda", one("float physics:density = 3", cube), replay=False)
    body = read.bodies[0]
    assert same([body["mass"], *body["com"], *body["inertia"]], [24, 1, 2, 3, 16, 0, 0, 16, 0, 16], SINGLE)
    assert "from_geometry" in read.causes()


def test_a_body_without_numbers_has_none(readers: Readers) -> None:
    """Neither a mass nor a shape: a mass of zero, and no number that OpenUSD left uninitialised."""
    body = readers.read("openusd", "empty.usda", one(schemas=BODY[:1]), replay=False).bodies[0]
    assert body["mass"] == 0
    assert body["inertia"] == [0.0] * 6


def test_bodies_float_unless_something_holds_them(readers: Readers) -> None:
    """A body without a joint is on a free joint; a kinematic one stands, and is told."""
    mass = "float physics:mass = 2", "float3 physics:diagonalInertia = (1, 1, 1)", "point3f physics:centerOfMass = (0, 0, 0)"
    assert readers.read("openusd", "free.usda", one(*mass), replay=False).bodies[0]["joint"]["type"] == "free"
    read = readers.read("openusd", "still.usda", one(*mass, "bool physics:kinematicEnabled = 1"), replay=False)
    assert not read.bodies
    assert "root_welded" in read.causes()


def test_loops_and_disabled_joints_are_told(readers: Readers) -> None:
    """A joint that closes a loop, one that is disabled, and one that is not of the articulation are no part of the tree."""
    writer, here = Writer(), (Place(), Place())
    held = 1.0, np.zeros(3), np.ones(3), np.array([0.0, 0.0, 0.0, 1.0])
    for name in "abc":
        writer.body(name, Place(), held)
    for k, ends in enumerate([("", "a"), ("a", "b"), ("b", "c"), ("a", "c")]):
        writer.joint("Revolute", f"j{k}", ends, here)
    writer.joint("Revolute", "off", ("", "b"), here, "bool physics:jointEnabled = 0")
    writer.joint("Spherical", "beside", ("", "c"), here, "bool physics:excludeFromArticulation = 1")
    read = readers.read("openusd", "loop.usda", writer.done(), replay=False)
    assert read.names() == ["a", "b", "c"] or read.names() == ["a", "c", "b"]
    told = [note["text"] for note in read.header["notes"] if note["cause"] == "not_compared"]
    assert sum("closes a loop" in text for text in told) == 1
    assert any("off is disabled" in text for text in told)
    assert any("beside is not of the articulation" in text for text in told)


def test_variants_and_missing_files_are_told(readers: Readers) -> None:
    """A variant set with its selection, and a reference to a file that is not there."""
    more = 'def "m" (prepend references = @nowhere.usda@\nvariants = { string size = "big" }\nprepend variantSets = "size")\n'
    more += '{\nvariantSet "size" = {\n"big" {\n}\n"small" {\n}\n}\n}\n'
    read = readers.read("openusd", "variants.usda", one("float physics:mass = 1", more=more), replay=False)
    assert noted(read, "the variant big of size (big, small)")
    assert noted(read, "nowhere.usda")


@pytest.mark.parametrize("axis", [("Y", [0.0, -9.81, 0.0]), ("Z", [0.0, 0.0, -9.81])])
def test_gravity_is_that_of_the_scene(readers: Readers, axis: tuple[str, list[float]]) -> None:
    """Down by the stage's axis, unless a scene says a direction and a magnitude, in units of the stage."""
    token, due = axis
    text = (
        one("float physics:mass = 1").replace('upAxis = "Z"', f'upAxis = "{token}"').replace("metersPerUnit = 1.0", "metersPerUnit = 0.01")
    )
    assert same(readers.read("openusd", "up.usda", text, replay=False).header["model"]["gravity"], due)
    scene = 'def PhysicsScene "s"\n{\nvector3f physics:gravityDirection = (0, 3, 4)\nfloat physics:gravityMagnitude = 200\n}\n'
    gravity = readers.read("openusd", "scene.usda", text + scene, replay=False).header["model"]["gravity"]
    assert same(gravity, [0, 1.2, 1.6], SINGLE)


@pytest.mark.parametrize("text", ["", "#usda 1.0\n{", "PXR-USDC" + "\0" * 80, '#usda 1.0\ndef Xform "a"\n{\n}\n'])
def test_what_is_no_robot_is_an_error(readers: Readers, text: str) -> None:
    """An error with a reason, after which the oracle goes on."""
    oracle, path = readers.oracles["openusd"], readers.file("bad.usda", text)
    answer = oracle.ask({"op": "import", "file": str(path), "format": "usd", "base": "fixed"})[0]
    assert answer["status"] == "error"
    assert answer["reason"]
    readers.read("openusd", "good.usda", one("float physics:mass = 1"), replay=False)
    assert within(SINGLE) > 0
