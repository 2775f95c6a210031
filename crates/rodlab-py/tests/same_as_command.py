"""Comparison with the files that the command writes."""

import csv
import math
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from rodlab import Table


def command(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the console script in a separate process."""
    script = Path(sys.executable).with_name("rodlab")
    return subprocess.run([script, *words], capture_output=True, text=True, check=False, timeout=300)


def expect_file(table: Table, path: Path) -> None:
    """Asserts that every name, text, truth value and number of `table` equals that of the file, to the last bit."""
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    columns = table.columns()
    assert list(columns) == names
    assert len(table) == len(rows) > 0
    for at, column in enumerate(columns.values()):
        cells = [row[at] for row in rows]
        if column.dtype.kind == "f":
            expected = np.array([float(cell) if cell else math.nan for cell in cells])
            finite = np.where(np.isfinite(column), column, np.nan)
            np.testing.assert_array_equal(finite, expected)
        elif column.dtype.kind == "b":
            assert [str(answer).lower() for answer in column] == cells
        else:
            assert column.tolist() == cells


def expect_files(tables: Mapping[str, Table], folder: Path) -> None:
    """Asserts that `tables` equal the files in `folder`, and that there are no other files."""
    assert sorted(tables) == sorted(path.stem for path in folder.glob("*.csv"))
    for name, table in tables.items():
        expect_file(table, folder / f"{name}.csv")
