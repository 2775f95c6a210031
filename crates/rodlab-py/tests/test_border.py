"""Border between Python and Rust: stubs, types, and invalid arguments."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rodlab
from rodlab import _rodlab, bars, force, frf, mobility, modulus, rheology, rods, sheet

PACKAGE = Path(__file__).parents[1]


def checked(*words: str) -> None:
    done = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True, cwd=PACKAGE, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_that_of_the_extension() -> None:
    pytest.importorskip("mypy")
    checked("mypy.stubtest", "rodlab._rodlab")


def test_package_and_tests_have_the_types_that_they_state() -> None:
    pytest.importorskip("mypy")
    checked("mypy", "--strict", "python/rodlab", "tests")


def test_an_import_takes_no_more_than_it_needs() -> None:
    code = "import sys, rodlab; print(*sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "rodlab._rodlab" in loaded
    assert not {"pandas", "xarray", "matplotlib", "dask", "distributed", "html", "rodlab.modulus", "rodlab.force"} & set(loaded)
    assert set(rodlab.__all__) <= set(dir(rodlab))


HOSTILE: tuple[Any, ...] = (None, True, -1, 10**400, float("nan"), float("inf"), "", "\0", "\ud800", b"x", (), [], {}, [None], object(), np.zeros(0))


def test_no_argument_crosses_the_border_as_a_panic(tmp_path: Path) -> None:
    """Checks that every public function raises a Python exception for invalid values of every argument, and never panics."""
    hits = rodlab.Hits((), {"a": "N", "b": "N"}, (), {"files": [], "channels": []}, {}, tmp_path)
    rod = sheet.LongRod(material="steel", diameter="10 mm")
    taken: list[tuple[int, object]] = []

    def one_bar(bad: Any) -> sheet.Part:
        return bars.bar(diameter=bad, length=1, gauges={"a": bad}, material=bad)

    for bad in HOSTILE:
        calls: list[Callable[[], object]] = [
            lambda: rodlab.run(bad),
            lambda: rodlab.run(sheet.Force(title=bad)),
            lambda: rodlab.check(bad),
            lambda: rodlab.inspect(bad),
            lambda: rodlab.convert(bad, tmp_path / "a.csv"),
            lambda: rodlab.init(bad, tmp_path / "a.ron"),
            lambda: rodlab.campaign(bad, tmp_path / "out"),
            lambda: rodlab.campaign([bad], tmp_path / "out"),
            lambda: rodlab.read(bad, channels={"a": "N"}),
            lambda: rodlab.read("a.npy", channels=bad),
            lambda: rodlab.read("a.npy", channels={"a": bad}),
            lambda: rodlab.read("a.npy", channels={"a": "N"}, sampling_rate_hz=bad),
            lambda: rodlab.of_sep005(bad),
            lambda: rodlab.of_sep005([{"name": "a", "unit_str": "N", "fs": 1.0, "data": bad}]),
            lambda: rodlab.of_sep005([{"name": "a", "unit_str": "N", "fs": bad, "data": [1.0, 2.0]}]),
            lambda: rodlab.of_sep005([{"name": "a", "unit_str": bad, "fs": 1.0, "data": [1.0, 2.0]}]),
            lambda: frf.h1(bad, bad, sampling_rate_hz=1.0),
            lambda: frf.h2(np.ones((2, 8)), bad, sampling_rate_hz=1.0),
            lambda: frf.hv(np.ones((2, 8)), np.ones((2, 8)), sampling_rate_hz=bad),
            lambda: frf.h1(np.ones((2, 8)), np.ones((2, 8)), sampling_rate_hz=1.0, window=bad),
            lambda: frf.of_hits(hits, estimator=bad),
            lambda: modulus.two_point(hits, length=bad, diameter=1, density=1),
            lambda: modulus.three_point(hits, gauges={"a": bad}, diameter=1, density=1),
            lambda: modulus.multi_point(hits, gauges=bad, diameter=1, density=1),
            lambda: rheology.fit(bad, "zener"),
            lambda: rheology.sweep(bad),
            lambda: rheology.sweep([bad]),
            lambda: rheology.of_arrays(bad, [1e9 + 1e8j], temperature="23 degC"),
            lambda: rheology.of_arrays([1.0], bad, temperature="23 degC"),
            lambda: rheology.of_arrays([1.0], [1e9 + 1e8j], temperature=bad),
            lambda: rheology.over_time(bad, [1e9], test="creep", temperature="23 degC"),
            lambda: rheology.over_time([1.0], bad, test="creep", temperature="23 degC"),
            lambda: rheology.over_time([1.0], [1e9], test="relaxation", ramp=bad, temperature=bad),
            lambda: rheology.of_arrays([1.0], [1e9 + 1e8j], temperature="23 degC", standard_error=bad or b"x"),
            lambda: bars.stress_strain(hits, incident=one_bar(bad), transmitted=rod, specimen_length=1, specimen_diameter=1, silent=1),
            lambda: bars.propagation(hits, length=bad, diameter=1, density=1, gauges={"a": 1}, silent=1),
            lambda: bars.propagation(bad, length=1, diameter=1, density=1, gauges={"a": 1}, silent=1),
            lambda: bars.stress_strain(bad, incident=rod, transmitted=rod, specimen_length=1, specimen_diameter=1, silent=1),
            lambda: bars.stress_strain(hits, incident=bad, transmitted=rod, specimen_length=1, specimen_diameter=1, silent=1),
            lambda: force.predict(bad, bad, velocity=1, duration=1e-3),
            lambda: force.predict(rod, rod, velocity=bad, duration=1e-3),
            lambda: force.predict(rod, rod, velocity=1, duration=1e-3, materials=bad),
            lambda: rods.mobility(bad, [1.0]),
            lambda: rods.transition_matrix(sheet.Chain(elements=[bad]), [1.0]),
            lambda: rods.propagation_coefficient(bad, [1.0]),
            lambda: rods.propagation_coefficient({"density": "1 kg/m3", "law": bad}, bad),
            lambda: rodlab.identify(bad, length=1, density=1),
            lambda: rodlab.recovery(bad, series_modulus=1e9, frequency=1e4),
            lambda: rodlab.recovery([], series_modulus=bad, frequency=1e4),
            lambda: mobility.of_hits(bad),
            lambda: mobility.of_two_hammers(hits, bad),
            lambda: mobility.of_file(bad),
            lambda: mobility.of_body(bad, highest=1e3, lines=8),
            lambda: mobility.of_body(sheet.RigidMass("1 kg"), highest=bad, lines=8),
            lambda: mobility.of_body(sheet.RigidMass("1 kg"), highest=1e3, lines=bad),
            lambda: rodlab.simulate(bad),
            lambda: rodlab.simulate(rod, seed=bad),
            lambda: _rodlab.run_text(bad, tmp_path),
            lambda: _rodlab.load(bad, tmp_path),
            lambda: _rodlab.one_test(bad, bad, bad, bad),
            lambda: _rodlab.frequency_response(bad, bad, bad, estimator=bad, window=bad),
        ]
        for number, call in enumerate(calls):
            try:
                call()
            except (ValueError, TypeError, OSError, AttributeError, OverflowError) as error:
                assert str(error), (number, bad)
            else:
                taken.append((number, bad))
    assert taken == []
