"""Rheological laws fitted to a complex modulus, and their material cards for other programs."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import Error, SheetError
from ._jobs import Progress, run_part
from ._result import Quantity, Result, Table
from ._sheet import Part, check_options, quantity
from .modulus import Modulus, Number

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory

    from matplotlib.axes import Axes

__all__ = ["Fit", "Sweep", "fit", "of_arrays", "over_time", "sweep"]

L = TypeVar("L", bound="_Laws")
N = TypeVar("N", np.float64, np.complex128)

_PROGRAMS = {
    "abaqus": "Abaqus",
    "ansys": "Ansys",
    "ls-dyna": "LsDyna",
    "comsol": "Comsol",
    "code_aster": "CodeAster",
    "json": "Json",
}


class _Laws(Result):
    """Fitted laws. The table ``laws`` compares them."""

    def parameters(self, law: str) -> dict[str, Quantity]:
        """Returns the parameters of a fitted law by name, with standard errors and verdicts.

        Raises
        ------
        Error
            The law was not fitted.
        """
        wanted = _plain(law)
        split = (quantity.name.split(", ", 1) + [quantity] for quantity in self.quantities if ", " in quantity.name)
        found: dict[str, Quantity] = {}
        for of, name, one in split:
            if isinstance(one, Quantity) and _plain(str(of)) == wanted:
                found[str(name)] = one
        if not found:
            raise Error(f"there is no fit of `{law}`")
        return found

    def card(
        self,
        program: str,
        *,
        name: str,
        poisson_ratio: Number,
        poisson_ratio_at: Number | None = None,
        temperature: str | None = None,
        progress: Progress | None = None,
    ) -> str:
        """Returns the text of a material card of the Prony series, the law ``generalised maxwell``, which must be among the fitted laws.

        Parameters
        ----------
        program : str
            ``abaqus``, ``ansys``, ``ls-dyna``, ``comsol``, ``code_aster`` or ``json``.
        name : str
            Name of the material: a letter followed by letters, digits, ``-`` or ``_``.
        poisson_ratio : float or str
            Poisson's ratio such as ``"0.40 ± 0.02"``.
        poisson_ratio_at : float or str, optional
            Frequency in Hz at which the ratio applies; the middle of the fitted lines by default.
        temperature : str, optional
            Temperature such as ``"23 degC"``, for a comment in the card.

        Raises
        ------
        Error
            There is no such program, or no card follows from the series.
        """
        return self._cards(program, None, name, poisson_ratio, poisson_ratio_at, temperature, progress)[0]

    def card_draws(
        self,
        program: str,
        *,
        draws: int,
        name: str,
        poisson_ratio: Number,
        poisson_ratio_at: Number | None = None,
        temperature: str | None = None,
        progress: Progress | None = None,
    ) -> list[str]:
        """Returns the texts of cards for `draws` random draws of modulus, density and Poisson's ratio, for a Monte Carlo calculation.

        Parameters
        ----------
        draws : int
            Number of cards, from 1 to 1000; the other parameters are those of ``card``.

        Raises
        ------
        Error
            As for ``card``.
        """
        return self._cards(program, draws, name, poisson_ratio, poisson_ratio_at, temperature, progress)[1:]

    def _cards(
        self,
        program: str,
        draws: int | None,
        name: str,
        poisson_ratio: Number,
        poisson_ratio_at: Number | None,
        temperature: str | None,
        progress: Progress | None,
    ) -> list[str]:
        if program not in _PROGRAMS:
            raise Error(f"program is `{program}`, expected one of {', '.join(f'`{known}`' for known in _PROGRAMS)}")
        cards = {
            "name": name,
            "poisson_ratio": quantity(poisson_ratio, "", "poisson_ratio"),
            "poisson_ratio_at": None if poisson_ratio_at is None else quantity(poisson_ratio_at, "Hz", "poisson_ratio_at"),
            "temperature": temperature,
            "programs": [Part(_PROGRAMS[program])],
            "draws": draws,
        }
        done = _with_laws(self, {"cards": cards}, progress, type(self))
        made = [text for file, text in done.attachments.items() if file not in self.attachments]
        if not made:
            raise Error("; ".join(done.warnings) or "no card was made, expected `generalised maxwell` among the laws")
        return [text.decode() for text in made]


class Fit(_Laws, Modulus):
    """Laws fitted to the valid lines of a modulus, together with this modulus."""


class Sweep(_Laws):
    """Tables of a modulus against frequency or time, at one or several temperatures, and the laws fitted to them.

    The table ``data`` contains the rows. For several temperatures, ``master_curve`` contains the rows at their reduced frequencies or times,
    ``shifts`` the shift of each temperature, and ``shift_laws`` the laws of WLF and Arrhenius.
    """

    @property
    def causal(self) -> Table | None:
        """Causal estimate, the relaxing material closest to all rows together, with its errors; None unless requested with ``causal=True``."""
        return self.tables.get("causal")

    @property
    def lines(self) -> Table:
        """Rows with their frequencies or times; for several temperatures, these are the reduced ones."""
        return self.tables.get("master_curve") or self.table("data")

    @property
    def frequency_hz(self) -> NDArray[np.float64]:
        """Frequencies in Hz (reduced frequencies for several temperatures), shape (n_rows,); only for rows over frequency."""
        return self.lines.numbers("reduced_frequency_hz" if "master_curve" in self.tables else "frequency_hz")

    @property
    def modulus(self) -> NDArray[np.complex128]:
        """Storage and loss modulus in Pa, shape (n_rows,), with the vertical shifts removed."""
        of = self.lines.numbers
        return np.asarray(of("storage_modulus_pa") + 1j * of("loss_modulus_pa"), dtype=np.complex128)

    @property
    def time(self) -> NDArray[np.float64]:
        """Times in s from the start of the load (reduced times for several temperatures), shape (n_rows,); only for rows over time."""
        return self.lines.numbers("reduced_time_s" if "master_curve" in self.tables else "time_s")

    @property
    def modulus_over_time(self) -> NDArray[np.float64]:
        """Modulus E(t), or 1/J(t) of creep, in Pa, shape (n_rows,), with the vertical shifts removed."""
        return self.lines.numbers("modulus_over_time_pa")

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws both moduli against frequency, or the modulus against time, with the series of a master curve; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(layout="constrained")
        if "storage_modulus_pa" in self.lines.units:
            along, label = self.frequency_hz, "frequency (Hz)"
            parts = [("storage modulus", "storage_modulus_series_pa", self.modulus.real), ("loss modulus", "loss_modulus_series_pa", self.modulus.imag)]
        else:
            along, label = self.time, "time (s)"
            parts = [("modulus", "modulus_over_time_series_pa", self.modulus_over_time)]
        order = np.argsort(along)
        for name, series, values in parts:
            (drawn,) = ax.loglog(along[order], values[order], ".", markersize=3, label=name)
            if series in self.lines.units:
                ax.loglog(along[order], self.lines.numbers(series)[order], color=drawn.get_color(), linewidth=1)
        ax.set_xlabel(f"reduced {label}" if "master_curve" in self.tables else label)
        ax.set_ylabel("modulus (Pa)")
        ax.set_title(self.title)
        ax.legend()
        return ax


def fit(
    modulus: Modulus,
    laws: str | Sequence[str],
    *,
    criterion: str = "Bic",
    confidence: Number = "95 %",
    most_branches: int | None = None,
    most_lines: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fits laws to the valid lines of a modulus and compares the laws, as the field ``laws`` of a sheet for ``rodlab modulus`` does.

    Parameters
    ----------
    modulus : Modulus
        Result of a function of :mod:`rodlab.modulus`. The files of its hits are read again.
    laws : str or list of str
        ``elastic``, ``constant q``, ``spring-pot``, ``kelvin-voigt``, ``maxwell``, ``zener``, ``fractional maxwell``, ``fractional zener``,
        ``havriliak-negami``, ``generalised maxwell`` (number of branches by the criterion), ``power law`` (Ödeen 1993, paper E, eq. 7).
    criterion : str
        ``Bic`` or ``Aicc``.
    confidence : float or str
        Confidence of the intervals.
    most_branches : int, optional
        Largest number of branches of a generalised Maxwell model; not limited by default.
    most_lines : int, optional
        Largest number of fitted lines, chosen evenly among the valid lines; 400 by default.

    Raises
    ------
    SheetError
        There is no such law.
    NotAllowed
        The data do not allow a modulus.
    """
    return _with_laws(modulus, _stated_laws(laws, criterion, confidence, most_branches, most_lines), progress, Fit)


class SweepOptions(TypedDict, total=False):
    """Options of :func:`sweep`, :func:`of_arrays` and :func:`over_time`; the defaults are those of a sheet."""

    title: str
    laws: str | Sequence[str]
    """Laws as for :func:`fit`; none by default."""
    reference_temperature: str
    """Reference temperature of the master curve, such as ``"20 degC"``; needed for several temperatures."""
    kind: str
    """``Tension`` (default), ``Bending``, ``Shear`` or ``Bulk``."""
    density: Number
    """Density in kg/m³; needed for cards."""
    band: tuple[Number, Number]
    """Lowest and highest measured frequency in Hz of the rows used."""
    steps: Part
    """Grouping of rows into temperatures; ``sheet.Within("1 K")`` by default."""
    scale_uncertainty: Number
    """Standard uncertainty of the scale of all moduli."""
    temperature_uncertainty: Number
    """Standard uncertainty of the temperature of each step in K, such as 0.5."""
    stated_shifts: Part
    """Shifts such as ``sheet.Wlf(c1=17.44, c2=51.6, at="100 degC")``, where neighbouring temperatures do not overlap."""
    vertical_shifts: Part
    """``AsNeeded`` (default), ``Unity`` or ``RubberElasticity(...)``."""
    causal: bool
    """True to determine also the modulus of the relaxing material that is closest to all rows together: :attr:`Sweep.causal`."""
    criterion: str
    confidence: Number
    most_branches: int
    most_lines: int
    progress: Progress


def sweep(
    tables: Sequence[Mapping[str, Any]], *, folder: str | os.PathLike[str] = ".", **options: Unpack[SweepOptions]
) -> Sweep:
    """Returns laws and a master curve of measured moduli, for example from a DMA, as ``rodlab fit`` does.

    Parameters
    ----------
    tables : list of mapping
        Tables with the fields of a sheet: ``files``, ``frequency``, ``modulus`` such as ``sheet.Parts(storage="E'", loss="E''")``, ``temperature``
        such as ``sheet.Column("T")``, ``units``, ``errors``. For moduli over time: ``time`` and ``ramp`` instead of ``frequency``, ``modulus`` such as
        ``sheet.Relaxation(modulus="E")``, ``sheet.Creep(compliance="J")`` or ``sheet.CreepModulus(modulus="E")``.
    folder : path
        Folder to which relative paths refer.
    **options
        See :class:`SweepOptions`.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The tables do not allow a result.
    """
    return _sweep(tables, Path(folder), None, options)


def of_arrays(
    frequency_hz: ArrayLike,
    modulus: ArrayLike,
    *,
    temperature: ArrayLike | str,
    standard_error: ArrayLike | None = None,
    **options: Unpack[SweepOptions],
) -> Sweep:
    """Returns laws and a master curve of moduli that are arrays in memory.

    Parameters
    ----------
    frequency_hz : array_like, shape (n_rows,)
        Frequencies in Hz.
    modulus : array_like of complex, shape (n_rows,)
        E' + iE'' in Pa.
    temperature : array_like of shape (n_rows,), or str
        Temperatures in °C; or one temperature of all rows, such as ``"23 degC"``.
    standard_error : array_like of complex, shape (n_rows,), optional
        Standard errors of E' (real part) and of E'' (imaginary part) in Pa, independent from row to row; by default they follow from the scatter about
        the fit.
    **options
        See :class:`SweepOptions`.

    Raises
    ------
    SheetError
        An array has a wrong length or a number that is not finite, or an argument is wrong.
    NotAllowed
        The moduli do not allow a result.
    """
    found = _array("modulus", modulus, np.complex128)
    columns = {"frequency (Hz)": _array("frequency_hz", frequency_hz, np.float64), "storage (Pa)": found.real, "loss (Pa)": found.imag}
    table: dict[str, Any] = {"frequency": "frequency", "modulus": Part("Parts", (), (("storage", "storage"), ("loss", "loss")))}
    if standard_error is not None:
        error = _array("standard_error", standard_error, np.complex128)
        columns |= {"error of storage (Pa)": error.real, "error of loss (Pa)": error.imag}
        of = Part("Parts", (), (("storage", "error of storage"), ("loss", "error of loss")))
        table["errors"] = Part("Columns", (of,))
    return _of_columns(table, columns, temperature, options)


def over_time(
    time: ArrayLike,
    modulus: ArrayLike,
    *,
    test: str,
    ramp: Number | None = None,
    temperature: ArrayLike | str,
    standard_error: ArrayLike | None = None,
    **options: Unpack[SweepOptions],
) -> Sweep:
    """Returns laws and a master curve of moduli over time that are arrays in memory.

    Parameters
    ----------
    time : array_like, shape (n_rows,)
        Times from the start of the load, in s. Rows up to the end of the ramp are omitted.
    modulus : array_like, shape (n_rows,)
        Stress divided by strain in Pa: E(t) of relaxation, 1/J(t) of creep.
    test : str
        ``relaxation`` or ``creep``.
    ramp : float or str, optional
        Duration in s of the ramp, during which the load grows in proportion to time; by default the load is a step.
    temperature : array_like of shape (n_rows,), or str
        Temperatures in °C; or one temperature of all rows, such as ``"23 degC"``.
    standard_error : array_like, shape (n_rows,), optional
        Standard errors of the moduli in Pa, independent from row to row; by default they follow from the scatter about the fit.
    **options
        See :class:`SweepOptions`; ``causal`` needs moduli over frequency.

    Raises
    ------
    SheetError
        An array has a wrong length or a number that is not finite, or an argument is wrong.
    NotAllowed
        The moduli do not allow a result.
    """
    tests = {"relaxation": "Relaxation", "creep": "CreepModulus"}
    if test not in tests:
        raise SheetError(f"test is {test!r}, expected 'relaxation' or 'creep'", field="test")
    columns = {"time (s)": _array("time", time, np.float64), "modulus (Pa)": _array("modulus", modulus, np.float64)}
    table: dict[str, Any] = {"time": "time", "modulus": Part(tests[test], (), (("modulus", "modulus"),))}
    if ramp is not None:
        table["ramp"] = quantity(ramp, "s", "ramp")
    if standard_error is not None:
        columns["error (Pa)"] = _array("standard_error", standard_error, np.float64)
        table["errors"] = Part("Columns", (Part(tests[test], (), (("modulus", "error"),)),))
    return _of_columns(table, columns, temperature, options)


def _of_columns(
    table: dict[str, Any], columns: dict[str, NDArray[np.float64]], temperature: ArrayLike | str, options: SweepOptions
) -> Sweep:
    from tempfile import TemporaryDirectory

    if isinstance(temperature, str):
        table["temperature"] = Part("Stated", (temperature,))
    else:
        columns["temperature (degC)"] = _array("temperature", temperature, np.float64)
        table["temperature"] = Part("Column", ("temperature",))
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) != 1:
        raise SheetError(f"found {lengths} rows, expected the same number of each", field="modulus")
    kept = TemporaryDirectory(prefix="rodlab-")
    lines = [",".join(columns), *(",".join(repr(float(one)) for one in row) for row in zip(*columns.values(), strict=True))]
    (Path(kept.name) / "moduli.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return _sweep([{"files": ["moduli.csv"]} | table], Path(kept.name), kept, options)


def _array(name: str, values: ArrayLike, kind: type[N]) -> NDArray[N]:
    """Returns `values` as a vector of finite numbers."""
    try:
        found = np.asarray(values)
        vector = found.astype(kind) if found.dtype.kind in "biuf" or (found.dtype.kind == "c" and kind is np.complex128) else None
    except (TypeError, ValueError, OverflowError):
        vector = None
    if vector is None or vector.ndim != 1 or vector.size == 0 or not np.all(np.isfinite(vector)):
        raise SheetError(f"{name} is not a vector of finite numbers, expected one of the shape (n_rows,)", field=name)
    return vector


def _sweep(
    tables: Sequence[Mapping[str, Any]], folder: Path, kept: TemporaryDirectory[str] | None, options: SweepOptions
) -> Sweep:
    check_options(options, SweepOptions)
    scale = options.get("scale_uncertainty")
    kelvin = options.get("temperature_uncertainty")
    density = options.get("density")
    fields: dict[str, Any] = {
        "title": options.get("title", "Complex modulus of a table"),
        "tables": tables,
        "kind": Part(options["kind"]) if "kind" in options else None,
        "reference_temperature": options.get("reference_temperature"),
        "density": None if density is None else quantity(density, "kg/m3", "density"),
        "steps": options.get("steps"),
        "scale_uncertainty": None if scale is None else quantity(scale, "", "scale_uncertainty"),
        "temperature_uncertainty": None if kelvin is None else quantity(kelvin, "K", "temperature_uncertainty"),
        "stated_shifts": options.get("stated_shifts"),
        "vertical_shifts": options.get("vertical_shifts"),
        "causal": options.get("causal"),
    }
    if "band" in options:
        low, high = (quantity(edge, "Hz", "band") for edge in options["band"])
        fields["band"] = {"from": low, "to": high}
    if "laws" in options:
        stated = (options.get("criterion", "Bic"), options.get("confidence", "95 %"), options.get("most_branches"), options.get("most_lines"))
        fields["laws"] = _stated_laws(options["laws"], *stated)
    sheet = Part("Fit", (), tuple(fields.items()))
    return run_part(sheet, folder, of=Sweep, progress=options.get("progress"), kept=kept).require()


def _stated_laws(
    laws: str | Sequence[str], criterion: str, confidence: Number, most_branches: int | None, most_lines: int | None
) -> dict[str, Any]:
    names = [laws] if isinstance(laws, str) else list(laws)
    return {
        "laws": [named_law(name) for name in names],
        "criterion": Part(criterion),
        "confidence": quantity(confidence, "", "confidence"),
        "most_branches": most_branches,
        "most_lines": most_lines,
    }


def _with_laws(of: Result, more: Mapping[str, Any], progress: Progress | None, kind: type[L]) -> L:
    """Runs the sheet of `of` again, with the fields `more` added to its laws."""
    if of._sheet is None:
        raise Error("the modulus is the result of a sheet in a file, expected one of this package: add `laws` to the sheet instead")
    fields = dict(of._sheet.fields)
    fields["laws"] = dict(fields.get("laws") or {}) | dict(more)
    sheet = Part(of._sheet.name, (), tuple(fields.items()))
    return run_part(sheet, of._folder or Path("."), of=kind, progress=progress, kept=of._kept).require()


def named_law(name: str) -> Part:
    """Returns the law as a part of a sheet, such as ``FractionalZener`` for ``fractional zener`` or ``fractional_zener``."""
    words = name.replace("-", " ").replace("_", " ").split()
    return Part("".join(word[:1].upper() + word[1:] for word in words))


def _plain(name: str) -> str:
    return name.replace("-", "").replace("_", "").replace(" ", "").lower()
