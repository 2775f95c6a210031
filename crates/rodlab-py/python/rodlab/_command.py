"""The console script `rodlab`."""

from __future__ import annotations

import sys

from ._rodlab import command


def main() -> int:
    """Does what the command line asks for; returns the exit status of the command."""
    return command(["rodlab", *sys.argv[1:]])
