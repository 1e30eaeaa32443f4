"""What an MJCF would be to a parser that reads one thing of it otherwise: hypotheses about other engines, which their numbers decide.

MuJoCo's compiler reads the file again, each time with one edit of its text: without its gravity, without all but the first body of the
world, and so on. An engine whose robot is that of a variant in all that the edit changes reads the file so. Pairs and triples of edits are
variants too, as one parser may do several. An edit that changes nothing, and a variant that MuJoCo refuses, are left out.
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

from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Place, turned

Describe = Callable[[mj.MjSpec, mj.MjModel], Header]
Edit = Callable[[Element], None]
MOST_BODIES = 200  # of a robot that has variants: each costs a compilation
MOST_OF_THREE = 40  # of a robot that has variants of three edits: 203 of a dog with 60 bodies took 116 s
MASSLESS = "mass and inertia of moving bodies must be larger than mjMINVAL"  # MuJoCo's own words
OF_DART = ("freejoint_ignored", "inertial_frame", "first_geoms")  # with its own inertias, four edits by one parser
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
        Of each variant `cause`, `text`, `edits` and `model`, single edits first.
    """
    if model.nbody > MOST_BODIES:
        return []
    root = _whole(path)
    for section in [child for child in root if child.tag in APART]:
        root.remove(section)
    _without_looks(root)
    found: dict[str, Header] = {}  # by their content
    unchanged = _content(reference)

    def keep(cause: str, text: str, described: Header | None, edits: int = 1) -> bool:
        if described is None or (content := _content(described)) == unchanged:
            return False
        twin = found.get(content)
        if twin is None:
            found[content] = {"cause": cause, "text": text, "edits": edits, "model": described}
        elif edits == 1:  # this file does not tell the two apart
            twin["text"] += f", or {text}"
        return twin is None

    def read(edits: list[Edit]) -> Header | None:
        changed = copy.deepcopy(root)
        try:
            for edit in edits:
                edit(changed)
            return describe(*_compiled(changed, path))
        except ValueError:  # MuJoCo does not accept it
            return None

    last = ("default_inertia", "every body has the engine's own 1 kg·m² about its centre of mass", _own_inertias(path))
    single = [(cause, text, edit) for cause, text, edit in (*EDITS, last) if keep(cause, text, read([edit]))]
    undone = "the pose of a free body is undone by its turned-back rotation and the negative of its translation, which is not its inverse"
    keep("free_pose", undone, _placed(reference, model, lambda rotation, p: (np.eye(3), p - rotation @ p)))
    kept = "the pose of a free body is the place of its joint"
    keep("free_pose", kept, _placed(reference, model, lambda rotation, p: (rotation, p)))
    keep("axis_length", "the axis of an axisangle in an inertial is not made a unit vector", _long_axes(reference, root))
    several = [chosen for count in ((2, 3) if model.nbody <= MOST_OF_THREE else (2,)) for chosen in combinations(single, count)]
    of_dart = tuple(one for one in single if one[0] in OF_DART or one[2] is last[2])
    for chosen in [*several, *([of_dart] if len(of_dart) > len(OF_DART) else [])]:
        keep(chosen[0][0], ", and ".join(text for _, text, _ in chosen), read([edit for _, _, edit in chosen]), len(chosen))
    return list(found.values())


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


def _without_looks(root: Element) -> None:
    """Remove textures and what shows them: MuJoCo paints them again for each variant, and they are in no dynamics."""
    for tag in ("texture", "material", "skin"):
        _without(tag)(root)
    for element in root.iter():
        element.attrib.pop("material", None)


def _read(root: Element, path: Path) -> mj.MjSpec:
    """Let MuJoCo read a variant."""
    spec = mj.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.modelfiledir = str(path.parent)
    return spec


def _compiled(root: Element, path: Path) -> tuple[mj.MjSpec, mj.MjModel]:
    """Compile a variant. MuJoCo refuses moving bodies without mass, which others accept: inertias are then those of fixed bodies."""
    spec = _read(root, path)
    try:
        return spec, spec.compile()
    except ValueError as error:
        if MASSLESS not in str(error):
            raise
    moving, fixed = _read(root, path), _read(root, path)
    moving.compiler.boundmass = moving.compiler.boundinertia = 1
    moving.compiler.balanceinertia = True
    for joint in list(fixed.joints):
        fixed.delete(joint)
    model, exact = moving.compile(), fixed.compile()
    if model.nbody != exact.nbody:  # the file has MuJoCo fuse fixed bodies
        raise ValueError("a moving body has no mass")
    for key in ("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_sameframe"):
        getattr(model, key)[:] = getattr(exact, key)
    return moving, model


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


def _without_in_classes(tag: str, *keys: str) -> Edit:
    """Take these attributes of a tag from no default class."""

    def edit(root: Element) -> None:
        for default in [inner for top in root if top.tag == "default" for inner in top.iter("default")]:
            for child in default.findall(tag):
                for key in keys:
                    child.attrib.pop(key, None)

    return edit


def _unit_inertials(bare: bool) -> Edit:
    """Give bodies, or those without geoms, one kilogram and one kg m²."""

    def edit(root: Element) -> None:
        _without("compiler", "inertiafromgeom")(root)
        for body in list(root.iter("body")):
            if bare and body.find("geom") is not None:
                continue
            for inertial in body.findall("inertial"):
                body.remove(inertial)
            body.insert(0, Element("inertial", ONE))

    return edit


def _own_inertias(path: Path) -> Edit:
    """Give bodies the mass and centre of mass that they have, and one kg m² about it. It is the last edit of several."""

    def edit(root: Element) -> None:
        _, model = _compiled(root, path)
        bodies = [body for world in root.iter("worldbody") for body in world.iter("body")]
        if len(bodies) != model.nbody - 1:  # bodies that are made by other elements have no places here
            return
        _without("compiler", "inertiafromgeom")(root)
        for i, body in enumerate(bodies, 1):
            for inertial in body.findall("inertial"):
                body.remove(inertial)
            if model.body_mass[i] > 0 or body.find("geom") is not None:
                pos = " ".join(f"{x:.17g}" for x in model.body_ipos[i])
                body.insert(0, Element("inertial", {"pos": pos, "mass": f"{model.body_mass[i]:.17g}", "diaginertia": "1 1 1"}))

    return edit


def _first_geoms(root: Element) -> None:
    """Keep the first geom of each body."""
    for body in root.iter("body"):
        for geom in body.findall("geom")[1:]:
            body.remove(geom)


def _geoms(root: Element) -> list[tuple[Element, Element, dict[str, str]]]:
    """List the geoms of bodies: parent, geom, its attributes with those of its default classes."""
    defaults: dict[str, dict[str, str]] = {}
    found: list[tuple[Element, Element, dict[str, str]]] = []

    def gather(default: Element, inherited: dict[str, str]) -> None:
        own = dict(inherited)
        for geom in default.findall("geom"):
            own |= geom.attrib
        defaults[default.get("class", "main")] = own
        defaults.setdefault("main", own)
        for inner in default.findall("default"):
            gather(inner, own)

    def walk(parent: Element, named: str) -> None:
        for child in parent:
            if child.tag == "geom":
                found.append((parent, child, defaults.get(child.get("class", named), {}) | child.attrib))
            else:
                walk(child, child.get("childclass", named))

    for default in root.findall("default"):
        gather(default, defaults.get("main", {}))
    for world in root.iter("worldbody"):
        walk(world, "main")
    return found


def _inertial_frames(root: Element) -> None:
    """Put bodies without pos where their inertial is, or else their first geom. MuJoCo once read files so."""
    geoms = _geoms(root)
    for body in list(root.iter("body")):
        if "pos" in body.attrib:
            continue
        inertial = body.find("inertial")
        place = inertial.attrib if inertial is not None else next((held for parent, _, held in geoms if parent is body), {})
        for key in POSE:
            body.attrib.pop(key, None)
        body.attrib |= {key: place[key] for key in POSE if key in place}
        if "fromto" in place and inertial is None:
            ends = np.array([float(x) for x in place["fromto"].split()]).reshape(2, 3)
            middle, along = (" ".join(f"{x:.17g}" for x in vector) for vector in (ends.mean(axis=0), ends[1] - ends[0]))
            body.attrib |= {"pos": middle, "zaxis": along}


def _unseen_geoms(root: Element) -> None:
    """Remove geoms that collide with nothing, by themselves or by their default class."""
    for parent, geom, held in _geoms(root):
        if all(held.get(key, "1") == "0" for key in ("contype", "conaffinity")):
            parent.remove(geom)


def _unit_meshes(root: Element) -> None:
    """Take for each mesh the sphere of one kilogram and one kg m²: 2/5 m r² is one."""
    for _, geom, held in _geoms(root):
        if held.get("type") == "mesh":
            geom.attrib.pop("mesh", None)
            geom.attrib |= {"type": "sphere", "size": f"{math.sqrt(2.5):.17g}", "mass": "1", "shellinertia": "false"}
        elif "mesh" in held:  # a shape that is fitted to a mesh
            geom.set("mesh", held["mesh"])
    _without_in_classes("geom", "mesh")(root)


EDITS: tuple[tuple[str, str, Edit], ...] = (
    ("gravity_ignored", "the gravity of <option> is not read", _without("option", "gravity")),
    ("gravity_ignored", "the flag that turns gravity off is not read", _without("flag", "gravity")),
    ("total_mass", "settotalmass is not read", _without("compiler", "settotalmass")),
    ("first_tree", "only the first body of the world is read", _first_tree),
    ("freejoint_ignored", "<freejoint> is not read: the body is fixed", _without("freejoint")),
    ("frame_skipped", "a <frame> is skipped with all that is in it", _without("frame")),
    ("world_pose", "the pose of a body that is fixed to the world is not read", _standing),
    ("inertia_groups", "inertiagrouprange is not read: geoms of all groups count", _without("compiler", "inertiagrouprange")),
    ("joint_ref", "the ref of joints is not read", _without("joint", "ref")),
    ("shell", "shellinertia is not read: the solid is taken", _without("geom", "shellinertia")),
    ("nested_classes", "nested default classes are not read", _empty_classes),
    ("defaults", "default classes are not read", _empty_defaults),
    ("classes", "the mass of geoms in default classes is not read", _without_in_classes("geom", "mass")),
    ("classes", "the mass and density of geoms in default classes are not read", _without_in_classes("geom", "mass", "density")),
    ("classes", "the pos of joints in default classes is not read", _without_in_classes("joint", "pos")),
    ("childclass", "childclass is not read", _without("body", "childclass")),
    ("inertial_ignored", "inertials are not read: geoms give the mass", _without("inertial")),
    ("default_inertia", "every body has the engine's own 1 kg and 1 kg·m²", _unit_inertials(bare=False)),
    ("default_inertia", "bodies without geoms have the engine's own 1 kg and 1 kg·m²", _unit_inertials(bare=True)),
    ("inertial_frame", "a body without pos stands where its inertial is, or else its first geom", _inertial_frames),
    ("first_geoms", "only the first geom of a body has mass", _first_geoms),
    ("default_inertia", "every mesh has the engine's own 1 kg and 1 kg·m² at the place of its geom", _unit_meshes),
    ("unseen_geoms", "geoms that collide with nothing have no mass", _unseen_geoms),
    ("first_compiler", "only the first <compiler> is read", _first_compiler),
    ("euler_sequence", "eulerseq is not read: the sequence is xyz", _without("compiler", "eulerseq")),
    ("euler_sequence", "the letters of eulerseq are all read as small ones", _settings("eulerseq", str.lower)),
    ("euler_sequence", "the letters of eulerseq are all read as capitals", _settings("eulerseq", str.upper)),
    ("degrees", "degrees are read as radians", _radians),
)


# ---- variants that MuJoCo cannot compile --------------------------------------------------------------------------------------------


def _placed(reference: Header, model: mj.MjModel, of: Callable[[Array, Array], tuple[Array, Array]]) -> Header:
    """Describe free bodies on another placement than none, made of their pose (R, p): a parser may undo it by what is not its inverse."""
    placed = copy.deepcopy(reference)
    names = {model.body(i).name or f"body {i}": i for i in range(1, model.nbody)}
    for body in placed["bodies"]:
        i = names.get(body["name"])
        if body["joint"]["type"] == "free" and i is not None:
            body["joint"]["placement"] = Place(*of(turned(*model.body_quat[i]), model.body_pos[i].copy())).json()
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
