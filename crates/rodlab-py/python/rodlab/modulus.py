"""Complex modulus of a rod, by the methods of papers A and B (Ödeen 1993) and related methods.

Every function gives the same results as ``rodlab modulus`` for a sheet with the same statements, to the last digit.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from ._errors import SheetError
from ._jobs import Progress, run_part
from ._records import Hits
from ._result import Column, Result, Table
from ._sheet import Part, check_options, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    import pandas
    import xarray

__all__ = ["Modulus", "Options", "multi_point", "three_point", "two_point"]

Number = float | str
"""A number in SI, which is exact, or a text with a unit and a standard uncertainty, such as ``"799 mm ± 0.3 mm"``."""


class Options(TypedDict, total=False):
    """Options for every method; the defaults are those of a sheet."""

    title: str
    band: tuple[Number, Number]
    """Lowest and highest frequency in Hz of the lines used."""
    poisson_ratio: Number
    """Poisson's ratio, to correct for lateral inertia with the theory of Pochhammer and Chree."""
    silent: Number
    """Time in s at the start of each record, before the hit, from which the noise is estimated."""
    tail: str
    """``"Keep"`` to keep the end of long hits, which contains only noise; by default ``"LeaveOut"``."""
    limits: Mapping[str, str]
    """Requirements on a valid line, such as ``{"storage_modulus": "2 %"}``."""
    checks: Mapping[str, Any]
    """Settings of the checks that any result must pass, such as ``{"level": "1 %"}``."""
    causal: bool
    """True to determine also the modulus of the relaxing material that is closest to all lines together: :attr:`Modulus.causal`."""
    report_at: Sequence[str]
    """Frequencies at which the results are also given as quantities, such as ``["1 kHz"]``."""
    folder: str | os.PathLike[str]
    """Folder to which the relative paths of a ``source`` of type ``Part`` refer; not needed for hits."""
    progress: Progress


class Modulus(Result):
    """Complex modulus as a function of frequency. Arrays have the shape (n_lines,).

    The table ``modulus`` and the properties are in SI, as ``modulus.csv`` is.
    """

    @property
    def lines(self) -> Table:
        """Table of all lines: modulus, loss factor, wave number, damping coefficient, phase velocity, their errors, validity."""
        return self.table("modulus")

    @property
    def budget(self) -> Table | None:
        """Sources of the uncertainty of E' (in % of E') and of the loss factor on every line; None if noise is the only source."""
        return self.tables.get("budget")

    @property
    def causal(self) -> Table | None:
        """Causal estimate, the relaxing material closest to all lines together, with its errors; None unless requested with ``causal=True``."""
        return self.tables.get("causal")

    @property
    def valid(self) -> NDArray[np.bool_]:
        """True for each line that meets the conditions of validity."""
        return np.asarray(self.lines.columns()["valid"], dtype=np.bool_)

    @property
    def frequency_hz(self) -> NDArray[np.float64]:
        """Frequencies in Hz."""
        return self.lines.numbers("frequency_hz")

    @property
    def modulus(self) -> NDArray[np.complex128]:
        """Complex modulus E' + iE'' in Pa."""
        of = self.lines.numbers
        return np.asarray(of("storage_modulus_pa") + 1j * of("loss_modulus_pa"), dtype=np.complex128)

    @property
    def standard_error(self) -> NDArray[np.complex128]:
        """Standard errors of E' (real part) and of E'' (imaginary part) in Pa."""
        of = self.lines.numbers
        errors = of("standard_error_storage_modulus_pa") + 1j * of("standard_error_loss_modulus_pa")
        return np.asarray(errors, dtype=np.complex128)

    @property
    def loss_factor(self) -> NDArray[np.float64]:
        """Loss factor E''/E'."""
        return self.lines.numbers("loss_factor")

    def columns(self) -> dict[str, Column]:
        """Returns the columns of the table of all lines."""
        return self.lines.columns()

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table of all lines; its `attrs` have `units`."""
        return self.lines.to_pandas()

    def to_xarray(self) -> xarray.Dataset:
        """Returns the table of all lines as a data set over the frequency; each variable has its `units`."""
        return self.lines.to_xarray()

    def plot(self, ax: Sequence[Axes] | None = None) -> Sequence[Axes]:
        """Draws E' and the loss factor on two axes, with bands of two standard errors and invalid lines in grey; returns the axes."""
        from ._plot import axes, band

        made = axes(ax, 2)
        of, valid = self.lines.numbers, self.valid
        storage, error = 1e-9 * of("storage_modulus_pa"), 1e-9 * of("standard_error_storage_modulus_pa")
        band(made[0], self.frequency_hz, storage, error, valid, "E' (GPa)")
        band(made[1], self.frequency_hz, of("loss_factor"), of("standard_error_loss_factor"), valid, "loss factor")
        made[1].set_xlabel("frequency (Hz)")
        made[0].set_title(self.title)
        return made


def two_point(
    source: Hits | Part,
    *,
    length: Number,
    diameter: Number,
    density: Number,
    accelerometer_mass: Number | None = None,
    impacted_end: str | None = None,
    free_end: str | None = None,
    solver: str | None = None,
    **options: Unpack[Options],
) -> Modulus:
    """Returns the complex modulus from the motions of both ends of a rod that is struck at one of them (Ödeen 1993, paper A, eqs. 1, 5-7).

    Parameters
    ----------
    source : Hits or Part
        Accepted hits from :func:`rodlab.read`; or ``sheet.Ratio(...)``, a file with the ratio of the motion of the impacted end to that of the
        free end.
    length, diameter : float or str
        Dimensions of the specimen in m.
    density : float or str
        Density in kg/m³.
    accelerometer_mass : float or str, optional
        Mass in kg of the accelerometer on the free end with its connector; none by default.
    impacted_end, free_end : str, optional
        Channels of the two ends; by default the first and the second.
    solver : str, optional
        ``Continuation`` (default), ``Newton`` or ``Series``.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The data do not allow a modulus.
    """
    first, second = _channels(source, 2)
    method = Part(
        "TwoPoint",
        (),
        (
            ("impacted_end", first if impacted_end is None else impacted_end),
            ("free_end", second if free_end is None else free_end),
            ("solver", None if solver is None else Part(solver)),
        ),
    )
    rod = _specimen(diameter, density) | {"length": quantity(length, "m", "length")}
    if accelerometer_mass is not None:
        rod["accelerometer_mass"] = quantity(accelerometer_mass, "kg", "accelerometer_mass")
    return _modulus(source, method, rod, options)


def three_point(
    source: Hits, *, gauges: Mapping[str, Number], diameter: Number, density: Number, **options: Unpack[Options]
) -> Modulus:
    """Returns the complex modulus from three equidistant gauges, in closed form (Ödeen 1993, paper B, eqs. 6-9).

    Parameters
    ----------
    source : Hits
        Accepted hits from :func:`rodlab.read`.
    gauges : mapping of str to float or str
        Position of the gauge of each of the three channels along the rod in m, in increasing order.
    diameter, density : float or str
        Diameter in m and density in kg/m³.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError, ReadError, NotAllowed
        As for :func:`two_point`.
    """
    method = Part("ThreePoint", (), (("gauges", _gauges(gauges)),))
    return _modulus(source, method, _specimen(diameter, density), options)


def multi_point(
    source: Hits,
    *,
    gauges: Mapping[str, Number],
    diameter: Number,
    density: Number,
    free_end_at: Number | None = None,
    wave_speed: Number | None = None,
    **options: Unpack[Options],
) -> Modulus:
    """Returns the complex modulus from three or more gauges at any positions, or from two gauges and a free end, by least squares
    (a generalisation of Ödeen 1993, paper B).

    One shot is enough: its errors follow from the quiet part before it. A record may end while the rod still rings.

    Parameters
    ----------
    source, gauges, diameter, density
        As for :func:`three_point`.
    free_end_at : float or str, optional
        Position of a free end in m, beyond the last gauge. With two gauges, the free end is the third condition; three or more gauges are
        checked against it.
    wave_speed : float or str, optional
        First guess in m/s; by default it is found by a search.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError, ReadError, NotAllowed
        As for :func:`two_point`.
    """
    fields = (
        ("gauges", _gauges(gauges)),
        ("wave_speed", None if wave_speed is None else quantity(wave_speed, "m/s", "wave_speed")),
        ("free_end_at", None if free_end_at is None else quantity(free_end_at, "m", "free_end_at")),
    )
    return _modulus(source, Part("MultiPoint", (), fields), _specimen(diameter, density), options)


def _channels(source: Hits | Part, count: int) -> Sequence[str]:
    if isinstance(source, Part):
        return [f"channel {number}" for number in range(1, count + 1)]
    if len(source.channels) < count:
        raise SheetError(f"the hits have {len(source.channels)} channels, expected {count}", field="channels")
    return source.channels[:count]


def _gauges(gauges: Mapping[str, Number]) -> list[dict[str, str]]:
    return [{"channel": name, "at": quantity(at, "m", f"gauges[{name!r}]")} for name, at in gauges.items()]


def _specimen(diameter: Number, density: Number) -> dict[str, str]:
    return {"diameter": quantity(diameter, "m", "diameter"), "density": quantity(density, "kg/m3", "density")}


def _modulus(source: Hits | Part, method: Part, specimen: Mapping[str, str], options: Options) -> Modulus:
    check_options(options, Options)
    stated: dict[str, Any] = {
        "title": options.get("title", "Complex modulus"),
        "specimen": specimen,
        "method": method,
        "source": source,
        "limits": options.get("limits"),
        "checks": options.get("checks"),
        "causal": options.get("causal"),
        "report_at": options.get("report_at"),
    }
    folder = Path(options.get("folder", "."))
    if isinstance(source, Hits):
        folder = source._folder
        silent = quantity(options["silent"], "s", "silent") if "silent" in options else None
        tail = Part(options["tail"]) if "tail" in options else None
        stated["source"] = Part("Hits", (), (("records", source._records), ("hits", source._hits), ("silent", silent), ("tail", tail)))
    if "band" in options:
        low, high = (quantity(edge, "Hz", "band") for edge in options["band"])
        stated["band"] = {"from": low, "to": high}
    if "poisson_ratio" in options:
        stated["lateral_inertia"] = {"poisson_ratio": quantity(options["poisson_ratio"], "", "poisson_ratio")}
    sheet = Part("Modulus", (), tuple(stated.items()))
    kept = source._kept if isinstance(source, Hits) else None
    return run_part(sheet, folder, progress=options.get("progress"), of=Modulus, kept=kept).require()
