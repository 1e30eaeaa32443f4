"""The robots that turn by keys and mouse: in the section of a comparison, on a robot's page, and in the card of a finding."""

from __future__ import annotations

import pathlib

from browser.client import ARROW_RIGHT, Browser
from browser.page import Checks, has, open_whole

PLACES = "return [...document.querySelectorAll(`${arguments[0]} ellipse`)].map(body => body.getAttribute('transform')).join()"
READY = "return document.querySelector(`${arguments[0]}[data-turns]`) !== null"


def robots(page: Browser, folder: pathlib.Path) -> Checks:
    """Turn a robot wherever a report has one: on a robot's page, in the section of a comparison, in the card of a finding."""
    index = (folder / "index.html").resolve().as_uri()
    open_whole(page, index)
    if has(page, ".robots figure.robot"):
        yield from turning(page, "the section", ".robots figure.robot")

    if not (folder / "robots").is_dir():
        yield "a run without robots has no drawing of one", not (folder / "drawings.json").exists(), "drawings.json"
        return
    drawn = (own for own in sorted((folder / "robots").glob("*.html")) if '<figure class="robot"' in own.read_text())
    own = next(drawn, folder / "robots" / "none-is-drawn.html")
    page.open(own.resolve().as_uri())
    yield from turning(page, "a robot's page", "#about > figure.robot")
    page.click("#about > figure.robot summary")
    tree = page.run("return [...document.querySelectorAll('#about .tree li')].map(body => body.offsetHeight > 0)")
    bodies = page.run("return document.querySelectorAll('#about > figure.robot ellipse').length")
    yield "its tree lists every body", len(tree) == bodies > 0 and all(tree), [tree, bodies]

    page.open(index)
    if not has(page, ".look"):
        return
    before = page.run("return document.querySelectorAll('.look ellipse').length")
    page.click(".look > summary")
    brought = page.until(READY, ".look figure.robot", seconds=5)
    yield "the card of a finding brings its robot when it is opened", before == 0 and brought, [before, brought]
    yield from turning(page, "the card", ".look figure.robot")
    marked = page.run("return [...document.querySelectorAll('.look .tree .marked')].map(body => body.textContent)")
    caption = page.run("return document.querySelector('.look figcaption').textContent")
    yield "the bodies in which the engine differs are marked", bool(marked) == ("differs in" in caption), [marked, caption]


def turning(page: Browser, where: str, figure: str) -> Checks:
    """Turn a robot by keys and by dragging."""
    picture = f"{figure} svg"
    page.until(READY, figure, seconds=5)
    first = page.run(PLACES, figure)
    yield f"{where}: a robot is drawn", "translate" in first, first
    page.run("document.querySelector(arguments[0]).focus()", picture)
    page.press(ARROW_RIGHT)
    turned = page.run(PLACES, figure)
    yield f"{where}: an arrow key turns it", turned != first, turned
    page.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", picture)
    drawing = page.find(picture)
    page.point((0, 0), "down", (60, 20), "up", origin=drawing)
    dragged = page.run(PLACES, figure)
    yield f"{where}: dragging turns it", dragged != turned, dragged
    page.point((10, 0), origin=drawing)
    after = page.run(PLACES, figure)
    yield f"{where}: it stays when it is let go", after == dragged, after
