"""Hits from recordings."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._errors import Error, SheetError
from ._sheet import Part, quantity, text_of

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory


@dataclass(frozen=True, eq=False)
class Hit:
    """Hit with its samples and the decisions on it.

    Attributes
    ----------
    name : str
        Name in the log of hits of a report.
    accepted : bool
        True if the hit contributes to the average.
    reasons : tuple of str
        Reasons against the hit, and decisions made by hand.
    samples : array, shape (n_channels, n_samples)
        Calibrated samples in SI, read-only.
    sampling_rate_hz, start_time : float
        Sampling rate in Hz; time of the first sample in s.
    """

    name: str
    accepted: bool
    reasons: tuple[str, ...]
    samples: NDArray[np.float64] = field(repr=False)
    sampling_rate_hz: float
    start_time: float

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the samples in s, shape (n_samples,)."""
        return self.start_time + np.arange(self.samples.shape[1]) / self.sampling_rate_hz


@dataclass(frozen=True, eq=False)
class Hits:
    """Hits of a test, accepted and rejected, with the units and warnings of their recordings.

    Attributes
    ----------
    hits : tuple of Hit
    units : mapping of str to str
        SI unit of each channel by the name of the channel, in the order of the rows of `samples`.
    warnings : tuple of str
        Contradictions between the arguments and a file, and data that were left out.
    """

    hits: tuple[Hit, ...] = field(repr=False)
    units: Mapping[str, str]
    warnings: tuple[str, ...]
    _records: dict[str, Any] = field(repr=False)
    _hits: dict[str, Any] = field(repr=False)
    _folder: Path = field(repr=False)
    _kept: TemporaryDirectory[str] | None = field(repr=False, default=None)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels, in the order of the rows of `samples`."""
        return tuple(self.units)

    @property
    def sampling_rate_hz(self) -> float:
        """Sampling rate of the hits in Hz.

        Raises
        ------
        Error
            There are no hits.
        """
        if not self.hits:
            raise Error("there are no hits, so there is no sampling rate")
        return self.hits[0].sampling_rate_hz

    def accepted(self, channel: str) -> NDArray[np.float64]:
        """Returns the samples of `channel` of all accepted hits in SI, shape (n_hits, n_samples); shorter hits are padded with zeros.

        Raises
        ------
        Error
            There is no such channel.
        """
        if channel not in self.units:
            raise Error(f"there is no channel `{channel}`, only {', '.join(f'`{name}`' for name in self.units)}")
        row = self.channels.index(channel)
        rows = [hit.samples[row] for hit in self.hits if hit.accepted]
        longest = max((len(samples) for samples in rows), default=0)
        return np.array([np.pad(samples, (0, longest - len(samples))) for samples in rows]).reshape(len(rows), longest)

    def __len__(self) -> int:
        return len(self.hits)

    def __getstate__(self) -> dict[str, Any]:
        if self._kept is not None:
            raise TypeError("hits of arrays are in a temporary folder of this process: pickle the arrays instead")
        return self.__dict__ | {"units": dict(self.units)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state | {"units": MappingProxyType(state["units"])})


def read(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    *,
    channels: Mapping[str, str | Mapping[str, Any]],
    sampling_rate_hz: float | str | None = None,
    cut: Part | None = None,
    criteria: Mapping[str, Any] | None = None,
    reject: Mapping[int, str] | None = None,
    accept: Mapping[int, str] | None = None,
    trigger_channel: str | None = None,
    folder: str | os.PathLike[str] = ".",
) -> Hits:
    """Reads recordings, calibrates them, cuts them into hits, and accepts or rejects the hits.

    The arguments are the fields of a test sheet: ``rodlab.init("frf")`` writes a sheet that explains all of them.

    Parameters
    ----------
    files : path, pattern or list of them, optional
        Files with all channels: NPY, NPZ, CSV, universal files (58, 58b), LVM, TDMS, WAVE, Excel, MATLAB (5 and 7.3), HDF5, netCDF-4 or traces of oscilloscopes, recognised by their content.
    channels : mapping
        Maps the name of each channel to its unit in the file, such as ``"m/s2"``, or to the fields of a channel, such as
        ``{"from": 2, "unit": "V", "sensitivity": "10.2 mV/g ± 2 %"}``. Without ``from``, the n-th entry is the n-th channel of the file.
        If each channel has its own files, state them here instead of in ``files``: ``{"files": ["force-*.csv"], "unit": "N"}``. Without ``from``,
        the channel is then the first one of its file.
    sampling_rate_hz : float or str, optional
        Sampling rate in Hz, or as a text such as ``"65.536 kHz"``; needed if the files do not contain it.
    cut : Part, optional
        Rule that cuts long records into hits, such as ``sheet.Trigger(level="20 N", pre_trigger="1 ms", length="4096 samples")``; by default each
        record is a hit.
    criteria : mapping, optional
        Conditions that an accepted hit must meet, such as ``{"double_hit": 0.1}``.
    reject, accept : mapping of int to str, optional
        Decisions made by hand: number of the hit, from 1, and the reason.
    trigger_channel : str, optional
        Channel that determines the start of a hit; by default the first.
    folder : path
        Folder to which relative paths refer.

    Returns
    -------
    Hits

    Raises
    ------
    ReadError
        A file is missing or is not a recording.
    SheetError
        An argument is wrong, or does not agree with the files.
    """
    if not channels:
        raise Error("channels is empty, expected a name and a unit of at least one channel")
    records = {
        "files": None if files is None else _names(files),
        "sampling_rate": None if sampling_rate_hz is None else quantity(sampling_rate_hz, "Hz", "sampling_rate_hz"),
        "channels": [_channel(name, stated, number) for number, (name, stated) in enumerate(channels.items(), 1)],
    }
    hits = {
        "channel": trigger_channel,
        "cut": cut,
        "criteria": criteria,
        "reject": [{"hit": hit, "because": because} for hit, because in (reject or {}).items()],
        "accept": [{"hit": hit, "because": because} for hit, because in (accept or {}).items()],
    }
    fields = (("title", ""), ("records", records), ("hits", hits), ("input", next(iter(channels))))
    found, units, warnings = _rodlab.load(text_of(Part("Frf", (), fields)), folder)
    return Hits(
        tuple(_hit(hit) for hit in found), MappingProxyType(dict(units)), tuple(warnings), records, hits, Path(folder)
    )


class HitOptions(TypedDict, total=False):
    """Options for the cutting of records into hits and the acceptance of hits, as for :func:`read`."""

    cut: Part | None
    criteria: Mapping[str, Any] | None
    reject: Mapping[int, str] | None
    accept: Mapping[int, str] | None
    trigger_channel: str | None


def of_arrays(
    arrays: ArrayLike | Sequence[ArrayLike],
    *,
    channels: Mapping[str, str | Mapping[str, Any]],
    sampling_rate_hz: float | str,
    **options: Unpack[HitOptions],
) -> Hits:
    """Returns hits from arrays in memory. They are accepted or rejected like hits from files.

    As long as the hits exist, the arrays are kept as files in a temporary folder, from which every job can read them.

    Parameters
    ----------
    arrays : array_like, shape (n_hits, n_channels, n_samples), or list of (n_channels, n_samples)
        Real numbers in the units of the channels.
    channels, sampling_rate_hz, **options
        As for :func:`read`.

    Raises
    ------
    SheetError
        An array is empty, has a wrong shape or contains no real numbers, or an argument is wrong.
    Error
        Two arrays are equal, so that one measurement would be counted twice.
    ReadError
        A record has numbers that are NaN or infinite.
    """
    from tempfile import TemporaryDirectory

    kept = TemporaryDirectory(prefix="rodlab-")
    records = list(arrays) if isinstance(arrays, (Sequence, np.ndarray)) else [arrays]
    if not records:
        raise SheetError("arrays is empty, expected one per hit", field="arrays")
    digits = len(str(len(records)))
    for number, record in enumerate(records, 1):
        samples = np.asarray(record)
        if samples.dtype.kind not in "biuf" or samples.ndim != 2 or samples.size == 0:
            found = f"has the type {samples.dtype} and the shape {samples.shape}"
            raise SheetError(f"array {number} {found}, expected real numbers of the shape (n_channels, n_samples)", field="arrays")
        np.save(Path(kept.name) / f"array-{number:0{digits}}.npy", samples.astype(np.float64))
    made = read("array-*.npy", channels=channels, sampling_rate_hz=sampling_rate_hz, folder=kept.name, **options)
    return replace(made, _kept=kept)


def _hit(hit: _rodlab.Hit) -> Hit:
    hit.samples.flags.writeable = False
    return Hit(hit.name, hit.accepted, tuple(hit.reasons), hit.samples, hit.sampling_rate_hz, hit.start_time)


def _channel(name: str, stated: str | Mapping[str, Any], number: int) -> dict[str, Any]:
    fields = {"unit": stated} if isinstance(stated, str) else dict(stated)
    if fields.get("files") is None:
        return {"name": name, "from": number} | fields
    return {"name": name, "from": 1} | fields | {"files": _names(fields["files"])}


def _names(files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> list[str]:
    return [os.fspath(file) for file in ([files] if isinstance(files, (str, os.PathLike)) else files)]
