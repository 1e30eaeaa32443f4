"""Checks of the plots: what they draw, and what they do under the mouse and the keyboard."""

from __future__ import annotations

import time
from typing import Any

from browser.client import ARROW_DOWN, ARROW_RIGHT, ENTER, ESCAPE, Browser
from browser.page import DRAWN, ROWS, Checks, Shot, has

PLOTS = [
    "accuracy-plot",
    "depth-plot",
    "time-plot",
    "speed-plot",
    "tradeoff-plot",
    "conditioning-plot",
    "floor-plot",
    "floating-base-plot",
    "steps-plot",
    "drift-plot",
    "scaling-time",
    "scaling-memory",
    "scaling-error",
    "scaling-ratio",
]
# A plot as its reader has it: texts of the ticks, names that are switched on, and whether the zoom can be taken back.
PLOT = """
    const box = document.getElementById(arguments[0]);
    const texts = selector => [...box.querySelectorAll(selector)].map(text => text.textContent);
    return {
      points: box.querySelectorAll('.marks .mark').length,
      ticks: [texts('.xticks text'), texts('.yticks text')],
      names: [...box.querySelectorAll('.chart-names button')].map(button => button.ariaPressed === 'true'),
      nothing: texts('.nothing').join(''),
      zoomed: !box.querySelector('.chart-back').hidden,
    }"""
# Where the mark is that has the most room about it, and the edges of the drawing.
LONELY = """
    const svg = document.querySelector(`#${arguments[0]} svg[role=img]`);
    svg.scrollIntoView({block: 'center', behavior: 'instant'});
    const middle = box => [box.x + box.width / 2, box.y + box.height / 2];
    const marks = [...svg.querySelectorAll('.marks .mark')].map(mark => middle(mark.getBoundingClientRect()));
    const room = ([x, y]) => Math.min(...marks.map(([a, b]) => Math.hypot(a - x, b - y)).filter(distance => distance > 1), 1e9);
    const rooms = marks.map(room);
    const edge = svg.getBoundingClientRect();
    return {mark: marks[rooms.indexOf(Math.max(...rooms))], edge: [edge.left, edge.top, edge.right, edge.bottom]}"""
# A figure as its reader saves it.
SAVED = """
    const text = featherbench.chart.figure(document.getElementById(arguments[0]));
    const file = new DOMParser().parseFromString(text, 'image/svg+xml');
    const named = [...document.querySelectorAll(`#${arguments[0]} .chart-names span`)].map(span => span.textContent);
    return {
      root: file.documentElement.tagName,
      marks: file.querySelectorAll('.mark').length,
      paper: file.querySelector('rect').getAttribute('fill'),
      names: named.every(name => [...file.querySelectorAll('text')].some(text => text.textContent.startsWith(name))),
      borrowed: text.includes('var(') || text.includes('currentColor'),
    }"""
# Seconds after which a browser is taken to save nothing, on a machine however busy.
PATIENCE = 120
# The lines that explain a mark.
EXPLAINED = """
    const tip = document.querySelector(`#${arguments[0]} .chart-tip`);
    return tip.hidden ? '' : [...tip.children].map(line => line.textContent).join('|')"""


def drawn(page: Browser) -> list[str]:
    """List the plots of this page."""
    return [box for box in PLOTS if has(page, f"#{box}")]


def plots(page: Browser, shot: Shot) -> Checks:
    """Check every plot of the page, and a figure as a file."""
    boxes = drawn(page)
    for box in boxes:
        points = page.until(DRAWN, box)
        yield f"{box} draws points", points > 0, points
        page.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", box)
        shot(box)
    for box in boxes:
        yield from chart(page, box, shot)
    if boxes:
        page.click(f"#{boxes[0]} .chart-save")
        file = page.downloads / f"featherbench-{boxes[0]}.svg"
        # The browser makes an empty file of this name before it writes the figure.
        text, end = "", time.monotonic() + PATIENCE
        while not text.endswith("</svg>") and time.monotonic() < end:
            time.sleep(0.05)
            text = file.read_text() if file.is_file() else ""
        yield "a figure is saved as a file", text.startswith("<svg xmlns=") and text.endswith("</svg>"), text[:200]
    yield from axes(page)
    yield from awkward(page)


def pointer(page: Browser, *steps: str | tuple[float, float]) -> None:
    """Move the mouse to places on the screen, press (`down`) and let go (`up`)."""
    actions: list[dict[str, Any]] = []
    for step in steps:
        if step == "down" or step == "up":
            actions.append({"type": "pointerDown" if step == "down" else "pointerUp", "button": 0})
        else:
            actions.append({"type": "pointerMove", "duration": 30, "x": round(step[0]), "y": round(step[1])})  # type: ignore[arg-type]
    page.post("/actions", actions=[{"type": "pointer", "id": "mouse", "actions": actions}])


def chart(page: Browser, box: str, shot: Shot) -> Checks:
    """Check what a plot does under the mouse and the keyboard."""
    first = page.run(PLOT, box)
    if first["points"] == 0:
        return
    numbers = [text for axis in first["ticks"] for text in axis]
    yield (
        f"{box} has ticks on both axes",
        all(first["ticks"]) and all("NaN" not in text and "undefined" not in text for text in numbers),
        numbers,
    )
    label = page.run("return document.querySelector(`#${arguments[0]} svg[role=img]`).ariaLabel", box)
    yield f"{box} is described in words", f"{first['points']} points" in label, label

    place = page.run(LONELY, box)
    x, y = place["mark"]
    pointer(page, (x + 3, y - 3), (x, y))
    text = page.run(EXPLAINED, box)
    yield f"{box} explains the mark that is pointed at", len(text) > 5 and "undefined" not in text and "NaN" not in text, text
    shot(f"{box}-tip")
    left, top, _, bottom = place["edge"]
    pointer(page, (left + 2, bottom - 2))
    yield f"{box} explains nothing where no mark is", page.run(EXPLAINED, box) == "", ""

    page.run("document.querySelector(`#${arguments[0]} svg[role=img]`).focus()", box)
    page.press(ARROW_RIGHT)
    text = page.run(EXPLAINED, box)
    page.press(ARROW_RIGHT)
    page.press(ARROW_DOWN)
    other = page.run(EXPLAINED, box)
    yield f"{box} is walked with the arrow keys", len(text) > 5 and (first["points"] < 2 or other != text), [text, other]
    page.press(ESCAPE)

    name = f"#{box} .chart-names button"
    page.click(name)
    off = page.run(PLOT, box)
    yield f"{box}: a click on a name switches it off", first["names"][0] and off["names"] == [False, *first["names"][1:]], off["names"]
    page.run("document.querySelector(arguments[0]).focus()", name)
    page.press(ENTER)
    again = page.run(PLOT, box)
    yield f"{box}: Enter on a name switches it on again", again == first, [again, first]
    buttons = "[...document.querySelectorAll(`#${arguments[0]} .chart-names button`)]"
    page.run(f"{buttons}.forEach(button => button.click())", box)
    none = page.run(PLOT, box)
    yield f"{box} without any series says so", none["points"] == 0 and none["nothing"] != "", none["nothing"]
    page.run(f"{buttons}.forEach(button => button.click())", box)
    yield f"{box} comes back whole", page.run(PLOT, box) == first, ""

    place = page.run(LONELY, box)
    x, y = place["mark"]
    left, top, right, bottom = place["edge"]
    for way in ["Escape", "a double click", "its button"]:
        begin = (x - min(60, x - left - 5), max(y - 50, top + 5))
        pointer(page, begin, "down", (x, y), (x + min(50, right - x - 5), y + min(40, bottom - y - 5)), "up")
        zoomed = page.run(PLOT, box)
        good = zoomed["zoomed"] and 0 < zoomed["points"] <= first["points"] and zoomed["ticks"] != first["ticks"]
        yield f"{box}: a drawn rectangle zooms, and opens no rows", good and not page.run(ROWS), [zoomed["points"], zoomed["ticks"]]
        if way == "Escape":
            shot(f"{box}-zoom")
            page.press(ESCAPE)
        elif way == "its button":
            page.click(f"#{box} .chart-back")
        else:
            corner = (left + 3, bottom - 3)
            pointer(page, corner, "down", "up", "down", "up")
        whole = page.run(PLOT, box)
        yield f"{box} is whole again after {way}", whole == first, [whole["zoomed"], whole["points"]]
        place = page.run(LONELY, box)
        x, y = place["mark"]
        left, top, right, bottom = place["edge"]

    saved = page.run(SAVED, box)
    whole = saved["root"] == "svg" and saved["marks"] == first["points"] and saved["names"]
    yield f"{box} as a file has its marks, names and colours", whole and saved["paper"].startswith("#") and not saved["borrowed"], saved


def axes(page: Browser) -> Checks:
    """Check ticks and labels by numbers."""
    found = page.run("""
        const {ticks, labels, range} = featherbench.axes;
        const texts = values => labels(values).map(([words, exponent]) => exponent === undefined ? words : `${words}^${exponent}`);
        const near = values => values.map(value => Number(value.toPrecision(12)));
        return [
          texts(ticks(true, [-16.3, -7.9], 10).major),
          ticks(true, [-16.3, -7.9], 10).minor.length > 0,
          texts(ticks(true, [0.1, 2.2], 9).major),
          texts(ticks(true, [2, 3], 5).major),
          near(ticks(true, [Math.log10(1.2), Math.log10(1.9)], 8).major),
          near(ticks(false, [-0.13, 0.52], 8).major),
          texts([0, 12000, 250000]),
          texts([2e-14, 5e-14]),
          texts([-0.5, 1.5]),
          range(true, [0, -1, NaN, null, undefined, Infinity]),
          range(true, [10]),
          range(false, [3, 3]),
        ]""")
    wanted = [
        ["10^−16", "10^−15", "10^−14", "10^−13", "10^−12", "10^−11", "10^−10", "10^−9", "10^−8"],
        True,
        ["2", "5", "10", "20", "50", "100"],
        ["100", "200", "500", "1000"],
        [1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9],
        [-0.1, 0, 0.1, 0.2, 0.3, 0.4, 0.5],
        ["0", "12\u202f000", "250\u202f000"],
        ["2×10^−14", "5×10^−14"],
        ["−0.5", "1.5"],
        None,
        [0.5, 1.5],
        [2.7, 3.3],
    ]
    for index, (one, other) in enumerate(zip(found, wanted, strict=True)):
        yield f"ticks and labels are right ({index + 1} of {len(wanted)})", one == other, [one, other]


def awkward(page: Browser) -> Checks:
    """Check plots of numbers that have no place."""
    found = page.run("""
        const place = document.createElement('div');
        Object.assign(place, {id: 'awkward', className: 'plot'});
        document.querySelector('main').append(place);
        const log = {x: {title: 'x', log: true}, y: {title: 'y', log: true}};
        const straight = {x: {title: 'x'}, y: {title: 'y'}};
        const look = (points, shape, more) => {
          featherbench.chart(place, [{name: 'one', ink: '#123456', points, mark: {symbol: 'circle', size: 8}, line: {}, ...more}], shape);
          const odd = /NaN|Infinity|undefined/.test(place.querySelector('svg').outerHTML);
          return [place.querySelectorAll('.mark').length, place.querySelector('.nothing')?.textContent ?? '', odd];
        };
        try {
          return [
            look([], log),
            look(undefined, log),
            look([{x: 0, y: 1}, {x: -1, y: 1}, {x: 1, y: NaN}, {x: null, y: 1}, {y: Infinity}], log),
            look([{x: 1, y: 0}, {x: 1, y: 1e-300, low: 0, high: null}, {x: 1e300, y: 2}, {x: NaN, y: 2}], log),
            look([{x: -1, y: 0, low: -2, high: 1}, {x: NaN, y: 0}], straight),
            look([{x: 5, y: 5}], straight),
            look([{x: 1, y: 1, label: 'a'}], log, {guide: 0, broad: [[0, 1], [1, 0]]}),
            look([{x: 1, y: 1}], {...log, x: {range: [0, 2], ticks: [[1, 'a name'], [NaN, 'none']], turn: true}}),
            look([], {...log, empty: 'words'}),
          ];
        } catch (error) {
          return String(error);
        } finally {
          place.remove();
        }""")
    none = [0, "no values to draw", False]
    wanted = [none, none, none, [2, "", False], [1, "", False], [1, "", False], [1, "", False], [1, "", False], [0, "words", False]]
    yield "plots leave out what has no place, and say when nothing is left", found == wanted, found
