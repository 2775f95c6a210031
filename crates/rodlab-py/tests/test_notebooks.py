"""Runs the notebooks cell by cell and checks their types."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
ALL = sorted(path.stem for path in NOTEBOOKS.glob("*.py"))


def cells(path: Path) -> list[str]:
    """Returns the code cells: the text between lines that begin with ``# %%``, without the cells of text."""
    parts = re.split(r"^# %%(.*)$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return [code for head, code in zip(parts[1::2], parts[2::2], strict=True) if "[markdown]" not in head]


def test_there_are_notebooks() -> None:
    assert ALL == [
        "card_of_a_dma",
        "force_of_a_cone",
        "frf_of_five_hits",
        "law_of_a_nylon_rod",
        "modulus_of_a_rod",
        "stress_strain_on_polymer_bars",
    ]


@pytest.mark.parametrize("name", ALL)
def test_a_notebook_runs_and_has_the_numbers_of_the_command(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import matplotlib
    import matplotlib.pyplot as plt

    matplotlib.use("Agg")
    plt.close("all")
    monkeypatch.chdir(NOTEBOOKS)
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    names: dict[str, object] = {"__name__": name}
    code = cells(NOTEBOOKS / f"{name}.py")
    assert len(code) >= 4
    for cell in code[:2]:
        exec(compile(cell, name, "exec"), names)
    # the first two cells must print the verdict before anything else
    assert re.match(r"(answered|in doubt|not allowed): ", capsys.readouterr().out)
    for cell in code[2:]:
        exec(compile(cell, name, "exec"), names)
    assert plt.get_fignums()
    said = capsys.readouterr().out.splitlines()[-1]
    found = re.fullmatch(r"(\d+) numbers and words are equal", said)
    assert found and int(found[1]) > 100, said
    plt.close("all")


def test_notebooks_have_types_that_a_checker_follows() -> None:
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", *NOTEBOOKS.glob("*.py")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    pytest.importorskip("pyright")
    words = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, str(NOTEBOOKS)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
