"""Scenes by DART: velocity-level boxed complementarity problems, by each solver."""

from __future__ import annotations

from functools import partial

import dartpy
import numpy as np

from featherbench_oracles.abilities.scenes import Body, Motion, Scene, Shape, Stepping, Variant
from featherbench_oracles.core.algebra import Array, quaternion

# Of each variant the friction that its solver has.
SOLVERS = {
    "dantzig": "box pyramid",
    "pgs": "box pyramid",
    "nsgs_coulomb": "round cone, Coulomb's law",
    "nsgs_associated": "round cone, associated law",
    "fbf": "round cone",
}
GROUND = 20.0  # half edges of the box that is the ground, m


def _rotation(turn: Array) -> Array:
    """Make the rotation matrix of (x, y, z, w)."""
    x, y, z, w = turn
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]]
    rows += [[2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]]
    rows += [[2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.array(rows)


def _add(node: dartpy.dynamics.BodyNode, shape: Shape, scene: Scene) -> None:
    geometry = (
        dartpy.dynamics.SphereShape(shape.radius) if shape.radius is not None else dartpy.dynamics.BoxShape(2 * np.asarray(shape.half))
    )
    added = node.createShapeNode(geometry)
    added.createCollisionAspect()
    dynamics = added.createDynamicsAspect()
    dynamics.setFrictionCoeff(scene.friction)
    # DART multiplies the coefficients of both shapes.
    dynamics.setRestitutionCoeff(float(np.sqrt(scene.restitution)))
    placed = dartpy.math.Isometry3()
    placed.set_translation(shape.at)
    added.setRelativeTransform(placed)


def _skeleton(index: int, body: Body, scene: Scene) -> dartpy.dynamics.Skeleton:
    skeleton = dartpy.dynamics.Skeleton(f"{index}")
    joint, node = skeleton.createFreeJointAndBodyNodePair()
    inertia = dartpy.dynamics.Inertia(body.mass, np.zeros(3), np.diag(body.inertia))
    node.setInertia(inertia)
    for shape in body.shapes:
        _add(node, shape, scene)
    placed = dartpy.math.Isometry3()
    placed.set_rotation(_rotation(body.orientation))
    placed.set_translation(body.position)
    joint.setTransform(placed)
    joint.setLinearVelocity(body.linear)
    joint.setAngularVelocity(body.angular)
    return skeleton


def _sample(nodes: list[dartpy.dynamics.BodyNode]) -> list[Array]:
    read = []
    for node in nodes:
        place = node.getWorldTransform()
        velocities = [np.ravel(node.getLinearVelocity()), np.ravel(node.getAngularVelocity())]
        read.append(np.concatenate([np.ravel(place.translation()), quaternion(place.rotation()), *velocities]))
    return read


def _contacts(world: dartpy.simulation.World) -> list[Array]:
    """Read the contacts of the last step. The force acts on the first object."""

    def body(of: dartpy.collision.CollisionObject) -> int:
        name = of.getShapeFrame().asShapeNode().getBodyNodePtr().getSkeleton().getName()
        return int(name) if name.isdigit() else -1

    found = []
    for contact in world.getLastCollisionResult().getContacts():
        first, second = body(contact.collisionObject1), body(contact.collisionObject2)
        force = np.ravel(contact.force)
        on, other, force = (first, second, force) if first >= 0 else (second, first, -force)
        found.append(np.concatenate([[on, other], np.ravel(contact.point), force]))
    return found


def _choose(name: str, solver: dartpy.constraint.BoxedLcpConstraintSolver) -> None:
    """Set the solver. Dantzig's and PGS have no constructor in Python: a world has one of each, the second for where the first fails."""
    if name == "pgs":
        chosen = solver.getSecondaryBoxedLcpSolver()
        solver.setSecondaryBoxedLcpSolver(None)
        solver.setBoxedLcpSolver(chosen)
    elif name == "fbf":
        solver.setBoxedLcpSolver(dartpy.constraint.FbfFrictionSolver())
    elif name != "dantzig":
        nsgs = dartpy.constraint.NsgsFrictionSolver()
        options, laws = nsgs.getOptions(), dartpy.constraint.NsgsFrictionSolver.Law
        options.law = laws.Coulomb if name == "nsgs_coulomb" else laws.Associated
        nsgs.setOptions(options)
        solver.setBoxedLcpSolver(nsgs)


def _check(solver: dartpy.constraint.BoxedLcpConstraintSolver) -> None:
    """Refuse numbers of steps in which a solver says that it failed. Dantzig's and PGS print it; the others count it."""
    chosen = solver.getBoxedLcpSolver()
    stats = chosen.getStats() if hasattr(chosen, "getStats") else None
    if stats is not None and stats.numFailed:
        raise ValueError(f"dart says that its solver failed in {stats.numFailed} of {stats.numSolves} solutions")


def _simulate(name: str, scene: Scene, stepping: Stepping) -> Motion:
    world = dartpy.simulation.World()
    world.setGravity(scene.gravity)
    world.setTimeStep(stepping.dt)
    world.setCollisionDetector(dartpy.collision.DARTCollisionDetector())
    _choose(name, world.getConstraintSolver())
    ground = dartpy.dynamics.Skeleton("ground")
    _, node = ground.createWeldJointAndBodyNodePair()
    _add(node, Shape(np.array([0, 0, -GROUND]), None, np.full(3, GROUND)), scene)
    world.addSkeleton(ground)
    skeletons = [_skeleton(k, body, scene) for k, body in enumerate(scene.bodies)]
    nodes = [skeleton.getBodyNode(0) for skeleton in skeletons]
    for skeleton in skeletons:
        world.addSkeleton(skeleton)
    samples = []
    for step in range(stepping.steps):
        for node, body in zip(nodes, scene.bodies, strict=True):
            if body.force.any():
                node.addExtForce(body.force, np.zeros(3), False, True)
        world.step()
        if (step + 1) % stepping.every == 0:
            samples.append(_sample(nodes))
    _check(world.getConstraintSolver())
    return Motion(samples, _contacts(world))


def _variant(name: str) -> Variant:
    contact = f"complementarity problem of velocities, {SOLVERS[name]}"
    return Variant(partial(_simulate, name), {"contact": contact, "integrator": "semi-implicit Euler", "collisions": "dart"})


VARIANTS = {name: _variant(name) for name in SOLVERS}
