"""Sheets from files: results, exceptions, interruption, progress, the console script."""

import json
import os
import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import rodlab
from rodlab import sheet
from same_as_command import command, expect_files


def test_a_result_is_what_the_command_writes(polypropylene: Path, tmp_path: Path) -> None:
    by_command = command("modulus", polypropylene / "modulus.ron", "--out", tmp_path / "command")
    assert by_command.returncode == 0, by_command.stderr
    result = rodlab.run(polypropylene / "modulus.ron", tmp_path / "python", job="modulus")
    assert (result.standing, result.valid) == ("answered", True)
    assert result.folder == tmp_path / "python"
    for path in (tmp_path / "command").iterdir():
        assert (tmp_path / "python" / path.name).read_bytes() == path.read_bytes(), path.name
    expect_files(result.tables, tmp_path / "command")
    told = json.loads((tmp_path / "command" / "result.json").read_text())
    assert list(result.summary) == told["summary"]
    assert [quantity.__dict__ for quantity in result.quantities] == told["quantities"]
    assert by_command.stdout.startswith(result.headline)
    assert result.quantity(told["quantities"][0]["name"]).value == told["quantities"][0]["value"]
    assert result.attachments["PP.inp"] == (tmp_path / "command" / "PP.inp").read_bytes()


def test_without_files_a_result_is_the_same(cone: Path) -> None:
    before = sorted(cone.iterdir())
    result = rodlab.run(cone / "force.ron", write=False)
    assert sorted(cone.iterdir()) == before
    assert result.folder is None
    written = rodlab.run(cone / "force.ron")
    assert written.folder == cone / "force-result"
    assert result.quantities == written.quantities
    expect_files(result.tables, cone / "force-result")


def test_a_result_shows_its_standing_first_and_survives_pickle(cone: Path) -> None:
    result = rodlab.run(cone / "force.ron", write=False)
    page = result._repr_html_()
    assert page.startswith("<p><strong>answered</strong>: ")
    assert "&lt;svg" in page
    again = pickle.loads(pickle.dumps(result))
    assert again.report() == result.report()
    assert again.quantities == result.quantities
    for name, table in result.tables.items():
        for column, values in table.columns().items():
            np.testing.assert_array_equal(again.table(name).columns()[column], values)


def test_a_table_carries_its_units(cone: Path) -> None:
    table = rodlab.run(cone / "force.ron", write=False).table("force_in_band")
    frame = table.to_pandas()
    assert frame.attrs["units"] == dict(table.units)
    assert table.units["time_s"] == "s"
    assert frame["time_s"].to_numpy().tolist() == table.numbers("time_s").tolist()
    data = table.to_xarray()
    assert data["force_in_band_n"].attrs["units"] == "N"
    np.testing.assert_array_equal(data["time_s"], table.numbers("time_s"))
    with pytest.raises(ValueError, match="read-only"):
        table.numbers("time_s")[0] = 1.0
    with pytest.raises(rodlab.Error, match="no column `times`, only `time_s`"):
        table.numbers("times")


def test_a_mistake_in_a_sheet_has_place_field_and_help(polypropylene: Path) -> None:
    path = polypropylene / "modulus.ron"
    path.write_text(path.read_text().replace("diameter:", "diametre:"))
    with pytest.raises(rodlab.SheetError) as caught:
        rodlab.run(path)
    lines = path.read_text().splitlines()
    error = caught.value
    assert error.line is not None and error.column is not None
    assert lines[error.line - 1][error.column - 1 :].startswith("diametre")
    assert (error.field, error.help) == ("Modulus.specimen.diametre", "did you mean `diameter`?")
    assert str(error).endswith("did you mean `diameter`?")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.line, again.help) == (str(error), error.line, error.help)


def test_files_that_are_missing_or_in_the_way_are_errors_of_the_system(polypropylene: Path) -> None:
    with pytest.raises(rodlab.ReadError, match="absent.ron"):
        rodlab.run(polypropylene / "absent.ron")
    with pytest.raises(OSError, match="cannot read"):
        rodlab.inspect(polypropylene)
    with pytest.raises(rodlab.ReadError, match="no file matches"):
        rodlab.read("absent-*.npy", channels={"a": "m/s2"}, folder=polypropylene)
    with pytest.raises(rodlab.WriteError, match="it exists"):
        rodlab.init("modulus", polypropylene / "modulus.ron")
    with pytest.raises(rodlab.Error, match="expected one of `frf`, `modulus`"):
        rodlab.init("moduli", polypropylene / "new.ron")
    with pytest.raises(rodlab.SheetError, match="a sheet for `modulus`, expected one for `force`"):
        rodlab.run(polypropylene / "modulus.ron", job="force")
    assert not (polypropylene / "modulus-result").exists()


def test_check_inspect_convert_and_init(polypropylene: Path) -> None:
    assert rodlab.check(polypropylene / "modulus.ron") == "modulus"
    found = rodlab.inspect(polypropylene / "hits-1.npy")
    samples = np.load(polypropylene / "hits-1.npy")
    assert (found["format"], len(found["series"])) == ("npy", len(samples))
    assert found["series"][0]["levels"]["greatest"] == samples[0].max()
    done = rodlab.convert(polypropylene / "hits-1.npy", polypropylene / "hits-1.csv")
    assert (done["from"], done["to"]) == ("npy", "csv")
    timed = polypropylene / "hits-1.wav"
    with pytest.raises(rodlab.Error, match="expected `--rate`"):
        rodlab.convert(polypropylene / "hits-1.npy", timed)
    done = rodlab.convert(polypropylene / "hits-1.npy", timed, sampling_rate_hz=65_536)
    assert (done["to"], rodlab.inspect(timed)["series"][0]["sampling_rate_hz"]) == ("wav", 65536.0)
    path = rodlab.init("frf", polypropylene / "new.ron")
    assert path.read_text().startswith("// Frequency responses of hits")
    path = rodlab.init("modulus", polypropylene / "member.toml", rig="three-gauges")
    assert "[method.multi_point]" in path.read_text()
    with pytest.raises(rodlab.Error, match="rodlab init fit"):
        rodlab.init("modulus", polypropylene / "sweep.toml", rig="dma")
    with pytest.raises(rodlab.Error, match="rig is `bench`, expected one of"):
        rodlab.init("modulus", polypropylene / "none.toml", rig="bench")


def test_data_that_allow_no_result_carry_what_was_found(polypropylene: Path) -> None:
    path = polypropylene / "modulus.ron"
    reject = ", ".join(f'(hit: {hit}, because: "test")' for hit in range(1, 6))
    path.write_text(path.read_text().replace('silent: "1.6 ms",', f'silent: "1.6 ms", hits: (reject: [{reject}]),'))
    result = rodlab.run(path, write=False)
    assert result.standing == "not allowed" and not result.valid
    with pytest.raises(rodlab.NotAllowed) as caught:
        result.require()
    assert caught.value.outcome is result
    assert str(caught.value) == result.headline != ""
    assert pickle.loads(pickle.dumps(caught.value)).outcome.log == result.log


def test_an_interruption_is_heard_within_three_tenths_of_a_second(nylon: Path) -> None:
    interrupted: list[float] = []

    def interrupt() -> None:
        interrupted.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    # the signal is ignored if a shell has started the tests in the background
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        threading.Timer(0.5, interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            rodlab.run(nylon / "identify.ron")
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - interrupted[0] < 0.3
    time.sleep(1.0)
    assert not (nylon / "identify-result").exists()


def test_progress_is_told_and_may_end_the_job(polypropylene: Path) -> None:
    told: list[tuple[str, int, int]] = []
    rodlab.run(polypropylene / "modulus.ron", write=False, progress=lambda *step: told.append(step))
    assert ("fitting laws", 0, 3) in told
    assert told.index(("reading", 0, 0)) < told.index(("finding the modulus", 0, 0))

    class Enough(Exception):
        pass

    def end(step: str, done: int, of: int) -> None:
        raise Enough(step)

    with pytest.raises(Enough, match="reading"):
        rodlab.run(polypropylene / "modulus.ron", progress=end)
    assert not (polypropylene / "modulus-result").exists()


def test_other_threads_go_on_while_a_job_computes(nylon: Path) -> None:
    turns: list[float] = []
    ended = threading.Event()

    def turn() -> None:
        while not ended.wait(0.01):
            turns.append(time.monotonic())

    thread = threading.Thread(target=turn)
    thread.start()
    began = time.monotonic()
    rodlab.run(nylon / "identify.ron", write=False)
    took = time.monotonic() - began
    ended.set()
    thread.join()
    # the other thread runs every 10 ms, or every 100 ms on a busy machine; if the lock were held,
    # it would not run
    assert len(turns) > took / 0.1


def test_the_console_script_ends_with_the_status_of_the_command(polypropylene: Path) -> None:
    version = command("--version")
    assert (version.returncode, version.stdout) == (0, "rodlab 0.1.0\n")
    assert command("modulus").returncode == 2
    wrong = command("modulus", polypropylene / "absent.ron")
    assert wrong.returncode == 2
    assert "absent.ron" in wrong.stderr
    checked = command("check", polypropylene / "modulus.ron")
    assert (checked.returncode, checked.stderr) == (0, "")


def test_a_sheet_in_python_is_the_sheet_of_a_file(cone: Path) -> None:
    nylon = {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")}
    steel = {"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")}
    body = sheet.Cone(material="nylon", near="75 mm", far="30 mm", length="400 mm")
    problem = sheet.Impact(
        first=sheet.Chain(elements=[body]),
        second=sheet.LongRod(material="steel", diameter="10 mm"),
        velocity="0.93 m/s ± 1 %",
        duration="4 ms",
    )
    made = sheet.Force(title='A "cone"\n', materials={"nylon": nylon, "steel": steel}, problem=problem)
    result = rodlab.run(made)
    assert result.title == 'A "cone"\n'
    assert result.quantities == rodlab.run(cone / "force.ron", write=False).quantities
    with pytest.raises(rodlab.SheetError, match="found `Kone`, expected one of .*; did you mean `Cone`") as caught:
        rodlab.run(sheet.Force(title="", problem=sheet.Impact(first=sheet.Chain(elements=[sheet.Kone()]))))
    assert caught.value.line is None
