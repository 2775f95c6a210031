"""Jobs that are run with arguments instead of a sheet. The arguments have the names of the fields of the sheet."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ._jobs import Progress, run_part
from ._result import Result
from ._sheet import Part, quantity


def identify(
    tests: Sequence[Mapping[str, Any]],
    *,
    length: float | str | None = None,
    density: float | str | None = None,
    diameter: float | str | None = None,
    poisson_ratio: float | str | None = None,
    recorder: Part | None = None,
    laws: Sequence[str] | None = None,
    compare: bool = True,
    profiles: bool = True,
    cell: float | str | None = None,
    title: str = "Constitutive law",
    folder: str | os.PathLike[str] = ".",
    progress: Progress | None = None,
) -> Result:
    """Returns the constitutive law of impacted rods from the histories of two sections (Ödeen 1993, paper D), as ``rodlab identify`` does.

    Parameters
    ----------
    tests : list of mapping
        Tests with the fields of a sheet: ``name``, ``records``, ``excitation``, ``response``, ``impact_velocity``, ...; for rods of several
        lengths also ``specimen``, such as ``{"length": "394 mm ± 0.5 mm", "density": "1140 kg/m3 ± 0.5 %"}``.
    length : float or str, optional
        Distance from the section of the excitation to the free end, in m, for all tests without a ``specimen``.
    density : float or str, optional
        Density in kg/m³, together with ``length``.
    diameter, poisson_ratio : float or str, optional
        Diameter in m and Poisson's ratio of a round rod, together with ``length``, for lateral inertia; without them, the rod is assumed to be thin.
    recorder : Part, optional
        Filter of the recorder of all tests, such as ``sheet.Butterworth(order=8, cutoff="17.9 kHz")``. Without it, the filter biases nonlinear laws.
    laws : list of str, optional
        Laws to be fitted, by their names in a sheet; by default those of paper D: ``Maxwell``, ``Norton``, ``GurevichRabinovich``.
    compare, profiles : bool
        True to compare the laws with each other and with linear competitors, and to compute profile likelihoods.
    cell : float or str, optional
        Length of the cells of the computed rod in m; by default as short as the accuracy requires.
    folder : path
        Folder to which relative paths refer.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The data do not allow a law to be identified.
    """
    specimen = {
        name: quantity(value, unit, name)
        for name, value, unit in (
            ("length", length, "m"),
            ("density", density, "kg/m3"),
            ("diameter", diameter, "m"),
            ("poisson_ratio", poisson_ratio, ""),
        )
        if value is not None
    }
    fields: dict[str, Any] = {
        "title": title,
        "specimen": specimen or None,
        "tests": tests,
        "recorder": recorder,
        "laws": None if laws is None else [Part(law) for law in laws],
        "compare": compare,
        "profiles": profiles,
        "cell": None if cell is None else quantity(cell, "m", "cell"),
    }
    sheet = Part("Identify", (), tuple(fields.items()))
    return run_part(sheet, Path(folder), of=Result, progress=progress).require()


def recovery(
    tests: Sequence[Mapping[str, Any]],
    *,
    series_modulus: float | str,
    frequency: float | str,
    virgin_loss_factor: float | str | None = None,
    standard_error: float | str | None = None,
    readings_are: str | None = None,
    error_scale: str | None = None,
    predictions: Sequence[Mapping[str, Any]] | None = None,
    paper_procedure: Mapping[str, Any] | None = None,
    title: str = "Creep recovery",
    folder: str | os.PathLike[str] = ".",
    progress: Progress | None = None,
) -> Result:
    """Returns the loss factor after creep loads, with one model for all tests (Ödeen 1993, paper C), as ``rodlab recovery`` does.

    Parameters
    ----------
    tests : list of mapping
        Tests with the fields of a sheet: ``name``, ``load`` such as ``[sheet.Constant(stress="45 MPa", duration="30 min")]``, and ``readings``
        such as ``sheet.Here([{"at": "1 min", "value": 0.0435}, ...])`` or ``sheet.File(path="test_2.csv", readings="loss factor")``.
    series_modulus : float or str
        Modulus of the virgin material in Pa at the frequency of the readings.
    frequency : float or str
        Frequency in Hz at which the loss factor was read.
    virgin_loss_factor : float or str, optional
        Loss factor before any load, such as ``"0.025 ± 0.0002"``.
    standard_error : float or str, optional
        Standard error of the readings that state none.
    readings_are : str, optional
        ``LossFactors`` (default) or ``Changes``.
    error_scale : str, optional
        ``Stated`` (default) or ``FromResidual``.
    predictions : list of mapping, optional
        Loads whose recovery is predicted: ``name`` and ``load``.
    paper_procedure : mapping, optional
        Settings of the procedure of the paper, such as ``{"reference": "45 MPa"}``, to apply it in addition to the joint fit.
    folder : path
        Folder to which relative paths refer.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The readings do not allow a model.
    """
    fields: dict[str, Any] = {
        "title": title,
        "series_modulus": quantity(series_modulus, "Pa", "series_modulus"),
        "frequency": quantity(frequency, "Hz", "frequency"),
        "virgin_loss_factor": None if virgin_loss_factor is None else quantity(virgin_loss_factor, "", "virgin_loss_factor"),
        "standard_error": None if standard_error is None else quantity(standard_error, "", "standard_error"),
        "readings_are": None if readings_are is None else Part(readings_are),
        "error_scale": None if error_scale is None else Part(error_scale),
        "tests": tests,
        "predictions": predictions,
        "paper_procedure": paper_procedure,
    }
    sheet = Part("Recovery", (), tuple(fields.items()))
    return run_part(sheet, Path(folder), of=Result, progress=progress).require()


def simulate(
    experiment: Part,
    *,
    instrument: Mapping[str, Any] | None = None,
    materials: Mapping[str, Mapping[str, Any]] | None = None,
    output: str = "records.npy",
    seed: int = 1,
    title: str = "Virtual test",
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Computes a virtual test, as ``rodlab simulate`` does: records like those of a laboratory, and a sheet for their evaluation.

    Parameters
    ----------
    experiment : Part
        ``sheet.EndAccelerations``, ``sheet.StrainsInFrame``, ``sheet.CreepRecovery``, ``sheet.ImpactedRod``,
        ``sheet.HammerOnBody`` or ``sheet.HopkinsonBars``.
    instrument : mapping
        Sensors, filter, sampling and converter, such as ``{"sampling_rate": "65.536 kHz", "length": "31.25 ms", "noise": "0.02 %"}``.
    materials : mapping
        Materials by name.
    output : str
        Name of the files of the records; the extension determines the format.
    seed : int
        Seed of scatter and noise: the same arguments give the same files to the last bit.
    out : path, optional
        Folder that receives records, sheets and report; by default nothing is written.

    Returns
    -------
    Result
        Result with the records and sheets as `attachments`, and the true values as tables.

    Raises
    ------
    SheetError
        An argument is wrong.
    WriteError
        The folder cannot be written.
    """
    fields: dict[str, Any] = {
        "title": title,
        "materials": materials or {},
        "experiment": experiment,
        "instrument": instrument,
        "output": output,
        "seed": seed,
    }
    sheet = Part("Simulate", (), tuple(fields.items()))
    return run_part(sheet, Path("."), of=Result, out=out, progress=progress)
