"""Drake's own parser: `Parser` on a continuous plant without a scene graph, so that no mesh is looked for; what the plant holds is told.

Drake keeps the links of fixed joints as bodies: they are merged in the description. A body of an MJCF with several joints has bodies of
Drake's own between them, which get the names that such bodies have in a description. Drake's log is told as warnings.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from protocol import Array, Description, Header, Reading, Unsupported, skew
from reading import HeldJoint, Link, Place, describe, elements, mentioned, note, overheard

_here = sys.path.pop(0)  # this directory, where other files are called like the packages they import
from pydrake.math import RigidTransform  # noqa: E402
from pydrake.multibody import tree  # noqa: E402
from pydrake.multibody.parsing import Parser  # noqa: E402
from pydrake.multibody.plant import MultibodyPlant  # noqa: E402

sys.path.insert(0, _here)

TYPES = {
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "helical",
    "ball_rpy": "spherical",
    "quaternion_floating": "free",
    "planar": "planar",
    "universal": "universal",
}
EDITED = 1e-9  # of a link's mass: what is told as edited


def read(path: Path, form: str, base: str, make: Callable[[Description, MultibodyPlant, list[tree.Joint]], Any]) -> Reading:
    """Reads a file; `make` makes a robot of the description, the plant and its moving joints in the description's order."""
    notes: list[Header] = []
    plant = MultibodyPlant(0.0)
    with overheard(notes):
        Parser(plant).AddModels(str(path))
        if form == "urdf":
            _stand(plant, path, base, notes)
        damping = {joint.name(): joint.default_damping_vector().copy() for joint in _joints(plant)}
        for joint in _joints(plant):
            joint.set_default_damping_vector(np.zeros(joint.num_velocities()))
        plant.Finalize()
    joints = _ordered(plant)
    links = _links(plant, joints, damping, _spare(path) if form == "mjcf" else {})
    name = plant.GetModelInstanceName(plant.world_body().model_instance())
    models = [plant.GetModelInstanceName(tree.ModelInstanceIndex(i)) for i in range(2, plant.num_model_instances())]
    description = describe(models[0] if models else name, plant.gravity_field().gravity_vector(), links)
    _note_masses(plant, path, notes)
    _note_extras(plant, path, notes)
    held = Description.read(description)
    return Reading(description, held, notes, make(held, plant, [joint for joint in joints if joint.num_velocities()]), {})
