"""Accessibility of every kind of page, light and dark, by the rules of axe-core (MPL-2.0; brought for the test, part of nothing)."""

from __future__ import annotations

import base64
import hashlib
import pathlib
import subprocess
import tarfile
from typing import Any

from browser.client import Browser
from browser.page import ROWS, Checks

VERSION = "4.14.1"
# The checksum of the package, as its registry gives it.
INTEGRITY = "FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ=="
FOLDER = pathlib.Path(__file__).resolve().parents[2] / "target" / "axe"
# The levels A and AA of WCAG 2.2, and what axe-core calls best practices.
TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
START = """
    window.axeAnswer = null;
    axe.run(document, {runOnly: {type: 'tag', values: arguments[0]}, resultTypes: ['violations']})
      .then(results => {
        const why = node => node.any.concat(node.all).map(({message}) => message).join('; ');
        const told = node => `${node.target.join(' ')}: ${why(node)}`;
        const part = ({id, impact, nodes}) => ({id, impact, count: nodes.length, nodes: nodes.slice(0, 3).map(told)});
        window.axeAnswer = {rules: results.testEngine.version, violations: results.violations.map(part)};
      })
      .catch(error => { window.axeAnswer = {rules: '', violations: [{id: String(error)}]}; });"""
# Seconds after which axe-core is taken to hang, on a machine however busy.
PATIENCE = 300


def source() -> str:
    """Get the script of axe-core: from the folder of builds, or else by npm. A package with another checksum is an error."""
    package = FOLDER / f"axe-core-{VERSION}.tgz"
    if not package.is_file():
        FOLDER.mkdir(parents=True, exist_ok=True)
        subprocess.run(
            ["npm", "pack", f"axe-core@{VERSION}", "--silent", "--pack-destination", str(FOLDER)],
            check=True,
            cwd=FOLDER,
            stdout=subprocess.DEVNULL,
        )
    found = base64.b64encode(hashlib.sha512(package.read_bytes()).digest()).decode()
    if found != INTEGRITY:
        raise RuntimeError(f"{package} has the checksum {found}, not the one of axe-core {VERSION}: remove it")
    with tarfile.open(package) as archive:
        script = archive.extractfile("package/axe.min.js")
        if script is None:
            raise RuntimeError(f"{package} has no axe.min.js")
        return script.read().decode()


def violations(page: Browser, script: str) -> Any:
    """Run the rules on the page as it is."""
    page.run(script)
    page.run(START, TAGS)
    answer = page.until("return window.axeAnswer", seconds=PATIENCE)
    if not answer or answer["rules"] != VERSION:
        return [f"axe-core did not answer: {answer}"]
    return answer["violations"]


def accessible(page: Browser, folder: pathlib.Path) -> Checks:
    """Check the first page, its rows, and a page of every kind, light and dark."""
    script = source()
    kinds = ["index.html", *(f"sections/{path.name}" for path in sorted((folder / "sections").glob("*.html")))]
    kinds += [f"{kind}/{first.name}" for kind in ("engines", "robots", "studies") for first in sorted((folder / kind).glob("*.html"))[:1]]
    for theme, width in (("light", 1440), ("dark", 1440), ("light", 500)):
        page.resize(width, 1000)
        page.prefer(theme)
        for kind in kinds:
            page.open((folder / kind).resolve().as_uri())
            # A page with a script has the reader's choice; any other follows the system.
            page.run(
                "if (!document.getElementById('theme')) return;"
                "document.documentElement.dataset.theme = arguments[0]; document.dispatchEvent(new CustomEvent('themechange'))",
                theme,
            )
            seen = page.run("return getComputedStyle(document.documentElement).colorScheme")
            yield f"{kind} is {theme} where that is wanted", seen == theme, seen
            found = violations(page, script)
            yield f"{kind}, {theme}, {width} px, has no violation of accessibility", not found, found
        page.open((folder / "index.html").resolve().as_uri())
        page.run("document.documentElement.dataset.theme = arguments[0]", theme)
        # A page over several runs opens no rows.
        if not page.run("const first = document.querySelector('[data-chunk]'); first?.click(); return first !== null"):
            continue
        found = violations(page, script) if page.until(ROWS) else ["no rows were opened"]
        yield f"the rows, {theme}, {width} px, have no violation of accessibility", not found, found
    page.prefer("")
