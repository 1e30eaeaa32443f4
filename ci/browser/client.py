"""Chromium, driven through chromedriver: a client of WebDriver without any package."""

from __future__ import annotations

import base64
import json
import pathlib
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request
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
        """Go to an address, and wait until its document is whole: the driver may answer while the one before it is still there."""
        self.post("/url", url=address)
        self.until(
            "return document.readyState === 'complete' && location.pathname === new URL(arguments[0]).pathname", address, seconds=100
        )

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

    def printed(self) -> bytes:
        """Print the page as a PDF, as a reader's browser does."""
        return base64.b64decode(self.post("/print"))

    def prefer(self, theme: str) -> None:
        """Let the system prefer light or dark; nothing, for an empty text."""
        feature = {"name": "prefers-color-scheme", "value": theme}
        self.post("/goog/cdp/execute", cmd="Emulation.setEmulatedMedia", params={"features": [feature]})

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
