"""Opens a report in Chromium from a file:// address and uses it as a reader would.

    python=target/oracles/venv/bin/python
    $python -m pytest -c oracles/pyproject.toml ci/browser_test.py --report FOLDER [--shots FOLDER] [-k use|axe|robots|layout]

Needs pytest and Selenium (`ci/python-tools`), and chromium and chromedriver on the path. Each check is a subtest; `-v` lists them.
The rules of accessibility are those of axe-core, which npm brings once, at a pinned version and checksum, into target/axe.
"""

from __future__ import annotations

import pathlib
import tempfile
from collections.abc import Iterator

import pytest
from browser.axe import accessible
from browser.client import Browser
from browser.layout import laid_out
from browser.page import Checks
from browser.robots import robots
from browser.sections import checks


@pytest.fixture(scope="module")
def report(request: pytest.FixtureRequest) -> pathlib.Path:
    """Find the report's folder."""
    folder: pathlib.Path = request.config.getoption("--report").resolve()
    assert (folder / "index.html").is_file(), f"{folder} has no index.html"
    return folder


@pytest.fixture(scope="module")
def shots(request: pytest.FixtureRequest) -> pathlib.Path | None:
    """Make the folder of pictures, if there is to be one."""
    folder: pathlib.Path | None = request.config.getoption("--shots")
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture(scope="module")
def page() -> Iterator[Browser]:
    """Start the browser."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            yield browser
        finally:
            browser.close()


def hold(subtests: pytest.Subtests, found: Checks) -> None:
    """Hold each check; one that does not tells what was seen."""
    for what, good, seen in found:
        with subtests.test(what):
            assert good, seen


def test_use(subtests: pytest.Subtests, page: Browser, report: pathlib.Path, shots: pathlib.Path | None) -> None:
    """What a reader does."""
    hold(subtests, checks(page, (report / "index.html").as_uri(), shots))


def test_axe(subtests: pytest.Subtests, page: Browser, report: pathlib.Path) -> None:
    """Accessibility of every kind of page."""
    hold(subtests, accessible(page, report))


def test_robots(subtests: pytest.Subtests, page: Browser, report: pathlib.Path) -> None:
    """Drawings of robots, turned."""
    hold(subtests, robots(page, report))


def test_layout(subtests: pytest.Subtests, page: Browser, report: pathlib.Path) -> None:
    """Layout of every page."""
    hold(subtests, laid_out(page, report))
