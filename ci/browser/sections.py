"""Checks of the page as a whole, section by section, in the order of a reader."""

from __future__ import annotations

import json
import pathlib
import re

from browser.cells import accuracy, heatmap, joints
from browser.client import ARROW_RIGHT, ESCAPE, Browser
from browser.page import DRAWING, DRAWN, ROWS, Checks, Shot, has, open_whole
from browser.plots import drawn, plots

# The most nodes of the first page before the reader does anything.
MOST_NODES = 3000
# Into each section with more than a line of its own: a line that says that there is nothing, before the last part.
NOTHING = """
    for (const section of document.querySelectorAll('main > section')) {
      if (section.children.length < 4) continue;
      const line = document.createElement('p');
      line.className = 'empty planted';
      line.textContent = 'Nothing.';
      section.insertBefore(line, section.lastElementChild);
    }"""
# What compareDocumentPosition says of an element behind another one.
FOLLOWING = 4
BACKGROUND = "return getComputedStyle(document.body).backgroundColor"
# Every section in its order, study by study. Those that are not in ALWAYS appear only if they have rows.
SECTIONS = [
    "verdict",
    "engines",
    "pairs",
    "agreement",
    "depth",
    "joints",
    "import",
    "accuracy",
    "sweep",
    "conditioning",
    "derivatives",
    "contact",
    "continuum",
    "scenes",
    "identification",
    "residuals",
    "lesson",
    "uncertainty",
    "steps",
    "scaling",
    "loops",
    "contact_timing",
    "time",
    "speed",
    "tradeoff",
    "figures",
    "conventions",
    "known",
    "provenance",
    "method",
    "unpassed",
]
# The levels of findings from the gravest; conditions without a level come last.
LEVELS = ["physics differs", "method loses digits", "not offered", "rounding", "gate not met"]
ALWAYS = {"verdict", "agreement", "depth", "pairs", "time", "conventions", "provenance", "method", "unpassed"}


def checks(page: Browser, address: str, shots: pathlib.Path | None) -> Checks:
    """Yield (what, whether it is so, what was seen)."""

    def shot(name: str) -> None:
        if shots:
            page.shot(shots / f"{name}.png")

    page.open(address)
    yield from first_page(page)
    yield from paper(page, address)
    open_whole(page, address)
    sections = page.run("return [...document.querySelectorAll('main > section')].map(section => section.id)")
    yield "the page has its sections", sections == [name for name in SECTIONS if name in ALWAYS or name in sections], sections
    led = page.run("return [...document.querySelectorAll('nav a')].map(link => link.hash.slice(1))")
    yield "the navigation leads to all of them", led == sections, led
    width = page.run("return [document.documentElement.scrollWidth, innerWidth]")
    yield "the page is no wider than its window", width[0] <= width[1], width
    shot("top")

    yield from findings(page)
    yield from plots(page, shot)
    yield from conventions(page, shot)
    if has(page, "#heat td button"):
        yield from heatmap(page, shot)
    if has(page, "#joints-table td button"):
        yield from joints(page, shot)
    if has(page, "#accuracy-table td button"):
        yield from accuracy(page, shot)
    if has(page, "#depth-quantity"):
        yield from depth(page)
    if has(page, "#time-family"):
        for family in page.run("return [...document.querySelector('#time-family').options].map(option => option.value)")[::-1]:
            page.choose("#time-family", family)
            yield f"times of family {family} are plotted", page.until(DRAWN, "time-plot") > 0, family
        yield from linked(page, address)
    if has(page, "#pairs-one"):
        yield from pairs(page, shot)
    if has(page, "#speed-quantity"):
        yield from speed(page, shot)
    if has(page, "#speed-verdict"):
        yield from fastest(page, shot)
    if has(page, "#figures"):
        yield from figures(page, shot)
    if has(page, "#scaling"):
        yield from scaling(page, shot)
    if has(page, "#unpassed [data-chunk]"):
        page.click("#unpassed [data-chunk]")
        yield "what did not pass can be opened", page.until(ROWS) > 0, ""
        page.press(ESCAPE)
    yield from theme(page, address, shot, sections if shots else [])
    yield from narrow(page, shot)
    yield from silence(page)


def first_page(page: Browser) -> Checks:
    """Check what the browser holds before the reader does anything. Times are printed, and decide nothing."""
    nodes = page.run("return document.querySelectorAll('*').length")
    yield f"the first page has at most {MOST_NODES} nodes: {nodes}", nodes <= MOST_NODES, nodes
    times = page.until("""
        const [page] = performance.getEntriesByType('navigation');
        const paint = performance.getEntriesByName('first-contentful-paint')[0];
        return page.loadEventEnd > 0 && paint && {
          'first paint': paint.startTime, 'usable': page.domContentLoadedEventEnd, 'loaded': page.loadEventEnd}""")
    told = ", ".join(f"{what} after {ms:.0f} ms" for what, ms in times.items()) if times else "no times"
    yield f"the browser tells its times: {told}", bool(times), times
    left = page.run("return [...document.querySelectorAll('[data-part]')].map(place => place.querySelector('a')?.getAttribute('href'))")
    missing = [place for place in left if not place or not place.startswith(("sections/", "robots/"))]
    yield "what is left out is linked, for readers without scripts", not missing, missing
    details = "document.querySelector('#verdict details:has(> [data-part])')"
    if page.run(f"return {details} !== null"):
        page.run(f"{details}.id = 'opened'")
        page.click("#opened > summary")
        brought = page.until("return !document.querySelector('#opened > [data-part]') && document.querySelectorAll('#opened *').length")
        yield "what is left out is brought when it is opened", brought > 3, brought
    far = page.run("return document.querySelector('main > section[data-part]:last-of-type')?.id")
    if far:
        page.click(f"nav a[href='#{far}']")
        brought = page.until("return !document.getElementById(arguments[0]).dataset.part", far)
        inside = page.run("return document.getElementById(arguments[0]).getBoundingClientRect().top < innerHeight", far)
        yield "a section is brought when the reader goes to it", brought and inside, [far, inside]


def paper(page: Browser, address: str) -> Checks:
    """Check that the printed page has every section, also those that the reader has not come to."""
    page.open("about:blank")
    page.open(address)
    left = "[...document.querySelectorAll('main > section[data-part]')].map(section => section.id)"
    away = page.run(f"return {left}")
    loaded = f"return {left}.every(id => featherbench.chunks.has(`part-${{id}}`)) && featherbench.chunks.has('figures')"
    yield "what paper needs is loaded when the page is idle", page.until(loaded), page.run(f"return {left}")
    pages = len(re.findall(rb"/Type\s*/Page\b", page.printed()))
    after = page.run(f"return {left}")
    sections = page.run("return document.querySelectorAll('main > section').length")
    yield f"paper has all {sections} sections, {len(away)} of them brought to print: {pages} pages", away and not after and pages > 1, after


def findings(page: Browser) -> Checks:
    """Check the findings on the first page: their order, their rows, the command that repeats them."""
    listed = page.run("return [...document.querySelectorAll('#verdict ol.findings .level')].map(level => level.textContent.trim())")
    told = [(not level.endswith(", new"), level.removesuffix(", new")) for level in listed]
    places = [(known, LEVELS.index(level)) for known, level in told if level in LEVELS]
    yield "new findings stand first, then from the gravest", len(places) == len(listed) and places == sorted(places), listed
    said = page.run("return [document.querySelector('h1').textContent, document.querySelectorAll('#verdict .tile').length]")
    failed = has(page, "#verdict.bad")
    yield (
        "a passed run opens with the verdict in numbers, a failed one with what failed",
        (": " in said[0] if failed else re.search("deviation|none with a bound", said[0]) and "off by" not in said[0])
        and said[1] == len(LEVELS) - 1,
        said,
    )
    if has(page, "#ranking"):
        above = "document.querySelector('#ranking').compareDocumentPosition(document.querySelector('#verdict .tiles'))"
        first = bool(page.run(f"return {above}") & FOLLOWING)
        yield "the ranking of the engines stands above the findings of a passed run", first != failed, first
        cut = page.run("const box = document.querySelector('.of-ranking'); return box.scrollWidth - box.clientWidth")
        yield "no column of the ranking is cut", cut <= 0, cut
    if has(page, "#verdict ol.findings [data-chunk]"):
        page.click("#verdict ol.findings [data-chunk]")
        yield "the rows of a finding can be opened", page.until(ROWS) > 0, ""
        page.press(ESCAPE)
        again = page.run("return document.querySelector('#verdict details.again code').textContent")
        yield "a finding has the command that repeats it", "--filter" in again or "compare" in again, again


def fastest(page: Browser, shot: Shot) -> Checks:
    """Check the verdict on speed: a time is told, and a cell of its map opens the rows of all robots."""
    told = page.run("return document.querySelector('#time-first')?.textContent ?? ''")
    yield "the section on time begins with a time", " ns" in told, told
    page.click("#speed-verdict details summary")
    lines = page.run("return document.querySelectorAll('#speed-by-robot tbody tr').length")
    yield "the verdict on speed lists robots and quantities", lines > 0, lines
    shot("fastest")
    if has(page, ".speed-map [data-chunk]"):
        page.click(".speed-map [data-chunk]")
        yield "a cell of the speed map opens its rows", page.until(ROWS) > 0, ""
        page.press(ESCAPE)


def figures(page: Browser, shot: Shot) -> Checks:
    """Check the figures for papers: each is drawn, and its data can be copied or saved."""
    page.run("document.getElementById('figures').scrollIntoView({block: 'start', behavior: 'instant'})")
    # Those off the screen are drawn at once, too.
    page.run("for (const image of document.querySelectorAll('#figures img')) image.loading = 'eager'")
    widths = "[...document.querySelectorAll('#figures img')].map(image => image.naturalWidth)"
    whole = page.until(f"const widths = {widths}; return widths.length > 0 && Math.min(...widths) > 100")
    yield "every figure for papers is drawn", whole, page.run(f"return {widths}")
    captions = page.run("return [...document.querySelectorAll('#figures figcaption')].map(caption => caption.textContent.length)")
    yield "every figure has a caption", min(captions) > 60, captions
    saved = page.run("return [...document.querySelectorAll('#figures a[download]')].map(link => link.getAttribute('href'))")
    yield "every figure can be saved, with its data", len(saved) == 2 * len(captions), saved
    page.click("#figures button.copy-data")
    answered = page.until("return document.querySelector('#figures button.copy-data').textContent !== 'Copy data'")
    name = page.run("return document.querySelector('#figures button.copy-data').dataset.figure")
    data = page.run("return featherbench.chunks.get('figure-data')[arguments[0]]", name)
    # A line of names, and a point at least: of a run on a machine that is not quiet few times count.
    yield "the data of a figure can be copied", answered and data.count("\n") >= 2, [answered, data[:80]]
    shot("figures")


def conventions(page: Browser, shot: Shot) -> Checks:
    """Check the list of conventions."""
    listed = page.run("return document.querySelectorAll('#conventions tbody tr').length")
    named = has(page, "#conventions-unlisted")
    nothing = has(page, "#conventions > .empty")
    told = "conventions are listed, engines without a list are named, or there is nothing to list"
    yield told, (listed > 0 or named) != nothing, [listed, named, nothing]
    page.run("document.getElementById('conventions').scrollIntoView({block: 'start', behavior: 'instant'})")
    shot("conventions")


def depth(page: Browser) -> Checks:
    """Check the drawings of errors against depth."""
    title = DRAWING + "const now = box?.querySelector('.ytitle').textContent; return now !== arguments[1] && now"
    before = page.run(title, "depth-plot", "")
    others = page.run(
        "const list = document.querySelector('#depth-quantity');"
        " return [...list.options].filter(option => option.value !== list.value).map(option => option.value)"
    )
    if others:
        page.choose("#depth-quantity", others[0])
        after = page.until(title, "depth-plot", before)
        yield "another quantity can be plotted", bool(after) and page.until(DRAWN, "depth-plot") > 0, [before, after]


def linked(page: Browser, address: str) -> Checks:
    """Check that the link below a drawing leads to it, with what is chosen. Opens the page anew, and brings all of it."""
    value = page.run("return [...document.querySelector('#time-quantity').options].at(-1).value")
    page.choose("#time-quantity", value)
    link = (
        DRAWING
        + "const link = box?.querySelector('.chart-link'); link?.dispatchEvent(new Event('pointerdown'));"
        + " return link?.hash.includes(arguments[1]) && link.hash"
    )
    found = page.until(link, "time-plot", value)
    page.open("about:blank")
    page.open(address + str(found))
    there = page.until(
        "const list = document.querySelector('#time-quantity');"
        " return list?.value === arguments[0] && list.getBoundingClientRect().top < innerHeight && list.value",
        value,
    )
    yield "the link below a drawing leads to it", there == value and page.until(DRAWN, "time-plot") > 0, [found, there]
    open_whole(page, address)


def pairs(page: Browser, shot: Shot) -> Checks:
    """Check the tables of two engines."""
    engines = page.run("return [...document.querySelector('#pairs-one').options].map(option => option.value).slice(1)")
    page.choose("#pairs-one", engines[-1])
    other = page.until("const list = document.querySelector('#pairs-other'); return list.value !== arguments[0] && list.value", engines[-1])
    lines = page.until("return [...document.querySelectorAll('#pairs table.compact tbody tr')].filter(row => row.offsetParent).length")
    yield f"{engines[-1]} can be compared with {other} alone", other in engines and lines > 0, [engines, other, lines]
    shot("pairs")
    page.choose("#pairs-one", "all")


def speed(page: Browser, shot: Shot) -> Checks:
    """Check the section on speed."""
    title = DRAWING + "const now = box?.querySelector('.ytitle').textContent ?? ''; return now.startsWith(arguments[1]) && now"
    for quantity in page.run("return [...document.querySelector('#speed-quantity').options].map(option => option.value)")[::-1]:
        option = "[...document.querySelector('#speed-quantity').options].find(option => option.value === arguments[0])"
        words = page.run(f"return {option}.textContent", quantity)
        page.choose("#speed-quantity", quantity)
        cases = "[...document.querySelector('#speed-case').options].filter(option => !option.disabled)"
        for case in page.run(f"return {cases}.map(option => option.value)"):
            page.choose("#speed-case", case)
            seen = page.until(title, "speed-plot", words)
            ends = page.until(DRAWING + "return box?.querySelectorAll('.interval').length", "speed-plot")
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
    # On a quiet machine every A/A control holds 1.
    for table in [table for table in ("speed-summary", "speed-controls") if has(page, f"#{table}")]:
        found = page.run("return document.querySelectorAll(`#${arguments[0]} tbody tr`).length", table)
        yield f"{table} has rows", found > 0, found
        page.run("document.getElementById(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", table)
        shot(table)
    page.run("document.querySelectorAll('#speed details').forEach(part => { part.open = false; })")


def scaling(page: Browser, shot: Shot) -> Checks:
    """Check the section on scaling."""
    if has(page, "#scaling-line"):
        answer = page.run("return document.getElementById('scaling-answer').textContent")
        yield "the section on scaling begins with its answer", "degrees of freedom" in answer and "a call" in answer, answer
        for line in page.run("return [...document.querySelector('#scaling-line').options].map(option => option.value)")[::-1]:
            page.choose("#scaling-line", line)
            drawn_points = [page.until(DRAWN, name) for name in ("scaling-time", "scaling-memory", "scaling-error")]
            yield f"time, memory and error of {line} are plotted", all(points > 0 for points in drawn_points), drawn_points
        last = "document.querySelectorAll('#scaling-limits tbody tr td:last-child')"
        reasons = page.run(f"return [...{last}].map(cell => cell.textContent.trim())")
        yield "every method says why it goes no further", bool(reasons) and all(reasons), reasons
    for table in ["scaling-crossovers", "scaling-errors", "scaling-counts"]:
        found = page.run("return document.querySelectorAll(`#${arguments[0]} tbody tr`).length", table)
        yield f"{table} has rows", found > 0, found
    if has(page, "#scaling-counts tbody button"):
        page.click("#scaling-counts tbody button")
        yield "a tree's counts open its rows", page.until(ROWS) > 0, ""
        page.press(ESCAPE)
    page.run("document.getElementById('scaling').scrollIntoView({block: 'start', behavior: 'instant'})")
    shot("scaling")


def theme(page: Browser, address: str, shot: Shot, pictured: list[str]) -> Checks:
    """Check the change of theme; of each section that is pictured, a picture is taken."""
    before = page.run(BACKGROUND)
    page.run("scrollTo({top: 0, behavior: 'instant'})")
    page.click("#theme")
    after = page.run(BACKGROUND)
    yield "the theme changes", before != after, [before, after]
    papers = page.run("return [...document.querySelectorAll('.paper')].map(paper => getComputedStyle(paper).backgroundColor)")
    yield "drawings stay on white paper", set(papers) <= {"rgb(255, 255, 255)"}, set(papers)
    shot("theme")
    for place in pictured:
        page.run("document.getElementById(arguments[0]).scrollIntoView({behavior: 'instant'})", place)
        shot(f"theme-{place}")
    page.open("about:blank")
    open_whole(page, address)
    yield "and is remembered", page.run(BACKGROUND) == after, ""


def narrow(page: Browser, shot: Shot) -> Checks:
    """Check the page in a narrow window."""
    page.resize(390, 844)
    fits = page.until("return innerWidth < 600 && document.documentElement.scrollWidth <= innerWidth")
    widths = "return [document.documentElement.scrollWidth, innerWidth]"
    yield "a narrow window does not scroll sideways", fits, page.run(widths)
    # A machine that is not quiet has no valid ratio: what says so stands between the drawings and the tables.
    page.run(NOTHING)
    width = page.run(widths)
    yield "neither does it where a part of each section has nothing to show", width[0] <= width[1], width
    page.run("document.querySelectorAll('.planted').forEach(line => line.remove())")
    shot("narrow")
    seen = "return document.querySelector('nav a').offsetParent !== null"
    page.click("#menu")
    opened = page.until(seen)
    shot("menu")
    page.click("nav a:nth-of-type(2)")
    yield "the navigation is a menu that opens, and closes when a section is chosen", opened and page.until(f"return !({seen[7:]})"), opened
    if boxes := drawn(page):
        page.run(DRAWING + "box.scrollIntoView({block: 'center', behavior: 'instant'}); box.querySelector('svg').focus()", boxes[0])
        page.press(ARROW_RIGHT)
        edges = "const {left, right} = box.querySelector('.chart-tip').getBoundingClientRect(); return [left, right]"
        tip = page.run(DRAWING + edges, boxes[0])
        yield "a tip is inside a narrow window", tip[1] > tip[0] >= 0 and tip[1] <= page.run("return innerWidth"), tip


def silence(page: Browser) -> Checks:
    """Check that the page reported no error and asked nothing of a network."""
    errors = [entry["message"] for entry in page.log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    yield "the console is silent", not errors, errors[:3]
    asked: set[str] = set()
    for entry in page.log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            asked.add(message["params"]["request"]["url"])
    outside = [url for url in asked if url.startswith(("http:", "https:", "ws:", "wss:"))]
    yield "nothing is asked of the network", bool(asked) and not outside, outside[:3]
