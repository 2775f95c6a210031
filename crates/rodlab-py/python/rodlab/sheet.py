"""Parts of test sheets by their names, for sheets that are written in Python.

Every capitalised name is a part: ``sheet.Cone(material="nylon", near="75 mm", far="30 mm", length="400 mm")`` is
``Cone(material: "nylon", near: "75 mm", far: "30 mm", length: "400 mm")`` in a file. A mapping becomes a list of fields, and a list
remains a list. The commented sheets of :func:`rodlab.init` show the parts and their fields; an unknown name is rejected when the sheet is
run, with the nearest known name as a suggestion. :func:`rodlab.run` takes a sheet: ``rodlab.run(sheet.Force(title="...", ...))``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._sheet import Part, text_of

__all__ = ["Part", "text_of"]


def __getattr__(name: str) -> Callable[..., Part]:
    if not (name.isidentifier() and name[0].isupper()):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}, expected the name of a part, such as `Cone`")

    def part(*values: Any, **fields: Any) -> Part:
        return Part(name, values, tuple(fields.items()))

    return part
