"""Exceptions of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._result import Result


class Error(ValueError):
    """Raised if a request cannot be met. The message states what was found, where, and what was expected."""


class SheetError(Error):
    """Raised for mistakes in a test sheet, or in arguments that replace a sheet. The attributes describe the first mistake.

    Attributes
    ----------
    line, column : int or None
        Place of the mistake in the file of the sheet, counted from 1; None for arguments, and for statements that contradict each other.
    field : str or None
        Field with the mistake, such as ``Modulus.specimen.length``.
    help : str or None
        Suggestion, such as the nearest known name.
    others : tuple of str
        The other mistakes, each with its place.
    """

    def __init__(
        self,
        message: str,
        line: int | None = None,
        column: int | None = None,
        field: str | None = None,
        help: str | None = None,
        others: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message, line, column, field, help, others)
        self.message = message
        self.line = line
        self.column = column
        self.field = field
        self.help = help
        self.others = tuple(others)

    def __str__(self) -> str:
        first = self.message if self.help is None else f"{self.message}; {self.help}"
        return "\n".join((first, *self.others))


class ReadError(OSError):
    """Raised if a file is missing, cannot be read or is not a recording."""


class WriteError(OSError):
    """Raised if a file or folder cannot be written, or would replace something other than an earlier result."""


class NotAllowed(Error):
    """Raised if the data do not allow the result.

    Attributes
    ----------
    outcome : Result
        The result, with the reasons, the log of hits and lines, and the tables that exist.
    """

    def __init__(self, outcome: Result) -> None:
        super().__init__(outcome)
        self.outcome = outcome

    def __str__(self) -> str:
        return self.outcome.headline
