"""MJCF files of installed packages, read by featherbench and compiled by MuJoCo: the same M and bias forces."""

import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import featherbench

ROOT = Path(__file__).parents[2]
PACKAGES = ROOT / "target" / "oracles" / "packages"
# MuJoCo diagonalises inertias: 1e-15 of the largest moment. Sums over a hundred bodies lose two digits more.
TOLERANCE = 1e-13


def files() -> list[Path]:
    return sorted(PACKAGES.rglob("*.xml")) if PACKAGES.is_dir() else []


def test_files_mean_what_mujoco_makes_of_them(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("mujoco", reason="mujoco is not installed")
    if not files():
        pytest.skip("the robots' packages are not installed")
    monkeypatch.syspath_prepend(str(ROOT / "oracles"))
    reading = import_module("featherbench_oracles.mujoco.reading")
    read, refused, worst, file = 0, dict[str, str](), dict[str, float](), tmp_path / "held.json"
    for path in files():
        try:
            robot = featherbench.Robot.from_mjcf(path)
        except featherbench.Error as error:
            refused[path.name] = str(error)
            continue
        try:
            theirs = reading.read(path, "mjcf", "fixed", lambda description, model: None)
        except Exception as error:  # MuJoCo's compiler refuses what misses meshes, which inertials do not need
            refused[path.name] = str(error)
            continue
        description = theirs.model
        assert [body["name"] for body in description["bodies"]] == [joint.body for joint in robot.joints], path
        q, rng = robot.random(seed=1, states=5), np.random.default_rng(1)
        file.write_text(json.dumps(description))
        held = featherbench.Robot.from_json(file)
        v = rng.uniform(-1, 1, (5, robot.nv))
        for ours, due in ((robot.mass_matrix(q), held.mass_matrix(q)), (robot.bias_force(q, v), held.bias_force(q, v))):
            worst[path.name] = max(worst.get(path.name, 0), np.max(np.abs(ours - due)) / max(np.max(np.abs(due)), 1e-300))
        read += 1
    # Refused are parts that other files include, and bodies whose mass is a mesh's.
    assert read >= 20, refused
    assert all(error <= TOLERANCE for error in worst.values()), worst


def test_included_files_are_found_where_mujoco_finds_them(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    (tmp_path / "sub" / "sub").mkdir(parents=True)
    for name, text in {
        "main.xml": "<mujoco><include file='sub/a.xml'/><worldbody><body><joint/><geom size='0.1'/></body></worldbody></mujoco>",
        "sub/a.xml": "<a><include file='sub/b.xml'/></a>",
        "sub/sub/b.xml": "<a><include file='c.xml'/></a>",
        "sub/sub/c.xml": "<a><default><geom density='3'/></default></a>",
    }.items():
        (tmp_path / name).write_text(text)

    def masses() -> tuple[float, float]:
        file = tmp_path / "main.xml"
        held = json.loads(featherbench.Robot.from_mjcf(file).to_json())
        return mujoco.MjModel.from_xml_path(str(file)).body_mass[1], held["bodies"][0]["mass"]

    theirs, ours = masses()
    assert ours == pytest.approx(theirs, rel=1e-15)
    # A file of that name beside the first one comes first, for both.
    (tmp_path / "c.xml").write_text("<a><default><geom density='7'/></default></a>")
    other, own = masses()
    assert other > 2 * theirs
    assert own == pytest.approx(other, rel=1e-15)
