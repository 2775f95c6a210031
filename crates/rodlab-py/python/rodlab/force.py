"""Force between two bodies that meet (Ödeen 1993, paper E)."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._jobs import Progress, run_part
from ._result import Result
from ._sheet import Part, quantity
from .modulus import Number

__all__ = ["Force", "predict"]


class Force(Result):
    """Force over time. Arrays have the shape (n_times,); the force is positive in compression.

    The table ``force`` contains the force by time marching, ``force_in_band`` the force in the frequency band with its error, and ``contacts`` the
    times at which the faces meet and separate.
    """

    @property
    def time(self) -> NDArray[np.float64]:
        """Times in s of the force in the band."""
        return self.table("force_in_band").numbers("time_s")

    @property
    def force(self) -> NDArray[np.float64]:
        """Force in the band in N."""
        return self.table("force_in_band").numbers("force_in_band_n")

    @property
    def standard_error(self) -> NDArray[np.float64] | None:
        """Standard error of the force in the band in N; None if no uncertainty was stated with ±."""
        name = "standard_error_force_n"
        table = self.table("force_in_band")
        return table.numbers(name) if name in table.units else None

    def plot(self, ax: Any = None) -> Any:
        """Draws the force in the frequency band, with its band of two standard errors; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(layout="constrained")
        (drawn,) = ax.plot(self.time, self.force)
        if (error := self.standard_error) is not None:
            low, high = self.force - 2 * error, self.force + 2 * error
            ax.fill_between(self.time, low, high, alpha=0.3, color=drawn.get_color(), linewidth=0)
        ax.set_xlabel("time (s)")
        ax.set_ylabel("force (N)")
        ax.set_title(self.title)
        return ax


def predict(
    first: Part,
    second: Part,
    *,
    velocity: Number,
    duration: Number,
    materials: Mapping[str, Mapping[str, Any]] | None = None,
    band: Number | None = None,
    contact: Part | None = None,
    title: str = "Force between two bodies",
    folder: str | os.PathLike[str] = ".",
    progress: Progress | None = None,
    **fields: Any,
) -> Force:
    """Returns the force between two bodies that meet, as ``rodlab force`` does (Ödeen 1993, paper E, eqs. 2-3).

    Parameters
    ----------
    first, second : Part
        Moving body and body at rest, such as ``sheet.LongRod(material="steel", diameter="10 mm")`` or
        ``sheet.Chain(elements=[sheet.Cone(...)])``; :meth:`rodlab.mobility.Mobility.body` returns a measured body. If the
        ``front_impedance`` of a measured body is not stated, there is no time marching and no table ``force_in_band``; the table ``force`` then
        ends with the first contact.
    velocity : float or str
        Relative velocity before the bodies meet, in m/s.
    duration : float or str
        Duration of the computed force, in s.
    materials : mapping
        Maps the name of each material to ``{"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")}``.
    band : float or str, optional
        Upper end of the frequency band in which the force is stated, in Hz; 10 kHz by default.
    contact : Part, optional
        Law of the contact, such as ``sheet.Linear("20 MN/m")``; rigid faces by default.
    folder : path
        Folder to which the relative paths of measured bodies refer.
    **fields
        Any other field of ``Impact`` in a sheet.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The bodies do not allow a force.
    """
    stated: dict[str, Any] = {
        "first": first,
        "second": second,
        "velocity": quantity(velocity, "m/s", "velocity"),
        "duration": quantity(duration, "s", "duration"),
        "band": None if band is None else quantity(band, "Hz", "band"),
        "contact": contact,
    }
    problem = Part("Impact", (), tuple((stated | fields).items()))
    sheet = Part("Force", (), (("title", title), ("materials", materials or {}), ("problem", problem)))
    return run_part(sheet, Path(folder), of=Force, progress=progress).require()
