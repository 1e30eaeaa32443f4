"""What checks share: their types, and scripts that tell what the page shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from browser.client import Browser

Checks = Iterator[tuple[str, Any, Any]]  # what, whether it is so, what was seen
Shot = Callable[[str], None]  # takes a picture of that name

ROWS = "return document.querySelector('#rows').open ? document.querySelectorAll('#rows-table tbody tr').length : 0"
# The drawing of a name that is seen: of a choice of drawings it is one.
DRAWING = "const box = document.querySelector(`[data-name='${arguments[0]}']:not([hidden] *)`);"
DRAWN = DRAWING + "return box?.querySelectorAll('.series .mark').length ?? 0"
# What is there to be brought; a drawing that is not chosen is not.
LEFT = "[...document.querySelectorAll('[data-part]')].filter(place => !place.closest('[data-choice][hidden]'))"
CLOSED = "return !document.querySelector('#rows').open"
FOCUS = "const cell = document.activeElement.closest('td'); return cell ? [cell.parentElement.rowIndex, cell.cellIndex] : null"


def has(page: Browser, selector: str) -> bool:
    """Tell whether the page has an element."""
    return bool(page.run("return document.querySelector(arguments[0]) !== null", selector))


def open_whole(page: Browser, address: str) -> None:
    """Open a report, and bring every section and piece that its first page leaves out."""
    page.open(address)
    page.run("featherbench.everything()")
    page.until(f"return {LEFT}.length === 0")
