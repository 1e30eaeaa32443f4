"""Starts the oracle: `python -m featherbench_oracles.dart`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.dart.oracle import Dart

if __name__ == "__main__":
    serve(Dart())
