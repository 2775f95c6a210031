"""Runs the campaign of `crates/rodlab/examples/campaign` with each installed scheduler, and compares the summaries."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import EXAMPLES
from same_as_command import command

EXAMPLE = EXAMPLES / "campaign"


@pytest.fixture
def campaign(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copy of the example with its sheets; the folder `command` contains the results of the command."""
    folder = tmp_path / "campaign"
    shutil.copytree(EXAMPLE, folder)
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    assert command("sweep", "cone.plan", "--out", "sheets").returncode == 0
    assert command("batch", "sheets", "--out", "command").returncode == 0
    return folder


def ran(folder: Path, *words: str, **environment: str) -> None:
    done = subprocess.run(words, cwd=folder, env=os.environ | environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def expect_the_results_of_the_command(folder: Path) -> None:
    found, expected = (
        {path.relative_to(root): path.read_bytes() for path in root.rglob("*") if path.is_file() and ".snakemake" not in path.name}
        for root in (folder / "results", folder / "command")
    )
    assert len(expected) > 6 * 8
    assert found == expected


def test_the_parts_of_the_slurm_script_are_one_campaign(campaign: Path) -> None:
    for part in (1, 2, 3):
        ran(campaign, "bash", "campaign.slurm", SLURM_ARRAY_TASK_ID=str(part), SLURM_ARRAY_TASK_COUNT="3", SLURM_CPUS_PER_TASK="1")
        assert len(list((campaign / "results").glob("*/result.json"))) == 2 * part
    assert command("merge", "results").returncode == 0
    expect_the_results_of_the_command(campaign)


def test_the_dask_script_is_the_campaign(campaign: Path) -> None:
    pytest.importorskip("distributed")
    ran(campaign, sys.executable, "on_dask.py")
    expect_the_results_of_the_command(campaign)


def test_snakemake_does_what_has_changed(campaign: Path) -> None:
    pytest.importorskip("snakemake")
    words = (sys.executable, "-m", "snakemake", "--cores", "1", "--quiet", "all")
    ran(campaign, *words)
    expect_the_results_of_the_command(campaign)
    written = {path: path.stat().st_mtime_ns for path in (campaign / "results").glob("*/result.json")}
    sheet = campaign / "sheets" / "cone-2.ron"
    sheet.write_text(sheet.read_text(encoding="utf-8").replace("400 mm", "410 mm"), encoding="utf-8")
    ran(campaign, *words)
    changed = [path.parent.name for path, at in written.items() if path.stat().st_mtime_ns != at]
    assert changed == ["cone-2"]
