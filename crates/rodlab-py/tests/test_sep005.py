"""Time series in the form of SEP-005, read and returned."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rodlab

CHANNELS = {"struck end": "m/s2", "free end": "m/s2"}


@pytest.fixture
def hits(polypropylene: Path) -> rodlab.Hits:
    return rodlab.read("hits-*.npy", channels=CHANNELS, sampling_rate_hz=65_536, folder=polypropylene)


def test_hits_survive_the_way_out_and_in(hits: rodlab.Hits) -> None:
    records = rodlab.to_sep005(hits)
    again = rodlab.of_sep005(records)
    assert (len(records), again.channels, again.sampling_rate_hz) == (5, hits.channels, 65_536)
    for one, other in zip(hits.hits, again.hits, strict=True):
        np.testing.assert_array_equal(one.samples, other.samples)
    rod: dict[str, Any] = {"length": "799 mm ± 0.3 mm", "diameter": "15.8 mm", "density": "912 kg/m3", "silent": "1.6 ms"}
    of_series = rodlab.modulus.two_point(again, **rod)
    np.testing.assert_array_equal(of_series.modulus, rodlab.modulus.two_point(hits, **rod).modulus)
    # the returned arrays are copies
    records[0][0]["data"][:] = 0
    assert np.any(hits.hits[0].samples[0])


def test_what_is_handed_out_passes_the_validator(hits: rodlab.Hits) -> None:
    validator = pytest.importorskip("sdypy_sep005.sep005")
    for record in rodlab.to_sep005(hits):
        for series in record:
            validator.assert_sep005_channel(series)
    broken = dict(rodlab.to_sep005(hits)[0][0])
    del broken["fs"]
    with pytest.raises(ValueError, match="fs"):
        validator.assert_sep005_channel(broken)


def test_what_the_validator_takes_is_read_with_its_unit() -> None:
    time = [0.1 + n / 128 for n in range(8)]
    series: dict[str, Any] = {"name": "tower", "unit_str": "km/s²", "data": [1.0, 2, 3, 4, 3, 2, 1, 0], "time": time, "quantity": "a"}
    pytest.importorskip("sdypy_sep005.sep005").assert_sep005_channel(series)
    hits = rodlab.of_sep005([series])
    assert dict(hits.units) == {"tower": "m/s^2"}
    assert hits.sampling_rate_hz == pytest.approx(128)
    np.testing.assert_allclose(hits.hits[0].samples[0], 1e3 * np.array(series["data"]), rtol=1e-15)


def test_series_that_are_wrong_are_refused_with_their_place() -> None:
    good: dict[str, Any] = {"name": "a", "unit_str": "N", "data": [0.0, 1, 2, 1], "fs": 10.0}
    other = good | {"name": "b"}
    uneven = [0.0, 0.1, 0.25, 0.3]
    cases: list[tuple[Any, str]] = [
        ([], "records is"),
        ({}, "records is"),
        ([[]], r"records\[0\] is"),
        ([good, 3], r"records\[1\] is of the type int"),
        ([good, good], r"\['name'\] is `a` a second time"),
        ([good | {"name": None}], r"\['name'\] is None, expected a text"),
        ([{key: good[key] for key in ("name", "data", "fs")}], r"\['unit_str'\] is None"),
        ([good | {"unit_str": "Newten"}], "Newten"),
        ([good | {"fs": None}], "neither `fs` nor `time`"),
        ([good | {"fs": 0.0}], "rate"),
        ([good | {"fs": "10"}], r"\['fs'\] is '10', expected a number in Hz"),
        ([good | {"data": [[1.0]]}], r"\['data'\] has the type float64 and the shape \(1, 1\)"),
        ([good | {"data": [None, 1.0]}], r"\['data'\] has the type object"),
        ([good, other | {"data": [1.0]}], "has 1 samples, expected 4"),
        ([good, other | {"fs": 11.0}], "has the rate 11.0 Hz, expected 10.0 Hz"),
        ([good | {"time": [0.0, 0.1, 0.2]}], "3 times of 4 samples"),
        ([good | {"time": [0.0, 0.2, 0.4, 0.6]}], r"\['fs'\] is 10.0 Hz, expected 5.0"),
        ([good | {"time": uneven, "fs": None}], "is not evenly spaced"),
        ([good | {"time": [0.0, 0.0, 0.0, 0.0], "fs": None}], "is not evenly spaced"),
        ([[good], [other]], "expected those of the first record"),
    ]
    for records, words in cases:
        with pytest.raises(rodlab.Error, match=words):
            rodlab.of_sep005(records)
