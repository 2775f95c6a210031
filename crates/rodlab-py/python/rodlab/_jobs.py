"""Functions that run sheets from files or from memory, and the functions check, inspect, convert and init."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from . import _rodlab
from ._result import Result
from ._sheet import Part, quantity, text_of

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory

R = TypeVar("R", bound=Result)
Progress = Callable[[str, int, int], object]
"""Called as ``progress(step, done, of)``; `of` is 0 if it is not known."""


def run(
    sheet: str | os.PathLike[str] | Part,
    out: str | os.PathLike[str] | None = None,
    *,
    job: str | None = None,
    write: bool = True,
    folder: str | os.PathLike[str] = ".",
    progress: Progress | None = None,
) -> Result:
    """Runs a test sheet, like the command of ``rodlab`` with the name of the job.

    Parameters
    ----------
    sheet : path or Part
        File of the sheet, or a sheet written in Python with :mod:`rodlab.sheet`.
    out : path, optional
        Folder for the files of the result. By default it is next to the sheet, and its name is that of the sheet followed by ``-result``; for a
        sheet written in Python, nothing is written by default.
    job : str, optional
        Job that the sheet must state, such as ``"modulus"``.
    write : bool
        True to write the files of the result, if the sheet is a file.
    folder : path
        Folder to which the relative paths of a sheet written in Python refer.
    progress : callable, optional
        ``progress(step, done, of)``. An exception that it raises ends the job.

    Returns
    -------
    Result
        Result with any standing; :meth:`Result.require` raises an exception if the data do not allow a result.

    Raises
    ------
    SheetError
        The sheet is wrong, or requests something impossible.
    ReadError, WriteError
        A file cannot be read, or the result cannot be written.
    KeyboardInterrupt
        Raised within 0.3 s of an interruption. No files are written afterwards.
    """
    if isinstance(sheet, Part):
        return run_part(sheet, Path(folder), of=Result, out=out, progress=progress)
    return Result._of(_rodlab.run_sheet(sheet, job=job, out=out, write=write, progress=progress))


def run_part(
    sheet: Part,
    folder: Path,
    *,
    of: type[R],
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    kept: TemporaryDirectory[str] | None = None,
) -> R:
    """Returns the result of a sheet written in Python, as an object of the class `of`. `kept` is a temporary folder that must not be deleted before the result."""
    outcome = _rodlab.run_text(text_of(sheet), folder, out=out, progress=progress)
    return of._of(outcome, sheet, folder, kept)


def check(sheet: str | os.PathLike[str]) -> str:
    """Reads a sheet and its files without computing anything; returns the name of the job.

    Raises
    ------
    SheetError, ReadError
        The sheet or a file is wrong.
    """
    return _rodlab.check(sheet)[0]


def inspect(file: str | os.PathLike[str]) -> dict[str, Any]:
    """Returns the contents of a recording: format, channels with units and levels, rates, apparent faults, and the statements that a sheet needs.

    The keys are those of ``rodlab inspect --json``.

    Raises
    ------
    ReadError
        The file cannot be read.
    """
    return dict(json.loads(_rodlab.inspect(file)))


def convert(
    input: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    tolerant: bool = False,
    lossless: bool = False,
    binary: bool = False,
    force: bool = False,
    sampling_rate_hz: float | str | None = None,
) -> dict[str, Any]:
    """Writes a recording in another format, given by the extension of `output`: csv, mat, npy, npz, uff, wav.

    Parameters
    ----------
    tolerant : bool
        True to convert the readable part of a damaged file and to list the unreadable parts.
    lossless : bool
        True to reject a conversion that would lose information.
    binary : bool
        True to write a universal file with IEEE numbers (58b), which preserves every bit.
    force : bool
        True to replace `output` if it exists.
    sampling_rate_hz : float or str, optional
        Sampling rate in Hz, or a text such as ``"51.2 kHz"``, if the file does not state it, or states it rounded (by less than 0.1 %).

    Returns
    -------
    dict
        ``from``, ``to``, ``n_series``, ``bytes``, ``not_read``, ``warnings``, ``lost``.

    Raises
    ------
    ReadError, WriteError, SheetError
    """
    rate = None if sampling_rate_hz is None else quantity(sampling_rate_hz, "Hz", "sampling_rate_hz")
    done = _rodlab.convert(input, output, tolerant=tolerant, lossless=lossless, binary=binary, force=force, sampling_rate=rate)
    return dict(json.loads(done))


def init(job: str, path: str | os.PathLike[str] | None = None, *, rig: str | None = None) -> Path:
    """Writes a commented sheet to start from, by default to ``<job>.ron``, and returns its path.

    If the test rig ``rig`` is given, the sheet has only the fields of this rig: ``"two-accelerometers"``, ``"three-gauges"``, ``"hopkinson-bar"``,
    ``"hammer-frf"``, ``"shpb"`` or ``"dma"``.

    Raises
    ------
    Error
        There is no such job or rig, or the rig belongs to another job.
    WriteError
        The file exists already, or cannot be written.
    """
    path = Path(f"{job}.ron" if path is None else path)
    _rodlab.init(job, path, rig)
    return path
