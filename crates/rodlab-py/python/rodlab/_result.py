"""Results of jobs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np
from numpy.typing import NDArray

from ._errors import Error, NotAllowed

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory

    import pandas
    import xarray

    from ._rodlab import Outcome
    from ._sheet import Part

Column = NDArray[np.float64] | NDArray[np.str_] | NDArray[np.bool_]


@dataclass(frozen=True)
class Quantity:
    """Scalar result: name, unit ("" for a pure number), value and standard error in that unit (None if there is none), its validity,
    and a verdict with the reason."""

    name: str
    unit: str
    value: float | None
    standard_error: float | None
    valid: bool
    verdict: str


@dataclass(frozen=True, eq=False)
class Table:
    """Table with columns of equal length, as in the file of the same name. Numbers are float64; a missing number is NaN.

    The name of a column ends with its unit, such as ``storage_modulus_pa``; a table of lines also has the columns ``valid`` and ``reasons``.

    Attributes
    ----------
    name, title : str
        Name of the file without extension; heading of the table.
    units : mapping of str to str
        Unit of each column, without a prefix; "" for pure numbers and texts.
    words : mapping of str to str
        Name of each column in reports and figures.
    """

    name: str
    title: str
    units: Mapping[str, str]
    words: Mapping[str, str]
    _columns: Mapping[str, Column] = field(repr=False)

    def columns(self) -> dict[str, Column]:
        """Returns the columns by their names: read-only arrays of shape (n_rows,)."""
        return dict(self._columns)

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Returns the column `name` as numbers.

        Raises
        ------
        Error
            There is no such column, or it contains texts.
        """
        column = self._columns.get(name)
        if column is None:
            raise Error(f"the table `{self.name}` has no column `{name}`, only {', '.join(f'`{n}`' for n in self._columns)}")
        if column.dtype.kind != "f":
            raise Error(f"the column `{name}` of the table `{self.name}` has no numbers")
        return cast(NDArray[np.float64], column)

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a data frame; its `attrs` have `units` (by column) and `title`."""
        import pandas

        frame = pandas.DataFrame({name: np.array(column) for name, column in self._columns.items()})
        frame.attrs.update(units=dict(self.units), title=self.title)
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """Returns a data set over the first column; the `attrs` of each variable have its `units`."""
        import xarray

        first = next(iter(self._columns))
        one = {name: (first, np.array(column), {"units": self.units[name]}) for name, column in self._columns.items()}
        return xarray.Dataset({n: v for n, v in one.items() if n != first}, {first: one[first]}, {"title": self.title})

    def __getstate__(self) -> dict[str, Any]:
        plain = {"units": dict(self.units), "words": dict(self.words), "_columns": dict(self._columns)}
        return self.__dict__ | plain

    def __setstate__(self, state: dict[str, Any]) -> None:
        for column in state["_columns"].values():
            column.flags.writeable = False
        self.__dict__.update(state | {name: MappingProxyType(state[name]) for name in ("units", "words", "_columns")})


@dataclass(frozen=True, eq=False)
class Result:
    """Result of the job of one sheet, with the contents of the report and of the file `result.json` of the command.

    Attributes
    ----------
    job, title : str
    standing : str
        ``answered``, ``in doubt`` (a check fails) or ``not allowed`` (the data do not allow a result).
    reasons : tuple of str
        Reasons why the result is in doubt or not allowed.
    summary, warnings : tuple of str
        Results as sentences; facts to be considered before the result is used.
    quantities : tuple of Quantity
    tables : mapping of str to Table
    settings, log, inputs : tuple of dict
        All settings of the job; decisions on hits and lines with their reasons; the files that were read, with their SHA-256.
    attachments : mapping of str to bytes
        Files for other programs, such as cards and universal files, by name.
    files : tuple of Path
        The files that were written; `result.json` is the last.
    """

    job: str
    title: str
    standing: str
    reasons: tuple[str, ...]
    summary: tuple[str, ...]
    warnings: tuple[str, ...]
    quantities: tuple[Quantity, ...]
    tables: Mapping[str, Table] = field(repr=False)
    settings: tuple[dict[str, Any], ...] = field(repr=False)
    log: tuple[dict[str, Any], ...] = field(repr=False)
    inputs: tuple[dict[str, Any], ...] = field(repr=False)
    attachments: Mapping[str, bytes] = field(repr=False)
    files: tuple[Path, ...] = field(repr=False)
    _report: Outcome | str = field(repr=False)
    _sheet: Part | None = field(repr=False, default=None)
    _folder: Path | None = field(repr=False, default=None)
    _kept: TemporaryDirectory[str] | None = field(repr=False, default=None)

    @classmethod
    def _of(
        cls, outcome: Outcome, sheet: Part | None = None, folder: Path | None = None, kept: TemporaryDirectory[str] | None = None
    ) -> Self:
        """Returns the result of an `outcome`. If the sheet was built from arguments, `sheet` is this sheet and `folder` the folder to which its paths
        refer; `kept` is this folder if it must be deleted together with the result."""
        told = json.loads(outcome.json)
        verdict = told["verdict"]
        return cls(
            job=told["job"],
            title=told["title"],
            standing=verdict["answer"],
            reasons=tuple(verdict.get("reasons", ())),
            summary=tuple(told["summary"]),
            warnings=tuple(told["warnings"]),
            quantities=tuple(Quantity(**quantity) for quantity in told["quantities"]),
            tables=MappingProxyType({name: _table(name, title, columns) for name, title, columns in outcome.tables()}),
            settings=tuple(told["settings"]),
            log=tuple(told["log"]),
            inputs=tuple(told["inputs"]),
            attachments=MappingProxyType(dict(outcome.attachments())),
            files=tuple(outcome.files),
            _report=outcome,
            _sheet=sheet,
            _folder=folder,
            _kept=kept,
        )

    @property
    def verdict(self) -> str:
        """Standing with its reasons, as one line."""
        return f"{self.standing}: {self.headline}"

    @property
    def headline(self) -> str:
        """Reasons why the result is in doubt or not allowed; otherwise the first sentence of the summary."""
        if self.standing == "answered":
            return next(iter(self.summary), "")
        return "; ".join(self.reasons)

    @property
    def folder(self) -> Path | None:
        """Folder of the files of the result; None if no files were written."""
        return self.files[-1].parent if self.files else None

    @property
    def valid(self) -> Any:
        """True if the result may be used: its standing is ``answered``, and no check fails."""
        return self.standing == "answered"

    def quantity(self, name: str) -> Quantity:
        """Returns the quantity with this name.

        Raises
        ------
        Error
            There is no such quantity.
        """
        found = next((quantity for quantity in self.quantities if quantity.name == name), None)
        if found is None:
            raise Error(f"there is no quantity `{name}`, only {', '.join(f'`{q.name}`' for q in self.quantities)}")
        return found

    def table(self, name: str) -> Table:
        """Returns the table with this name, such as ``modulus`` for ``modulus.csv``.

        Raises
        ------
        Error
            There is no such table.
        """
        found = self.tables.get(name)
        if found is None:
            raise Error(f"there is no table `{name}`, only {', '.join(f'`{t}`' for t in self.tables)}")
        return found

    def require(self) -> Self:
        """Returns the result itself if the data allow a result; otherwise raises an exception.

        Raises
        ------
        NotAllowed
            The data do not allow a result.
        """
        if self.standing == "not allowed":
            raise NotAllowed(self)
        return self

    def report(self) -> str:
        """Returns the report: one page of HTML that contains its interactive figures, and no date."""
        return self._report if isinstance(self._report, str) else self._report.report()

    def _repr_html_(self) -> str:
        import html

        page = html.escape(self.report(), quote=True)
        frame = f'<iframe srcdoc="{page}" style="width:100%;height:40em;border:0"></iframe>'
        return f"<p><strong>{html.escape(self.standing)}</strong>: {html.escape(self.headline)}</p>{frame}"

    def __getstate__(self) -> dict[str, Any]:
        plain = {"tables": dict(self.tables), "attachments": dict(self.attachments), "_report": self.report()}
        return self.__dict__ | plain | {"_kept": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        maps = {name: MappingProxyType(state[name]) for name in ("tables", "attachments")}
        self.__dict__.update(state | maps)


def _table(name: str, title: str, columns: list[tuple[str, str, str, NDArray[np.float64] | NDArray[np.bool_] | list[str]]]) -> Table:
    arrays: dict[str, Column] = {}
    for column, _, _, cells in columns:
        array: Column = cells if isinstance(cells, np.ndarray) else np.array(cells, dtype=np.str_)
        array.flags.writeable = False
        if column in arrays:
            raise RuntimeError(f"fault in rodlab, please report it: the table `{name}` has two columns `{column}`")
        arrays[column] = array
    units = {column: unit for column, _, unit, _ in columns}
    words = {column: said for column, said, _, _ in columns}
    return Table(name, title, MappingProxyType(units), MappingProxyType(words), MappingProxyType(arrays))
