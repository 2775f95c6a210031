"""The page of the package, run as it stands."""

import re
import shutil
from pathlib import Path

import pytest
from conftest import EXAMPLES

PAGE = EXAMPLES.parents[2] / "docs" / "python.md"


def test_the_page_runs_as_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    (tmp_path / "examples" / "nylon" / "identify.ron").unlink()  # takes as long as all others together
    monkeypatch.chdir(tmp_path / "examples")
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    said = capsys.readouterr().out
    assert "5 hits of 2048 samples" in said
    assert "answered - " in said
    assert "Force.problem.Impact.velocity: `0.93 m` has the dimension m, expected a velocity" in said
    assert "answered\n" in said
    assert (tmp_path / "examples" / "results" / "cone" / "report.html").is_file()
