"""Checks of the tables whose cells open rows: the heatmap, the joint matrix and the accuracies."""

from __future__ import annotations

from browser.client import ARROW_DOWN, ARROW_RIGHT, ENTER, ESCAPE, Browser
from browser.page import CLOSED, DRAWING, DRAWN, FOCUS, ROWS, Checks, Shot, open_whole

FOLLOWING = 4  # what compareDocumentPosition says of an element behind another
DISTINCT = """
    const heads = [...document.querySelectorAll('#rows-table th')].map(head => head.textContent);
    const table = [...document.querySelectorAll('#rows-table tbody tr')];
    return arguments[0].map(name => [...new Set(table.map(row => row.cells[heads.indexOf(name)].textContent))])"""


def heatmap(page: Browser, shot: Shot) -> Checks:
    """Check the heatmap of margins, and the rows that a cell opens."""
    page.click("#heat td button")
    rows = page.until(ROWS)
    count = page.run("return document.querySelector('#rows-count').textContent")
    yield "a click on a cell shows its rows", rows > 0, count
    seen = page.run("""
        const heads = [...document.querySelectorAll('#rows-table th')].map(head => head.textContent);
        const column = heads.indexOf('engine');
        const engines = [...document.querySelectorAll('#rows-table tbody tr')].map(row => row.cells[column].textContent);
        return [[...new Set(engines)], document.querySelector('#heat th.engine').title]""")
    yield "they are that engine's rows alone", seen[0] == [seen[1]], seen
    about = page.run("""
        const heads = [...document.querySelectorAll('#rows-about dt')].map(head => head.textContent);
        const words = [...document.querySelectorAll('#rows-about dd')].map(words => words.textContent);
        return [heads, words, document.querySelector('#rows-about').compareDocumentPosition(document.querySelector('#rows-table'))]""")
    due = ["robot", "engine", "quantity", "reference", "worst", "level", "repeat it"]
    named = [head for head in about[0] if head in due]
    yield (
        "the rows begin with what the cell is about, and with the command that repeats it",
        named == due and all(about[1]) and "--filter" in about[1][-1] and about[2] == FOLLOWING,
        about,
    )
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
    open_whole(page, here)
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

    first = "[...document.querySelector('#heat').tBodies].find(body => body.rows.length > 0).rows"
    names = f"return [...{first}].filter(row => row.dataset.m).map(row => row.cells[0].firstChild.textContent)"
    given = page.run(names)
    page.choose("#heat-sort", "worst")
    ranks = page.run(f"return [...{first}].map(row => Number(row.dataset.worst))")
    yield "the robots can be sorted from the worst", len(ranks) > 0 and ranks == sorted(ranks), ranks[:9]
    page.choose("#heat-sort", "")
    yield "and stand in their order again", page.run(names) == given, given[:3]
    page.click("#heat-trouble")
    seen = page.run("""
        const shown = [...document.querySelectorAll('#heat tr[data-m]')].filter(row => !row.hidden);
        return shown.every(row => [...row.querySelectorAll('td button')].some(button => !/^p\\d/.test(button.className)))""")
    yield "only robots with trouble can be shown", seen, ""
    page.click("#heat-trouble")
    page.run(
        "const box = document.querySelector('#heat-filter'); box.value = 'no model has this name'; box.dispatchEvent(new Event('input'))"
    )
    shown = page.run("return [...document.querySelectorAll('#heat tr[data-m]')].filter(row => !row.hidden).length")
    yield "the filter hides models", shown == 0, shown
    page.run("const box = document.querySelector('#heat-filter'); box.value = ''; box.dispatchEvent(new Event('input'))")

    engine = page.run("return document.querySelector('#heat th.engine').title")
    page.click("#heat th.engine")
    table = page.until("return document.querySelector('.heat-of:not([hidden]) table.map')?.id ?? ''")
    heads = page.run("return [...document.querySelectorAll(`#${arguments[0]} th.engine`)].map(head => head.title)", table)
    hidden = page.run("return document.querySelector('#heat-whole').hidden")
    yield "the head of an engine opens its quantities", hidden and len(heads) > 1, [engine, heads]
    shot("engine")
    page.click(f"#{table} td button")
    rows = page.until(ROWS)
    seen = page.run(DISTINCT, ["engine", "quantity", "robot"])
    yield (
        "a cell of an engine's quantities opens its rows alone",
        rows > 0 and seen[0] == [engine] and all(len(part) == 1 for part in seen),
        seen,
    )
    page.press(ESCAPE)
    page.choose("#heat-engine", "")
    yield "the worst of each engine comes back", page.run("return !document.querySelector('#heat-whole').hidden"), ""


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
        along = page.run("return document.querySelector('#accuracy-family').value")
        plotted = along == "" or page.until(DRAWN, "accuracy-plot") > 0
        yield f"the digits of {quantity} can be chosen", heads == 1 and plotted, heads
    if along:
        title = DRAWING + "const now = box?.querySelector('.xtitle')?.textContent; return now && !arguments[1].includes(now) && now"
        titles: set[str] = set()
        options = "[...document.querySelector('#accuracy-axis').options]"
        axes = page.run(f"return {options}.filter(option => !option.disabled).map(option => option.value)")
        for axis in axes[::-1]:
            page.choose("#accuracy-axis", axis)
            now = page.until(title, "accuracy-plot", sorted(titles))
            family = page.run("return document.querySelector('#accuracy-family').value")
            yield (
                f"the digits can be plotted against {axis}",
                bool(now) and page.until(DRAWN, "accuracy-plot") > 0 and family != "",
                [now, family],
            )
            titles.add(now)
            page.run(DRAWING + "box.scrollIntoView({block: 'center', behavior: 'instant'})", "accuracy-plot")
            shot(f"accuracy-{axis}")
    page.run("const box = document.querySelector('#accuracy-filter'); box.value = 'no such robot'; box.dispatchEvent(new Event('input'))")
    left = page.run("return [...document.querySelectorAll('#accuracy-table tr[data-m]')].filter(row => !row.hidden).length")
    yield "the filter hides robots of the table of accuracy", left == 0, left
    page.run("const box = document.querySelector('#accuracy-filter'); box.value = ''; box.dispatchEvent(new Event('input'))")
