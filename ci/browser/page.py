"""What checks share: their types, and scripts that tell what the page shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from browser.client import Browser

Checks = Iterator[tuple[str, Any, Any]]  # what, whether it is so, what was seen
Shot = Callable[[str], None]  # takes a picture of that name

ROWS = "return document.querySelector('#rows').open ? document.querySelectorAll('#rows-table tbody tr').length : 0"
DRAWN = "return document.getElementById(arguments[0]).querySelectorAll('.marks .mark').length"
CLOSED = "return !document.querySelector('#rows').open"
FOCUS = "const cell = document.activeElement.closest('td'); return cell ? [cell.parentElement.rowIndex, cell.cellIndex] : null"


def has(page: Browser, selector: str) -> bool:
    """Tell whether the page has an element."""
    return bool(page.run("return document.querySelector(arguments[0]) !== null", selector))


def open_whole(page: Browser, address: str) -> None:
    """Open a report, and bring every section and piece that its first page leaves out."""
    page.open(address)
    page.run("featherbench.everything()")
    page.until("return !document.querySelector('[data-part]')")
