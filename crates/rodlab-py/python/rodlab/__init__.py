"""Complex moduli, constitutive laws and impact forces from recordings of struck rods, with their errors.

Arrays are float64 or complex128. Quantities are numbers in SI, or texts with a unit and a standard uncertainty, such as
``"799 mm ± 0.3 mm"``. A result has one of three standings: ``answered``, ``in doubt`` or ``not allowed``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._campaign import Campaign, campaign, map
from ._errors import Error, NotAllowed, ReadError, SheetError, WriteError
from ._jobs import check, convert, init, inspect, run
from ._made import identify, recovery, simulate
from ._records import Hit, Hits, of_arrays, read
from ._result import Quantity, Result, Table
from ._sep005 import of_sep005, to_sep005

__all__ = [
    "Campaign",
    "Error",
    "Hit",
    "Hits",
    "NotAllowed",
    "Quantity",
    "ReadError",
    "Result",
    "SheetError",
    "Table",
    "WriteError",
    "bars",
    "campaign",
    "check",
    "convert",
    "force",
    "frf",
    "identify",
    "init",
    "inspect",
    "map",
    "mobility",
    "modulus",
    "of_arrays",
    "of_sep005",
    "read",
    "recovery",
    "rheology",
    "rods",
    "run",
    "sheet",
    "simulate",
    "to_sep005",
]

if TYPE_CHECKING:
    from . import bars, force, frf, mobility, modulus, rheology, rods, sheet
else:  # imports on first use shorten the import by two fifths; a type checker that saw `__getattr__` would accept any name

    def __getattr__(name: str) -> Any:
        if name.startswith("_") or name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        return import_module(f".{name}", __name__)

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
