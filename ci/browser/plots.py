"""Checks of the drawings: what they show, and what they do under the mouse and the keyboard."""

from __future__ import annotations

import time

from browser.client import ARROW_DOWN, ARROW_RIGHT, ENTER, ESCAPE, Browser
from browser.page import DRAWING, DRAWN, ROWS, Checks, Shot

# The names of the drawings that are seen, each once.
SEEN = """
    const boxes = [...document.querySelectorAll('.drawing:not([hidden] *)')];
    return boxes.filter(box => box.querySelector('svg')).map(box => box.dataset.name)"""
# A drawing as its reader has it: marks, numbers at the ticks, names that are switched on, and whether the zoom can be taken back.
PLOT = (
    DRAWING
    + """
    const seen = part => part.style.display !== 'none' && part.getAttribute('display') !== 'none';
    const texts = selector => [...box.querySelectorAll(selector)].filter(tick => seen(tick))
      .flatMap(tick => [...tick.querySelectorAll('text')].filter(seen)).map(text => text.textContent);
    const series = [...box.querySelectorAll('.series')].filter(seen);
    return {
      points: series.flatMap(group => [...group.querySelectorAll('.mark')]).filter(seen).length,
      ticks: [texts('.xticks .tick'), texts('.yticks .tick')],
      names: [...box.querySelectorAll('.entry')].map(name => name.ariaPressed === 'true'),
      zoomed: !box.querySelector('.chart-back').hidden,
    }"""
)
# Where the mark is that has the most room about it, and the edges of the box.
LONELY = (
    DRAWING
    + """
    const svg = box.querySelector('svg');
    // A drawing with many names may be higher than the window.
    svg.querySelector('.box').scrollIntoView({block: 'center', behavior: 'instant'});
    const middle = box => [box.x + box.width / 2, box.y + box.height / 2];
    const marks = [...svg.querySelectorAll('.series .mark')].filter(mark => mark.getBoundingClientRect().width > 0);
    const places = marks.map(mark => middle(mark.getBoundingClientRect()));
    const room = ([x, y]) => Math.min(...places.map(([a, b]) => Math.hypot(a - x, b - y)).filter(distance => distance > 1), 1e9);
    const rooms = places.map(room);
    const best = rooms.indexOf(Math.max(...rooms));
    const edge = svg.querySelector('.box').getBoundingClientRect();
    return {mark: places[best], rows: marks[best].dataset.rows ?? '', edge: [edge.left, edge.top, edge.right, edge.bottom]}"""
)
# A drawing as its reader saves it.
SAVED = (
    DRAWING
    + """
    const text = box.saved();
    const file = new DOMParser().parseFromString(text, 'image/svg+xml');
    const named = [...box.querySelectorAll('.entry[aria-pressed=true] text')].map(name => name.textContent);
    return {
      root: file.documentElement.tagName,
      marks: file.querySelectorAll('.series .mark').length,
      names: named.every(name => [...file.querySelectorAll('text')].some(text => text.textContent === name)),
      borrowed: /var\\(|currentColor|data-|tabindex/.test(text),
    }"""
)
# The lines that explain a mark.
EXPLAINED = (
    DRAWING
    + """
    const tip = box.querySelector('.chart-tip');
    return tip.hidden ? '' : [...tip.children].map(line => line.textContent).join('|')"""
)
SWITCH = (
    DRAWING
    + """
    const names = box.querySelectorAll('.entry');
    for (const k of arguments[1]) names[k].dispatchEvent(new MouseEvent('click', {bubbles: true}));"""
)
FOCUS = DRAWING + "box.querySelector('svg').focus()"
# Seconds after which a browser is taken to save nothing, on a machine however busy.
PATIENCE = 120


def drawn(page: Browser) -> list[str]:
    """List the drawings of this page."""
    return list(page.run(SEEN))


def plots(page: Browser, shot: Shot) -> Checks:
    """Check every drawing of the page, and one as a file."""
    boxes = drawn(page)
    yield "no two drawings that are seen have one name", len(set(boxes)) == len(boxes), boxes
    for box in boxes:
        points = page.until(DRAWN, box)
        yield f"{box} draws points", points > 0, points
        page.run(DRAWING + "box.scrollIntoView({block: 'center', behavior: 'instant'})", box)
        shot(box)
    for box in boxes:
        yield from drawing(page, box, shot)
    if boxes:
        page.run(DRAWING + "box.querySelector('.chart-save').click()", boxes[0])
        file = page.downloads / f"featherbench-{boxes[0]}.svg"
        # The browser makes an empty file of this name before it writes the drawing.
        text, end = "", time.monotonic() + PATIENCE
        while not text.endswith("</svg>") and time.monotonic() < end:
            time.sleep(0.05)
            text = file.read_text() if file.is_file() else ""
        yield "a drawing is saved as a file", text.startswith("<svg xmlns=") and text.endswith("</svg>"), text[:200]
        page.run(DRAWING + "box.querySelector('.chart-copy').click()", boxes[0])
        answered = page.until(DRAWING + "return box.querySelector('.chart-copy').textContent !== 'Copy data'", boxes[0])
        yield "the data of a drawing can be copied, or the browser forbids it", answered, ""


# Series that are seen at first: `figure/draw.rs` says which.
AT_ONCE = 6


def drawing(page: Browser, box: str, shot: Shot) -> Checks:
    """Check what a drawing does under the mouse and the keyboard."""
    first = page.run(PLOT, box)
    numbers = [text for axis in first["ticks"] for text in axis]
    yield (
        f"{box} has ticks on both axes",
        all(first["ticks"]) and all("NaN" not in text and "undefined" not in text for text in numbers),
        numbers,
    )
    label = page.run(DRAWING + "return box.querySelector('svg').ariaLabel", box)
    yield f"{box} is described in words", f"{first['points']} points" in label, label

    place = page.run(LONELY, box)
    x, y = place["mark"]
    page.point((x + 3, y - 3), (x, y))
    text = page.run(EXPLAINED, box)
    yield f"{box} explains the mark that is pointed at", len(text) > 5 and "undefined" not in text and "NaN" not in text, text
    shot(f"{box}-tip")
    left, top, right, bottom = place["edge"]
    page.point((left - 40, bottom + 30))
    yield f"{box} explains nothing where no mark is", page.run(EXPLAINED, box) == "", ""
    if place["rows"]:
        page.point((x, y), "down", "up")
        yield f"{box}: a click on a mark shows its rows", page.until(ROWS) > 0, place
        page.press(ESCAPE)

    page.run(FOCUS, box)
    page.press(ARROW_RIGHT)
    text = page.run(EXPLAINED, box)
    page.press(ARROW_RIGHT)
    page.press(ARROW_DOWN)
    other = page.run(EXPLAINED, box)
    yield f"{box} is walked with the arrow keys", len(text) > 5 and (first["points"] < 2 or other != text), [text, other]
    page.press(ESCAPE)

    press = DRAWING + "box.querySelector('.entry').dispatchEvent(new MouseEvent('click', {bubbles: true}))"
    page.run(press, box)
    off = page.run(PLOT, box)
    yield f"{box}: a click on a name switches it off", first["names"][0] and off["names"] == [False, *first["names"][1:]], off["names"]
    page.run(DRAWING + "box.querySelector('.entry').focus()", box)
    page.press(ENTER)
    again = page.run(PLOT, box)
    yield f"{box}: Enter on a name switches it on again", again == first, [again, first]
    of_first = [k for k, on in enumerate(first["names"]) if on]
    others = [k for k, on in enumerate(first["names"]) if not on]
    page.run(SWITCH, box, of_first)
    none = page.run(PLOT, box)
    yield f"{box} without any series has no points", none["points"] == 0, none["points"]
    page.run(SWITCH, box, of_first)
    yield f"{box} comes back whole", page.run(PLOT, box) == first, ""
    at_once = min(len(first["names"]), AT_ONCE)
    yield f"{box} shows six series at first, or all of fewer", len(of_first) == at_once, first["names"]
    if others:
        page.run(DRAWING + "box.querySelector('.chart-every').click()", box)
        whole = page.run(PLOT, box)
        yield f"{box} shows all of them by its button", all(whole["names"]) and whole["points"] >= first["points"], whole["names"]
        page.run(SWITCH, box, others)

    for way in ["Escape", "a double click", "its button"]:
        place = page.run(LONELY, box)
        x, y = place["mark"]
        left, top, right, bottom = place["edge"]
        begin = (max(x - 60, left + 5), max(y - 50, top + 5))
        end = (min(x + 50, right - 5), min(y + 40, bottom - 5))
        page.point(begin, "down", (x, y), end, "up")
        zoomed = page.run(PLOT, box)
        good = zoomed["zoomed"] and 0 < zoomed["points"] <= first["points"] and zoomed["ticks"] != first["ticks"]
        yield f"{box}: a drawn rectangle zooms, and opens no rows", good and not page.run(ROWS), [zoomed["points"], zoomed["ticks"]]
        if way == "Escape":
            shot(f"{box}-zoom")
            page.run(FOCUS, box)
            page.press(ESCAPE)
        elif way == "its button":
            page.run(DRAWING + "box.querySelector('.chart-back').click()", box)
        else:
            corner = (left - 40, bottom + 30)
            page.point(corner, "down", "up", "down", "up")
        whole = page.run(PLOT, box)
        yield f"{box} is whole again after {way}", whole == first, [whole["zoomed"], whole["points"]]

    saved = page.run(SAVED, box)
    whole = saved["root"] == "svg" and saved["marks"] == first["points"] and saved["names"]
    yield f"{box} as a file has its marks and names, and nothing of the page", whole and not saved["borrowed"], saved
