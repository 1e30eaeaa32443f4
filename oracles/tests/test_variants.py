"""Hypotheses about files: a variant is the robot of the same file with what is said to be read otherwise written otherwise."""

from __future__ import annotations

import os

import numpy as np
import pytest

from featherbench_oracles.core.messages import Header

from .readers import Readers

DRAWN = 12
SIZES = ("0.1 0.2", "0.2 0.1", "0.15 0.15")


def drawn(seed: int) -> tuple[str, dict[str, str]]:
    """Draw an arm, and the same arm as each variant says that it is read, by the text of the variant."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 4))
    poses = [" ".join(f"{x:.3f}" for x in rng.normal(size=3)) for _ in range(2 * count)]
    hinge = f'pos="{poses[0]}"'

    def text(classes: str = hinge, unseen: bool = True, second: bool = True) -> str:
        lines = [f'<mujoco><default><default class="c"><joint {classes}/></default></default><worldbody>']
        for k in range(count):
            lines.append(f'<body name="b{k}" pos="{poses[k]}"><joint name="j{k}" class="c" axis="0 1 0"/>')
            lines.append(f'<geom type="capsule" size="{SIZES[k]}"/>')
            if second and (unseen or k):
                hidden = 'contype="0" conaffinity="0"' if k == 0 else ""
                lines.append(f'<geom type="sphere" size="0.1" pos="{poses[count + k]}" {hidden}/>')
        return "".join(lines) + "</body>" * count + "</worldbody></mujoco>"

    otherwise = {
        "geoms that collide with nothing have no mass": text(unseen=False),
        "only the first geom of a body has mass": text(second=False),
        "the pos of joints in default classes is not read": text(classes=""),
    }
    return text(), otherwise


def test_a_variant_is_the_file_written_otherwise(readers: Readers) -> None:
    """The description of a variant is that of the file in which the same is left out."""
    for seed in range(DRAWN):
        text, otherwise = drawn(seed)
        told = {variant["text"]: variant for variant in readers.variants(f"arm{seed}.xml", text)}
        for k, (name, other) in enumerate(otherwise.items()):
            due = readers.read("mujoco", f"arm{seed}-{k}.xml", other)
            found = next(variant for said, variant in told.items() if variant["edits"] == 1 and name in said)
            _same(found["model"]["bodies"], due.bodies)
        pair = next(variant for variant in told.values() if variant["edits"] == 2)
        assert ", and " in pair["text"]


def test_inertias_of_an_engine_are_about_the_centres_of_mass(readers: Readers) -> None:
    """Mass and centre of mass are kept, and the inertia about it is one kg m²."""
    for seed in range(DRAWN):
        text, _ = drawn(seed)
        read = readers.read("mujoco", f"own{seed}.xml", text)
        variants = readers.variants(f"own{seed}.xml", text)
        found = next(variant for variant in variants if variant["text"].startswith("every body has the engine's own 1 kg·m²"))
        for body, own in zip(found["model"]["bodies"], read.bodies, strict=True):
            assert body["mass"] == pytest.approx(own["mass"], rel=1e-15)
            assert body["com"] == pytest.approx(own["com"], abs=1e-15)
            assert body["inertia"] == pytest.approx([1, 0, 0, 1, 0, 1], abs=1e-14)


MESHES = 200 if "FEATHERBENCH_FULL" in os.environ else 40
SOLID = """v 0 0 0
v 0.3 0 0
v 0 0.2 0
v 0 0 0.4
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
OF_CLASSES = 'class="light"', 'class="unseen"', 'class="mesh"', 'type="mesh" mesh="solid"', 'type="sphere" size="0.2" mass="3"'


def with_meshes(seed: int) -> str:
    """Draw an arm whose bodies have meshes and others geoms, some with a mass of their class, some that collide with nothing."""
    rng = np.random.default_rng(seed)
    lines = [
        """<mujoco model="arm"><compiler angle="radian"/><asset><mesh name="solid" file="solid.obj"/></asset>
<default><geom friction="1"/><default class="light"><geom type="capsule" size="0.1 0.2" mass="0.25"/></default>
<default class="unseen"><geom type="mesh" mesh="solid" contype="0" conaffinity="0"/></default>
<default class="mesh"><geom type="mesh" mesh="solid" mass="0.5"/></default></default><worldbody>"""
    ]
    count = int(rng.integers(2, 5))
    for k in range(count):
        pose = " ".join(f"{x:.3f}" for x in rng.normal(size=3))
        lines.append(f'<body name="b{k}" pos="{pose}"><joint name="j{k}" axis="0 1 0"/>')
        drawn_classes = list(rng.choice(OF_CLASSES, size=int(rng.integers(1, 4))))
        for of_class in [OF_CLASSES[3], *drawn_classes] if k == 0 and seed % 2 else drawn_classes:
            pose, quat = (" ".join(f"{x:.3f}" for x in rng.normal(size=n)) for n in (3, 4))
            lines.append(f'<geom {of_class} pos="{pose}" quat="{quat}"/>')
    return "".join(lines) + "</body>" * count + "</worldbody></mujoco>"


def test_meshes_as_pinocchio_reads_them(readers: Readers) -> None:
    """Pinocchio has a variant's masses wherever a file has meshes: those that collide have 1 kg and 1 kg m², and a body may have none."""
    readers.file("solid.obj", SOLID)
    named = massless = 0
    for seed in range(MESHES):
        name, text = f"meshes{seed}.xml", with_meshes(seed)
        held = readers.read("pinocchio", name, text, replay=False).bodies
        variants = readers.variants(name, text)
        massless += any(body["mass"] == 0 for body in held)
        texts = [variant["text"] for variant in variants if _as_heavy(variant["model"]["bodies"], held)]
        assert texts, (seed, text)
        named += any("every mesh has" in text for text in texts)
    assert named > MESHES // 2  # each second file has a mesh that collides
    assert massless > 0


DISPLACED = 200 if "FEATHERBENCH_FULL" in os.environ else 40
PLACES = 'fromto="0 0 0 0.2 0.1 0.3"', 'pos="0.1 0 0.2" quat="0.6 0 0 0.8"', 'pos="0.1 0.3 0"'


def without_places(seed: int) -> str:
    """Draw an arm for DART: some bodies have no pos, some a first geom without mass, some several geoms, and the root may be free."""
    rng = np.random.default_rng(seed)
    lines = ['<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="base" pos="0 0 1">']
    lines.append('<freejoint/><geom type="sphere" size="0.2"/>' if seed % 2 else '<geom type="sphere" size="0.2"/>')
    count = int(rng.integers(2, 5))
    for k in range(count):
        pose = " ".join(f"{x:.3f}" for x in rng.normal(size=3))
        at, geom, mass = rng.choice(["", f'pos="{pose}"']), rng.choice(PLACES), rng.choice(["", 'mass="0"'])
        lines.append(f'<body name="b{k}" {at if k else ""}><joint name="j{k}" axis="0 0 1"/>')
        lines.append(f'<geom type="capsule" size="0.1 0.2" {geom} {mass}/>')
        if mass or rng.random() < 0.7:
            lines.append(f'<geom type="box" size="0.1 0.2 0.3" pos="{pose}"/>')
    return "".join(lines) + "</body>" * (count + 1) + "</worldbody></mujoco>"


def test_places_and_masses_as_dart_reads_them(readers: Readers) -> None:
    """DART has the masses and the placements of a variant: a body without pos stands at its first geom, which alone has mass."""
    massless = 0
    for seed in range(DISPLACED):
        name, text = f"places{seed}.xml", without_places(seed)
        held = readers.read("dart", name, text, replay=False).bodies
        variants = [variant for variant in readers.variants(name, text) if _as_heavy(variant["model"]["bodies"], held)]
        massless += any(body["mass"] == 0 for body in held)
        found = [variant["text"] for variant in variants if _as_placed(variant["model"]["bodies"], held)]
        assert any("without pos" in text for text in found), (seed, text, [variant["text"] for variant in variants])
    assert 0 < massless < DISPLACED


def _as_placed(found: list[Header], due: list[Header]) -> bool:
    """Whether the bodies stand at the same places."""
    pairs = zip(found, due, strict=True)
    places = [[body["joint"]["placement"][key] for body in pair for key in ("rotation", "translation")] for pair in pairs]
    # A rotation by a quaternion, and by the turn from one vector to another.
    return all(np.allclose(np.ravel(a), np.ravel(c), rtol=0, atol=1e-14) and np.allclose(b, d, rtol=0, atol=1e-14) for a, b, c, d in places)


def _as_heavy(found: list[Header], due: list[Header]) -> bool:
    """Whether the bodies have the same masses, centres of mass and inertias."""
    scale = 1 + max(abs(x) for body in due for x in body["inertia"])

    def same(one: Header, other: Header) -> bool:
        keys = ("mass", "com", "inertia") if other["mass"] > 0 else ("mass", "inertia")
        # The compiler diagonalises and multiplies back.
        return all(np.allclose(one[key], other[key], rtol=0, atol=1e-12 * scale) for key in keys)

    return len(found) == len(due) and all(same(one, other) for one, other in zip(found, due, strict=True))


def _same(found: list[Header], due: list[Header]) -> None:
    assert [body["name"] for body in found] == [body["name"] for body in due]
    for one, other in zip(found, due, strict=True):
        for key in ("mass", "com", "inertia"):
            # The compiler diagonalises and multiplies back.
            assert np.allclose(one[key], other[key], rtol=0, atol=1e-12 * (1 + np.abs(other[key]).max())), (one, other)
        place, due_place = (
            np.concatenate([np.ravel(body["joint"]["placement"][key]) for key in ("rotation", "translation")]) for body in (one, other)
        )
        assert np.allclose(place, due_place, rtol=0, atol=1e-14)
