"""Tests that campaigns in one process, on workers and by the command write the same files."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
import rodlab
from conftest import copy_of
from same_as_command import command

N_SHEETS = 40


@pytest.fixture
def sheets(tmp_path: Path) -> Path:
    """Sheets of forces at several velocities, one that is wrong, and one whose file is missing."""
    text = (copy_of("cone", tmp_path) / "force.ron").read_text()
    folder = tmp_path / "sheets"
    for number in range(N_SHEETS):
        path = folder / f"group {number % 3}" / f"cone {number:03}.ron"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text.replace("0.93 m/s", f"{0.5 + 0.01 * number:.2f} m/s"))
    (folder / "wrong.ron").write_text("Force(title: 1)")
    frame = (copy_of("frame", tmp_path) / "modulus.ron").read_text()
    (folder / "missing.ron").write_text(frame)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_campaign_is_that_of_the_command(sheets: Path, tmp_path: Path) -> None:
    for path in sorted(sheets.glob("group */*.ron"))[6:]:
        path.unlink()
    assert command("batch", sheets, "--out", tmp_path / "command").returncode == 2
    told: list[tuple[str, int, int]] = []
    done = rodlab.campaign(sheets, tmp_path / "python", jobs=2, progress=lambda *step: told.append(step))
    assert contents(tmp_path / "python") == contents(tmp_path / "command")
    assert (done.count("answered"), done.count("wrong input"), len(done.tests)) == (6, 2, 8)
    assert told[0] == ("tests", 0, 8) and told[-1] == ("tests", 8, 8)
    (tmp_path / "python" / "group 0" / "cone 000" / "force.csv").write_text("spoilt")
    again = rodlab.campaign(sheets, tmp_path / "python", resume=True)
    assert again.tests == done.tests
    assert contents(tmp_path / "python") == contents(tmp_path / "command")
    with pytest.raises(rodlab.ReadError):
        rodlab.campaign(tmp_path / "absent", tmp_path / "python")


distributed = pytest.importorskip("distributed")


@pytest.fixture
def client() -> Iterator[object]:
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def test_a_campaign_on_workers_that_die_is_that_of_one_process(sheets: Path, tmp_path: Path, client: object) -> None:
    rodlab.campaign(sheets, tmp_path / "here", jobs=1)
    killed: list[int] = []

    def kill(step: str, done: int, of: int) -> None:
        if done in (5, 15):
            pids = sorted(client.run(os.getpid).values())  # type: ignore[attr-defined]
            killed.append(pids[0])
            os.kill(pids[0], signal.SIGKILL)

    done = rodlab.campaign(sheets, tmp_path / "there", client, progress=kill)  # type: ignore[arg-type]
    assert len(set(killed)) == 2
    assert len(done.tests) == N_SHEETS + 2
    assert contents(tmp_path / "there") == contents(tmp_path / "here")


def test_calls_with_seeds_give_the_same_results_on_workers(client: object) -> None:
    here = rodlab.map(square, range(20))
    assert rodlab.map(square, range(20), client) == here == [number**2 for number in range(20)]  # type: ignore[arg-type]


def test_a_closed_client_is_an_exception(sheets: Path, tmp_path: Path, client: object) -> None:
    client.close()  # type: ignore[attr-defined]
    with pytest.raises(Exception, match="(?i)clos|not running|shutdown"):
        rodlab.campaign(sheets, tmp_path / "out", client)  # type: ignore[arg-type]
    assert not (tmp_path / "out" / "summary.csv").exists()


def square(seed: int) -> int:
    return seed**2
