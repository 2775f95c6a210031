"""Runs the code of docs/python.md without changes."""

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import EXAMPLES

PAGE = EXAMPLES.parents[2] / "docs" / "python.md"


def examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Returns the text of the page; the working folder is a copy of the examples."""
    import matplotlib

    matplotlib.use("Agg")
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    (tmp_path / "examples" / "nylon" / "identify.ron").unlink()  # takes as long as all other sheets together
    monkeypatch.chdir(tmp_path / "examples")
    return PAGE.read_text(encoding="utf-8")


def blocks_of(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)


def test_the_page_runs_as_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    blocks = blocks_of(examples(tmp_path, monkeypatch), "python")
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    said = capsys.readouterr().out
    assert "5 hits of 2048 samples" in said
    assert "answered - " in said
    assert "Force.problem.Impact.velocity: `0.93 m` has the dimension of a length (m), expected a velocity" in said
    assert "answered\n" in said
    assert (tmp_path / "examples" / "results" / "cone" / "report.html").is_file()


@pytest.mark.parametrize("package", ["pyFRF", "pyuff", "lmfit", "pyvisco"])
def test_other_packages_have_the_numbers_of_the_page(package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compares the results of another package with ours, with the tolerance that the page states."""
    pytest.importorskip(package)
    page = examples(tmp_path, monkeypatch)
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks_of(page.partition("## Frequency responses")[0], "python"):
        exec(block, names)
    task = page.partition(f"**{package}**")[2]
    (theirs,), (ours,) = blocks_of(task, "py")[:1], blocks_of(task, "python")[:1]
    one: dict[str, Any] = dict(names)
    exec(ours, one)
    other: dict[str, Any] = dict(names)
    exec(theirs, other)
    if package == "lmfit":
        np.testing.assert_allclose(one["ours"], other["theirs"], rtol=1e-3)
        assert 30 < np.sqrt(other["fitted"].redchi) < 60
    elif package == "pyvisco":
        temperature, ours, theirs = names["epoxy"].table("shifts").numbers("temperature_degc"), one["ours"], other["theirs"]
        np.testing.assert_allclose(ours[temperature >= 50], theirs[temperature >= 50], atol=0.06)
        # the sweep was simulated with the WLF law with C1 = 12 and C2 = 90 K at 60 degC: a shift of 6 decades at 30 degC
        assert abs(ours[0] - 6) < 0.4 < 1.5 < abs(theirs[0] - 6)
    elif package == "pyuff":
        np.testing.assert_array_equal(one["samples"], other["samples"])
        np.testing.assert_array_equal(one["samples"], np.load("polypropylene/hits-1.npy")[0])
    else:
        # the other package subtracts the mean of each hit, which changes the line at 0 Hz
        apart = np.abs(one["values"] - other["values"])[1:]
        assert np.max(apart) < 1e-12 * np.max(np.abs(one["values"]))
        np.testing.assert_allclose(one["coherence"][1:], np.squeeze(other["coherence"])[1:], atol=1e-12)
