"""Starts the oracle: `python -m featherbench_oracles.dart`."""

from featherbench_oracles.dart.oracle import Dart
from featherbench_oracles.session import serve

if __name__ == "__main__":
    serve(Dart())
