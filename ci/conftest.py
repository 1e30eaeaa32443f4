"""What `browser_test.py` is asked with."""

from __future__ import annotations

import pathlib

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    parser.addoption("--report", type=pathlib.Path, required=True, help="folder that holds index.html")
    parser.addoption("--shots", type=pathlib.Path, help="folder for screenshots")
