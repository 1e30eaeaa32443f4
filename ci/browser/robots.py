"""The robots that one can look at turn: by keys and by dragging, on a page whose sections are brought when the reader comes to them."""

from __future__ import annotations

import pathlib

from browser.client import ARROW_RIGHT, ELEMENT, Browser
from browser.page import Checks, open_whole

PICTURE = "figure.robot svg"
PLACES = "return [...document.querySelectorAll('figure.robot ellipse')].map(body => body.getAttribute('transform')).join()"


def robots(page: Browser, folder: pathlib.Path) -> Checks:
    """Turn the first robot of the page of a comparison."""
    open_whole(page, (folder / "index.html").resolve().as_uri())
    page.until("return document.querySelector('figure.robot[data-turns]') !== null", seconds=5)
    first = page.run(PLACES)
    yield "a robot is drawn", "translate" in first, first
    page.run("document.querySelector(arguments[0]).focus()", PICTURE)
    page.press(ARROW_RIGHT)
    turned = page.run(PLACES)
    yield "an arrow key turns it", turned != first, turned
    page.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", PICTURE)
    origin = {ELEMENT: page.find(PICTURE)}
    steps = [
        {"type": "pointerMove", "duration": 0, "origin": origin, "x": 0, "y": 0},
        {"type": "pointerDown", "button": 0},
        {"type": "pointerMove", "duration": 100, "origin": origin, "x": 60, "y": 20},
        {"type": "pointerUp", "button": 0},
    ]
    page.post("/actions", actions=[{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}])
    dragged = page.run(PLACES)
    yield "dragging turns it", dragged != turned, dragged
    page.post("/actions", actions=[{"type": "pointer", "id": "mouse", "actions": [{**steps[0], "x": 10}]}])
    yield "it stays when it is let go", page.run(PLACES) == dragged, page.run(PLACES)
