"""Test sheets as Python values, and their text."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._errors import Error, SheetError

# Fields of sheets that contain a map with names chosen by the user. All other mappings contain fields with fixed names.
_MAPS = frozenset({"materials", "full_scales", "noise_of"})


@dataclass(frozen=True)
class Part:
    """Named part of a sheet, such as ``sheet.Cone(material="nylon", ...)``, with the fields that the part has in a file."""

    name: str
    values: tuple[Any, ...] = ()
    fields: tuple[tuple[str, Any], ...] = ()


def check_options(options: Mapping[str, Any], known: type) -> None:
    """Rejects an option that the typed dictionary `known` does not contain."""
    for name in options:
        if name not in known.__annotations__:
            near = difflib.get_close_matches(name, known.__annotations__, 1)
            meant = f"; did you mean {near[0]!r}?" if near else f", expected one of {', '.join(known.__annotations__)}"
            raise TypeError(f"got an unexpected keyword argument {name!r}{meant}")


def quantity(value: object, unit: str, argument: str) -> str:
    """Returns a quantity as text: a text is unchanged, a number gets the SI unit `unit` ("" for a pure number)."""
    return value if isinstance(value, str) else f"{number(value, unit, argument)!r} {unit}".strip()


def number(value: object, unit: str, argument: str) -> float:
    """Returns a finite number in the unit `unit`."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        expected = f'a number in {unit}, or a text such as "1.5 {unit}"' if unit else 'a number, or a text such as "0.4 ± 0.02"'
        raise SheetError(f"{argument} is {value!r}, expected {expected}", field=argument)
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise SheetError(f"{argument} is {found}, expected a finite number", field=argument)
    return found


def text_of(value: object) -> str:
    """Returns a sheet, or a part of a sheet, as RON text. Fields that are None are omitted."""
    return _text(value, "")


def _text(value: object, field: str) -> str:
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        if not math.isfinite(value):
            raise SheetError(f"{field} is {value}, expected a finite number", field=field)
        return repr(float(value))
    if isinstance(value, Part):
        if value.fields:
            return f"{value.name}({_fields(value.fields)})"
        if value.values:
            return f"{value.name}({', '.join(_text(one, field) for one in value.values)})"
        return value.name
    if isinstance(value, Mapping):
        if field in _MAPS:
            pairs = (f"{_quoted(str(key))}: {_text(one, str(key))}" for key, one in value.items())
            return "{" + ", ".join(pairs) + "}"
        return f"({_fields(tuple(value.items()))})"
    if isinstance(value, tuple):
        return f"({', '.join(_text(one, field) for one in value)})"
    if isinstance(value, Sequence):
        return f"[{', '.join(_text(one, field) for one in value)}]"
    raise Error(f"{field or 'the sheet'} is of the type {type(value).__name__}, expected texts, numbers, lists, mappings or parts")


def _fields(fields: Sequence[tuple[Any, Any]]) -> str:
    for name, _ in fields:
        if not isinstance(name, str) or not name.isidentifier():
            raise SheetError(f"found the field {name!r}, expected a name of letters, digits and _")
    stated = ((name, value) for name, value in fields if value is not None)
    return ", ".join(f"{name}: {_text(value, name)}" for name, value in stated)


def _quoted(text: str) -> str:
    plain = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}
    letters = (plain.get(c) or (c if c.isprintable() or ord(c) >= 0xA0 else f"\\u{{{ord(c):x}}}") for c in text)
    return '"' + "".join(letters) + '"'
