"""Mobility of an impact face, measured or computed (Ödeen 1993, paper E, section 3.1).

Every function gives the same results as ``rodlab mobility`` for a sheet with the same statements, to the last digit.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from ._errors import Error, SheetError
from ._jobs import Progress, run_part
from ._records import Hits
from ._result import Result, Table
from ._sheet import Part, check_options, quantity
from .modulus import Number

__all__ = ["Mobility", "Options", "of_body", "of_file", "of_hits", "of_two_hammers"]


class Options(TypedDict, total=False):
    """Options for every source; the defaults are those of a sheet."""

    title: str
    head_mass: Number
    """Mass in kg between the force gauge of an impedance head and the face."""
    up_to: Number
    """Upper frequency in Hz of the lines used; all lines by default."""
    support: Part
    """``sheet.Free(mass="1.504 kg ± 1 gram")``, ``sheet.Fixed()`` or ``sheet.LongRod(impedance="392 kg/s")``."""
    complete: tuple[Number, Number]
    """Two frequencies in Hz: lines below the first are computed from the weighed mass; the model is fitted to the lines up to the second."""
    front_impedance: Number
    """Characteristic impedance in kg/s of the body at its face; required for a force by time marching."""
    progress: Progress


class Mobility(Result):
    """Mobility v/F as a function of frequency. Arrays have the shape (n_lines,) and start at 0 Hz; time factor exp(+iωt)."""

    @property
    def lines(self) -> Table:
        """Table of all lines: mobility, errors, coherence, validity."""
        return self.table("mobility")

    @property
    def frequency_hz(self) -> NDArray[np.float64]:
        """Frequencies in Hz."""
        return self.lines.numbers("frequency_hz")

    @property
    def mobility(self) -> NDArray[np.complex128]:
        """Mobility in m/(N s); NaN on lines at which it is not determined."""
        of = self.lines.numbers
        return np.asarray(of("real_part_m_per_n_s") + 1j * of("imaginary_part_m_per_n_s"), dtype=np.complex128)

    @property
    def standard_error(self) -> NDArray[np.float64] | None:
        """Standard error √(E|δY|²) of the complex mobility Y in m/(N s), from the scatter of the hits; None if the scatter is not known."""
        name = "standard_error_m_per_n_s"
        return self.lines.numbers(name) if name in self.lines.units else None

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Validity of each line."""
        return np.asarray(self.lines.columns()["valid"], dtype=np.bool_)

    def body(self, file: str | os.PathLike[str], **fields: Any) -> Part:
        """Writes the mobility to a new universal file `file`, and returns the measured body for :func:`rodlab.force.predict`.

        Parameters
        ----------
        file : path
            Path such as ``"hammer.uff"``. An existing file is not replaced.
        **fields
            Fields of ``Measured`` in a sheet, such as ``support=sheet.Free(mass="1.5 kg ± 1 gram")`` and ``front_impedance="3.2e3 kg/s"``.

        Raises
        ------
        FileExistsError
            The file exists.
        """
        path = Path(file).resolve()
        with path.open("xb") as new:
            new.write(self.attachments["mobility.uff"])
        return Part("Measured", (), (("file", str(path)), *fields.items()))


def of_hits(
    hits: Hits,
    *,
    force: str | None = None,
    response: str | None = None,
    estimator: str | None = None,
    silent: Number | None = None,
    source: Mapping[str, Any] | None = None,
    **options: Unpack[Options],
) -> Mobility:
    """Returns the mobility from hits with a hammer.

    Parameters
    ----------
    hits : Hits
        Hits from :func:`rodlab.read`.
    force, response : str, optional
        Channels of the force and of the motion of the face; by default the first and the second.
    estimator : str, optional
        ``H1`` (default), ``H2``, ``Hv`` or ``Hs``.
    silent : float or str, optional
        Time in s before a hit in which the channels are at rest.
    source : mapping, optional
        Other fields of ``Hits`` in a sheet, such as ``{"exponential_window": "1 %"}``.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The hits do not allow a mobility.
    """
    fields = _hits(hits, force, response, estimator, silent, source)
    return _mobility(Part("Hits", (), fields), hits._folder, options)


def of_two_hammers(
    low: Hits,
    high: Hits,
    *,
    force: str | None = None,
    response: str | None = None,
    estimator: str | None = None,
    silent: Number | None = None,
    merge: str | None = None,
    source: Mapping[str, Any] | None = None,
    **options: Unpack[Options],
) -> Mobility:
    """Returns the mobility from two tests of the same face, merged line by line.

    Parameters
    ----------
    low, high : Hits
        Hits of the heavy and of the light hammer, read with the same `folder`.
    merge : str, optional
        ``InverseVariance`` (default) or ``LargerInput``.
    force, response, estimator, silent, source, **options
        As for :func:`of_hits`, for both tests.

    Raises
    ------
    SheetError, ReadError, NotAllowed
        As for :func:`of_hits`.
    """
    if low._folder != high._folder:
        found = f"the folders of low and high are `{low._folder}` and `{high._folder}`"
        raise Error(f"{found}, expected one: read both with the same `folder`")
    tests = ((name, dict(_hits(one, force, response, estimator, silent, source))) for name, one in (("low", low), ("high", high)))
    merged = ("merge", None if merge is None else Part(merge))
    return _mobility(Part("TwoHammers", (), (*tests, merged)), low._folder, options)


def of_file(
    file: str | os.PathLike[str],
    *,
    kind: str | None = None,
    data_set: int | str | None = None,
    source: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] = ".",
    **options: Unpack[Options],
) -> Mobility:
    """Returns the mobility from an averaged frequency response in a file.

    Parameters
    ----------
    file : path
        Universal file, or any format with lines on a frequency axis.
    kind : str, optional
        ``Mobility``, ``Accelerance``, ...; by default the kind that follows from the unit in the file.
    data_set : int or str, optional
        Data set, by its number (from 1) or its name; by default the only complex data set.
    source : mapping, optional
        Other fields of ``File`` in a sheet, such as ``{"coherence": 3, "averages": 8}``.
    folder : path
        Folder to which a relative path refers.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError, ReadError, NotAllowed
        As for :func:`of_hits`.
    """
    fields = {"file": os.fspath(file), "kind": None if kind is None else Part(kind), "data_set": data_set}
    return _mobility(Part("File", (), tuple((fields | dict(source or {})).items())), Path(folder), options)


def of_body(
    body: Part,
    *,
    highest: Number,
    lines: int,
    materials: Mapping[str, Mapping[str, Any]] | None = None,
    **options: Unpack[Options],
) -> Mobility:
    """Returns the mobility of a computed body on equidistant lines, with the same checks as a measured mobility.

    :func:`rodlab.rods.mobility` gives only the values, at any frequencies.

    Parameters
    ----------
    body : Part
        Body such as ``sheet.Chain(elements=[sheet.Cone(...)])``.
    highest : float or str
        Highest frequency in Hz.
    lines : int
        Number of lines above 0 Hz.
    materials : mapping
        Materials by name.
    **options
        See :class:`Options`.

    Raises
    ------
    SheetError
        An argument is wrong.
    """
    fields = (("body", body), ("up_to", quantity(highest, "Hz", "highest")), ("lines", lines))
    return _mobility(Part("Computed", (), fields), Path("."), options, materials)


def _hits(
    hits: Hits,
    force: str | None,
    response: str | None,
    estimator: str | None,
    silent: Number | None,
    source: Mapping[str, Any] | None,
) -> tuple[tuple[str, Any], ...]:
    if len(hits.channels) < 2:
        raise SheetError(f"the hits have {len(hits.channels)} channels, expected a force and a motion", field="channels")
    fields: dict[str, Any] = {
        "records": hits._records,
        "hits": hits._hits,
        "force": hits.channels[0] if force is None else force,
        "response": hits.channels[1] if response is None else response,
        "estimator": None if estimator is None else Part(estimator),
        "silent": None if silent is None else quantity(silent, "s", "silent"),
    }
    return tuple((fields | dict(source or {})).items())


def _mobility(
    source: Part, folder: Path, options: Options, materials: Mapping[str, Mapping[str, Any]] | None = None
) -> Mobility:
    check_options(options, Options)
    stated: dict[str, Any] = {
        "title": options.get("title", "Mobility"),
        "materials": materials or {},
        "source": source,
        "support": options.get("support"),
    }
    if "complete" in options:
        below, to = (quantity(edge, "Hz", "complete") for edge in options["complete"])
        stated["complete"] = {"below": below, "fitted_to": to}
    if "head_mass" in options:
        stated["head_mass"] = quantity(options["head_mass"], "kg", "head_mass")
    if "up_to" in options:
        stated["up_to"] = quantity(options["up_to"], "Hz", "up_to")
    if "front_impedance" in options:
        stated["front_impedance"] = quantity(options["front_impedance"], "kg/s", "front_impedance")
    sheet = Part("Mobility", (), tuple(stated.items()))
    return run_part(sheet, folder, of=Mobility, progress=options.get("progress")).require()
