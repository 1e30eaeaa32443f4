"""Chromium, driven by Selenium through chromedriver. Both are programs of the system: nothing is brought at run time."""

from __future__ import annotations

import base64
import pathlib
import shutil
import time
from typing import Any

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.action_builder import ActionBuilder
from selenium.webdriver.common.actions.interaction import POINTER_MOUSE
from selenium.webdriver.common.actions.mouse_button import MouseButton
from selenium.webdriver.common.actions.pointer_input import PointerInput
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

ESCAPE, ARROW_RIGHT, ARROW_DOWN, ENTER = Keys.ESCAPE, Keys.ARROW_RIGHT, Keys.ARROW_DOWN, Keys.ENTER
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
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
    "--window-size=1440,1000",
)


class Browser:
    """One page of Chromium.

    Parameters
    ----------
    profile : str
        The folder of the browser's files.
    """

    def __init__(self, profile: str) -> None:
        self.downloads = pathlib.Path(profile) / "downloads"
        options = webdriver.ChromeOptions()
        for flag in (*FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        options.add_experimental_option("prefs", {"download.default_directory": str(self.downloads)})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        if binary := next(filter(None, map(shutil.which, BROWSERS)), None):
            options.binary_location = binary
        # Without a path Selenium would bring a driver of its own.
        driver = shutil.which("chromedriver")
        if driver is None:
            raise FileNotFoundError("there is no chromedriver")
        self.driver = webdriver.Chrome(options, webdriver.ChromeService(driver))

    def open(self, address: str) -> None:
        """Go to an address, and wait until its document is whole: the driver may answer while the one before it is still there."""
        self.driver.get(address)
        self.until(
            "return document.readyState === 'complete' && location.pathname === new URL(arguments[0]).pathname", address, seconds=100
        )

    def run(self, script: str, *arguments: Any) -> Any:
        """Run a script in the page; its `return` is the value."""
        return self.driver.execute_script(script, *arguments)

    def find(self, selector: str) -> WebElement:
        """Find the first element of a selector."""
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def click(self, selector: str) -> None:
        """Click at the element's place on the screen: one that is covered or off the screen fails."""
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", selector)
        self.find(selector).click()

    def press(self, *keys: str) -> None:
        """Press keys, one after the other."""
        ActionChains(self.driver).send_keys(*keys).perform()

    def point(self, *steps: str | tuple[float, float], origin: WebElement | None = None) -> None:
        """Move the mouse to places on the screen, or from the middle of an element; press (`down`) and let go (`up`)."""
        mouse = PointerInput(POINTER_MOUSE, "mouse")
        for step in steps:
            if isinstance(step, str):
                (mouse.create_pointer_down if step == "down" else mouse.create_pointer_up)(button=MouseButton.LEFT)
            else:
                mouse.create_pointer_move(duration=30, x=round(step[0]), y=round(step[1]), origin=origin)
        ActionBuilder(self.driver, mouse=mouse).perform()

    def resize(self, width: int, height: int) -> None:
        """Give the window another size."""
        self.driver.set_window_rect(width=width, height=height)

    def printed(self) -> bytes:
        """Print the page as a PDF, as a reader's browser does."""
        return base64.b64decode(self.driver.print_page())

    def prefer(self, theme: str) -> None:
        """Let the system prefer light or dark; nothing, for an empty text."""
        feature = {"name": "prefers-color-scheme", "value": theme}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})

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
        return list(self.driver.get_log(kind))

    def shot(self, path: pathlib.Path) -> None:
        """Write a picture of the window."""
        self.driver.save_screenshot(str(path))

    def close(self) -> None:
        """End the page and the driver."""
        self.driver.quit()
