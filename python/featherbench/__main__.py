"""`python -m featherbench …` is the program `featherbench`."""

import sys

from featherbench._program import call


def main() -> int:
    """Pass the arguments on.

    Returns
    -------
    int
        The program's exit code; 2 when there is no program.
    """
    try:
        return call(sys.argv[1:])
    except FileNotFoundError as missing:
        print(f"error: {missing}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
