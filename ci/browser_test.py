#!/usr/bin/env python3
"""Opens a report in Chromium from a file:// address and uses it as a reader would.

    python ci/browser_test.py REPORT_DIR [--shots FOLDER] [--only axe|use|robots]

Needs chromium and chromedriver on the path, and no Python package: chromedriver is asked by JSON over local HTTP.
The rules of accessibility are those of axe-core, which npm brings once, at a pinned version and checksum, into target/axe.
Prints each check and `N passed, N failed`. Exit status: 0 if all passed, 1 if one failed, 2 if the browser could not be started.
"""

from __future__ import annotations

import argparse
import itertools
import pathlib
import subprocess
import sys
import tempfile

from browser.axe import accessible
from browser.client import Browser
from browser.robots import robots
from browser.sections import checks


def main() -> int:
    """Run the checks."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("report", type=pathlib.Path, help="folder that holds index.html")
    parser.add_argument("--only", choices=["axe", "use", "robots"], help="accessibility, what a reader does, or drawings of robots")
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
            asked = [arguments.only] if arguments.only else ["use", "axe", "robots"]
            used = checks(page, index.as_uri(), arguments.shots) if "use" in asked else ()
            ruled = accessible(page, arguments.report) if "axe" in asked else ()
            turned = robots(page, arguments.report) if "robots" in asked else ()
            for what, good, seen in itertools.chain(used, ruled, turned):
                print(f"{'ok  ' if good else 'FAIL'} {what}" + ("" if good else f": {seen}"))
                passed, failed = passed + bool(good), failed + (not good)
        except (OSError, RuntimeError, subprocess.SubprocessError) as error:
            print(f"FAIL the test was cut short: {error}")
            failed += 1
        finally:
            page.close()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
