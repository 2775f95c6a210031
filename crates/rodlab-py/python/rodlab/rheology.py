"""Rheological laws fitted to a complex modulus, and cards of them for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ._errors import Error
from ._jobs import Progress, run_part
from ._result import Quantity
from ._sheet import Part, quantity
from .modulus import Modulus, Number

__all__ = ["Fit", "fit"]

_PROGRAMS = {"abaqus": "Abaqus", "ansys": "Ansys", "ls-dyna": "LsDyna"}


class Fit(Modulus):
    """Laws fitted to the valid lines of a modulus, which it is as well. The table ``laws`` compares them."""

    def parameters(self, law: str) -> dict[str, Quantity]:
        """The parameters of a fitted law by their names, with standard errors and verdicts.

        Raises
        ------
        Error
            The law was not fitted.
        """
        wanted = _law(law).lower()
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
        """The text of a material card of the Prony series, ``generalised maxwell``, which must be among the fitted laws.

        Parameters
        ----------
        program : str
            ``abaqus``, ``ansys`` or ``ls-dyna``.
        name : str
            Name of the material: a letter followed by letters, digits, ``-`` or ``_``.
        poisson_ratio : float or str
            As ``"0.40 ± 0.02"``.
        poisson_ratio_at : float or str, optional
            Frequency in Hz at which that is the ratio; the middle of the fitted lines by default.
        temperature : str, optional
            As ``"23 degC"``: a comment of the card.

        Raises
        ------
        Error
            There is no such program, or the series determines no card.
        """
        if program not in _PROGRAMS:
            raise Error(f"program is `{program}`, expected one of {', '.join(f'`{known}`' for known in _PROGRAMS)}")
        cards = {
            "name": name,
            "poisson_ratio": quantity(poisson_ratio, "", "poisson_ratio"),
            "poisson_ratio_at": None if poisson_ratio_at is None else quantity(poisson_ratio_at, "Hz", "poisson_ratio_at"),
            "temperature": temperature,
            "programs": [Part(_PROGRAMS[program])],
        }
        done = _with_laws(self, {"cards": cards}, progress)
        made = [text for file, text in done.attachments.items() if file not in self.attachments]
        if not made:
            raise Error("; ".join(done.warnings) or "no card was made, expected `generalised maxwell` among the laws")
        return made[0].decode()


def fit(
    modulus: Modulus,
    laws: str | Sequence[str],
    *,
    criterion: str = "Bic",
    confidence: Number = "95 %",
    most_lines: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fits laws to the valid lines of a modulus and compares them, as ``laws`` of a sheet for ``rodlab modulus`` does.

    Parameters
    ----------
    modulus : Modulus
        Of :mod:`rodlab.modulus`. Its files are read again.
    laws : str or list of str
        ``elastic``, ``constant q``, ``spring-pot``, ``kelvin-voigt``, ``maxwell``, ``zener``, ``fractional maxwell``, ``fractional zener``,
        ``havriliak-negami``, ``generalised maxwell`` (as many branches as the criterion wants), ``power law`` (Ödeen 1993, paper E, eq. 7).
    criterion : str
        ``Bic`` or ``Aicc``.
    confidence : float or str
        Confidence of the intervals.
    most_lines : int, optional
        Lines that are fitted at most, evenly chosen among the valid ones; 400 by default.

    Raises
    ------
    SheetError
        There is no such law.
    NotAllowed
        The data allow no modulus.
    """
    names = [laws] if isinstance(laws, str) else list(laws)
    stated = {
        "laws": [Part(_law(name)) for name in names],
        "criterion": Part(criterion),
        "confidence": quantity(confidence, "", "confidence"),
        "most_lines": most_lines,
    }
    return _with_laws(modulus, stated, progress)


def _with_laws(modulus: Modulus, more: Mapping[str, Any], progress: Progress | None) -> Fit:
    """The sheet of `modulus` done again, with `more` in its laws."""
    if modulus._sheet is None:
        raise Error("the modulus is the result of a file, expected one of rodlab.modulus: add `laws` to the sheet instead")
    fields = dict(modulus._sheet.fields)
    fields["laws"] = dict(fields.get("laws", {})) | dict(more)
    sheet = Part("Modulus", (), tuple(fields.items()))
    return run_part(sheet, modulus._folder or Path("."), of=Fit, progress=progress).require()


def _law(name: str) -> str:
    """The name of a law in a sheet: ``fractional zener`` is ``FractionalZener`` there."""
    words = name.replace("-", " ").split()
    return "".join(word[:1].upper() + word[1:] for word in words)


def _plain(name: str) -> str:
    return name.replace("-", "").replace(" ", "").lower()
