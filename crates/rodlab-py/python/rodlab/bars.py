"""Long bars: propagation of waves in a bar, and the stress-strain curve of a specimen between two bars.

Every function gives the same results as ``rodlab bar`` or ``rodlab shpb`` for a sheet with the same statements, to the last digit.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import SheetError
from ._jobs import Progress, run_part
from ._records import Hits
from ._result import Result, Table
from ._sheet import Part, quantity
from .modulus import Modulus, Number
from .rheology import named_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Propagation", "StressStrain", "bar", "propagation", "stress_strain"]


class Propagation(Modulus):
    """Propagation of waves in a bar, and the modulus of its material. Arrays have the shape (n_lines,).

    The table ``propagation`` contains alpha, k and the phase velocity with their covariance. If laws were fitted,
    ``attachments["material.json"]`` is a material for later sheets.
    """

    @property
    def propagation(self) -> Table:
        """Damping coefficient, wave number and phase velocity of all lines, with the half widths of their 95 % bands."""
        return self.table("propagation")

    @property
    def damping_coefficient(self) -> NDArray[np.float64]:
        """Damping coefficient alpha in 1/m."""
        return self.propagation.numbers("damping_coefficient_per_m")

    @property
    def wave_number(self) -> NDArray[np.float64]:
        """Wave number k in rad/m."""
        return self.propagation.numbers("wave_number_rad_per_m")

    @property
    def phase_velocity(self) -> NDArray[np.float64]:
        """Phase velocity omega/k in m/s."""
        return self.propagation.numbers("phase_velocity_m_per_s")


class StressStrain(Result):
    """Stress-strain curve of a specimen. Arrays have the shape (n_times,); values are engineering values, positive in the sense of the loading.

    The table ``stress_strain`` also contains true values and the parts of the errors; ``faces`` the forces and velocities of both faces;
    ``waves`` the strain waves at the faces; ``budget`` the sources of the errors.
    """

    @property
    def curve(self) -> Table:
        """Table of the curve: for one shot against time, for several shots the mean curve against strain."""
        return self.tables.get("mean") or self.table("stress_strain")

    @property
    def strain(self) -> NDArray[np.float64]:
        """Engineering strain."""
        return self.curve.numbers("strain")

    @property
    def stress(self) -> NDArray[np.float64]:
        """Engineering stress in Pa."""
        return self._mean_or_own("{}stress_pa")

    @property
    def stress_half_width_95(self) -> NDArray[np.float64]:
        """Half the width of the 95 % band of the stress in Pa."""
        return self._mean_or_own("half_width_{}stress_95_pa")

    @property
    def strain_rate(self) -> NDArray[np.float64]:
        """Strain rate in 1/s."""
        return self._mean_or_own("{}strain_rate_per_s")

    def _mean_or_own(self, name: str) -> NDArray[np.float64]:
        return self.curve.numbers(name.format("mean_" if "mean" in self.tables else ""))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws stress against strain with its 95 % band; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(layout="constrained")
        stress, half = 1e-6 * self.stress, 1e-6 * self.stress_half_width_95
        (drawn,) = ax.plot(self.strain, stress)
        ax.fill_between(self.strain, stress - half, stress + half, alpha=0.3, color=drawn.get_color(), linewidth=0)
        ax.set_xlabel("strain")
        ax.set_ylabel("stress (MPa)")
        ax.set_title(self.title)
        return ax


def bar(
    *,
    diameter: Number,
    length: Number,
    gauges: Mapping[str, Number],
    material: str | None = None,
    density: Number | None = None,
    wave_speed: Number | None = None,
    poisson_ratio: Number | None = None,
    separation: str | None = None,
    averaged_with: Mapping[str, Sequence[str]] | None = None,
) -> Part:
    """Returns the description of one of the two bars for :func:`stress_strain`.

    Parameters
    ----------
    diameter, length : float or str
        Dimensions of the bar in m.
    gauges : mapping of str to float or str
        Distance in m from the specimen to the gauge of each channel, for one or two gauges.
    material : str, optional
        Name of one of the `materials` of :func:`stress_strain`.
    density, wave_speed : float or str, optional
        Density in kg/m³ and wave speed in m/s of an elastic bar, instead of a material.
    poisson_ratio : float or str, optional
        Poisson's ratio, for the dispersion by lateral inertia in the theory of Pochhammer and Chree; without it, the waves are one-dimensional.
    separation : str, optional
        ``Passages``, ``TwoGauges``, ``FreeEnd`` or ``Balanced``; by default ``Passages`` for one gauge and ``TwoGauges`` for two.
    averaged_with : mapping of str to list of str, optional
        Maps a channel to the channels of other gauges around the same section, with which it is averaged; bending cancels in the mean.

    Raises
    ------
    SheetError
        An argument is not a quantity, or material and wave speed are both stated or both missing.
    """
    if material is not None and density is None and wave_speed is None:
        waves = Part("Material", (material,))
    elif material is None and density is not None and wave_speed is not None:
        speed = (("density", quantity(density, "kg/m3", "density")), ("wave_speed", quantity(wave_speed, "m/s", "wave_speed")))
        waves = Part("Speed", (), speed)
    else:
        found = f"found material {material!r}, density {density!r} and wave_speed {wave_speed!r}"
        raise SheetError(f"{found}, expected `material`, or `density` and `wave_speed`", field="material")
    fields: tuple[tuple[str, Any], ...] = (
        ("waves", waves),
        ("diameter", quantity(diameter, "m", "diameter")),
        ("length", quantity(length, "m", "length")),
        ("poisson_ratio", None if poisson_ratio is None else quantity(poisson_ratio, "", "poisson_ratio")),
        ("gauges", [_gauge(name, at, "at", (averaged_with or {}).get(name)) for name, at in gauges.items()]),
        ("separation", None if separation is None else Part(separation)),
    )
    return Part("", (), fields)


def propagation(
    shots: Hits,
    *,
    length: Number,
    diameter: Number,
    density: Number,
    gauges: Mapping[str, Number],
    silent: Number,
    poisson_ratio: Number | None = None,
    wave_speed: Number | None = None,
    band: tuple[Number, Number] | None = None,
    limits: Mapping[str, str] | None = None,
    laws: Sequence[str] | None = None,
    report_at: Sequence[str] | None = None,
    title: str = "Waves of a bar",
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Propagation:
    """Returns the propagation of waves in a long bar from one or several shots: damping, wave number and phase velocity with their covariance.

    With one gauge, the result follows from a pulse and its reflection, which must not overlap. With two or more gauges, it follows by least squares, and
    the waves may overlap.

    Parameters
    ----------
    shots : Hits
        Hits from :func:`rodlab.read`; each record is a shot.
    length, diameter, density : float or str
        Dimensions of the bar in m, and its density in kg/m³.
    gauges : mapping of str to float or str
        Distance in m from the free end to the gauge of each channel, in the order in which the pulse passes the gauges.
    silent : float or str
        Time in s before the pulse, from which level and noise are estimated.
    poisson_ratio : float or str, optional
        Poisson's ratio, to correct the modulus for lateral inertia; ``0`` for simulated waves in one dimension.
    wave_speed : float or str, optional
        First guess in m/s; by default it is found by a search.
    band : tuple, optional
        Lowest and highest frequency in Hz.
    limits : mapping, optional
        Limits that a valid line must meet, such as ``{"storage_modulus": "1 %"}``.
    laws : list of str, optional
        Laws as in :func:`rodlab.rheology.fit`; the preferred law becomes the material.
    report_at : list of str, optional
        Frequencies at which the results are also given as quantities.
    out : path, optional
        Folder that receives the files of the command, among them ``material.json``.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The shots do not allow a result.
    """
    fields: dict[str, Any] = {
        "title": title,
        "bar": {
            "length": quantity(length, "m", "length"),
            "diameter": quantity(diameter, "m", "diameter"),
            "density": quantity(density, "kg/m3", "density"),
            "poisson_ratio": None if poisson_ratio is None else quantity(poisson_ratio, "", "poisson_ratio"),
        },
        "gauges": [_gauge(name, at, "from_free_end") for name, at in gauges.items()],
        "records": shots._records,
        "silent": quantity(silent, "s", "silent"),
        "wave_speed": None if wave_speed is None else quantity(wave_speed, "m/s", "wave_speed"),
        "limits": limits,
        "laws": None if laws is None else {"laws": [named_law(law) for law in laws]},
        "report_at": report_at,
    }
    if band is not None:
        low, high = (quantity(edge, "Hz", "band") for edge in band)
        fields["band"] = {"from": low, "to": high}
    sheet = Part("Bar", (), tuple(fields.items()))
    return run_part(sheet, shots._folder, of=Propagation, out=out, progress=progress, kept=shots._kept).require()


def stress_strain(
    shots: Hits | Sequence[Hits],
    *,
    incident: Part,
    transmitted: Part,
    specimen_length: Number,
    specimen_diameter: Number,
    silent: Number,
    specimen_wall: Number | None = None,
    loading: str = "Compression",
    materials: Mapping[str, Mapping[str, Any]] | None = None,
    stress_from: str | None = None,
    band: Number | None = None,
    align_arrivals: bool = False,
    monte_carlo: int | None = None,
    title: str = "Split Hopkinson bars",
    folder: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> StressStrain:
    """Returns the stress-strain curve of a specimen between split Hopkinson bars, with its 95 % band (Zhao and Gary 1996; Bacon 1998).

    The waves at the faces of the specimen are computed from those at the gauges by the law of the bars, which may be elastic or viscoelastic.

    Parameters
    ----------
    shots : Hits or list of Hits
        Strains of a shot, from :func:`rodlab.read`. For several shots with the same bars, the result is the mean curve.
    incident, transmitted : Part
        The two bars, from :func:`bar`.
    specimen_length, specimen_diameter, specimen_wall : float or str
        Dimensions in m; the wall is that of a tube in torsion.
    silent : float or str
        Time in s before any pulse, from which level and noise are estimated.
    loading : str
        ``Compression``, ``Tension`` or ``Torsion``.
    materials : mapping
        Maps the name of each material to ``{"density": "1150 kg/m3", "law": sheet.Prony(...)}``, or to
        ``{"law": sheet.Result("bar/material.json")}``, a file written by :func:`propagation`.
    stress_from : str, optional
        ``Both`` (default), ``Incident`` or ``Transmitted``.
    band : float or str, optional
        Upper end of the frequency band in Hz; by default it is chosen for the bars.
    align_arrivals : bool
        True to subtract the lag between the arrivals at both faces, instead of relying on positions and wave speeds.
    monte_carlo : int, optional
        Number of random draws in which noise and all other sources of error vary together, as a check of the linear errors.
    folder : path, optional
        Folder to which the relative paths of materials refer; by default that of the shots.
    out : path, optional
        Folder that receives the files of the command.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The shots do not allow a curve.
    """
    all_shots = [shots] if isinstance(shots, Hits) else list(shots)
    if not all_shots:
        raise SheetError("shots is empty, expected the hits of one shot or more", field="shots")
    start = all_shots[0]._folder if folder is None else Path(folder)
    records = [_records_from(shot, start) for shot in all_shots]
    wall = None if specimen_wall is None else quantity(specimen_wall, "m", "specimen_wall")
    fields: dict[str, Any] = {
        "title": title,
        "loading": Part(loading),
        "materials": materials or {},
        "bars": {"incident": incident, "transmitted": transmitted},
        "specimen": {
            "length": quantity(specimen_length, "m", "specimen_length"),
            "diameter": quantity(specimen_diameter, "m", "specimen_diameter"),
            "wall": wall,
        },
        "records": [records[0]],
        "further_shots": [{"records": [more]} for more in records[1:]],
        "silent": quantity(silent, "s", "silent"),
        "stress_from": None if stress_from is None else Part(stress_from),
        "band": None if band is None else quantity(band, "Hz", "band"),
        "align_arrivals": align_arrivals,
        "monte_carlo": monte_carlo,
    }
    sheet = Part("Shpb", (), tuple(fields.items()))
    return run_part(sheet, start, of=StressStrain, out=out, progress=progress).require()


def _gauge(channel: str, at: Number, place: str, averaged_with: Sequence[str] | None = None) -> dict[str, Any]:
    more = {} if averaged_with is None else {"averaged_with": list(averaged_with)}
    return {"channel": channel, place: quantity(at, "m", f"gauges[{channel!r}]")} | more


def _records_from(shot: Hits, start: Path) -> dict[str, Any]:
    """Returns the records of `shot`, with paths relative to `start`."""
    if shot._folder == start:
        return shot._records

    def moved(stated: dict[str, Any]) -> dict[str, Any]:
        files = stated.get("files")
        if files is None:
            return stated
        return stated | {"files": [os.fspath(shot._folder.resolve() / file) for file in files]}

    return moved(shot._records) | {"channels": [moved(channel) for channel in shot._records["channels"]]}
