"""The conventions of the engines, asked of the engines themselves: one test for each row of conventions.toml.

    python oracles/test_conventions.py [-v] [--otherwise] [ENGINE...]

Nothing here goes through our oracles. A test in conventions/ says what is measured, what it is by the convention, and what it would be
otherwise; it fails where the convention does not hold, and also where the two could not be told apart. Without arguments all engines are asked.
With --otherwise every test claims the other thing, and every test has to fail.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

# Not this directory, whose files are called like the engines' packages.
sys.path[0] = str(Path(__file__).parent / "conventions")
asking = import_module("asking")
ENGINES = ("pinocchio", "mujoco", "drake", "dart")


def main(arguments: list[str]) -> int:
    """Runs the tests of the engines that are named, or of all."""
    failed = passed = 0
    asking.swapped = "--otherwise" in arguments
    for engine in [word for word in arguments if not word.startswith("-")] or ENGINES:
        tests = {name: test for name, test in vars(import_module(f"of_{engine}")).items() if name.startswith("test_")}
        for name, test in tests.items():
            asking.asked = 0
            try:
                test()
                assert asking.asked, "it asks nothing"
            except Exception as reason:  # whatever an engine does is this test's failure
                failed += 1
                if not asking.swapped or "-v" in arguments:
                    print(f"FAILED {name}: {type(reason).__name__}: {reason}")
            else:
                passed += 1
                if "-v" in arguments:
                    print(f"ok     {name}: {test.__doc__}")
    print(f"{passed} passed, {failed} failed")
    return int(failed == 0 or passed > 0) if asking.swapped else int(failed > 0 or passed == 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
