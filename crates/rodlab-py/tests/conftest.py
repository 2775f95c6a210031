"""Sheets and records of the examples of the command; each test gets its own copy."""

import shutil
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "rodlab" / "examples"


def copy_of(example: str, folder: Path) -> Path:
    shutil.copytree(EXAMPLES / example, folder / example)
    return folder / example


@pytest.fixture
def polypropylene(tmp_path: Path) -> Path:
    """Five hits on a rod with accelerometers at both ends."""
    return copy_of("polypropylene", tmp_path)


@pytest.fixture
def frame(tmp_path: Path) -> Path:
    """Five hits on a member of a frame with three gauges."""
    return copy_of("frame", tmp_path)


@pytest.fixture
def cone(tmp_path: Path) -> Path:
    """Impact of a nylon cone on a long steel rod."""
    return copy_of("cone", tmp_path)


@pytest.fixture
def nylon(tmp_path: Path) -> Path:
    """A nylon rod that was struck at two velocities; its evaluation takes seconds."""
    return copy_of("nylon", tmp_path)
