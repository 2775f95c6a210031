"""Hits from files, and frequency responses from arrays, compared with NumPy."""

import gc
import pickle
from pathlib import Path

import numpy as np
import pytest
import rodlab
from numpy.typing import NDArray
from rodlab import frf, sheet
from same_as_command import command, expect_files

RATE = 8192.0


def test_hits_are_the_samples_of_the_files_in_si(polypropylene: Path) -> None:
    channels: dict[str, str | dict[str, object]] = {
        "a": "m/s2",
        "b": {"unit": "V", "sensitivity": "2 mV/(m/s2)", "inverted": True},
    }
    hits = rodlab.read("hits-*.npy", channels=channels, sampling_rate_hz="65.536 kHz", folder=polypropylene)
    files = [np.load(path) for path in sorted(polypropylene.glob("hits-*.npy"))]
    assert (len(hits), hits.channels, dict(hits.units)) == (5, ("a", "b"), {"a": "m/s^2", "b": "m/s^2"})
    for hit, samples in zip(hits.hits, files, strict=True):
        np.testing.assert_array_equal(hit.samples[0], samples[0])
        # tolerance: two roundings
        np.testing.assert_allclose(hit.samples[1], -samples[1] / 2e-3, rtol=1e-15)
        assert hit.time[1] - hit.time[0] == 1 / 65_536
    assert hits.accepted("a").shape == (5, files[0].shape[1])
    assert pickle.loads(pickle.dumps(hits)).units == hits.units


def test_channels_in_separate_files_are_those_of_one_file(polypropylene: Path) -> None:
    for path in polypropylene.glob("hits-*.npy"):
        for name, samples in zip(("struck", "free"), np.load(path), strict=True):
            np.save(path.with_name(path.name.replace("hits", name)), samples[np.newaxis])
    joined = rodlab.read("hits-*.npy", channels={"a": "m/s2", "b": "m/s2"}, sampling_rate_hz=65_536, folder=polypropylene)
    channels: dict[str, dict[str, object]] = {
        "a": {"files": "struck-*.npy", "unit": "m/s2"},
        "b": {"files": [Path("free-*.npy")], "unit": "m/s2"},
    }
    separate = rodlab.read(channels=channels, sampling_rate_hz=65_536, folder=polypropylene)
    assert separate.hits[2].name == "hit 3, struck-3.npy + free-3.npy"
    for found, expected in zip(separate.hits, joined.hits, strict=True):
        np.testing.assert_array_equal(found.samples, expected.samples)
    (polypropylene / "free-3.npy").unlink()
    with pytest.raises(rodlab.SheetError, match=r"partner of struck-3\.npy"):
        rodlab.read(channels=channels, sampling_rate_hz=65_536, folder=polypropylene)
    with pytest.raises(rodlab.SheetError, match="state `files` in every channel"):
        rodlab.read(channels={"a": "m/s2"}, sampling_rate_hz=65_536, folder=polypropylene)


def test_long_records_are_cut_by_a_trigger(tmp_path: Path) -> None:
    long = np.random.default_rng(1).normal(0, 1e-3, (2, 40_000))
    for at in (5_000, 25_000):
        long[0, at : at + 9] += 10 * np.sin(np.pi * np.arange(1, 10) / 10)
    np.save(tmp_path / "long.npy", long)
    cut = sheet.Trigger(level="3 N", length="4096 samples", pre_trigger="20 ms")
    hits = rodlab.read(tmp_path / "long.npy", channels={"f": "N", "a": "m/s2"}, sampling_rate_hz=RATE, cut=cut)
    assert len(hits) == 2
    for hit, at in zip(hits.hits, (5_000, 25_000), strict=True):
        assert hit.samples.shape == (2, 4096)
        begin = round(hit.start_time * RATE)
        np.testing.assert_array_equal(hit.samples, long[:, begin : begin + 4096])
        assert begin < at < begin + 4096


def test_hits_of_arrays_are_those_of_files(polypropylene: Path) -> None:
    channels = {"struck end": "m/s2", "free end": "m/s2"}
    files = rodlab.read("hits-*.npy", channels=channels, sampling_rate_hz=65_536, folder=polypropylene)
    arrays = np.array([np.load(path) for path in sorted(polypropylene.glob("hits-*.npy"))])
    hits = rodlab.of_arrays(arrays, channels=channels, sampling_rate_hz=65_536)
    rod: dict[str, str] = {"length": "799 mm ± 0.3 mm", "diameter": "15.8 mm", "density": "912 kg/m3"}
    of_files = rodlab.modulus.two_point(files, silent="1.6 ms", **rod)  # type: ignore[arg-type]
    of_hits = rodlab.modulus.two_point(hits, silent="1.6 ms", **rod)  # type: ignore[arg-type]
    np.testing.assert_array_equal(of_hits.modulus, of_files.modulus)
    folder = hits._folder
    assert folder.exists()
    # a modulus reads its hits again when a law is fitted to it
    del hits
    gc.collect()
    law = rodlab.rheology.fit(of_hits, "constant q")
    assert law.parameters("constant q") == rodlab.rheology.fit(of_files, "constant q").parameters("constant q")
    del of_hits, law
    gc.collect()
    assert not folder.exists()
    broken = arrays.copy()
    broken[1, 0, 5] = np.nan
    left = rodlab.of_arrays(broken, channels=channels, sampling_rate_hz=65_536)
    assert len(left) == 4
    for bad in (np.zeros((2, 0, 5)), np.zeros(5), 1j * arrays, [], [["a"]], None):
        with pytest.raises(rodlab.SheetError, match="array"):
            rodlab.of_arrays(bad, channels=channels, sampling_rate_hz=65_536)  # type: ignore[arg-type]
    with pytest.raises(rodlab.Error, match="one measurement"):
        rodlab.of_arrays([arrays[0], arrays[0]], channels=channels, sampling_rate_hz=65_536)


def noisy(n_hits: int = 6, n_samples: int = 256) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    draw = np.random.default_rng(1993)
    x = draw.normal(size=(n_hits, n_samples))
    y = 3 * np.roll(x, 2, axis=1) + 0.5 * draw.normal(size=x.shape)
    return x, y


def test_responses_are_those_of_averaged_transforms() -> None:
    x, y = noisy()
    spectra_x, spectra_y = np.fft.rfft(x), np.fft.rfft(y)
    g_xx = (np.abs(spectra_x) ** 2).mean(axis=0)
    g_yy = (np.abs(spectra_y) ** 2).mean(axis=0)
    g_xy = (spectra_x.conj() * spectra_y).mean(axis=0)
    coherence = np.abs(g_xy) ** 2 / (g_xx * g_yy)
    expected = {"h1": g_xy / g_xx, "h2": g_yy / g_xy.conj(), "hv": np.sqrt(g_yy / g_xx) * g_xy / np.abs(g_xy)}
    for name, values in expected.items():
        response = getattr(frf, name)(x, y, sampling_rate_hz=RATE)
        # tolerance: rounding of transforms of 256 values by two libraries
        np.testing.assert_allclose(response.values, values, rtol=1e-12)
        np.testing.assert_allclose(response.coherence, coherence, rtol=1e-12)
        np.testing.assert_array_equal(response.frequency_hz, np.fft.rfftfreq(256, 1 / RATE))
    response = frf.h1(x, y, sampling_rate_hz=RATE)
    assert response.magnitude_error is not None and response.variance is not None
    # the formula of Bendat and Piersol, with one average less because the response itself is estimated
    error = np.sqrt((1 - coherence) / (2 * 5 * coherence))
    np.testing.assert_allclose(response.magnitude_error, error, rtol=1e-9)
    np.testing.assert_allclose(response.variance, 2 * (error * np.abs(response.values)) ** 2, rtol=1e-9)
    assert response.valid.all()
    frame = response.to_pandas()
    assert (len(frame), frame.attrs["units"]["frequency_hz"]) == (129, "Hz")
    assert pickle.loads(pickle.dumps(response)).n_averages == 6


def test_any_layout_and_real_type_gives_the_same_numbers() -> None:
    x, y = noisy()
    expected = frf.h1(x, y, sampling_rate_hz=RATE).values
    np.testing.assert_array_equal(frf.h1(np.asfortranarray(x), y, sampling_rate_hz=RATE).values, expected)
    wide = np.zeros((6, 512))
    wide[:, ::2] = x
    np.testing.assert_array_equal(frf.h1(wide[:, ::2], y, sampling_rate_hz=RATE).values, expected)
    x.flags.writeable = False
    np.testing.assert_array_equal(frf.h1(x, y.tolist(), sampling_rate_hz=RATE).values, expected)
    single = frf.h1(x.astype(np.float32), y, sampling_rate_hz=RATE)
    np.testing.assert_array_equal(single.values, frf.h1(x.astype(np.float32).astype(float), y, sampling_rate_hz=RATE).values)
    whole = np.arange(256) % 7
    assert frf.h1(whole, 2 * whole, sampling_rate_hz=RATE).values[10] == pytest.approx(2)
    assert frf.h1(whole, 2 * whole, sampling_rate_hz=RATE).coherence is None


def test_arrays_that_are_none_are_refused_with_reasons() -> None:
    x, y = noisy()
    bad = x.copy()
    bad[2, 7] = np.nan
    cases: list[tuple[object, object, float, str]] = [
        (x[:, :0], y[:, :0], RATE, "shape"),
        (np.zeros((0, 8)), np.zeros((0, 8)), RATE, "shape"),
        (x[None], y[None], RATE, "shape"),
        (x, y[:, 1:], RATE, "shapes"),
        (x, y[:3], RATE, "shapes"),
        (x + 1j, y, RATE, "complex128"),
        (x.astype(object), y, RATE, "object"),
        (np.full(8, "a"), y, RATE, "<U1"),
        (bad, y, RATE, "NaN"),
        (x, np.where(y > 0, np.inf, y), RATE, "inf"),
        (x, y, 0.0, "rate"),
        (x, y, float("nan"), "rate"),
    ]
    for first, second, rate, words in cases:
        with pytest.raises(rodlab.Error, match=words):
            frf.h1(first, second, sampling_rate_hz=rate)  # type: ignore[arg-type]
    with pytest.raises(rodlab.Error, match="window is `box`, expected `rectangular`"):
        frf.h1(x, y, sampling_rate_hz=RATE, window="box")


def test_responses_of_hits_are_those_of_the_command(polypropylene: Path) -> None:
    text = """Frf(title: "Ends", records: (files: ["hits-*.npy"], sampling_rate: "65536 Hz", channels: [
        (name: "struck end", from: 1, unit: "m/s2"), (name: "free end", from: 2, unit: "m/s2")]),
        input: "struck end", estimator: H2, silent: "1.6 ms", band: (from: "100 Hz", to: "15 kHz"))"""
    (polypropylene / "frf.ron").write_text(text)
    assert command("frf", polypropylene / "frf.ron").returncode in (0, 3)
    channels = {"struck end": "m/s2", "free end": "m/s2"}
    hits = rodlab.read("hits-*.npy", channels=channels, sampling_rate_hz=65_536, folder=polypropylene)
    found = frf.of_hits(hits, estimator="H2", silent="1.6 ms", band=("100 Hz", "15 kHz"))
    expect_files(found.tables, polypropylene / "frf-result")
