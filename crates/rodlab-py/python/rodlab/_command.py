"""The console script `rodlab`."""

from __future__ import annotations

import sys

from ._rodlab import command


def main() -> int:
    """Runs the command line; returns the exit status of the command."""
    return command(["rodlab", *sys.argv[1:]])
