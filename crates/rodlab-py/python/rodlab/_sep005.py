"""Records as time series in the form of SEP-005 of SDyPy: a list of dictionaries, one per channel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Unpack, cast

import numpy as np
from numpy.typing import NDArray

from ._errors import SheetError
from ._records import HitOptions, Hits, of_arrays
from ._sheet import number

Series = Mapping[str, Any]

# Quantities of the standard for each unit. Quantities that do not follow from the unit are omitted.
_QUANTITIES = {"N": "f", "m/s^2": "a", "m/s": "v", "m": "d"}

# Largest deviation of a time from an even grid, in steps: times are often rounded to about six digits.
_UNEVEN = 1e-3
# Largest relative difference between a stated rate and the rate that the times give.
_OTHER_RATE = 1e-6


def of_sep005(records: Sequence[Series] | Sequence[Sequence[Series]], **options: Unpack[HitOptions]) -> Hits:
    """Returns hits from time series in the form of SEP-005. They are accepted or rejected like hits from files.

    Parameters
    ----------
    records : list of dict, or list of such lists
        Channels of one record, or of several records with the same channels in the same order. Each channel has ``name``, ``data``,
        ``unit_str``, and ``fs`` in Hz or ``time`` in s. The samples must be evenly spaced. Times of day, groups and other fields are not kept.
    **options
        As for :func:`rodlab.read`.

    Raises
    ------
    SheetError
        A field is missing or wrong, or the records differ in channels, units or rate.
    Error, ReadError
        As for :func:`rodlab.of_arrays`.
    """
    if not isinstance(records, Sequence) or isinstance(records, str) or not records:
        raise SheetError(f"records is {records!r:.60}, expected a list of time series", field="records")
    one = isinstance(records[0], Mapping)
    several = cast(Sequence[Sequence[Series]], [records] if one else records)
    units: dict[str, str] | None = None
    rate: float | None = None
    arrays = []
    for at, record in enumerate(several):
        place = "records" if one else f"records[{at}]"
        if not isinstance(record, Sequence) or isinstance(record, str) or not record:
            raise SheetError(f"{place} is {record!r:.60}, expected a list of time series", field=place)
        found: dict[str, str] = {}
        rows: list[NDArray[np.float64]] = []
        for channel, series in enumerate(record):
            here = f"{place}[{channel}]"
            name, unit, samples, of_series = _series(series, here)
            if name in found:
                raise SheetError(f"{here}['name'] is `{name}` a second time, expected each name once", field=here)
            if rows and len(samples) != len(rows[0]):
                raise SheetError(f"{here} has {len(samples)} samples, expected {len(rows[0])} as in the first channel", field=here)
            rate = of_series if rate is None else rate
            if abs(of_series - rate) > _OTHER_RATE * rate:
                raise SheetError(f"{here} has the rate {of_series} Hz, expected {rate} Hz as in the first channel", field=here)
            found[name] = unit
            rows.append(samples)
        units = found if units is None else units
        if list(found.items()) != list(units.items()):
            raise SheetError(f"{place} has the channels {found}, expected those of the first record, {units}", field=place)
        arrays.append(np.array(rows))
    assert units is not None and rate is not None
    return of_arrays(arrays, channels=units, sampling_rate_hz=rate, **options)


def to_sep005(hits: Hits) -> list[list[dict[str, Any]]]:
    """Returns the hits, accepted or not, as time series in the form of SEP-005: one list per hit, with one dictionary per channel.

    The fields are ``name``, ``data`` (float64), ``fs`` in Hz, ``unit_str`` in SI, ``group`` (the name of the hit), ``quantity`` of forces
    and motions and, in addition to the standard, ``start_time``: the time of the first sample in s from the start of its record.
    """
    return [
        [
            {
                "name": name,
                "data": hit.samples[row].copy(),
                "fs": hit.sampling_rate_hz,
                "unit_str": unit,
                "group": hit.name,
                "start_time": hit.start_time,
            }
            | ({"quantity": _QUANTITIES[unit]} if unit in _QUANTITIES else {})
            for row, (name, unit) in enumerate(hits.units.items())
        ]
        for hit in hits.hits
    ]


def _series(series: object, place: str) -> tuple[str, str, NDArray[np.float64], float]:
    """Returns the name, unit, samples and sampling rate of a time series."""
    if not isinstance(series, Mapping):
        raise SheetError(f"{place} is of the type {type(series).__name__}, expected a mapping", field=place)
    for key in ("name", "unit_str"):
        if not isinstance(series.get(key), str):
            raise SheetError(f"{place}['{key}'] is {series.get(key)!r}, expected a text", field=place)
    samples = _row(series.get("data"), f"{place}['data']")
    time = series.get("time")
    stated = series.get("fs")
    if stated is None and time is None:
        raise SheetError(f"{place} has neither `fs` nor `time`, expected one of them", field=place)
    rate = None if stated is None else number(stated, "Hz", f"{place}['fs']")
    if time is not None:
        of_times = _rate(_row(time, f"{place}['time']"), len(samples), f"{place}['time']")
        if rate is not None and abs(of_times - rate) > _OTHER_RATE * rate:
            raise SheetError(f"{place}['fs'] is {rate} Hz, expected {of_times} Hz from its `time`", field=place)
        rate = of_times if rate is None else rate
    assert rate is not None
    return series["name"], series["unit_str"], samples, rate


def _row(values: object, place: str) -> NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "biuf" or array.ndim != 1 or array.size == 0:
        found = f"has the type {array.dtype} and the shape {array.shape}"
        raise SheetError(f"{place} {found}, expected real numbers of the shape (n_samples,)", field=place)
    return array.astype(np.float64)


def _rate(time: NDArray[np.float64], n_samples: int, place: str) -> float:
    """Returns the rate in Hz of evenly spaced times."""
    if len(time) != n_samples or n_samples < 2:
        raise SheetError(f"{place} has {len(time)} times of {n_samples} samples, expected two or more of each", field=place)
    step = (time[-1] - time[0]) / (n_samples - 1)
    off = np.abs(time - (time[0] + step * np.arange(n_samples)))
    if not (step > 0 and np.max(off) <= _UNEVEN * step):
        raise SheetError(f"{place} is not evenly spaced, expected a step of {step} s to {_UNEVEN} of it", field=place)
    return float(1 / step)
