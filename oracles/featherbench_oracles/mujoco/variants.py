"""What an MJCF would be to a parser that reads one thing of it otherwise: hypotheses about other engines, which their numbers decide.

MuJoCo's compiler reads the file again, each time with one edit of its text: without its gravity, without all but the first body of the
world, and so on. An engine whose robot is that of a variant in all that the edit changes reads the file so. Pairs of edits are variants
too, as one parser may do both. An edit that changes nothing, and a variant that MuJoCo refuses, are left out.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import mujoco as mj
import numpy as np

from featherbench_oracles.core.algebra import skew
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Place, turned

Describe = Callable[[mj.MjSpec, mj.MjModel], Header]
Edit = Callable[[Element], None]
MOST_BODIES = 200  # of a robot that has variants: each costs a compilation
APART = ("contact", "tendon", "actuator", "equality", "sensor", "keyframe", "custom")  # names what an edit may remove, and is in no variant
POSE = ("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler")
ONE = {"pos": "0 0 0", "mass": "1", "diaginertia": "1 1 1"}  # the inertial that DART gives a body, kg and kg m²


def variants(path: Path, describe: Describe, model: mj.MjModel, reference: Header) -> list[Header]:
    """List the variants of a file.

    Parameters
    ----------
    path : Path
        An MJCF that MuJoCo compiles as it is written.
    describe : callable
        Describes a compiled model.
    model : mj.MjModel
        The file's own.
    reference : dict
        The description of the file as it is written.

    Returns
    -------
    list of dict
        Of each variant `cause`, `text` and `model`, single edits first.
    """
    if model.nbody > MOST_BODIES:
        return []
    root = _whole(path)
    for section in [child for child in root if child.tag in APART]:
        root.remove(section)
    found: list[Header] = []

    def keep(cause: str, text: str, described: Header | None, alone: bool = True) -> bool:
        if described is None or _content(described) == _content(reference):
            return False
        twin = next((other for other in found if _content(other["model"]) == _content(described)), None)
        if twin is None:
            found.append({"cause": cause, "text": text, "model": described})
        elif alone:  # this file does not tell the two apart
            twin["text"] += f", or {text}"
        return twin is None

    def read(edits: list[Edit]) -> Header | None:
        changed = copy.deepcopy(root)
        for edit in edits:
            edit(changed)
        return _compiled(changed, path, describe)

    single = [(cause, text, edit) for cause, text, edit in EDITS if keep(cause, text, read([edit]))]
    if not model.nmesh:  # meshes are read again by each compilation
        for (cause, text, edit), (_, more, other) in combinations(single, 2):
            keep(cause, f"{text}, and {more}", read([edit, other]), alone=False)
    undone = "the pose of a free body is undone by its turned-back rotation and the negative of its translation, which is not its inverse"
    keep("free_pose", undone, _undone(reference, model))
    keep("axis_length", "the axis of an axisangle in an inertial is not made a unit vector", _long_axes(reference, root))
    return found


def _content(description: Header) -> str:
    return repr((description["gravity"], description["bodies"]))


def _whole(path: Path) -> Element:
    """Parse a file with the files that it includes in their places. Those passed `examination`, so they end."""
    root = ElementTree.parse(path).getroot()
    for parent in list(root.iter()):
        for at, child in reversed(list(enumerate(list(parent)))):
            if child.tag == "include" and child.get("file"):
                parent.remove(child)
                for k, inner in enumerate(_whole(path.parent / str(child.get("file")))):
                    parent.insert(at + k, inner)
    return root


def _compiled(root: Element, path: Path, describe: Describe) -> Header | None:
    """Compile and describe a variant, if MuJoCo accepts it."""
    try:
        spec = mj.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
        spec.modelfiledir = str(path.parent)
        return describe(spec, spec.compile())
    except ValueError:
        return None


# ---- edits -----------------------------------------------------------------------------------------------------------------------


def _without(tag: str, *keys: str) -> Edit:
    """Remove attributes of a tag, or the elements themselves if none is named."""

    def edit(root: Element) -> None:
        for parent in list(root.iter()):
            for child in [child for child in parent if child.tag == tag]:
                if not keys:
                    parent.remove(child)
                for key in keys:
                    child.attrib.pop(key, None)

    return edit


def _settings(key: str, change: Callable[[str], str]) -> Edit:
    """Change a setting of the compiler."""

    def edit(root: Element) -> None:
        for compiler in root.iter("compiler"):
            if key in compiler.attrib:
                compiler.set(key, change(compiler.attrib[key]))

    return edit


def _radians(root: Element) -> None:
    """Take all angles as radians."""
    compiler = Element("compiler", {"angle": "radian"})
    for other in root.iter("compiler"):
        other.attrib.pop("angle", None)
    root.insert(0, compiler)


def _first_compiler(root: Element) -> None:
    """Keep the first element with settings of the compiler."""
    for other in list(root.iter("compiler"))[1:]:
        other.attrib.clear()


def _top(root: Element) -> Iterator[tuple[Element, Element]]:
    """List the bodies of the world."""
    for world in root.iter("worldbody"):
        for body in [child for child in world if child.tag == "body"]:
            yield world, body


def _first_tree(root: Element) -> None:
    """Keep the first body of the world."""
    for world, body in list(_top(root))[1:]:
        world.remove(body)


def _standing(root: Element) -> None:
    """Put bodies that are fixed to the world at its origin."""
    for _, body in _top(root):
        if not any(child.tag in ("joint", "freejoint") for child in body):
            for key in POSE:
                body.attrib.pop(key, None)


def _empty_classes(root: Element) -> None:
    """Empty all default classes but the outermost."""
    outer = [child for child in root if child.tag == "default"]
    for default in [inner for top in outer for inner in top.iter("default") if inner is not top]:
        for child in [child for child in default if child.tag != "default"]:
            default.remove(child)


def _empty_defaults(root: Element) -> None:
    """Empty all default classes."""
    for default in [inner for top in root if top.tag == "default" for inner in top.iter("default")]:
        for child in [child for child in default if child.tag != "default"]:
            default.remove(child)


def _class_masses(root: Element) -> None:
    """Take no mass and no density from default classes."""
    for default in [inner for top in root if top.tag == "default" for inner in top.iter("default")]:
        for geom in default.findall("geom"):
            geom.attrib.pop("mass", None)
            geom.attrib.pop("density", None)


def _unit_inertials(bare: bool) -> Edit:
    """Give bodies, or those without geoms, one kilogram and one kg m²."""

    def edit(root: Element) -> None:
        for body in list(root.iter("body")):
            if bare and body.find("geom") is not None:
                continue
            for inertial in body.findall("inertial"):
                body.remove(inertial)
            body.insert(0, Element("inertial", ONE))

    return edit


EDITS: tuple[tuple[str, str, Edit], ...] = (
    ("gravity_ignored", "the gravity of <option> is not read", _without("option", "gravity")),
    ("gravity_ignored", "the flag that turns gravity off is not read", _without("flag", "gravity")),
    ("total_mass", "settotalmass is not read", _without("compiler", "settotalmass")),
    ("first_tree", "only the first body of the world is read", _first_tree),
    ("frame_skipped", "a <frame> is skipped with all that is in it", _without("frame")),
    ("world_pose", "the pose of a body that is fixed to the world is not read", _standing),
    ("inertia_groups", "inertiagrouprange is not read: geoms of all groups count", _without("compiler", "inertiagrouprange")),
    ("joint_ref", "the ref of joints is not read", _without("joint", "ref")),
    ("shell", "shellinertia is not read: the solid is taken", _without("geom", "shellinertia")),
    ("nested_classes", "nested default classes are not read", _empty_classes),
    ("defaults", "default classes are not read", _empty_defaults),
    ("class_mass", "the mass and density of geoms in default classes are not read", _class_masses),
    ("childclass", "childclass is not read", _without("body", "childclass")),
    ("inertial_ignored", "inertials are not read: geoms give the mass", _without("inertial")),
    ("default_inertia", "every body has the engine's own 1 kg and 1 kg·m²", _unit_inertials(bare=False)),
    ("default_inertia", "bodies without geoms have the engine's own 1 kg and 1 kg·m²", _unit_inertials(bare=True)),
    ("first_compiler", "only the first <compiler> is read", _first_compiler),
    ("euler_sequence", "eulerseq is not read: the sequence is xyz", _without("compiler", "eulerseq")),
    ("euler_sequence", "the letters of eulerseq are all read as small ones", _settings("eulerseq", str.lower)),
    ("euler_sequence", "the letters of eulerseq are all read as capitals", _settings("eulerseq", str.upper)),
    ("degrees", "degrees are read as radians", _radians),
)


# ---- variants that MuJoCo cannot compile --------------------------------------------------------------------------------------------


def _undone(reference: Header, model: mj.MjModel) -> Header | None:
    """Describe free bodies on the placement (R, p)(R', -p) = (1, p - R p), where a parser undoes their pose (R, p) by no inverse of it."""
    placed = copy.deepcopy(reference)
    names = {model.body(i).name or f"body {i}": i for i in range(1, model.nbody)}
    for body in placed["bodies"]:
        i = names.get(body["name"])
        if body["joint"]["type"] == "free" and i is not None:
            p = model.body_pos[i].copy()
            body["joint"]["placement"] = Place(translation=p - turned(*model.body_quat[i]) @ p).json()
    return placed


def _long_axes(reference: Header, root: Element) -> Header | None:
    """Describe bodies whose inertial has an axis of another length than one, used in Rodrigues' formula as it is."""
    changed = copy.deepcopy(reference)
    bodies = {body["name"]: body for body in changed["bodies"]}
    unit = math.pi / 180 if all(compiler.get("angle", "degree") == "degree" for compiler in root.iter("compiler")) else 1.0
    for element in root.iter("body"):
        inertial, held = element.find("inertial"), bodies.get(element.get("name", ""))
        if inertial is None or held is None or "axisangle" not in inertial.attrib:
            continue
        try:
            *numbers, angle = (float(x) for x in inertial.attrib["axisangle"].split())
            moments = np.array([float(x) for x in inertial.attrib["diaginertia"].split()])
        except (KeyError, ValueError):
            continue
        axis, angle = np.array(numbers), angle * unit
        spun = math.cos(angle) * np.eye(3) + math.sin(angle) * skew(axis) + (1 - math.cos(angle)) * np.outer(axis, axis)
        held["inertia"] = ((spun * moments) @ spun.T)[np.triu_indices(3)].tolist()
    return changed
