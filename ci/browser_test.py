#!/usr/bin/env python3
"""Opens a report in Chromium from a file:// address and uses it as a reader would.

    python ci/browser_test.py REPORT_DIR [--shots FOLDER]

Needs chromium and chromedriver on the path, and no Python package: chromedriver is asked by JSON over local HTTP.
Prints each check and `N passed, N failed`. Exit status: 0 if all passed, 1 if one failed, 2 if the browser could not be started.
"""

from __future__ import annotations

import argparse
import base64
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from typing import Any

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
ESCAPE, ARROW_RIGHT, ARROW_DOWN, ENTER = "\ue00c", "\ue014", "\ue015", "\ue007"


class Browser:
    """One page of Chromium, driven through chromedriver."""

    def __init__(self, profile: str) -> None:
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.session: str | None = None
        self.downloads = pathlib.Path(profile) / "downloads"
        try:
            for line in self.driver.stdout or ():
                if port := re.search(r"started successfully on port (\d+)", line):
                    self.base = f"http://127.0.0.1:{port[1]}"
                    break
            else:
                raise RuntimeError("chromedriver did not start")
            flags = [
                "--headless=new",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--disable-dev-shm-usage",
                "--force-prefers-reduced-motion",
                f"--user-data-dir={profile}",
                "--window-size=1440,1000",
            ]
            options: dict[str, Any] = {"args": flags, "prefs": {"download.default_directory": str(self.downloads)}}
            if binary := shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome"):
                options["binary"] = binary
            wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
            self.session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        except BaseException:
            self.close()
            raise

    def call(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
        """Send a command of WebDriver, and return its value."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].splitlines()[0]) from None

    def post(self, path: str, **body: Any) -> Any:
        """Send a command of this session."""
        return self.call("POST", f"/session/{self.session}{path}", body)

    def open(self, address: str) -> None:
        """Go to an address."""
        self.post("/url", url=address)

    def run(self, script: str, *arguments: Any) -> Any:
        """Run a script in the page; its `return` is the value."""
        return self.post("/execute/sync", script=script, args=list(arguments))

    def find(self, selector: str) -> str:
        """Find the first element of a selector."""
        return str(self.post("/element", using="css selector", value=selector)[ELEMENT])

    def click(self, selector: str) -> None:
        """Click at the element's place on the screen: one that is covered or off the screen fails."""
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", selector)
        self.post(f"/element/{self.find(selector)}/click")

    def press(self, *keys: str) -> None:
        """Press keys, one after the other."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.post("/actions", actions=[{"type": "key", "id": "keyboard", "actions": actions}])

    def choose(self, selector: str, value: str) -> None:
        """Choose an option of a list with the event of a user's choice."""
        self.run(
            "const list = document.querySelector(arguments[0]); list.value = arguments[1];"
            " list.dispatchEvent(new Event('change', {bubbles: true}))",
            selector,
            value,
        )

    def until(self, script: str, *arguments: Any, seconds: float = 20) -> Any:
        """Wait until a script returns something true, and return it; if it never does, return the last value."""
        end = time.monotonic() + seconds
        while not (value := self.run(script, *arguments)) and time.monotonic() < end:
            time.sleep(0.05)
        return value

    def log(self, kind: str) -> list[dict[str, Any]]:
        """Take the new entries of a log."""
        entries: list[dict[str, Any]] = self.post("/se/log", type=kind)
        return entries

    def shot(self, path: pathlib.Path) -> None:
        """Write a picture of the window."""
        path.write_bytes(base64.b64decode(self.call("GET", f"/session/{self.session}/screenshot")))

    def close(self) -> None:
        """End the page and the driver."""
        if self.session:
            self.call("DELETE", f"/session/{self.session}")
        self.driver.terminate()
        self.driver.wait(10)


# What the page shows, as scripts for it.
ROWS = "return document.querySelector('#rows').open ? document.querySelectorAll('#rows-table tbody tr').length : 0"
DRAWN = "return document.getElementById(arguments[0]).querySelectorAll('.marks .mark').length"
PLOTS = [
    "accuracy-plot",
    "depth-plot",
    "time-plot",
    "speed-plot",
    "tradeoff-plot",
    "conditioning-plot",
    "floor-plot",
    "steps-plot",
    "drift-plot",
]
CLOSED = "return !document.querySelector('#rows').open"
BACKGROUND = "return getComputedStyle(document.body).backgroundColor"
# Every section in its order. Those that are not in ALWAYS appear only if they have rows.
SECTIONS = [
    "verdict",
    "agreement",
    "import",
    "joints",
    "accuracy",
    "depth",
    "time",
    "speed",
    "tradeoff",
    "conditioning",
    "steps",
    "pairs",
    "conventions",
    "known",
    "provenance",
    "method",
    "unpassed",
]
ALWAYS = set(SECTIONS) - {"import", "joints", "accuracy", "speed", "tradeoff", "conditioning", "steps", "known"}
Checks = Iterator[tuple[str, Any, Any]]  # what, whether it is so, what was seen
Shot = Callable[[str], None]  # takes a picture of that name
FOCUS = "const cell = document.activeElement.closest('td'); return cell ? [cell.parentElement.rowIndex, cell.cellIndex] : null"


def checks(page: Browser, address: str, shots: pathlib.Path | None) -> Checks:
    """Yield (what, whether it is so, what was seen)."""

    def shot(name: str) -> None:
        if shots:
            page.shot(shots / f"{name}.png")

    def has(selector: str) -> bool:
        return bool(page.run("return document.querySelector(arguments[0]) !== null", selector))

    page.open(address)
    sections = page.run("return [...document.querySelectorAll('main > section')].map(section => section.id)")
    yield "the page has its sections", sections == [name for name in SECTIONS if name in ALWAYS or name in sections], sections
    led = page.run("return [...document.querySelectorAll('nav a')].map(link => link.hash.slice(1))")
    yield "the navigation leads to all of them", led == sections, led
    width = page.run("return [document.documentElement.scrollWidth, innerWidth]")
    yield "the page is no wider than its window", width[0] <= width[1], width
    shot("top")

    plots = [box for box in PLOTS if has(f"#{box}")]
    for box in plots:
        points = page.until(DRAWN, box)
        yield f"{box} draws points", points > 0, points
        page.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", box)
        shot(box)
    for box in plots:
        yield from chart(page, box, shot)
    if plots:
        page.click(f"#{plots[0]} .chart-save")
        file = page.downloads / f"featherbench-{plots[0]}.svg"
        end = time.monotonic() + 20
        while not file.is_file() and time.monotonic() < end:
            time.sleep(0.05)
        text = file.read_text() if file.is_file() else ""
        yield "a figure is saved as a file", text.startswith("<svg xmlns=") and text.endswith("</svg>"), text[:200]
    yield from axes(page)
    yield from awkward(page)

    listed = page.run("return document.querySelectorAll('#conventions tbody tr').length")
    yield "conventions are listed", listed > 0, listed
    page.run("document.getElementById('conventions').scrollIntoView({block: 'start', behavior: 'instant'})")
    shot("conventions")

    if has("#heat td button"):
        page.click("#heat td button")
        rows = page.until(ROWS)
        count = page.run("return document.querySelector('#rows-count').textContent")
        yield "a click on a cell shows its rows", rows > 0, count
        seen = page.run("""
            const heads = [...document.querySelectorAll('#rows-table th')].map(head => head.textContent);
            const column = heads.indexOf('engine');
            const engines = [...document.querySelectorAll('#rows-table tbody tr')].map(row => row.cells[column].textContent);
            return [[...new Set(engines)], document.querySelector('#heat th.engine').textContent]""")
        yield "they are that engine's rows alone", seen[0] == [seen[1]], seen
        shot("rows")
        first = page.run("return document.querySelector('#rows-table tbody').textContent")
        head = "[...document.querySelectorAll('#rows-table th button')].find(button => button.textContent === 'value')"
        if page.run(f"return {head} !== undefined"):
            page.run(f"{head}.click()")
            low = page.run("return document.querySelector('#rows-table tbody').textContent")
            page.run(f"{head}.click()")
            high = page.run("return document.querySelector('#rows-table tbody').textContent")
            yield "rows sort both ways", rows < 2 or low != high, [first[:60], low[:60], high[:60]]
        here = page.run("return location.href")
        page.press(ESCAPE)
        yield "Escape closes the rows", page.until(CLOSED), ""
        page.open("about:blank")
        page.open(here)
        yield "the address of open rows opens them again", page.until(ROWS) == rows, here[-80:]
        page.press(ESCAPE)

        page.run("document.querySelector('#heat td button').focus()")
        start = page.run(FOCUS)
        page.press(ARROW_RIGHT)
        page.press(ARROW_DOWN)
        end = page.run(FOCUS)
        yield "arrow keys walk the heatmap", start and end and end[0] > start[0] and end[1] > start[1], [start, end]
        tip = page.run("const tip = document.querySelector('#tip'); return tip.hidden ? '' : tip.textContent")
        yield "the focused cell is explained", len(tip) > 10, tip
        shot("tip")
        page.press(ENTER)
        yield "Enter opens the focused cell", page.until(ROWS) > 0, ""
        page.press(ESCAPE)

        engine = page.run("return document.querySelector('#heat-engine').options[1].value")
        page.choose("#heat-engine", engine)
        shown = page.run("return [...document.querySelectorAll('#heat th.engine')].filter(head => !head.hidden).length")
        yield "one engine can be chosen", shown == 1, shown
        shot("engine")
        page.choose("#heat-engine", "")
        page.run(
            "const box = document.querySelector('#heat-filter'); box.value = 'no model has this name';"
            " box.dispatchEvent(new Event('input'))"
        )
        shown = page.run("return [...document.querySelectorAll('#heat tr[data-m]')].filter(row => !row.hidden).length")
        yield "the filter hides models", shown == 0, shown
        page.run("const box = document.querySelector('#heat-filter'); box.value = ''; box.dispatchEvent(new Event('input'))")

    if has("#joints-table td button"):
        yield from joints(page, shot)

    if has("#accuracy-table td button"):
        yield from accuracy(page, shot)

    if has("#depth-quantity"):
        title = "return document.querySelector('#depth-plot .ytitle').textContent"
        before = page.run(title)
        others = page.run(
            "const list = document.querySelector('#depth-quantity');"
            " return [...list.options].filter(option => option.value !== list.value).map(option => option.value)"
        )
        if others:
            page.choose("#depth-quantity", others[0])
            after = page.until(f"const now = (() => {{ {title} }})(); return now !== arguments[0] && now", before)
            yield "another quantity can be plotted", bool(after) and page.until(DRAWN, "depth-plot") > 0, [before, after]
        marks = """
            const mark = document.querySelector('#depth-plot .marks .mark');
            if (!mark) return null;
            mark.scrollIntoView({block: 'center', behavior: 'instant'});
            const box = mark.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]"""
        place = page.run(marks)
        if place:
            move = {"type": "pointerMove", "duration": 50, "x": round(place[0]), "y": round(place[1])}
            pointer = [move, {"type": "pause", "duration": 300}, {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
            page.post("/actions", actions=[{"type": "pointer", "id": "mouse", "actions": pointer}])
            yield "a click on a mark shows its rows", page.until(ROWS) > 0, place
            page.press(ESCAPE)
    if has("#time-unit"):
        page.choose("#time-unit", "joint")
        title = page.until("return document.querySelector('#time-plot .ytitle').textContent.includes('joint')")
        yield "time per joint can be plotted", title, ""

    if has("#speed-plot"):
        yield from speed(page, shot)

    if has("#unpassed [data-chunk]"):
        page.click("#unpassed [data-chunk]")
        yield "what did not pass can be opened", page.until(ROWS) > 0, ""
        page.press(ESCAPE)

    before = page.run(BACKGROUND)
    ink = "const title = document.querySelector('.ytitle'); return title && title.getAttribute('fill')"
    plot_before = page.run(ink)
    page.run("scrollTo({top: 0, behavior: 'instant'})")
    page.click("#theme")
    after = page.run(BACKGROUND)
    yield "the theme changes", before != after, [before, after]
    if plot_before:
        yield (
            "the plots change with it",
            page.until(f"const now = (() => {{ {ink} }})(); return now !== arguments[0] && now", plot_before),
            plot_before,
        )
    shot("theme")
    if shots:
        for place in sections:
            page.run("document.getElementById(arguments[0]).scrollIntoView({behavior: 'instant'})", place)
            shot(f"theme-{place}")
    page.open("about:blank")
    page.open(address)
    yield "and is remembered", page.run(BACKGROUND) == after, ""

    page.post("/window/rect", width=500, height=900)
    narrow = page.until("return innerWidth < 600 && document.documentElement.scrollWidth <= innerWidth")
    yield "a narrow window does not scroll sideways", narrow, page.run("return [document.documentElement.scrollWidth, innerWidth]")
    shot("narrow")
    if plots:
        sizes = """
            const drawings = arguments[0].map(id => document.querySelector(`#${id} svg[role=img]`));
            return drawings.map(svg => [svg.viewBox.baseVal.width, svg.clientWidth])"""
        fitted = f"return (() => {{ {sizes} }})().every(([drawn, wide]) => drawn === wide && wide < 500)"
        yield "the plots are drawn again for a narrow window", page.until(fitted, plots), page.run(sizes, plots)

    errors = [entry["message"] for entry in page.log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    yield "the console is silent", not errors, errors[:3]
    asked: set[str] = set()
    for entry in page.log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            asked.add(message["params"]["request"]["url"])
    outside = [url for url in asked if url.startswith(("http:", "https:", "ws:", "wss:"))]
    yield "nothing is asked of the network", bool(asked) and not outside, outside[:3]


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
# The lines that explain a mark.
EXPLAINED = """
    const tip = document.querySelector(`#${arguments[0]} .chart-tip`);
    return tip.hidden ? '' : [...tip.children].map(line => line.textContent).join('|')"""


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

    saved = page.run(
        """
        const text = featherbench.chart.figure(document.getElementById(arguments[0]));
        const file = new DOMParser().parseFromString(text, 'image/svg+xml');
        const named = [...document.querySelectorAll(`#${arguments[0]} .chart-names span`)].map(span => span.textContent);
        return {
          root: file.documentElement.tagName,
          marks: file.querySelectorAll('.mark').length,
          paper: file.querySelector('rect').getAttribute('fill'),
          names: named.every(name => [...file.querySelectorAll('text')].some(text => text.textContent.startsWith(name))),
          borrowed: text.includes('var(') || text.includes('currentColor'),
        }""",
        box,
    )
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


def joints(page: Browser, shot: Shot) -> Checks:
    """Check the joint matrix."""
    page.run("document.getElementById('joints').scrollIntoView({behavior: 'instant'})")
    shot("joints")
    drawn = page.run("return document.querySelectorAll('#joints-table td button').length")
    told = page.run("return featherbench.chunks.get('figures').joints.cells.length")
    yield "the joint matrix shows every cell", drawn == told > 0, [drawn, told]
    kinds = {"unsupported": "skip", "deviates": "deviation", "agrees": "p"}
    for state, style in kinds.items():
        tip = page.run(
            """
            const button = document.querySelector(`#joints-table td button[class^='${arguments[0]}']`);
            if (!button) return null;
            button.focus();
            return document.querySelector('#tip').textContent""",
            style,
        )
        words = {"unsupported": "not offered", "deviates": "deviates by known cause", "agrees": "method"}[state]
        yield f"a cell of the joint matrix that {state} says so", tip is None or words in tip, tip
    shot("joints-tip")
    page.click("#joints-table td button")
    rows = page.until(ROWS)
    seen = page.run("""
        const heads = [...document.querySelectorAll('#rows-table th')].map(head => head.textContent);
        const table = [...document.querySelectorAll('#rows-table tbody tr')];
        return ['engine', 'quantity', 'robot'].map(name => [...new Set(table.map(row => row.cells[heads.indexOf(name)].textContent))])""")
    yield (
        "a click on a cell of the joint matrix shows its rows alone",
        rows > 0 and all(len(part) == 1 for part in seen) and seen[2][0].startswith("joints-"),
        seen,
    )
    page.press(ESCAPE)
    page.run("document.querySelector('#joints-table td button').focus()")
    start = page.run(FOCUS)
    page.press(ARROW_RIGHT)
    page.press(ARROW_DOWN)
    end = page.run(FOCUS)
    yield "arrow keys walk the joint matrix", start and end and end != start, [start, end]


def accuracy(page: Browser, shot: Shot) -> Checks:
    """Check the digits section."""
    shown = "[...document.querySelectorAll('#accuracy-table td button')].find(button => !button.closest('[hidden]'))"
    yield (
        "a cell of the accuracies says its quartiles",
        "quartiles"
        in page.run("""
        const button = [...document.querySelectorAll('#accuracy-table td button[class^=d]')].find(button => !button.closest('[hidden]'));
        button.focus();
        return document.querySelector('#tip').textContent"""),
        "",
    )
    shot("accuracy-cell")
    page.run(f"{shown}.id = 'clicked'")
    page.click("#clicked")
    rows = page.until(ROWS)
    seen = page.run("""
        const heads = [...document.querySelectorAll('#rows-table th')].map(head => head.textContent);
        const table = [...document.querySelectorAll('#rows-table tbody tr')];
        const values = name => [...new Set(table.map(row => row.cells[heads.indexOf(name)].textContent))];
        return [values('engine'), values('method'), values('quantity'), document.querySelector('#rows-filters [name=study]').value]""")
    yield (
        "a click on a cell of the digits shows its method's rows alone",
        rows > 0 and [len(part) for part in seen[:3]] == [1, 1, 1] and seen[3] == "accuracy",
        seen,
    )
    page.press(ESCAPE)

    page.run(f"{shown}.focus()")
    start = page.run(FOCUS)
    page.press(ARROW_RIGHT)
    page.press(ARROW_DOWN)
    end = page.run(FOCUS)
    yield "arrow keys walk the digits", start and end and end != start, [start, end]

    for quantity in page.run("return [...document.querySelector('#accuracy-quantity').options].map(option => option.value)")[::-1]:
        page.choose("#accuracy-quantity", quantity)
        heads = page.run("return [...document.querySelectorAll('#accuracy-table th.engine')].filter(head => !head.hidden).length")
        plotted = page.run("return !document.getElementById('accuracy-plot')") or page.until(DRAWN, "accuracy-plot") > 0
        yield f"the digits of {quantity} can be chosen", heads == 1 and plotted, heads
    if page.run("return document.querySelector('#accuracy-axis') !== null"):
        title = "return document.querySelector('#accuracy-plot .xtitle').textContent"
        titles: set[str] = set()
        axes = page.run("return [...document.querySelector('#accuracy-axis').options].map(option => option.value)")
        for axis in axes[::-1]:
            page.choose("#accuracy-axis", axis)
            now = page.until(f"const now = (() => {{ {title} }})(); return !arguments[0].includes(now) && now", sorted(titles))
            family = page.run("return document.querySelector('#accuracy-family').value")
            yield (
                f"the digits can be plotted against {axis}",
                bool(now) and page.until(DRAWN, "accuracy-plot") > 0 and family != "",
                [now, family],
            )
            titles.add(now)
            page.run("document.getElementById('accuracy-plot').scrollIntoView({block: 'center', behavior: 'instant'})")
            shot(f"accuracy-{axis}")
    page.run("const box = document.querySelector('#accuracy-filter'); box.value = 'no such robot'; box.dispatchEvent(new Event('input'))")
    left = page.run("return [...document.querySelectorAll('#accuracy-table tr[data-m]')].filter(row => !row.hidden).length")
    yield "the filter hides robots of the table of accuracy", left == 0, left
    page.run("const box = document.querySelector('#accuracy-filter'); box.value = ''; box.dispatchEvent(new Event('input'))")


def speed(page: Browser, shot: Shot) -> Checks:
    """Check the section on speed."""
    title = "return document.querySelector('#speed-plot .ytitle').textContent"
    for quantity in page.run("return [...document.querySelector('#speed-quantity').options].map(option => option.value)")[::-1]:
        words = page.run("return document.querySelector('#speed-quantity').options[arguments[0]].textContent", int(quantity))
        for case in ["hot", "stream"]:
            page.choose("#speed-case", case)
            page.choose("#speed-quantity", quantity)
            seen = page.until(f"const now = (() => {{ {title} }})(); return now.startsWith(arguments[0]) && now", words)
            ends = page.until("return document.querySelectorAll('#speed-plot .bar').length")
            yield (
                f"ratios of {words}, {case}, are plotted with intervals",
                bool(seen) and page.until(DRAWN, "speed-plot") > 0 and ends > 0,
                [seen, ends],
            )
    rows = page.run("""
        const number = cell => parseFloat(cell.textContent.replace(/^[^0-9]+/, ''));
        const rows = [...document.querySelectorAll('#speed-summary tbody tr')];
        const means = rows.map(row => [...row.querySelectorAll('td.number')].map(number));
        return means.map(([robots, mean, least, largest]) => least <= mean && mean <= largest && robots > 0)""")
    # On a machine that is not quiet, all ratios may be invalid. The page then says so, and why.
    none = page.run("return !!document.querySelector('#speed-none-valid') && document.querySelectorAll('#speed-invalid li').length > 0")
    yield (
        "every geometric mean lies between its least and its largest, or no ratio counts and the page says why",
        bool(rows) != none and all(rows),
        [rows, none],
    )
    page.run("document.querySelectorAll('#speed details').forEach(part => { part.open = true; })")
    for table in ["speed-controls"] if none else ["speed-summary", "speed-controls"]:
        found = page.run("return document.querySelectorAll(`#${arguments[0]} tbody tr`).length", table)
        yield f"{table} has rows", found > 0, found
        page.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", table)
        shot(table)
    page.run("document.querySelectorAll('#speed details').forEach(part => { part.open = false; })")


def main() -> int:
    """Run the checks."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("report", type=pathlib.Path, help="folder that holds index.html")
    parser.add_argument("--shots", type=pathlib.Path, help="folder for screenshots")
    arguments = parser.parse_args()
    index = (arguments.report / "index.html").resolve()
    if not index.is_file():
        parser.error(f"{index} does not exist")
    if arguments.shots:
        arguments.shots.mkdir(parents=True, exist_ok=True)

    passed = failed = 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        try:
            page = Browser(profile)
        except (OSError, RuntimeError) as error:
            print(f"the browser could not be started: {error}", file=sys.stderr)
            return 2
        try:
            for what, good, seen in checks(page, index.as_uri(), arguments.shots):
                print(f"{'ok  ' if good else 'FAIL'} {what}" + ("" if good else f": {seen}"))
                passed, failed = passed + bool(good), failed + (not good)
        except (OSError, RuntimeError) as error:
            print(f"FAIL the test was cut short: {error}")
            failed += 1
        finally:
            page.close()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
