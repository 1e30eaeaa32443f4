"""Layout of every page: nothing is cut, nothing overlaps, no text is too small."""

from __future__ import annotations

import pathlib

from browser.client import Browser
from browser.page import LEFT, Checks

#: Widths of the window. A table's last columns must be seen from the second on.
WIDTHS = (390, 820, 1280)
#: Tables need this much.
DESK = 1280
#: The smallest text, in pixels.
SMALLEST = 11
# What is seen: not in a closed part, and with a size.
SEEN = "const seen = element => element.checkVisibility({visibilityProperty: true}) && element.getClientRects().length > 0;"
# How an element is told.
NAMED = """
    const name = element => {
      const place = element.closest('[id],[data-name]');
      const where = place ? (place.id || place.dataset.name) : '';
      return `${where}: ${element.tagName.toLowerCase()}.${element.getAttribute('class') || ''} ${element.textContent.trim().slice(0, 40)}`;
    };"""
# Texts that are smaller than so many pixels on the screen. A drawing's are scaled with it.
SMALL = (
    SEEN
    + NAMED
    + """
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const found = new Set();
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      if (!walker.currentNode.data.trim() || element.closest('script, style, sup, sub, .hidden') || !seen(element)) continue;
      const scale = element instanceof SVGElement ? Math.hypot(element.getScreenCTM().a, element.getScreenCTM().b) : 1;
      const size = parseFloat(getComputedStyle(element).fontSize) * scale;
      if (size < arguments[0] - 0.05) found.add(`${size.toFixed(1)} px, ${name(element)}`);
    }
    return [...found].slice(0, 8);"""
)
# Boxes that their contents leave, so that a reader must scroll sideways to see the rest.
CUT = (
    SEEN
    + NAMED
    + """
    const boxes = [...document.querySelectorAll('.scroll, .paper, nav, header')].filter(seen);
    const cut = boxes.filter(box => box.scrollWidth > box.clientWidth + 1);
    return cut.map(box => `${box.scrollWidth} in ${box.clientWidth} px, ${name(box.querySelector('th, text, a') ?? box)}`).slice(0, 8);"""
)
# Pairs that share more than a sliver: texts of a drawing, and what can be clicked in the head of the page.
OVER = (
    SEEN
    + NAMED
    + """
    const texts = svg => [...svg.querySelectorAll('text')].filter(text => text.textContent.trim());
    const groups = [...document.querySelectorAll('svg')].map(texts);
    groups.push([...document.querySelectorAll('nav a, header button, header a, #menu')]);
    groups.push([...document.querySelectorAll('.controls select, .controls button, .controls input')]);
    const found = [];
    for (const group of groups) {
      const boxes = group.filter(seen).map(element => [element, element.getBoundingClientRect()]);
      boxes.forEach(([a, p], index) => boxes.slice(index + 1).forEach(([b, q]) => {
        const across = Math.min(p.right, q.right) - Math.max(p.left, q.left);
        const down = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (across > 2 && down > 3) found.push(`${name(a)} and ${name(b)}`);
      }));
    }
    return found.slice(0, 8);"""
)

# Cells whose text runs down letter by letter: more than five lines, of less than four letters' height in width.
TORN = (
    SEEN
    + NAMED
    + """
    const torn = cell => {
      const size = parseFloat(getComputedStyle(cell).fontSize), upright = cell.querySelector('span, a');
      if (upright && getComputedStyle(upright).writingMode !== 'horizontal-tb') return false;
      return cell.clientHeight > 7.5 * size && cell.clientWidth < 4 * size && cell.textContent.trim().length > 8;
    };
    return [...document.querySelectorAll('td, th')].filter(cell => seen(cell) && torn(cell)).map(name).slice(0, 8);"""
)
# Rows that begin beyond the page's left edge and end on it: their lines cross the page.
STRAY = (
    SEEN
    + NAMED
    + """
    const rows = [...document.querySelectorAll('tr')].filter(seen).map(row => [row, row.getBoundingClientRect()]);
    const clipped = row => row.closest('thead') && getComputedStyle(row.closest('thead')).clipPath !== 'none';
    const stray = rows.filter(([row, box]) => box.left < -2 && box.right > 2 && !clipped(row));
    return stray.map(([row]) => name(row)).slice(0, 8);"""
)


def laid_out(page: Browser, folder: pathlib.Path) -> Checks:
    """Check the first page with all that it can bring, and every other page, in windows of several widths."""
    kinds = ["index.html", *(f"sections/{path.name}" for path in sorted((folder / "sections").glob("*.html")))]
    kinds += [f"{kind}/{path.name}" for kind in ("engines", "robots", "studies") for path in sorted((folder / kind).glob("*.html"))[:3]]
    for width in WIDTHS:
        page.resize(width, 1000)
        for kind in kinds:
            page.open((folder / kind).resolve().as_uri())
            if kind == "index.html":
                page.run("featherbench.everything()")
                page.until(f"return {LEFT}.length === 0")
            room = page.run("return [document.documentElement.scrollWidth, innerWidth]")
            yield f"{kind}, {width} px, does not scroll sideways", room[0] <= room[1], room
            small = page.run(SMALL, SMALLEST)
            yield f"{kind}, {width} px, has no text below {SMALLEST} px", not small, small
            over = page.run(OVER)
            yield f"{kind}, {width} px, has nothing on top of something else", not over, over
            torn = page.run(TORN)
            yield f"{kind}, {width} px, breaks no text letter by letter", not torn, torn
            stray = page.run(STRAY)
            yield f"{kind}, {width} px, has no row across its edge", not stray, stray
            if width >= DESK:
                cut = page.run(CUT)
                yield f"{kind}, {width} px, cuts nothing", not cut, cut
