"""From recordings of struck rods to a complex modulus, a constitutive law or an impact force, with their errors.

Arrays are float64 or complex128, quantities are numbers in SI or texts with a unit and a standard uncertainty, as ``"799 mm ± 0.3 mm"``.
Results have one of three standings: ``answered``, ``in doubt`` and ``not allowed``.
"""

from . import force, frf, modulus, rheology, rods, sheet
from ._campaign import Campaign, campaign, map
from ._errors import Error, NotAllowed, ReadError, SheetError, WriteError
from ._jobs import check, convert, init, inspect, run
from ._made import identify, simulate
from ._records import Hit, Hits, of_arrays, read
from ._result import Quantity, Result, Table

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
    "campaign",
    "check",
    "convert",
    "force",
    "frf",
    "identify",
    "init",
    "inspect",
    "map",
    "modulus",
    "of_arrays",
    "read",
    "rheology",
    "rods",
    "run",
    "sheet",
    "simulate",
]
