"""What an MJCF says that is not compared, by name.

An attribute is read, or has no part in the dynamics, only if it is listed here. All others are told. So an attribute or an element that a
later format adds is told until somebody lists it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import parsed

_PLACE = {"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"}
_SOFT = {"solref", "solimp", "solreflimit", "solimplimit", "solreffriction", "solimpfriction", "margin"}

# element → the attributes that enter the description, its loops or its keyframes
READ: dict[str, set[str]] = {
    "mujoco": {"model"},
    "worldbody": set(),
    "asset": set(),
    "default": set(),
    "equality": {"active"},
    "include": {"file"},
    "compiler": {
        *("alignfree", "angle", "assetdir", "autolimits", "balanceinertia", "boundinertia", "boundmass", "conflict", "coordinate"),
        *("discardvisual", "eulerseq", "fitaabb", "fusestatic", "inertiafromgeom", "inertiagrouprange", "meshdir", "settotalmass"),
        "strippath",
    },
    "option": {"gravity"},
    "flag": {"gravity"},
    "body": {*_PLACE, "fuse", "simple"},
    "frame": _PLACE,
    "replicate": {"count", "offset", "euler", "sep"},
    "attach": {"model", "body", "frame", "prefix"},
    "model": {"file", "content_type"},
    "inertial": {*_PLACE, "mass", "diaginertia", "fullinertia"},
    "joint": {
        *("type", "pos", "axis", "ref", "range", "limited", "armature", "damping", "frictionloss"),
        *("actuatorfrcrange", "actuatorfrclimited"),
    },
    "freejoint": {"align"},
    "geom": {*_PLACE, "type", "size", "fromto", "mass", "density", "shellinertia", "mesh", "hfield", "fitscale", "group"},
    "mesh": {
        *("file", "content_type", "scale", "inertia", "vertex", "face", "refpos", "refquat", "builtin", "params", "maxhullvert"),
        *("normal", "texcoord", "smoothnormal"),
    },
    "hfield": {"file", "content_type", "size", "nrow", "ncol", "elevation"},
    # those that are no loops are told one by one
    "equality connect": {"active", "anchor", "body1", "body2", "site1", "site2"},
    "equality weld": {"active", "anchor", "body1", "body2", "relpose", "site1", "site2"},
    "equality joint": {"active", "joint1", "joint2", "polycoef"},
    "equality tendon": {"active", "tendon1", "tendon2", "polycoef"},
    "equality flex": {"active", "flex"},
    "equality flexstrain": {"active", "flex", "cell"},
}

# the sections whose elements are told one by one
SECTIONS = {"tendon", "actuator", "contact", "deformable", "extension"}

# what an element is called by: its own name, or that of what it acts on
NAMES = ("name", "joint", "tendon", "site", "body", "geom1", "body1")

# attributes of which the first number alone is read: those after it are coefficients of higher powers
FIRST = {("joint", "damping")}

# attributes of any element that have no part in the dynamics: names, appearance, numbers for the user
NO_PART = {"name", "class", "childclass", "user", "rgba", "material", "group"}

# elements that have no part in the dynamics, with all that is in them
NO_PART_ELEMENTS = {
    # appearance
    *("visual", "texture", "material", "skin", "camera", "light", "statistic"),
    # memory, and numbers and words for the user
    *("size", "custom"),
    # a place that others may name
    "site",
    # what is measured
    "sensor",
    # states: they are the description's keyframes
    "keyframe",
    # how the range of an actuator's length is found
    "lengthrange",
}

# the same kind of thing in many attributes: what it is called, and where it is found
FAMILIES: dict[str, dict[str, set[str]]] = {
    "contact": {"geom": {"adhesion", "conaffinity", "condim", "contype", "friction", "gap", "priority", "solmix", "surfacevel", *_SOFT}},
    "how a simulation steps and solves": {
        "option": {
            *("actuatorgroupdisable", "ccd_iterations", "ccd_tolerance", "cone", "impratio", "integrator", "iterations", "jacobian"),
            *("ls_iterations", "ls_tolerance", "noslip_iterations", "noslip_tolerance", "o_friction", "o_margin", "o_solimp", "o_solref"),
            *("sdf_initpoints", "sdf_iterations", "sleep_tolerance", "solver", "timestep", "tolerance"),
        },
        "flag": {
            *("autoreset", "diagexact", "energy", "eulerdamp", "filterparent", "fwdinv", "invdiscrete", "island", "midphase", "multiccd"),
            *("nativeccd", "override", "refsafe", "sensor", "sleep", "warmstart"),
        },
        "compiler": {"usethread", "texturedir", "saveinertial", "savecompiled", "savecanonical", "passthrough"},
        "body": {"sleep"},
        "joint": _SOFT,
        **{f"equality {kind}": _SOFT for kind in ("connect", "joint", "tendon", "flex", "flexstrain")},
        "equality weld": {*_SOFT, "torquescale"},
        "equality": _SOFT,
    },
}


def not_compared(path: Path) -> list[Header]:
    """Tell what an MJCF says that no compared quantity includes.

    Parameters
    ----------
    path : Path
        The file. Files that it includes are read as well.

    Returns
    -------
    list of dict
        A note `not_compared` for each kind of thing, with the names of the elements that have it.
    """
    found: dict[str, dict[str, None]] = {}  # names in order, each once
    for kind, name in _told(parsed(path), path.parent, "", ""):
        names = found.setdefault(kind, {})
        if name:
            names[name] = None
    return [{"cause": "not_compared", "about": None, "text": kind + _few(list(names))} for kind, names in found.items()]


def _few(names: list[str]) -> str:
    """Write the first names, and how many there are."""
    more = f", … ({len(names)} in all)" if len(names) > 3 else ""
    return f" ({', '.join(names[:3])}{more})" if names else ""


def _told(element: ElementTree.Element, folder: Path, section: str, owner: str) -> Iterator[tuple[str, str]]:
    """Find what is told of an element: what it is called, and the name of the element that has it."""
    tag = element.tag
    if tag in NO_PART_ELEMENTS:
        return
    if tag == "include":
        included = folder / element.get("file", "")
        children = list(ElementTree.parse(included).getroot()) if included.is_file() else []
        for child in children:
            yield from _told(child, folder, section, owner)
        return
    name = next((element.get(key, "") for key in NAMES if element.get(key)), owner)
    if tag == "default":
        name = f"class '{element.get('class')}'" if element.get("class") else owner or "defaults"
    elif section == "default":
        name = owner
    if section in SECTIONS:
        yield f"{section} {tag}", name
        return
    key = f"equality {tag}" if section == "equality" else tag
    if key in READ:
        for attribute, value in element.attrib.items():
            if (key, attribute) in FIRST and len(value.split()) > 1:
                yield f"{key} {attribute} after its first number", name
            if attribute not in READ[key] and attribute not in NO_PART:
                family = next((kind for kind, places in FAMILIES.items() if attribute in places.get(key, ())), None)
                yield family or f"{key} {attribute}", "" if family else name
    elif tag not in SECTIONS:
        if section != "default":  # what a class says of an element that is told is told with the element
            yield tag, name
        return
    elif section == "default":
        return
    inner = tag if tag in SECTIONS or tag in ("default", "equality") and section != "default" else section
    for child in element:
        yield from _told(child, folder, inner, name)
