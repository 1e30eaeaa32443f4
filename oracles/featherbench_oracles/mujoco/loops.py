"""Equality constraints of a compiled MJCF as the `loops` of a description (PROTOCOL.md, "The file as read").

The compiler has resolved names, defaults and reference configurations: `eq_data` holds numbers. A constraint that is switched off at the
start, or of a kind that descriptions do not have, is told and left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import mujoco as mj
import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Place, note, turned

JOINT = {mj.mjtEq.mjEQ_CONNECT: "spherical", mj.mjtEq.mjEQ_WELD: "fixed"}  # the loop's type
KINDS = {mj.mjtEq.mjEQ_TENDON: "tendon", mj.mjtEq.mjEQ_FLEX: "flex"}  # in a note


def loops(model: mj.MjModel, names: Sequence[str], description: Header, notes: list[Header]) -> list[Header]:
    """List the equality constraints of a model.

    Parameters
    ----------
    model : mj.MjModel
        The model.
    names : sequence of str
        The names of the model's bodies, that of the world first.
    description : dict
        The description of the same model, with frames for bodies that are not where their description's body is.
    notes : list of dict
        Gets a note for each constraint that is left out.

    Returns
    -------
    list of dict
        The loops of the description.
    """
    found = []
    for k in range(model.neq):
        name = model.equality(k).name or f"equality {k}"
        kind = mj.mjtEq(model.eq_type[k])
        why = None
        if not model.eq_active0[k]:
            why = "is switched off at the start"
        elif kind in JOINT:
            joint = _joint(model, k, name, kind, names, description)
            if joint["first"]["body"] == joint["second"]["body"]:
                why = "ties bodies that are fixed to each other"
            else:
                found.append(joint)
        elif kind == mj.mjtEq.mjEQ_JOINT and model.eq_obj2id[k] >= 0:
            found.append(_mimic(model, k, name, description))
        elif kind == mj.mjtEq.mjEQ_JOINT:
            why = "holds one joint at a number"
        else:
            why = f"is of the kind {KINDS.get(kind, kind.name)}"
        if why:
            notes.append(note("not_compared", None, f"the equality constraint {name} {why}, and is no loop of the description"))
    return found


def _joint(model: mj.MjModel, k: int, name: str, kind: mj.mjtEq, names: Sequence[str], description: Header) -> Header:
    """Describe a `connect` or `weld`: two frames that coincide.

    Between bodies, `eq_data` of a `connect` has the point in body 1 and the one in body 2. That of a `weld` has the point in body 2, the
    point in body 1, and the quaternion of body 2's axes in body 1.
    """
    ids = (int(model.eq_obj1id[k]), int(model.eq_obj2id[k]))
    data = model.eq_data[k]
    if model.eq_objtype[k] == mj.mjtObj.mjOBJ_SITE:
        bodies = tuple(int(model.site_bodyid[i]) for i in ids)
        places = tuple(Place(turned(*model.site_quat[i]), model.site_pos[i].copy()) for i in ids)
    elif kind == mj.mjtEq.mjEQ_CONNECT:
        bodies, places = ids, (Place(translation=data[0:3].copy()), Place(translation=data[3:6].copy()))
    else:
        bodies, places = ids, (Place(turned(*data[6:10]), data[3:6].copy()), Place(translation=data[0:3].copy()))
    ends = [_end(names[body] if body else None, place, description) for body, place in zip(bodies, places, strict=True)]
    return {"name": name, "type": JOINT[kind], "first": ends[0], "second": ends[1]}


def _end(body: str | None, place: Place, description: Header) -> Header:
    """Describe a frame on a body of the model, or in the world, as one on the description's body."""
    home, on_home = -1, Place()
    if body is not None:
        home = next((i for i, item in enumerate(description["bodies"]) if item["name"] == body), -1)
        for frame in description["frames"]:  # a frame of the body's name says where the body is
            if frame["name"] == body:
                home, on_home = frame["body"], Place.of(frame["placement"])
    # without a product where the frames agree, so that numbers are kept to the bit
    return {"body": home, "placement": (place if on_home.identical() else on_home @ place).json()}


def _mimic(model: mj.MjModel, k: int, name: str, description: Header) -> Header:
    """Describe a joint that follows another: q1 - ref1 = p(q2 - ref2), with the references of `qpos0`."""
    joints = [int(model.eq_obj1id[k]), int(model.eq_obj2id[k])]
    follower, leader = (_body_of(model.joint(j).name or f"joint {j}", description) for j in joints)
    own, other = (float(model.qpos0[model.jnt_qposadr[j]]) for j in joints)
    polynomial = _shifted(model.eq_data[k, :5], other)
    polynomial[0] += own
    return {"name": name, "type": "mimic", "follower": follower, "leader": leader, "polynomial": (polynomial + 0.0).tolist()}


def _body_of(joint: str, description: Header) -> int:
    """Find the body that a joint carries."""
    return next(i for i, body in enumerate(description["bodies"]) if body["joint"]["name"] == joint)


def _shifted(coefficients: Array, by: float) -> Array:
    """Expand p(x - by) in powers of x."""
    count = len(coefficients)
    powers = [[comb(n, k) * (-by) ** (n - k) if n >= k else 0.0 for n in range(count)] for k in range(count)]
    return np.array([float(np.dot(row, coefficients)) for row in powers])
